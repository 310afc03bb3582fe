//! Moving in time and among tracks.

use std::time::Duration;

use honami_model::track::TrackId;

use super::{Mode, State, complain, say};
use crate::app::menu::Menu;
use crate::app::state::Play;

pub(super) fn on_clock(state: &mut State, now: Duration) {
    state.now = now;
    let Some(play) = state.play else { return };
    state.frame = state.frame_of_clock(&play);
    let end = if play.rate >= 0.0 { state.last_frame() } else { 0 };
    if state.frame == end {
        state.play = None;
    }
    keep_in_view(state);
}

/// Plays at a rate, or pauses what plays.
pub(super) fn play(state: &mut State, rate: f64) {
    if state.play.take().is_some() {
        return;
    }
    let end = if rate >= 0.0 { state.last_frame() } else { 0 };
    if state.frame == end {
        state.frame = state.last_frame() - end;
    }
    state.play = Some(Play { rate, since: state.now, from: state.frame });
}

/// Goes to a frame, the last one at most; stops playing.
pub(super) fn go(state: &mut State, frame: u32) {
    if frame > state.last_frame() {
        let line = format!("there is no frame {frame}: this is the last one, {}", state.last_frame());
        say(state, line);
    }
    state.play = None;
    state.frame = frame.min(state.last_frame());
    if let Mode::Move { .. } = state.mode {
        state.mode = Mode::Review;
    }
    keep_in_view(state);
}

pub(super) fn step(state: &mut State, frames: i64) {
    let target = (i64::from(state.frame) + frames).clamp(0, i64::from(state.last_frame()));
    go(state, u32::try_from(target).unwrap_or(0));
}

pub(super) fn select(state: &mut State, track: TrackId) {
    state.selected = Some(track);
    keep_in_view(state);
}

/// Selects the track so many further in the list, from its end to its beginning.
pub(super) fn step_track(state: &mut State, by: i64) {
    let n = i64::try_from(state.tracks.len()).unwrap_or(0);
    if n == 0 {
        return complain(state, "there are no tracks yet: t follows features, a adds one by hand");
    }
    let listed = state.listed();
    let here = state.selected.and_then(|id| listed.iter().position(|row| row.id == id));
    let next = match here {
        Some(at) => (i64::try_from(at).unwrap_or(0) + by).rem_euclid(n),
        None => 0,
    };
    let next = listed[usize::try_from(next).unwrap_or(0)].id;
    select(state, next);
}

/// Lists tracks by doubt, or by number again.
pub(super) fn sort(state: &mut State) {
    state.by_doubt = !state.by_doubt;
    let line = if state.by_doubt {
        "tracks are listed by doubt, the worst first"
    } else {
        "tracks are listed by number"
    };
    say(state, line);
}

/// Selects the track with the number typed before, or opens the list of tracks.
pub(super) fn go_track(state: &mut State) {
    let Some(number) = state.count else {
        state.mode = Mode::Menu(Box::new(Menu::of_tracks(state)));
        return;
    };
    match state.row(TrackId(number)).map(|row| row.id) {
        Some(track) => select(state, track),
        None => complain(state, format!("there is no track {number}")),
    }
}

/// Goes to the most doubtful frame of the selected track, from there to the next worst, and round again.
pub(super) fn go_worst(state: &mut State) {
    let Some(row) = state.selected_row() else {
        return complain(state, "select a track first: n takes the next");
    };
    let (id, n) = (row.id, row.worst.len());
    let here = row.worst.iter().position(|&frame| frame == state.frame);
    let at = here.map_or(0, |at| (at + 1) % n);
    match row.worst.get(at).copied() {
        Some(frame) => {
            go(state, frame);
            say(state, format!("track {id}: doubtful frame {} of {n}", at + 1));
        }
        None => say(state, format!("track {id}: nothing is doubtful")),
    }
}

/// Goes to the key-frame so many further on.
pub(super) fn go_key(state: &mut State, by: i64) {
    let Some(row) = state.selected_row() else {
        return complain(state, "select a track first: n takes the next");
    };
    let id = row.id;
    let nth = usize::try_from(by.unsigned_abs()).unwrap_or(usize::MAX).saturating_sub(1);
    let target = if by > 0 {
        let mut later = row.keys.iter().filter(|k| **k > state.frame);
        later.clone().nth(nth).or_else(|| later.next_back()).copied()
    } else {
        let mut earlier = row.keys.iter().rev().filter(|k| **k < state.frame);
        earlier.clone().nth(nth).or_else(|| earlier.next_back()).copied()
    };
    match target {
        Some(frame) => go(state, frame),
        None => say(
            state,
            format!("track {id}: no key-frame {}", if by > 0 { "after this" } else { "before this" }),
        ),
    }
}

/// Following, the selected track stays in the middle.
pub(super) fn keep_in_view(state: &mut State) {
    if state.follow
        && let Some(at) = state.selected_at()
    {
        state.centre = at;
    }
}
