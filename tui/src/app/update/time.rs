//! Moving in time and among tracks.

use std::time::Duration;

use honami_model::track::TrackId;

use super::{Mode, State, complain, say, sketch};
use crate::app::clock::Play;
use crate::app::menu::Menu;

/// Slowest and fastest that a clip is played, percent of real time.
pub(in crate::app) const RATES: (u32, u32) = (1, 1600);
/// Widest loop, frames to both sides.
pub(in crate::app) const LOOP_MAX: u32 = 10_000;

/// The two rates at which a clip is played: thesis 3.3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// As it was, unless set otherwise.
    Real,
    /// Half as fast, unless set otherwise.
    Slow,
}

pub(super) fn on_clock(state: &mut State, now: Duration) {
    state.now = now;
    let Some(play) = state.play else { return };
    if play.around.is_none() {
        state.frame = play.frame(state.clip.times.as_slice(), now);
        let end = if play.rate >= 0.0 { state.last_frame() } else { 0 };
        if state.frame == end {
            halt(state);
        }
    }
    keep_in_view(state);
}

/// Stops playing; a loop goes back to the frame round which it went.
pub(super) fn stop(state: &mut State) {
    halt(state);
    sketch::on_stop(state);
}

/// The clip stands; a hand that follows it is still on its way.
fn halt(state: &mut State) {
    state.play = None;
    state.dropped = None;
    keep_in_view(state);
}

/// Plays forward or backward at one of the rates, or pauses what plays so. A count sets the rate and keeps it.
pub(super) fn play(state: &mut State, pace: Pace, direction: f64) {
    if let Some(percent) = state.count {
        let rate = percent.clamp(RATES.0, RATES.1);
        state.rates[pace as usize] = rate;
        if rate != percent {
            complain(state, format!("a rate is {} to {} %, got {percent}", RATES.0, RATES.1));
        }
    }
    let rate = direction * f64::from(state.rates[pace as usize]) / 100.0;
    let around = state.play.and_then(|play| play.around);
    let is_same = state.play.is_some_and(|play| (play.rate - rate).abs() < 1e-9);
    if is_same && state.count.is_none() {
        return stop(state);
    }
    let end = if rate >= 0.0 { state.last_frame() } else { 0 };
    if state.frame == end && around.is_none() {
        state.frame = state.last_frame() - end;
    }
    begin(state, rate, around);
}

/// Loops round the current frame, or stops the loop. A count sets the width.
pub(super) fn repeat(state: &mut State) {
    if let Some(count) = state.count {
        state.loop_frames = count.clamp(1, LOOP_MAX);
    } else if state.play.is_some_and(|play| play.around.is_some()) {
        return stop(state);
    }
    let rate = state.play.map_or(f64::from(state.rates[0]) / 100.0, |play| play.rate);
    begin(state, rate, Some(state.loop_frames));
}

fn begin(state: &mut State, rate: f64, around: Option<u32>) {
    state.dropped = None;
    let play = Play { rate, since: state.now, from: state.frame, around };
    state.play = Some(play);
    sketch::on_play(state, play);
}

/// Goes to a frame, the last one at most; stops playing. A loop goes on round that frame.
pub(super) fn go(state: &mut State, frame: u32) {
    if frame > state.last_frame() {
        let line = format!("there is no frame {frame}: this is the last one, {}", state.last_frame());
        say(state, line);
    }
    state.frame = frame.min(state.last_frame());
    match state.play {
        Some(Play { rate, around: Some(around), .. }) => begin(state, rate, Some(around)),
        _ => state.play = None,
    }
    state.dropped = None;
    if let Mode::Move(moving) = &mut state.mode {
        moving.walked = None;
    }
    sketch::on_arrival(state);
    keep_in_view(state);
}

/// Another clock than the terminal's has come to a frame.
pub(super) fn pass(state: &mut State, frame: u32) {
    halt(state);
    state.frame = frame.min(state.last_frame());
    keep_in_view(state);
}

pub(super) fn step(state: &mut State, frames: i64) {
    go(state, stepped(state, frames));
}

/// The frame so many further on, as far as there are any.
pub(super) fn stepped(state: &State, frames: i64) -> u32 {
    let target = (i64::from(state.frame) + frames).clamp(0, i64::from(state.last_frame()));
    u32::try_from(target).unwrap_or(0)
}

pub(super) fn select(state: &mut State, track: TrackId) {
    state.selected = Some(track);
    keep_in_view(state);
}

/// Selects the track so many further in the list, from its end to its beginning.
pub(super) fn step_track(state: &mut State, by: i64) {
    let n = i64::try_from(state.tracks.len()).unwrap_or(0);
    if n == 0 {
        return complain(state, "there are no tracks yet: t r follows features, a adds one by hand");
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

/// Goes to the key-frame so many further on.
pub(super) fn go_key(state: &mut State, by: i64) {
    let Some(row) = state.selected_row() else {
        return complain(state, "select a track first: j takes the next");
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

/// Following, the selected track stays in the middle; the view stands still under a hand that draws.
pub(super) fn keep_in_view(state: &mut State) {
    if state.follow
        && !matches!(state.mode, Mode::Sketch(_))
        && let Some(at) = state.selected_row().and_then(|row| row.at(state.shown_frame()))
    {
        state.centre = at;
    }
}
