//! The skeleton over the picture: shown, hidden, taken in when it has grown; its root placed by hand.

use std::sync::Arc;

use honami_model::brief::counted;
use honami_model::skeleton::seen;
use honami_workbench::WorkbenchError;
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
    let line = format!("growing the skeleton of {} … Esc stops", counted(groups.shown.len(), "group"));
    state.skeleton.show();
    say(state, line);
}

/// Stops what grows because somebody asked for it, not what grows anew by itself; whether anything did.
pub(super) fn stop(state: &mut State) -> bool {
    let is_asked = state.skeleton.awaited == Some(Awaited::Line);
    if is_asked {
        state.skeleton.hide();
        say(state, "growing was stopped: no skeleton is shown");
    }
    is_asked
}

/// The groups are others now; of another clustering, they have other bones.
pub(super) fn on_groups(state: &mut State, is_regrouped: bool) {
    state.window.outdate();
    let skeleton = &mut state.skeleton;
    skeleton.outdate();
    skeleton.is_past = skeleton.bones.is_some();
    if is_regrouped {
        skeleton.chosen = None;
        if let Some(mode) = at_bone(&mut state.mode) {
            *mode = Mode::Review;
            let line = "the tracks are grouped otherwise now: the bone's shape is not kept";
            happened(state, line.to_owned(), true);
        }
    }
}

/// Where a bone is being shaped, also below a list.
fn at_bone(mode: &mut Mode) -> Option<&mut Mode> {
    match mode {
        Mode::Shape(_) => Some(mode),
        Mode::Menu(menu) => at_bone(&mut menu.below),
        _ => None,
    }
}

/// What has become of a growth; what it grew from may have changed meanwhile.
pub(super) fn on_grown(state: &mut State, revision: u64, grown: Result<Arc<Bones>, String>) {
    let skeleton = &mut state.skeleton;
    if !skeleton.is_on || skeleton.revision != revision {
        return;
    }
    let awaited = skeleton.awaited.take();
    skeleton.bones = grown.as_ref().ok().cloned();
    (skeleton.pose, skeleton.is_past) = (None, false);
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
        state.window.outdate();
        state.skeleton.take(hand);
        pose(state);
    }
}

/// Works out where all joints are, as bones are shaped; and where they will be, where one is being shaped.
pub(super) fn pose(state: &mut State) {
    let Some(bones) = state.skeleton.bones.clone() else { return };
    let hand = &state.skeleton.hand;
    match bones.pose(|node| hand.shape(node)) {
        Ok(kept) => state.skeleton.pose = Some(kept),
        Err(why) => cannot(state, &why),
    }
    preview(state);
}

/// Works out where all joints will be, where a bone is being shaped.
pub(super) fn preview(state: &mut State) {
    let Some(bones) = state.skeleton.bones.clone() else { return };
    let hand = &state.skeleton.hand;
    let Some(Mode::Shape(shaping)) = at_bone(&mut state.mode) else { return };
    let (open, shape) = (shaping.bone.node, shaping.shape);
    match bones.pose(|node| if node == open { shape } else { hand.shape(node) }) {
        Ok(pose) => shaping.pose = pose,
        Err(why) => cannot(state, &why),
    }
}

fn cannot(state: &mut State, why: &WorkbenchError) {
    happened(state, format!("the skeleton cannot be shaped so: {why}"), true);
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
    let middle = || edit::within(&state.clip, state.centre.map(f32::round));
    state.mode = Mode::Root(root(state).unwrap_or_else(middle));
    if !state.skeleton.is_on && state.groups.is_some() {
        state.skeleton.show();
    }
}

/// Where the root is, by hand or as it grew.
fn root(state: &State) -> Option<[f32; 2]> {
    let bones = state.skeleton.bones.as_ref().filter(|_| !state.skeleton.is_past);
    let grown = bones.map(|bones| seen(bones.growth.skeleton.root()));
    state.skeleton.hand.root.or(grown).map(|at| at.map(|v| v as f32))
}

/// Keeps the root where it was placed.
pub(super) fn place_root(state: &mut State) -> Vec<Effect> {
    let Mode::Root(at) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    if root(state) == Some(at) {
        say(state, "the root stays where it is");
        return Vec::new();
    }
    vec![Effect::Shape(Step::Root(Some(at.map(f64::from))), UNDO)]
}

/// It is as it grows again.
pub(super) fn release(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    vec![Effect::Shape(Step::Release, UNDO)]
}
