//! Whole tracks: picked, split, swapped, joined, duplicated, averaged, named.

use honami_model::edit::Transaction;
use honami_model::track::TrackId;
use honami_workbench::correct::Step;

use super::{Effect, Mode, State, UNDO, complain, edit, ranges, say};
use crate::app::menu::{Choice, Menu};

/// Picks the selected track, or no longer.
pub(super) fn pick(state: &mut State) {
    let Some(track) = state.selected else {
        return complain(state, "select a track first: j takes the next, a click takes the nearest");
    };
    let is_new = state.picked.insert(track);
    if !is_new {
        state.picked.remove(&track);
    }
    say_picked(state, &format!("track {track} is {}picked", if is_new { "" } else { "not " }));
}

/// Picks the selected track's group; where all of it is picked, none of it.
pub(super) fn pick_group(state: &mut State) {
    let found = state.selected.zip(state.groups.as_ref());
    let group = found.and_then(|(track, groups)| Some((groups, groups.of(track)?)));
    let Some((groups, group)) = group else {
        return complain(state, "the selected track is in no group: c groups the tracks, y picks one track");
    };
    let is_there = |track: &TrackId| groups.of(*track) == Some(group) && state.row(*track).is_some();
    let tracks: Vec<TrackId> = groups.tracks.iter().copied().filter(is_there).collect();
    let is_whole = tracks.iter().all(|track| state.picked.contains(track));
    for track in tracks {
        if is_whole {
            state.picked.remove(&track);
        } else {
            state.picked.insert(track);
        }
    }
    say_picked(state, &format!("group {} is {}picked", group + 1, if is_whole { "not " } else { "" }));
}

fn say_picked(state: &mut State, what: &str) {
    let line = match state.picked.len() {
        0 => format!("{what}; none are"),
        n => format!("{what}, {n} in all: x o O mark them, d deletes, Esc picks none"),
    };
    say(state, line);
}

/// Cuts the selected track in two here.
pub(super) fn split(state: &mut State) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    let (frame, frames) = (state.frame, row.span.frames());
    if frame <= frames.start || frames.end <= frame {
        let line = format!(
            "track {} is in frames {}-{}: go to where the second part begins",
            row.id,
            frames.start,
            frames.end.saturating_sub(1)
        );
        complain(state, line);
        return Vec::new();
    }
    ranges::step(state, Step::Split { track: row.id, frame })
}

/// Makes a track like the selected one.
pub(super) fn duplicate(state: &mut State) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    ranges::step(state, Step::Duplicate(row.id))
}

/// Makes a track in the middle of the picked ones.
pub(super) fn average(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    if state.picked.len() < 2 {
        let n = state.picked.len();
        complain(
            state,
            format!("two tracks or more have an average, {n} picked: y picks the selected one, Y its group"),
        );
        return Vec::new();
    }
    ranges::step(state, Step::Average(state.picked.iter().copied().collect()))
}

/// Lists the tracks that the selected one can be swapped or joined with.
pub(super) fn choose_other(state: &mut State, title: &'static str, choice: fn(TrackId) -> Choice) {
    let Some(row) = edit::selected(state) else { return };
    if state.tracks.len() < 2 {
        return complain(state, format!("track {} is alone: there is no other to work with", row.id));
    }
    super::time::stop(state);
    state.mode = Mode::Menu(Box::new(Menu::of_others(state, title, choice)));
}

/// Exchanges the selected track with another: in the range, else from here on.
pub(super) fn swap(state: &mut State, with: TrackId) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    let here = state.frame;
    let frames = state.range.map_or(here..state.clip.n_frames(), |range| range.frames(here));
    ranges::step(state, Step::Swap { tracks: [row.id, with], frames })
}

/// Fills the selected track with another.
pub(super) fn join(state: &mut State, with: TrackId) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    ranges::step(state, Step::Join { track: row.id, with })
}

/// Asks for a name.
pub(super) fn begin_name(state: &mut State) {
    if let Some(row) = edit::selected(state) {
        super::time::stop(state);
        state.mode = Mode::Name(row.name.unwrap_or_default());
    }
}

/// Takes the typed name; an empty one forgets it.
pub(super) fn name(state: &mut State) -> Vec<Effect> {
    let Mode::Name(typed) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let Some(row) = edit::selected(state) else { return Vec::new() };
    let name = Some(typed.trim().to_owned()).filter(|name| !name.is_empty());
    if name == row.name {
        return Vec::new();
    }
    vec![Effect::Commit(Transaction::name_track(row.id, name), UNDO)]
}
