//! Saying what a pixel is: both ends of something of known length, and how long it is.

use super::{Effect, Mode, State, UNDO, complain, edit, say, time};
use crate::app::correcting::nudge_px;
use crate::app::layout::Lens;
use crate::app::scaling::{End, Scaling};

/// Both ends are set, and somebody goes on pointing.
const SET: &str = "both ends are set: Enter keeps what they say, Backspace takes it back";

/// Begins to set a scale bar in the frame that is shown.
pub(super) fn begin(state: &mut State) {
    if edit::is_writable(state) {
        time::stop(state);
        let at = edit::within(&state.clip, state.centre.map(f32::round));
        state.mode = Mode::Scale(Box::new(Scaling::new(state.frame, at)));
    }
}

/// Leads the cursor, and the view after it.
pub(super) fn steer(state: &mut State, by: [f32; 2]) {
    let (px, State { mode, clip, .. }) = (nudge_px(state.zoom), &mut *state);
    let Mode::Scale(scaling) = mode else { return };
    if !scaling.is_placing() {
        return say(state, SET);
    }
    scaling.at = edit::within(clip, [scaling.at[0] + by[0] * px, scaling.at[1] + by[1] * px]);
    let at = scaling.at;
    if Lens::shown(state).pixel_of(at).is_none() {
        state.centre = at;
    }
}

/// The mouse sets an end.
pub(super) fn click(state: &mut State, lens: &Lens, (column, row): (u16, u16)) {
    let (Mode::Scale(scaling), Some(at)) = (&state.mode, lens.point_of(column, row)) else { return };
    if !scaling.is_placing() {
        return say(state, SET);
    }
    let (width, height) = lens.cell_sides_px();
    let at = edit::within(&state.clip, at);
    set(state, End { at, sides_px: [width, height] });
}

/// Sets an end, makes a bar of the length that was typed, or keeps it.
pub(super) fn accept(state: &mut State) -> Vec<Effect> {
    let lens = Lens::shown(state);
    let Mode::Scale(scaling) = &mut state.mode else { return Vec::new() };
    if let Some(bar) = scaling.bar {
        state.mode = Mode::Review;
        return vec![Effect::Scale(Some(bar), UNDO)];
    }
    if scaling.is_typing() {
        let measured = scaling.measure();
        measured.unwrap_or_else(|why| complain(state, why));
        return Vec::new();
    }
    let (at, (columns, rows)) = (scaling.at, lens.size());
    let sides_px = [lens.width / f64::from(columns.max(1)), lens.height / f64::from(rows.max(1))];
    set(state, End { at, sides_px });
    Vec::new()
}

fn set(state: &mut State, end: End) {
    if let Mode::Scale(scaling) = &mut state.mode
        && let Err(why) = scaling.set(end)
    {
        complain(state, format!("{why} (z looks closer)"));
    }
}

/// Takes back what was set last.
pub(super) fn take_back(state: &mut State) {
    if let Mode::Scale(scaling) = &mut state.mode
        && !scaling.take_back()
    {
        say(state, "no end is set yet: a click or Enter sets one");
    }
}

/// What a pixel is, nobody knows any more.
pub(super) fn remove(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    if state.scale.is_none() {
        complain(state, "the project has no scale bar: e b sets one");
        return Vec::new();
    }
    vec![Effect::Scale(None, UNDO)]
}
