//! Correcting: each edit is one transaction, and one `u` takes it back.

use honami_model::clip::Clip;
use honami_model::edit::Transaction;
use honami_model::track::{Source, TrackId};
use honami_workbench::retrack::Way;

use super::{Effect, Mode, State, UNDO, complain, ranges, say};
use crate::app::tracks::TrackRow;

/// Whether edits are possible; says why not.
pub(super) fn is_writable(state: &mut State) -> bool {
    match &state.read_only {
        Some(holder) => {
            let line = format!("read only: {holder} holds this project; nothing can be changed here");
            complain(state, line);
            false
        }
        None => true,
    }
}

/// The point, or the nearest one of the picture.
pub(super) fn within(clip: &Clip, [x, y]: [f32; 2]) -> [f32; 2] {
    let edge = |n: u32| n.saturating_sub(1) as f32;
    [x.clamp(0.0, edge(clip.width)), y.clamp(0.0, edge(clip.height))]
}

pub(super) fn begin_place(state: &mut State) {
    if is_writable(state) {
        super::time::stop(state);
        let from = state.selected_at().filter(|_| state.zoom > 0).unwrap_or(state.centre);
        state.mode = Mode::Place(within(&state.clip, from.map(f32::round)));
    }
}

pub(super) fn place(state: &mut State) -> Vec<Effect> {
    let Mode::Place(at) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    vec![Effect::AddFeature { frame: state.frame, at }]
}

/// The selected track, where it can be edited; says why not.
pub(super) fn selected(state: &mut State) -> Option<TrackRow> {
    if !is_writable(state) {
        return None;
    }
    let row = state.selected_row().cloned();
    if row.is_none() {
        complain(state, "select a track first: j takes the next, a click takes the nearest");
    }
    row
}

/// Confirms the sample shown here.
pub(super) fn confirm(state: &mut State) -> Vec<Effect> {
    if !is_writable(state) {
        return Vec::new();
    }
    let Some(row) = state.selected_row() else {
        say(state, "j selects a track; Enter confirms its sample here");
        return Vec::new();
    };
    let id = row.id;
    match row.span.get(state.frame) {
        Some(sample) if sample.source == Source::Key => {
            say(state, format!("track {id}: frame {} is a key-frame already", state.frame));
            Vec::new()
        }
        Some(sample) => match Transaction::confirm_key(id, state.frame, sample) {
            Ok(edit) => vec![Effect::Commit(edit, UNDO)],
            Err(why) => {
                complain(state, format!("{why} (m places it)"));
                Vec::new()
            }
        },
        None => {
            complain(state, format!("track {id} has no sample at {}; m places one", state.frame));
            Vec::new()
        }
    }
}

/// Takes the key-frame here away.
pub(super) fn clear_key(state: &mut State) -> Vec<Effect> {
    if !is_writable(state) {
        return Vec::new();
    }
    let key = state.selected_row().filter(|row| row.keys.contains(&state.frame)).map(|row| row.id);
    match key {
        Some(track) => vec![Effect::Commit(Transaction::clear_key(track, state.frame), UNDO)],
        None => {
            complain(state, "no key-frame of the selected track is here; [ and ] go to them");
            Vec::new()
        }
    }
}

/// Deletes the picked tracks, else the selected one, and selects the next that is left.
pub(super) fn delete(state: &mut State) -> Vec<Effect> {
    let Some(tracks) = ranges::targets(state) else { return Vec::new() };
    let listed: Vec<TrackId> = state.listed().iter().map(|row| row.id).collect();
    let at = listed.iter().position(|id| Some(*id) == state.selected).unwrap_or(0);
    let (before, after) = listed.split_at(at);
    let stays = |track: &&TrackId| !tracks.contains(**track);
    state.selected = after.iter().find(stays).or_else(|| before.iter().rev().find(stays)).copied();
    vec![Effect::Commit(Transaction::delete_tracks(tracks), UNDO)]
}

/// Tracks the selected track again from the key-frames round the cursor.
pub(super) fn retrack(state: &mut State, way: Way) -> Vec<Effect> {
    let Some(row) = selected(state) else { return Vec::new() };
    if let Some(job) = &state.job {
        let running = format!("{} is still running: wait for it, or stop it with Esc", job.plugin);
        complain(state, running);
        return Vec::new();
    }
    let (frame, within) = (state.frame, state.range.map(|range| range.frames(state.frame)));
    vec![Effect::Retrack { track: row.id, way, frame, within }]
}

/// Cuts the hierarchy into so many groups more.
pub(super) fn cut(state: &mut State, by: i64) -> Vec<Effect> {
    if !is_writable(state) {
        return Vec::new();
    }
    let Some(groups) = &state.groups else {
        complain(state, "there is no hierarchy to cut; c groups the tracks");
        return Vec::new();
    };
    let n_groups = i64::try_from(groups.shown.len()).unwrap_or(i64::MAX);
    let wanted = n_groups.saturating_add(by).clamp(1, i64::from(groups.dendrogram.n_leaves()).max(1));
    // What is held by hand is not opened, nor does it vanish in another group.
    let cut = groups.at(u32::try_from(wanted).unwrap_or(1));
    if cut.of == groups.shown.of {
        let by_hand = if groups.held.is_empty() { "" } else { ": those made by hand stay" };
        let counted = if n_groups == 1 { "1 group".to_owned() } else { format!("{n_groups} groups") };
        let line = format!("{counted} is as far as it goes{by_hand}");
        say(state, line);
        return Vec::new();
    }
    let k = u32::try_from(cut.len()).unwrap_or(u32::MAX);
    vec![Effect::Commit(Transaction::set_cut(k), UNDO)]
}

/// Undo or redo as often as the count says.
pub(super) fn repeat(state: &mut State, effect: fn(u32) -> Effect) -> Vec<Effect> {
    if !is_writable(state) {
        return Vec::new();
    }
    state.corrected = None;
    vec![effect(state.count.unwrap_or(1))]
}
