//! Looking: closer, farther, elsewhere.

use super::actions::count;
use super::{Mode, State, complain, say};
use crate::app::layout::{Layout, Lens};
use crate::app::panel::Panel;

/// One pan moves the view by this part of it.
const PAN: f64 = 0.25;

/// Looks so many steps closer, at the cursor or the selected track, or from farther away.
pub(super) fn zoom(state: &mut State, by: i64) {
    let focus = match state.mode {
        Mode::Place(at) | Mode::Root(at) => Some(at),
        Mode::Move(ref moving) => Some(moving.to()),
        Mode::Paint(ref painting) => Some(painting.at),
        Mode::Scale(ref scaling) => Some(scaling.at),
        _ => state.selected_at(),
    };
    if let Some(focus) = focus.filter(|_| by > 0) {
        state.centre = focus;
    }
    step(state, by);
}

/// Looks closer or from farther away; the image point under a cell of the screen stays there.
pub(super) fn zoom_at(state: &mut State, by: i64, point: [f32; 2]) {
    let before = Lens::shown(state);
    step(state, by);
    let ratio = Lens::shown(state).cell_px() / before.cell_px();
    let middle = before.middle();
    state.centre = [0, 1].map(|axis| point[axis] + (middle[axis] - point[axis]) * ratio);
    settle(state);
}

fn step(state: &mut State, by: i64) {
    let deepest = Lens::deepest(state, Layout::of(state).picture);
    let zoom = (i64::from(state.zoom) + by).clamp(0, i64::from(deepest));
    if i64::from(state.zoom) == zoom {
        let line = if by > 0 { "as close as it gets: 8 cells a pixel" } else { "all of the picture is seen" };
        say(state, line);
    }
    state.zoom = u8::try_from(zoom).unwrap_or(deepest);
}

/// Moves the view by quarters of it; following ends.
pub(super) fn pan(state: &mut State, dx: f64, dy: f64) {
    let (lens, n) = (Lens::shown(state), count(state) as f64 * PAN);
    shift(state, [n * dx * lens.width, n * dy * lens.height]);
}

/// Moves the view with the mouse, by cells.
pub(super) fn drag(state: &mut State, (columns, rows): (i32, i32)) {
    let lens = Lens::shown(state);
    let cell =
        [lens.width / f64::from(lens.area.width.max(1)), lens.height / f64::from(lens.area.height.max(1))];
    shift(state, [-f64::from(columns) * cell[0], -f64::from(rows) * cell[1]]);
}

fn shift(state: &mut State, by: [f64; 2]) {
    if state.zoom == 0 {
        return say(state, "all of the picture is seen: z looks closer");
    }
    state.follow = false;
    let middle = Lens::shown(state).middle();
    state.centre = [0, 1].map(|axis| middle[axis] + by[axis] as f32);
    settle(state);
}

/// The middle is where it is seen to be: at the edges of the picture the next move back is felt at once.
fn settle(state: &mut State) {
    state.centre = Lens::shown(state).middle();
}

/// Brings the selected track to the middle, once.
pub(super) fn centre(state: &mut State) {
    match state.selected_at() {
        Some(at) => {
            state.zoom = state.zoom.max(1);
            state.centre = at;
        }
        None if state.selected.is_some() => complain(state, "the selected track is not in this frame"),
        None => complain(state, "select a track first: n takes the next, a click takes the nearest"),
    }
}

/// Keeps the selected track in the middle, or not.
pub(super) fn follow(state: &mut State) {
    state.follow = !state.follow && state.selected.is_some();
    if state.follow {
        state.zoom = state.zoom.max(1);
        super::time::keep_in_view(state);
    }
    say(state, if state.follow { "following the selected track" } else { "not following" });
}

/// Plots the selected track's group, or the track again.
pub(super) fn plot_group(state: &mut State) {
    let has_group =
        state.selected.is_some_and(|id| state.groups.as_ref().is_some_and(|g| g.of(id).is_some()));
    state.plotted.of_group = !state.plotted.of_group && has_group;
    state.panel = Some(Panel::Plots);
    if !has_group {
        complain(state, "the selected track is in no group; c groups the tracks");
    }
}
