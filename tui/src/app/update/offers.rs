//! Corrections that are worked out behind the screen: asked for, shown when they come, and kept no sooner.

use super::{Action, Effect, Found, Mode, Notice, State, on_key};
use crate::app::correcting::{Answer, Ask, Moving};
use crate::term::key::Key;

/// More keys than anybody presses while one correction is worked out.
const HELD_MAX: usize = 64;

/// What is to be worked out now for the sample that is moved; nothing any more once none is.
pub(super) fn asks(state: &mut State) -> Vec<Effect> {
    match &mut state.mode {
        Mode::Move(moving) => {
            let asks = moving.asks();
            state.is_asking |= !asks.is_empty();
            asks.into_iter().map(Effect::Offer).collect()
        }
        // What is open lies below.
        Mode::Menu(_) => Vec::new(),
        _ if std::mem::take(&mut state.is_asking) => vec![Effect::Offer(Ask::Ghost(None))],
        _ => Vec::new(),
    }
}

/// Says something that has no place in the log: it answers no action that is there, and comes in its own time.
fn note(state: &mut State, text: String, is_error: bool) {
    state.notice = Some(Notice { text, is_error });
}

/// Something was worked out, or cannot be: then it is said.
pub(super) fn on_answer(state: &mut State, answer: Answer) {
    let State { mode, clip, held, .. } = state;
    let Some(moving) = moving(mode) else { return };
    let why = match &answer {
        Answer::Ghost(wish, Err(why)) if moving.wish().as_ref() == Some(wish) => Some(why.clone()),
        Answer::Errors(track, Err(why)) if *track == moving.track => {
            Some(format!("how far off each model is could not be measured: {why}"))
        }
        _ => None,
    };
    moving.answer(answer, held.is_empty());
    moving.preview(&clip.times);
    if let Some(text) = why {
        note(state, text, true);
    }
}

/// The sample that is moved, also below a menu.
fn moving(mode: &mut Mode) -> Option<&mut Moving> {
    match mode {
        Mode::Move(moving) => Some(moving),
        Mode::Menu(menu) => moving(&mut menu.below),
        _ => None,
    }
}

/// Holds the keys that would keep what is not there yet, and those after them; returns whether it does.
pub(super) fn hold(state: &mut State, found: Found) -> bool {
    let Mode::Move(moving) = &state.mode else { return false };
    if found != Found::Action(Action::Accept) || !moving.is_pending() {
        return false;
    }
    let word = moving.model().map_or("it", |model| model.word());
    let line = format!("{word} …: kept as soon as it is there; Esc goes on moving");
    state.held = std::mem::take(&mut state.pending);
    note(state, line, false);
    true
}

/// One more key behind those that are held; Esc gives them up.
pub(super) fn hold_more(state: &mut State, key: Key) {
    if state.keys.find(state.mode.context(), &[key]) == Found::Action(Action::Back) {
        state.held.clear();
        note(state, "not kept: it can be moved on".to_owned(), false);
    } else if state.held.len() < HELD_MAX {
        state.held.push(key);
    }
}

/// The first of the held keys, once what it waited for is there.
pub(super) fn release(state: &mut State) -> Vec<Effect> {
    if state.held.is_empty() || state.awaits_ghost() {
        return Vec::new();
    }
    if let Mode::Move(moving) = &state.mode
        && let Some(Err(why)) = &moving.ghost
    {
        let line = why.clone();
        state.held.clear();
        note(state, line, true);
        return Vec::new();
    }
    let mut held = std::mem::take(&mut state.held);
    let first = held.remove(0);
    let effects = on_key(state, first);
    state.held.append(&mut held);
    effects
}
