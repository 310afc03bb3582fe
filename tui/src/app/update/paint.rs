//! Painting what is plant and what lies behind it; the matte is found behind the screen and kept.

use std::sync::Arc;

use honami_workbench::matting::{Mark, Parts};

use super::facts::happened;
use super::{Effect, Mode, State, UNDO, complain, edit, say, time};
use crate::app::layout::Lens;
use crate::app::painting::Painting;

/// Begins to paint on the frame that is shown.
pub(super) fn begin(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    time::stop(state);
    let at = edit::within(&state.clip, state.centre.map(f32::round));
    let size = [state.clip.width, state.clip.height];
    state.mode = Mode::Paint(Box::new(Painting::new(state.frame, at, size)));
    vec![Effect::LookAtMatte(state.frame)]
}

/// Where something is painted, also below a list.
fn at_painting(mode: &mut Mode) -> Option<&mut Painting> {
    match mode {
        Mode::Paint(painting) => Some(painting),
        Mode::Menu(menu) => at_painting(&mut menu.below),
        _ => None,
    }
}

/// The project keeps this of the frame.
pub(super) fn on_kept(state: &mut State, frame: u32, marks: Arc<Vec<Mark>>, parts: Arc<Parts>) {
    if let Some(painting) = at_painting(&mut state.mode).filter(|painting| painting.frame == frame) {
        painting.go_on_from(marks, parts);
    }
}

/// The matte of so many strokes was found; of another frame it is no longer wanted.
pub(super) fn on_found(state: &mut State, (frame, n_strokes): (u32, usize), parts: Arc<Parts>, line: String) {
    let Some(painting) = at_painting(&mut state.mode).filter(|painting| painting.frame == frame) else {
        return happened(state, "painting is over: the matte that was found is not kept".to_owned(), false);
    };
    painting.found = Some((Some(n_strokes), parts));
    let line = match painting.can_keep() {
        true => format!("{line}; Enter keeps it, more strokes refine it"),
        false => format!("{line}; Enter finds it anew, with the strokes since"),
    };
    happened(state, line, false);
}

/// Leads the pen by so many steps: as far as the brush is wide, or a pixel.
pub(super) fn steer(state: &mut State, [dx, dy]: [f32; 2], is_fine: bool) {
    let State { mode, clip, .. } = state;
    let Mode::Paint(painting) = mode else { return };
    let px = if is_fine { 1.0 } else { painting.radius_px.max(1) as f32 };
    let to = edit::within(clip, [painting.at[0] + dx * px, painting.at[1] + dy * px]);
    painting.lead(to, painting.is_down);
}

/// The button of the mouse goes down in a cell, or comes into it.
pub(super) fn touch(state: &mut State, lens: &Lens, (column, row): (u16, u16), is_press: bool) {
    let State { mode, clip, .. } = state;
    if let (Mode::Paint(painting), Some(at)) = (mode, lens.point_of(column, row)) {
        let at = edit::within(clip, at);
        match is_press {
            true => {
                painting.is_down = false;
                painting.begin(at);
            }
            false => painting.lead(at, true),
        }
    }
}

/// Puts the pen down, or lifts it.
pub(super) fn pen(state: &mut State) {
    if let Mode::Paint(painting) = &mut state.mode {
        painting.set_pen(!painting.is_down);
    }
}

/// Takes the next brush.
pub(super) fn next_brush(state: &mut State) {
    if let Mode::Paint(painting) = &mut state.mode {
        painting.next_brush();
    }
}

/// A wider brush, or a narrower one.
pub(super) fn widen(state: &mut State, by: i64) {
    if let Mode::Paint(painting) = &mut state.mode {
        painting.widen(by);
    }
}

/// Takes back what was painted last.
pub(super) fn take_back(state: &mut State) {
    if let Mode::Paint(painting) = &mut state.mode
        && !painting.take_back()
    {
        say(state, "no stroke is left to be taken back");
    }
}

/// Has the matte found, or keeps the one that was.
pub(super) fn accept(state: &mut State) -> Vec<Effect> {
    if let Some(job) = &state.job {
        let line = format!("{} is still running: wait for it, or stop it with Esc", job.plugin);
        complain(state, line);
        return Vec::new();
    }
    let Mode::Paint(painting) = &mut state.mode else { return Vec::new() };
    painting.is_down = false;
    if painting.can_keep() {
        let frame = painting.frame;
        state.mode = Mode::Review;
        return vec![Effect::KeepMatte(frame, UNDO)];
    }
    let there_is = |mark| painting.marks.marks.contains(&mark);
    let line = match (there_is(Mark::Foreground), there_is(Mark::Background)) {
        (true, true) if painting.strokes.is_empty() => "this matte is kept already: more strokes refine it",
        (true, true) => {
            let (frame, n_strokes) = (painting.frame, painting.strokes.len());
            return vec![Effect::FindMatte(frame, n_strokes, painting.marks.clone())];
        }
        (true, false) => "only the plant is marked: Tab takes the brush for what lies behind it",
        (false, true) => "only background is marked: Tab takes the brush for the plant",
        (false, false) => "nothing is painted: drag the mouse, or press D and go by the arrows",
    };
    complain(state, line);
    Vec::new()
}

/// Stops what is being found, else leaves without a trace.
pub(super) fn back(state: &mut State) -> Vec<Effect> {
    if let Some(job) = state.job.as_mut().filter(|job| !job.is_stopping) {
        job.is_stopping = true;
        return vec![Effect::StopJob];
    }
    state.mode = Mode::Review;
    Vec::new()
}
