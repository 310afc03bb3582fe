//! Every action is found by its name wherever it works, and every hint is a key that works.

use super::*;
use crate::app::action::TABLE;
use crate::app::fixture;

/// A state in which keys are read in a place.
fn in_place(context: Context) -> State {
    let mut state = fixture::state();
    if context == Context::Shape {
        fixture::skeleton::show(&mut state);
    }
    let mut press = |keys: &str| {
        for key in keys.split(' ') {
            update(&mut state, Msg::Key(key.parse().unwrap()));
        }
    };
    match context {
        Context::Review => press("g f 4 0 Enter z"),
        Context::Place => press("z a"),
        Context::Shape => press("G b"),
        Context::Move => press("g f 4 0 Enter m"),
        Context::Slide => press("g f 4 0 Enter T"),
        Context::Sketch => press("g f 4 0 Enter s ."),
        Context::Paint => press("e p"),
        Context::Scale => press("e b"),
        Context::Form => press("t r j"),
        Context::Menu => press("/ 1"),
        Context::Prompt => press("g f 4"),
        Context::Dial => press("v d"),
        Context::Label => press("g l"),
        Context::History => press("U j"),
        Context::Start | Context::Forest => unreachable!("no project is open there"),
    }
    assert_eq!(state.mode.context(), context);
    state
}

/// Where keys are read in a project.
fn places() -> impl Iterator<Item = Context> {
    Context::ALL.into_iter().filter(|context| !matches!(context, Context::Start | Context::Forest))
}

#[test]
fn every_action_is_reached_from_the_palette_and_the_help() {
    for context in places().filter(|context| !context.is_text()) {
        for opener in [Action::Palette, Action::Help] {
            for info in TABLE.iter().filter(|info| info.action.word_in(context).is_some()) {
                let mut state = in_place(context);
                if opener.word_in(context).is_none() {
                    continue;
                }
                call(&mut state, opener);
                let Mode::Menu(menu) = &mut state.mode else { panic!("no menu in {context:?}") };
                assert!(menu.rows().any(|row| row.choice == Choice::Action(info.action)), "{}", info.name);
                menu.retype(|typed| typed.push_str(&info.name.replace('-', " ")));
                let first = menu.chosen().map(|row| row.choice.clone());
                assert_eq!(first, Some(Choice::Action(info.action)), "{} by its name", info.name);
            }
        }
    }
}

/// G13: what is chosen by its name does what its key does.
#[test]
fn the_palette_and_the_help_do_what_the_key_does() {
    let line = super::tests::line;
    for info in TABLE.iter().filter(|info| info.action.word_in(Context::Review).is_some()) {
        let by_key = |keys: &str| {
            let mut state = in_place(Context::Review);
            let effects = fixture::press(&mut state, keys);
            line(&state, &effects)
        };
        let wanted = by_key(info.keys[0]);
        for opener in [":", "?"] {
            let mut state = in_place(Context::Review);
            fixture::press(&mut state, opener);
            let Mode::Menu(menu) = &mut state.mode else { panic!("{opener} opens no menu") };
            menu.retype(|typed| typed.push_str(&info.name.replace('-', " ")));
            let effects = fixture::press(&mut state, "Enter");
            assert_eq!(line(&state, &effects), wanted, "{} by {opener}", info.name);
        }
    }
}

/// What the bar at the bottom says, drawn: pairs of keys and words.
fn drawn_hints(state: &State) -> Vec<(String, String)> {
    let frame = crate::app::view::draw(&State { size: (600, 24), ..state.clone() }, None);
    let row: String = (0..600).map(|x| frame.cells[(x, 23)].symbol().to_owned()).collect();
    let right = row.trim_end().rsplit_once("    ").unwrap_or_default().1;
    let hints = right.trim().split("  ").filter(|hint| !hint.is_empty());
    // Keys are a sequence as in `t t re-track`, or `space play`: whichever the key map calls so.
    let keys = state.keys.hints(state.mode.context());
    let of = |hint: &str| {
        // What Enter does is said in the words of what is open.
        let is_accept = |(keys, word): &(String, &str)| {
            let words =
                ["accept", "open", "shape", "key-frame", "set", "keep"].map(|word| format!("{keys} {word}"));
            *word == "accept" && words.iter().any(|words| words == hint)
        };
        let is_it = |known: &&(String, &str)| hint == format!("{} {}", known.0, known.1) || is_accept(known);
        let known = keys.iter().find(is_it);
        known.map(|(keys, word)| (keys.clone(), (*word).to_owned()))
    };
    hints.map(|hint| of(hint).unwrap_or_else(|| panic!("{hint} is in no key map: {keys:?}"))).collect()
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig {
        failure_persistence: None,
        ..proptest::prelude::ProptestConfig::with_cases(48)
    })]

    /// Hints are the live key map, also when a user has given keys away, and given one to several.
    #[test]
    fn hints_are_the_live_key_map_whatever_a_user_binds(
        wishes in proptest::collection::btree_map(0..TABLE.len(), 1..12_u8, 0..12),
    ) {
        let wishes: Vec<String> =
            wishes.iter().map(|(at, key)| format!("{} = \"F{key}\"", TABLE[*at].name)).collect();
        let (keys, _) = crate::app::keymap::KeyMap::with(&wishes.join("\n").parse().unwrap());
        for context in places() {
            let mut state = in_place(context);
            state.keys = keys.clone();
            state.zoom = 0;
            for (shown, word) in drawn_hints(&state) {
                let alike = TABLE.iter().filter(|info| info.action.word_in(context) == Some(word.as_str()));
                let first = |info: &crate::app::action::Info| {
                    keys.bindings().iter().find(|b| (b.context, b.action) == (context, info.action))
                };
                let mut rest = shown.as_str();
                for binding in alike.filter_map(first) {
                    let Some(after) = rest.strip_prefix(&crate::app::keymap::shown(&binding.keys)) else { continue };
                    rest = after;
                    proptest::prop_assert_eq!(keys.find(context, &binding.keys), Found::Action(binding.action));
                }
                proptest::prop_assert_eq!(rest, "", "{} {} in {:?} with {:?}", shown, word, context, &wishes);
            }
        }
    }
}

#[test]
fn every_hint_is_a_key_that_works_here() {
    for context in places() {
        let state = in_place(context);
        for (keys, word) in state.keys.hints(context) {
            let bound = state.keys.bindings().iter().filter(|b| b.context == context);
            let mut alike = bound.filter(|b| b.action.word_in(context) == Some(word));
            let first = alike.next().unwrap();
            assert!(keys.contains(&crate::app::keymap::shown(&first.keys)), "{keys} {word}");
        }
    }
}
