//! Colours of motion, and the dial of their directions.

use super::actions::count;
use super::{Mode, State, complain, say};
use honami_model::track::Span;
use honami_workbench::overlay::usual_speed;

/// One step of the dial, degrees.
const STEP: f64 = 10.0;

/// Shows the colours of motion, or not.
pub(super) fn turn_on(state: &mut State) {
    state.motion.is_on = !state.motion.is_on && is_possible(state);
    if state.motion.is_on {
        begin(state);
        let speed = state.motion.full_px_s();
        say(state, format!("motion of the tracks: full colour at {speed:.0} px/s (v + v - gain, v d dial)"));
    }
}

/// More gain, or less; shows the colours.
pub(super) fn gain(state: &mut State, steps: i64) {
    if is_possible(state) {
        begin(state);
        state.motion.gain(steps);
        let speed = state.motion.full_px_s();
        say(state, format!("full colour at {speed:.*} px/s", usize::from(speed < 10.0)));
    }
}

/// Opens the dial.
pub(super) fn open_dial(state: &mut State) {
    if is_possible(state) {
        let before = state.motion;
        begin(state);
        state.mode = Mode::Dial(before);
    }
}

/// hjkl at the dial: across turns it, up and down set its width.
pub(super) fn steer(state: &mut State, across: f64, down: f64) {
    let n = count(state) as f64 * STEP;
    if across != 0.0 {
        state.motion.turn(n * across);
    }
    if down != 0.0 {
        state.motion.open(-n * down);
    }
}

fn is_possible(state: &mut State) -> bool {
    let why = match () {
        () if state.mono => "motion is shown in colours, and this terminal has none",
        () if state.tracks.is_empty() => {
            "motion is shown of tracks, and there are none yet: t r follows features"
        }
        () => return true,
    };
    complain(state, why);
    false
}

/// Shows the colours; the first time with the gain that suits the clip.
fn begin(state: &mut State) {
    state.motion.is_on = true;
    if state.motion.full_px_s.is_none() {
        let spans: Vec<&Span> = state.tracks.iter().map(|row| &*row.span).collect();
        state.motion.full_px_s = usual_speed(&spans, &state.clip.times);
    }
}
