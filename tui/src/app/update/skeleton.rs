//! The skeleton over the picture: shown, hidden, taken in when it has grown; its root placed by hand.

use std::sync::Arc;

use honami_model::skeleton::seen;
use honami_workbench::shape::Step;

use super::facts::happened;
use super::{Effect, Mode, State, UNDO, actions, complain, edit, say, time};
use crate::app::panel::Panel;
use crate::app::skeleton::{Awaited, Bones, Hand};

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
    skeleton.pose = None;
    pose(state);
    match grown {
        Ok(bones) if awaited == Some(Awaited::Line) => {
            happened(state, bones.words(&state.skeleton.hand), false);
        }
        Ok(_) => {}
        Err(why) => happened(state, format!("no skeleton: {why}"), true),
    }
}

/// This was done by hand now.
pub(super) fn on_hand(state: &mut State, hand: Hand) {
    if state.skeleton.hand != hand {
        state.skeleton.take(hand);
        pose(state);
    }
}

/// Works out where all joints are, as bones are shaped; and as they will be, where one is being shaped.
pub(super) fn pose(state: &mut State) {
    let Some(bones) = state.skeleton.bones.clone() else { return };
    let hand = &state.skeleton.hand;
    let kept = bones.pose(|node| hand.shape(node));
    let open = match &mut state.mode {
        Mode::Shape(shaping) => {
            let (open, shape) = (shaping.bone.node, shaping.shape);
            let pose = bones.pose(|node| if node == open { shape } else { hand.shape(node) });
            pose.map(|pose| shaping.pose = pose)
        }
        _ => Ok(()),
    };
    match kept.and_then(|kept| open.map(|()| kept)) {
        Ok(kept) => state.skeleton.pose = Some(kept),
        Err(why) => happened(state, format!("the skeleton cannot be shaped so: {why}"), true),
    }
}

/// Lists the bones, or no longer; where no skeleton is shown it grows.
pub(super) fn show_bones(state: &mut State) {
    actions::show_panel(state, Panel::Skeleton);
    if state.panel == Some(Panel::Skeleton) && !state.skeleton.is_on && state.groups.is_some() {
        state.skeleton.show();
    }
}

/// Has the root placed, from where it is; the skeleton is shown meanwhile.
pub(super) fn begin_root(state: &mut State) {
    if !edit::is_writable(state) {
        return;
    }
    time::stop(state);
    let grown = state.skeleton.bones.as_ref().map(|bones| seen(bones.growth.skeleton.root()));
    let from = state.skeleton.hand.root.or(grown).map(|at| at.map(|v| v as f32));
    let from = from.unwrap_or(state.centre).map(f32::round);
    state.mode = Mode::Root(edit::within(&state.clip, from));
    if !state.skeleton.is_on && state.groups.is_some() {
        state.skeleton.show();
    }
}

/// Keeps the root where it was placed.
pub(super) fn place_root(state: &mut State) -> Vec<Effect> {
    let Mode::Root(at) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    vec![Effect::Shape(Step::Root(Some(at.map(f64::from))), UNDO)]
}

/// It is as it grows again.
pub(super) fn release(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    vec![Effect::Shape(Step::Release, UNDO)]
}
