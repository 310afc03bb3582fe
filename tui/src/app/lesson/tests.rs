//! The tutorial, walked through by the keys it asks for.

use std::sync::Arc;

use honami_model::history::Entry;

use super::*;
use crate::app::fixture;
use crate::app::state::State;
use crate::app::update::{Effect, Fact, Msg, update};

/// The fixture as the tutorial begins: nothing is grouped.
fn begun() -> State {
    let mut state = fixture::state();
    state.groups = None;
    state.lesson = Some(Lesson::new(&state));
    state
}

/// What the world would make of an effect, as far as a lesson looks.
fn carry_out(state: &mut State, effect: &Effect) {
    let (n, head) = (state.history.len() as u32, state.history.head);
    let fact = match effect {
        Effect::Commit(..) | Effect::Judge(_) | Effect::Correct(..) | Effect::Retrack { .. } => {
            let entry = Entry {
                id: EntryId(n),
                parent: Some(head),
                next: None,
                label: String::new(),
                author: String::new(),
                time: String::new(),
            };
            Fact::History(vec![entry], EntryId(n))
        }
        Effect::Study(track) => Fact::Layers(fixture::layers(state, *track).map(Arc::new)),
        Effect::Undo(_) => Fact::History(Vec::new(), EntryId(0)),
        Effect::Cluster(_) => Fact::Groups(fixture::state().groups.map(Box::new)),
        _ => return,
    };
    update(state, Msg::Fact(fact));
}

fn press(state: &mut State, keys: &str) {
    for key in keys.split_whitespace() {
        for effect in update(state, Msg::Key(key.parse().unwrap())) {
            carry_out(state, &effect);
        }
    }
}

fn at(state: &State) -> usize {
    state.lesson.as_ref().unwrap().at
}

/// For every step keys that are asked for, and before them some that do not do it.
const WALK: [(&str, &str); 15] = [
    (".", "space"),
    ("z", "space"),
    ("j", "3 ."),
    ("w", "j"),
    ("w", "n"),
    ("w", "Enter"),
    ("m l Esc", "m l Enter"),
    ("j", "t t"),
    ("m l Enter", "x"),
    ("s l . Esc", "s . Enter"),
    ("j", "u"),
    ("v t", "v v"),
    ("c Esc", "c Enter"),
    ("j", ": Esc"),
    (": Esc", "? Esc"),
];

#[test]
fn every_step_is_done_by_the_keys_it_asks_for_and_by_no_others() {
    let mut state = begun();
    for (step, (other, asked)) in WALK.into_iter().enumerate() {
        press(&mut state, other);
        assert_eq!(at(&state), step, "{other} is not what was asked");
        let words = state.lesson.as_ref().unwrap().words(&state.keys);
        let said =
            |keys: &str| words.iter().any(|(word, is_key)| *is_key && word.trim_end_matches(',') == keys);
        let chords = asked.replace("3 ", "").replace("v v", "v_v").replace("t t", "t_t");
        for keys in chords.split(' ').map(|keys| keys.replace('_', " ").replace("Enter", "⏎")) {
            assert!(said(&keys), "{keys} is not said in {words:?}");
        }
        press(&mut state, asked);
        assert_eq!(at(&state), step + 1, "{asked} is what was asked");
    }
    assert_eq!(state.lesson.as_ref().unwrap().step(), Some((STEPS.len(), STEPS.len())));
}

#[test]
fn every_step_names_keys_that_are_bound() {
    let keys = KeyMap::default();
    for (at, step) in STEPS.iter().enumerate() {
        let words = Lesson { at, ..Lesson::default() }.words(&keys);
        assert!(
            words.iter().all(|(word, is_key)| !*is_key || !word.starts_with(':') || word.len() < 3),
            "{words:?}"
        );
        assert!(
            words.iter().any(|(_, is_key)| *is_key) && !words.iter().any(|w| w.0.contains('{')),
            "{}",
            step.text
        );
        let n: usize = words.iter().map(|(word, _)| word.chars().count() + 1).sum();
        assert!(n <= 110, "three rows of a narrow screen: {}", step.text);
    }
}

#[test]
fn keys_of_ones_own_are_those_that_are_said() {
    let table = "[review]\nplay = \"F5\"\n".parse().unwrap();
    let (keys, wrong) = KeyMap::with(&table);
    assert_eq!(wrong, Vec::<String>::new());
    assert!(Lesson::default().words(&keys).contains(&("F5".to_owned(), true)));
}

#[test]
fn escape_closes_it_once_nothing_else_is_left_to_close() {
    let mut state = begun();
    press(&mut state, "space Esc");
    assert_eq!(at(&state), 2, "the clip was paused");
    press(&mut state, "? Esc");
    assert_eq!(at(&state), 2, "the help was closed");
    press(&mut state, "Esc");
    assert_eq!(state.lesson.as_ref().unwrap().step(), None);
    press(&mut state, "space .");
    assert_eq!(state.lesson.as_ref().unwrap().step(), None, "and stays closed");
}
