//! Every action is found by its name wherever it works, and every hint is a key that works.

use super::*;
use crate::app::action::TABLE;
use crate::app::fixture;

/// A state in which keys are read in a place.
fn in_place(context: Context) -> State {
    let mut state = fixture::state();
    let mut press = |keys: &str| {
        for key in keys.split(' ') {
            update(&mut state, Msg::Key(key.parse().unwrap()));
        }
    };
    match context {
        Context::Review => press("g f 4 0 Enter z"),
        Context::Place => press("z a"),
        Context::Move => press("g f 4 0 Enter m"),
        Context::Slide => press("g f 4 0 Enter T"),
        Context::Sketch => press("g f 4 0 Enter s ."),
        Context::Form => press("t r j"),
        Context::Menu => press("/ 1"),
        Context::Prompt => press("g f 4"),
        Context::Dial => press("v d"),
        Context::Label => press("g l"),
        Context::History => press("U j"),
        Context::Start => unreachable!("nothing is open there"),
    }
    assert_eq!(state.mode.context(), context);
    state
}

#[test]
fn every_action_is_reached_from_the_palette_and_the_help() {
    for context in Context::ALL.into_iter().filter(|c| !c.is_text() && *c != Context::Start) {
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

#[test]
fn every_hint_is_a_key_that_works_here() {
    for context in Context::ALL.into_iter().filter(|context| *context != Context::Start) {
        let state = in_place(context);
        for (keys, word) in state.keys.hints(context) {
            let bound = state.keys.bindings().iter().filter(|b| b.context == context);
            let mut alike = bound.filter(|b| b.action.word_in(context) == Some(word));
            let first = alike.next().unwrap();
            assert!(keys.contains(&crate::app::keymap::shown(&first.keys)), "{keys} {word}");
        }
    }
}
