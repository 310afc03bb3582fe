//! Ranges of frames, and what is said of the feature in them; on all picked tracks at once.

use honami_model::track::{Status, TrackSet};
use honami_workbench::correct::Step;

use super::{Effect, State, UNDO, complain, edit, say};
use crate::app::ranging::Ranging;

/// Begins a range here, or ends it here.
pub(super) fn begin_or_end(state: &mut State) {
    super::time::stop(state);
    let here = state.frame;
    let line = match state.range {
        Some(Ranging { from, to: None }) => {
            let range = Ranging { from, to: Some(here) };
            state.range = Some(range);
            format!(
                "{}: x lost, o occluded, O outside, d r takes it away, Esc gives it up",
                range.words(here)
            )
        }
        _ => {
            state.range = Some(Ranging { from: here, to: None });
            format!("a range begins at {here}: go to its other end; r ends it there, x o O d r work on it")
        }
    };
    say(state, line);
}

/// Says that the feature is lost in the range, or from here to the next key-frame of any of the tracks.
pub(super) fn lost(state: &mut State) -> Vec<Effect> {
    let Some(tracks) = targets(state) else { return Vec::new() };
    let (here, last) = (state.frame, state.last_frame());
    let frames = match state.range {
        Some(range) => range.frames(here),
        None => {
            let rows = tracks.iter().filter_map(|track| state.row(track));
            let next = rows.filter_map(|row| row.keys.iter().find(|key| **key > here)).min();
            here..next.copied().unwrap_or(last.saturating_add(1))
        }
    };
    step(state, Step::Mark { tracks, frames, status: Status::Lost })
}

/// Says what is known of the feature in the range, or in this frame.
pub(super) fn mark(state: &mut State, status: Status) -> Vec<Effect> {
    let Some(tracks) = targets(state) else { return Vec::new() };
    let here = state.frame;
    let frames = state.range.map_or(here..here.saturating_add(1), |range| range.frames(here));
    step(state, Step::Mark { tracks, frames, status })
}

/// Takes the samples of the range away.
pub(super) fn delete(state: &mut State) -> Vec<Effect> {
    let Some(tracks) = targets(state) else { return Vec::new() };
    let Some(range) = state.range else {
        complain(state, "no range to take away: r begins one here");
        return Vec::new();
    };
    step(state, Step::DeleteRange { tracks, frames: range.frames(state.frame) })
}

/// The picked tracks, else the selected one; says why there are none, or why they cannot be edited.
pub(super) fn targets(state: &mut State) -> Option<TrackSet> {
    if state.picked.is_empty() {
        return edit::selected(state).map(|row| row.id.into());
    }
    edit::is_writable(state).then(|| state.picked.iter().copied().collect())
}

/// Asks for a step; the clip stops, so that its outcome is seen.
pub(super) fn step(state: &mut State, step: Step) -> Vec<Effect> {
    super::time::stop(state);
    vec![Effect::Correct(step, UNDO)]
}
