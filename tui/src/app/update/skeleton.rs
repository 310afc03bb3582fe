//! The skeleton over the picture: shown, hidden, taken in when it has grown.

use std::sync::Arc;

use super::facts::happened;
use super::{State, complain, say};
use crate::app::skeleton::{Awaited, Bones};

/// Grows the skeleton of the shown groups and shows it, or shows it no longer.
pub(super) fn toggle(state: &mut State) {
    if state.skeleton.is_on {
        state.skeleton.hide();
        return say(state, "the skeleton is hidden");
    }
    let Some(groups) = &state.groups else {
        return complain(state, "a skeleton grows from groups, and there are none: c groups the tracks");
    };
    let n = groups.shown.len();
    let line = format!("growing the skeleton of {n} {} … Esc stops", if n == 1 { "group" } else { "groups" });
    state.skeleton.show();
    say(state, line);
}

/// Stops what grows; whether anything did.
pub(super) fn stop(state: &mut State) -> bool {
    let is_growing = state.skeleton.awaited.is_some();
    if is_growing {
        state.skeleton.hide();
        say(state, "growing was stopped: no skeleton is shown");
    }
    is_growing
}

/// What has become of a growth; what it grew from may have changed meanwhile.
pub(super) fn on_grown(state: &mut State, revision: u64, grown: Result<Arc<Bones>, String>) {
    let skeleton = &mut state.skeleton;
    if !skeleton.is_on || skeleton.revision != revision {
        return;
    }
    let awaited = skeleton.awaited.take();
    skeleton.bones = grown.as_ref().ok().cloned();
    match grown {
        Ok(bones) if awaited == Some(Awaited::Line) => happened(state, bones.words(), false),
        Ok(_) => {}
        Err(why) => happened(state, format!("no skeleton: {why}"), true),
    }
}
