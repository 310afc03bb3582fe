//! Drawing a track while the clip plays, or frame by frame, previewed until it is kept.

use std::sync::Arc;

use honami_model::correct::Layers;
use honami_workbench::correct::Step;

use super::{Effect, Mode, State, complain, edit, time};
use crate::app::clock::Play;
use crate::app::correcting::nudge_px;
use crate::app::layout::Lens;
use crate::app::sketching::Sketching;

/// Begins to draw the selected track.
pub(super) fn begin(state: &mut State) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    time::stop(state);
    let frames = row.span.frames();
    let nearest = state.frame.clamp(frames.start, frames.end.saturating_sub(1).max(frames.start));
    let point = edit::within(&state.clip, row.at(nearest).unwrap_or(state.centre));
    state.mode = Mode::Sketch(Box::new(Sketching::new(row.id, point)));
    vec![Effect::Study(row.id)]
}

/// The layers of a track have come.
pub(super) fn on_layers(state: &mut State, layers: Option<&Arc<Layers>>) {
    let State { mode, clip, .. } = state;
    if let (Mode::Sketch(sketching), Some(layers)) = (mode, layers)
        && sketching.track == layers.id
    {
        sketching.layers = Some(Arc::clone(layers));
        sketching.preview(&clip.times);
    }
}

/// The clip begins to play.
pub(super) fn on_play(state: &mut State, play: Play) {
    let from_s = state.clip.times.get(play.from).unwrap_or_default();
    let link_s = state.link.delay_ms.map_or(0.0, |ms| f64::from(ms) / 1e3);
    let State { mode, clip, .. } = state;
    if let Mode::Sketch(sketching) = mode {
        sketching.begin(play, from_s, link_s);
        sketching.preview(&clip.times);
    }
}

/// The clip was stopped.
pub(super) fn on_stop(state: &mut State) {
    let State { mode, clip, now, .. } = state;
    if let Mode::Sketch(sketching) = mode {
        sketching.end(*now);
        sketching.preview(&clip.times);
    }
}

/// Another frame was gone to.
pub(super) fn on_arrival(state: &mut State) {
    on_stop(state);
    let State { mode, clip, frame, .. } = state;
    if let Mode::Sketch(sketching) = mode {
        sketching.arrive(*frame, &clip.times);
    }
}

/// Leads the point by so many steps.
pub(super) fn steer(state: &mut State, [dx, dy]: [f32; 2]) {
    let px = nudge_px(state.zoom);
    let State { mode, clip, now, .. } = state;
    let Mode::Sketch(sketching) = mode else { return };
    let (px, [x, y]) = (px * sketching.step, sketching.point);
    sketching.steer(edit::within(clip, [x + dx * px, y + dy * px]), *now);
}

/// The button of the mouse goes down in a cell.
pub(super) fn press(state: &mut State, lens: &Lens, (column, row): (u16, u16)) {
    let State { mode, clip, now, .. } = state;
    if let (Mode::Sketch(sketching), Some(at)) = (mode, lens.point_of(column, row)) {
        sketching.press(edit::within(clip, at), *now);
        sketching.preview(&clip.times);
    }
}

/// The mouse comes into a cell with its button down.
pub(super) fn drag(state: &mut State, lens: &Lens, (column, row): (u16, u16)) {
    let State { mode, clip, now, .. } = state;
    if let (Mode::Sketch(sketching), Some([x, y])) = (mode, lens.point_of(column, row)) {
        let (width, height) = lens.cell_sides_px();
        let half = [width as f32 / 2.0, height as f32 / 2.0];
        let corner = |way: f32| edit::within(clip, [x + way * half[0], y + way * half[1]]);
        sketching.drag([corner(-1.0), corner(1.0)], *now);
    }
}

/// The button goes up: with the stroke, the clip stops.
pub(super) fn release(state: &mut State) {
    let now = state.now;
    if let Mode::Sketch(sketching) = &mut state.mode
        && sketching.release(now)
    {
        time::stop(state);
    }
}

/// Puts the point down here and steps on.
pub(super) fn put(state: &mut State, by: i64) {
    let here = state.frame;
    let next = time::stepped(state, by);
    if next == here {
        return complain(
            state,
            "this is the last frame: there is none to step to; Enter keeps what is drawn",
        );
    }
    on_stop(state);
    let State { mode, clip, .. } = state;
    let at = |frame: u32| (frame, clip.times.get(frame).unwrap_or_default());
    let Mode::Sketch(sketching) = mode else { return };
    sketching.put(at(here), at(next));
    sketching.point = edit::within(clip, sketching.point);
    sketching.preview(&clip.times);
    time::go(state, next);
}

/// Takes back what was drawn last.
pub(super) fn take_back(state: &mut State) {
    if let Mode::Sketch(sketching) = &mut state.mode {
        sketching.take_back();
    }
    time::stop(state);
}

/// Changes the step of the keys.
pub(super) fn scale_step(state: &mut State, times: i64) {
    if let Mode::Sketch(sketching) = &mut state.mode {
        sketching.scale_step(times);
    }
}

/// Stops what plays, else leaves.
pub(super) fn back(state: &mut State) {
    let is_open = matches!(&state.mode, Mode::Sketch(sketching) if sketching.is_open());
    if state.play.is_some() || is_open {
        time::stop(state);
    } else {
        state.mode = Mode::Review;
    }
}

/// Keeps what is drawn.
pub(super) fn keep(state: &mut State) -> Vec<Effect> {
    time::stop(state);
    let Mode::Sketch(sketching) = &state.mode else { return Vec::new() };
    if sketching.strokes.is_empty() {
        complain(
            state,
            "nothing is drawn yet: hold the mouse's button down, or steer, while the clip plays; or step",
        );
        return Vec::new();
    }
    if let Some(Err(why)) = &sketching.ghost {
        let line = why.clone();
        complain(state, line);
        return Vec::new();
    }
    let step = Step::Sketch { track: sketching.track, strokes: sketching.strokes.clone() };
    // The clip has run on while the hand followed: back to what was drawn.
    if let Some(affected) = sketching.correction().map(|ghost| ghost.affected.clone())
        && !affected.is_empty()
    {
        state.frame = state.frame.clamp(affected.start, affected.end - 1);
    }
    state.mode = Mode::Review;
    time::keep_in_view(state);
    vec![Effect::Correct(step, "T slides a sample in time, u undoes")]
}
