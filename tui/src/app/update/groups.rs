//! Groups by hand: merged, split, tracks taken into another, named. The selected track says which group is meant.

use honami_model::track::TrackSet;
use honami_workbench::regroup::Step;

use super::{Effect, Mode, State, UNDO, complain, edit};
use crate::app::menu::{Choice, Menu};

/// The selected track's group, where groups can be changed; says why not.
fn selected(state: &mut State) -> Option<u32> {
    if !edit::is_writable(state) {
        return None;
    }
    let group = state.selected.and_then(|track| state.groups.as_ref()?.of(track));
    if group.is_none() {
        complain(state, "the selected track is in no group: c groups the tracks");
    }
    group
}

/// Lists the other groups, to merge with or to take tracks into.
pub(super) fn choose_other(state: &mut State, title: &'static str, choice: fn(u32) -> Choice) {
    let Some(group) = selected(state) else { return };
    let Some(groups) = state.groups.as_ref().filter(|groups| groups.shown.len() > 1) else {
        return complain(state, "there is one group alone: + opens it");
    };
    state.mode = Mode::Menu(Box::new(Menu::of_groups(groups, group, title, choice)));
    super::time::stop(state);
}

/// Merges the selected track's group with another.
pub(super) fn merge(state: &mut State, with: u32) -> Vec<Effect> {
    let group = selected(state);
    group.map(|group| Effect::Regroup(Step::Merge(group, with), UNDO)).into_iter().collect()
}

/// Splits the selected track's group.
pub(super) fn split(state: &mut State) -> Vec<Effect> {
    selected(state).map(|group| Effect::Regroup(Step::Split(group), UNDO)).into_iter().collect()
}

/// Takes the picked tracks, else the selected one, into a group.
pub(super) fn take(state: &mut State, into: u32) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    let picked: TrackSet = match &state.picked {
        none if none.is_empty() => state.selected.into_iter().collect(),
        picked => picked.iter().copied().collect(),
    };
    vec![Effect::Regroup(Step::Take(picked, into), UNDO)]
}

/// Asks for a name of the selected track's group.
pub(super) fn begin_name(state: &mut State) {
    let Some(group) = selected(state) else { return };
    super::time::stop(state);
    state.mode = Mode::GroupName(known(state, group).unwrap_or_default());
}

/// Takes the typed name; an empty one forgets it.
pub(super) fn name(state: &mut State) -> Vec<Effect> {
    let Mode::GroupName(typed) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let Some(group) = selected(state) else { return Vec::new() };
    let name = Some(typed.trim().to_owned()).filter(|name| !name.is_empty());
    if name == known(state, group) {
        return Vec::new();
    }
    vec![Effect::Regroup(Step::Name(group, name), UNDO)]
}

fn known(state: &State, group: u32) -> Option<String> {
    state.groups.as_ref()?.names.get(group as usize)?.clone()
}

/// The groups are those of the cut again.
pub(super) fn release(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    if state.groups.as_ref().is_none_or(|groups| groups.held.is_empty()) {
        complain(state, "no group was made by hand: G m merges, G s splits, G t takes tracks into another");
        return Vec::new();
    }
    vec![Effect::Regroup(Step::Release, UNDO)]
}
