//! The viewer's window beside the terminal: opened and closed, told where the terminal is, and heard.
//!
//! Whoever moved last leads. What the window itself has said is never told back to it.

use honami_model::track::TrackId;
use honami_workbench::scene::control::{Chosen, Command, Event};

use super::facts::happened;
use super::{Effect, Mode, State, UNDO, complain, edit, logged, say, time};
use crate::app::panel::Panel;
use crate::app::window::{Seen, Stage};
use crate::viewer::{self, Heard};

/// Opens the window, or closes the one that there is.
pub(super) fn toggle(state: &mut State) -> Vec<Effect> {
    if state.window.stage != Stage::Shut {
        state.window.shut();
        say(state, "the viewer's window is closed");
        return vec![Effect::CloseWindow];
    }
    if state.groups.is_none() {
        complain(state, "the window shows a skeleton, which grows from groups: c groups the tracks");
        return Vec::new();
    }
    state.window.open();
    say(state, "opening the viewer's window …");
    vec![Effect::OpenWindow]
}

/// The window has said something, or is gone.
pub(super) fn on_heard(state: &mut State, heard: Heard) -> Vec<Effect> {
    if state.window.stage == Stage::Shut {
        return Vec::new();
    }
    match heard {
        Heard::Said(event) => on_event(state, event),
        Heard::Garbled(garbled) => {
            happened(state, format!("the viewer: {garbled}"), true);
            Vec::new()
        }
        Heard::Ended(how) => {
            let is_error = how.is_some();
            end(state, how.unwrap_or_else(|| "the viewer's window was closed".to_owned()), is_error)
        }
    }
}

fn on_event(state: &mut State, event: Event) -> Vec<Effect> {
    match event {
        Event::Ready { protocol, adapter } => match viewer::stranger(protocol) {
            Some(why) => return end(state, why.to_owned(), true),
            None => {
                state.window.stage = Stage::Open;
                happened(state, format!("the viewer's window is open, drawn by {adapter}"), false);
            }
        },
        Event::Playing(is_playing) => {
            state.window.is_playing = is_playing;
            if is_playing && follows(state) {
                time::stop(state);
            }
        }
        Event::Frame(frame) if follows(state) => time::go(state, frame),
        // What was on its way when the terminal went elsewhere is no longer where the window is.
        Event::Passing(frame) if follows(state) && state.window.is_playing => time::pass(state, frame),
        Event::Frame(_) | Event::Passing(_) | Event::Captured(_) | Event::Closed => {}
        Event::Failed(why) => happened(state, format!("the viewer: {why}"), true),
        Event::Selected(_) if !matches!(state.mode, Mode::Review) => {}
        Event::Selected(_)
        | Event::Shape { .. }
        | Event::Root(_)
        | Event::Cut(_)
        | Event::Undo
        | Event::Redo => {
            logged::window(state, &event);
            return act(state, event);
        }
    }
    Vec::new()
}

/// It is gone.
fn end(state: &mut State, line: String, is_error: bool) -> Vec<Effect> {
    state.window.shut();
    happened(state, line, is_error);
    vec![Effect::CloseWindow]
}

/// Whether the terminal goes where the window goes: what is open in a frame stays there.
fn follows(state: &State) -> bool {
    matches!(state.mode, Mode::Review | Mode::Shape(_))
}

/// Does what was done in the window to what is selected, or to the project.
pub(super) fn act(state: &mut State, event: Event) -> Vec<Effect> {
    let chosen = match event {
        Event::Selected(chosen) => chosen,
        asked => return change(state, asked),
    };
    match chosen {
        Some(Chosen::Bone(node)) => choose(state, node),
        Some(Chosen::Track(track)) => {
            state.skeleton.chosen = None;
            let track = u32::try_from(track).ok().map(TrackId);
            if let Some(track) = track.filter(|track| state.row(*track).is_some()) {
                time::select(state, track);
            }
        }
        None => state.skeleton.chosen = None,
    }
    Vec::new()
}

/// Chooses a bone; where bones are not listed, by a track of its group.
fn choose(state: &mut State, node: u32) {
    state.skeleton.chosen = Some(node);
    let Some(groups) = state.groups.as_ref().filter(|_| state.panel != Some(Panel::Skeleton)) else { return };
    let Some(group) = groups.shown.mains().position(|main| main == node) else { return };
    let is_its = |track: &TrackId| groups.of(*track).is_some_and(|of| of as usize == group);
    if !state.selected.as_ref().is_some_and(is_its)
        && let Some(track) = state.tracks.iter().map(|row| row.id).find(is_its)
    {
        time::select(state, track);
    }
}

/// Changes the project, unless something is open that the change would be under.
fn change(state: &mut State, asked: Event) -> Vec<Effect> {
    let is_free = matches!(state.mode, Mode::Review);
    if !is_free {
        complain(
            state,
            "something is open in the terminal: Enter keeps it, Esc drops it, then the window goes on",
        );
    }
    if !is_free || !edit::is_writable(state) {
        let line = state.notice.as_ref().map(|notice| Command::Say(notice.text.clone()));
        let line = line.filter(|_| state.window.stage == Stage::Open);
        return line.into_iter().map(Effect::Tell).collect();
    }
    // Nothing was given up in the terminal for it.
    state.before = None;
    if matches!(asked, Event::Undo | Event::Redo) {
        state.corrected = None;
    }
    // Also what changes nothing is answered by what there is.
    state.window.outdate();
    vec![Effect::Edit(asked, UNDO)]
}

/// Has the window keep in step: what has changed is shown there, and it goes where the terminal went, unless that was where
/// the window has led.
pub(super) fn keep_step(state: &mut State, was_led: bool) -> Vec<Effect> {
    let mut effects = Vec::new();
    if state.window.is_outdated() {
        effects.push(match state.groups.is_some() {
            true => Effect::ShowWindow,
            false => Effect::Tell(Command::Say(
                "there are no groups any more: this is what grew before".to_owned(),
            )),
        });
    }
    if state.window.stage != Stage::Open {
        return effects;
    }
    let now = Seen::of(state);
    let before = state.window.step(now);
    if was_led && before.is_some() {
        return effects;
    }
    let has_moved = before.is_none_or(|before| before.frame != now.frame);
    if state.window.is_playing && (has_moved || state.play.is_some()) {
        state.window.is_playing = false;
        effects.push(Effect::Tell(Command::Pause));
    }
    if has_moved {
        effects.push(Effect::Tell(Command::Frame(now.frame)));
    }
    if before.is_none_or(|before| before.chosen != now.chosen) {
        effects.push(Effect::Tell(Command::Select(now.chosen)));
    }
    effects
}
