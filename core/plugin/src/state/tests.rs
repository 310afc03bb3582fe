//! What was saved is loaded as it was saved, or not at all.

use super::{Setting, State, load, mix, tracker_head};
use crate::testing::stream;
use crate::{Cx, Frame, Info, Points, Result, Seed, Stream, Tracker};
use honami_abi::code;

/// Carries a text.
struct Word(String);

impl Tracker for Word {
    type Params = ();
    const INFO: Info = Info { id: "org.honami.test.word", name: "Word", doc: "", ..Info::NEW };
    const STATE: Option<State<Self>> = Some(State {
        version: 3,
        save: |word| Ok(word.0.clone().into_bytes()),
        load: |(), _, bytes| Ok(Self(std::str::from_utf8(bytes)?.to_owned())),
    });

    fn begin((): &(), _: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self(String::new()))
    }
    fn seed(&mut self, _: &[Seed], _: &Cx<'_>) -> Result<()> {
        Ok(())
    }
    fn retire(&mut self, _: &[u32]) {}
    fn push(&mut self, _: &Frame<'_>, _: &mut Points, _: &Cx<'_>) -> Result<()> {
        Ok(())
    }
}

fn setting() -> Setting {
    Setting { params: mix(0, b"params"), stream: stream(64, 48) }
}

fn saved(word: &str) -> Vec<u8> {
    let state = Word::STATE.unwrap();
    let own = (state.save)(&Word(word.into())).unwrap();
    [tracker_head(&state, &setting(), &own).as_slice(), &own].concat()
}

fn loaded(state: &State<Word>, setting: &Setting, bytes: &[u8]) -> Result<String> {
    load(state, &(), setting, bytes).map(|word| word.0)
}

#[test]
fn what_was_saved_comes_back() {
    for word in ["", "leaf", "穂波 in the wind"] {
        assert_eq!(loaded(&Word::STATE.unwrap(), &setting(), &saved(word)).unwrap(), word);
    }
}

#[test]
fn what_is_cut_or_changed_in_any_place_is_refused() {
    let (state, whole) = (Word::STATE.unwrap(), saved("a leaf"));
    for n in 0..whole.len() {
        let error = loaded(&state, &setting(), &whole[..n]).expect_err("it is cut");
        assert_eq!(error.code(), code::DATA, "{n} bytes: {error}");
        for bit in 0..8 {
            let mut bytes = whole.clone();
            bytes[n] ^= 1 << bit;
            let error = loaded(&state, &setting(), &bytes).expect_err("it is changed");
            assert_eq!(error.code(), code::DATA, "bit {bit} of byte {n}: {error}");
        }
    }
    let longer = [whole.as_slice(), &[0]].concat();
    assert_eq!(loaded(&state, &setting(), &longer).expect_err("it is too long").code(), code::DATA);
}

#[test]
fn what_was_saved_under_other_circumstances_is_refused_and_says_why() {
    let (state, bytes) = (Word::STATE.unwrap(), saved("leaf"));
    let newer = State { version: 4, ..Word::STATE.unwrap() };
    let other = Setting { params: mix(0, b"others"), ..setting() };
    let larger = Setting { stream: stream(65, 48), ..setting() };
    let backward = Setting { stream: Stream { reversed: true, ..stream(64, 48) }, ..setting() };
    for (state, setting, wanted) in [
        (&newer, setting(), "what was saved is of another plugin, or of another version of it"),
        (&state, other, "what was saved is of other parameters, or of another input"),
        (&state, larger, "what was saved is of other parameters, or of another input"),
        (&state, backward, "what was saved is of other parameters, or of another input"),
    ] {
        assert_eq!(loaded(state, &setting, &bytes).expect_err(wanted).to_string(), wanted);
    }
    let own = [0xff];
    let bytes = [tracker_head(&state, &setting(), &own).as_slice(), &own].concat();
    let error = loaded(&state, &setting(), &bytes).expect_err("it is no text");
    assert_eq!(error.code(), code::DATA);
    assert!(error.to_string().starts_with("what was saved cannot be read: "), "{error}");
}
