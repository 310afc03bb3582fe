//! Colours of motion, and the dial of their directions.

use super::actions::count;
use super::{Effect, Mode, State, complain, say};
use crate::app::dense::{Dense, FieldOf};
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
        let of = state.dense.as_ref().map_or_else(
            || "motion of the tracks".to_owned(),
            |dense| format!("dense motion by {}", dense.plugin),
        );
        say(state, format!("{of}: full colour at {speed:.0} px/s (v + v - gain, v d dial)"));
    }
}

/// Shows dense motion, where a tracker measures that, or again that of the tracks.
pub(super) fn change_source(state: &mut State) -> Vec<Effect> {
    if state.motion.is_on && state.dense.take().is_some() {
        state.motion.is_on = false;
        turn_on(state);
    } else if has_colours(state) {
        return vec![Effect::Measure(state.selected)];
    }
    Vec::new()
}

/// A tracker measures dense motion: that is shown.
pub(super) fn on_measures(state: &mut State, plugin: String) {
    say(state, format!("dense motion by {plugin}: measured frame by frame (v f back to the tracks)"));
    state.dense = Some(Dense { plugin, field: None });
    begin(state);
}

/// A field was measured; without tracks the first of them says which gain suits the clip.
pub(super) fn on_field(state: &mut State, field: Option<FieldOf>) {
    if let Some((_, field)) = &field {
        state.motion.full_px_s = state.motion.full_px_s.or_else(|| field.usual_speed());
    }
    state.dense.iter_mut().for_each(|dense| dense.field = field.clone());
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
    let has_motion = state.dense.is_some() || !state.tracks.is_empty();
    if !has_motion {
        complain(state, "motion is shown of tracks, and there are none yet: t r follows features");
    }
    has_motion && has_colours(state)
}

fn has_colours(state: &mut State) -> bool {
    if state.mono {
        complain(state, "motion is shown in colours, and this terminal has none");
    }
    !state.mono
}

/// Shows the colours; the first time with the gain that suits the clip.
fn begin(state: &mut State) {
    state.motion.is_on = true;
    if state.motion.full_px_s.is_none() {
        let spans: Vec<&Span> = state.tracks.iter().map(|row| &*row.span).collect();
        state.motion.full_px_s = usual_speed(&spans, &state.clip.times);
    }
}

#[cfg(test)]
mod tests;
