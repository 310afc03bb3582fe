//! The mouse: selects, places, scrubs; whatever it does, keys do too.

use super::{Effect, Mode, State, history, look, moving, paint, queue, scale, sketch, time, versus};
use crate::app::layout::{Layout, Lens, bar, frame_at};
use crate::app::skeleton::Skeletal;
use crate::app::view::column::{self, Pick};
use crate::term::input::{Mouse, MouseKind};

/// A click farther than so many cells from a track selects nothing.
const REACH_CELLS: f32 = 3.0;

pub(super) fn on_mouse(state: &mut State, mouse: Mouse) -> Vec<Effect> {
    let layout = Layout::of(state);
    let lens = Lens::of(state, layout.picture);
    let cell = (mouse.column, mouse.row);
    let here = cell.into();
    match mouse.kind {
        MouseKind::WheelUp | MouseKind::WheelDown => {
            let by = if mouse.kind == MouseKind::WheelUp { -1 } else { 1 };
            match &mut state.mode {
                Mode::Menu(menu) => menu.step(by),
                Mode::Form(form) => form.step(by),
                Mode::Review if layout.column.contains(here) => step_list(state, by),
                Mode::Review if layout.time.contains(here) => time::step(state, by),
                Mode::Review
                | Mode::Place(_)
                | Mode::Root(_)
                | Mode::Shape(_)
                | Mode::Move(_)
                | Mode::Sketch(_)
                | Mode::Paint(_)
                | Mode::Scale(_) => {
                    if let Some(point) = lens.point_of(mouse.column, mouse.row) {
                        look::zoom_at(state, -by, point);
                    }
                }
                Mode::History { .. } => history::step(state, by),
                Mode::Dial(_) | Mode::Prompt(_) | Mode::Name(_) | Mode::GroupName(_) | Mode::Label(_) => {}
            }
        }
        MouseKind::Press(1 | 2) => state.dragged = Some((mouse.column, mouse.row)),
        MouseKind::Drag(1 | 2) => {
            if let Some((column, row)) = state.dragged.replace((mouse.column, mouse.row)) {
                let by = |to: u16, from: u16| i32::from(to) - i32::from(from);
                look::drag(state, (by(mouse.column, column), by(mouse.row, row)));
            }
        }
        MouseKind::Release(0) => sketch::release(state),
        MouseKind::Press(0) | MouseKind::Drag(0) if layout.time.contains(here) => {
            if matches!(state.mode, Mode::Review | Mode::Move(_)) {
                let n_frames = state.clip.n_frames();
                time::go(state, frame_at(bar(layout.time, n_frames), n_frames, mouse.column));
            }
        }
        MouseKind::Press(0) if layout.column.contains(here) => {
            // Elsewhere the click would take away what is open.
            if matches!(state.mode, Mode::Review | Mode::History { .. }) {
                pick(state, column::pick_at(state, layout.column, mouse.row));
            }
        }
        MouseKind::Press(0) if matches!(state.mode, Mode::Sketch(_)) => sketch::press(state, &lens, cell),
        MouseKind::Drag(0) if matches!(state.mode, Mode::Sketch(_)) => sketch::drag(state, &lens, cell),
        MouseKind::Press(0) | MouseKind::Drag(0) if matches!(state.mode, Mode::Paint(_)) => {
            paint::touch(state, &lens, cell, mouse.kind == MouseKind::Press(0));
        }
        MouseKind::Press(0) if matches!(state.mode, Mode::Scale(_)) => scale::click(state, &lens, cell),
        MouseKind::Press(0) | MouseKind::Drag(0) => {
            if let Some(point) = lens.point_of(mouse.column, mouse.row) {
                match &mut state.mode {
                    Mode::Place(at) | Mode::Root(at) => *at = point,
                    Mode::Move(_) => moving::point(state, point),
                    Mode::Review if matches!(mouse.kind, MouseKind::Press(_)) => nearest(state, &lens, point),
                    _ => {}
                }
            }
        }
        _ => {}
    }
    Vec::new()
}

/// Takes what was picked in the column.
fn pick(state: &mut State, picked: Option<Pick>) {
    match picked {
        Some(Pick::Panel(panel)) => state.panel = panel,
        Some(Pick::Item(rank)) => queue::open_rank(state, rank),
        Some(Pick::Track(track)) => time::select(state, track),
        Some(Pick::At(track, frame)) => versus::open(state, track, frame),
        Some(Pick::Frame(frame)) => time::go(state, frame),
        Some(Pick::Entry(row)) => {
            if !matches!(state.mode, Mode::History { .. }) {
                history::toggle(state);
            }
            if let Mode::History { at, .. } = &mut state.mode {
                *at = row;
            }
        }
        Some(Pick::Bone(node)) => state.skeleton.chosen = Some(node),
        Some(Pick::Print(line)) => state.prints.look_at(line),
        None => {}
    }
}

/// Goes so many rows on in the list beside the picture.
pub(super) fn step_list(state: &mut State, by: i64) {
    pick(state, column::pick_beside(state, by));
}

/// Selects the track nearest to a point of the frame that is shown.
fn nearest(state: &mut State, lens: &Lens, point: [f32; 2]) {
    if Skeletal::azimuth(state) != 0 {
        // Where tracks are is not seen.
        return;
    }
    let far = |at: [f32; 2]| (at[0] - point[0]).hypot(at[1] - point[1]);
    let frame = state.shown_frame();
    let shown = match &state.versus {
        Some(versus) if versus.compared.is_some() => versus.points(frame),
        _ => state.tracks.iter().filter_map(|row| Some((row.id, row.at(frame)?))).collect(),
    };
    let found = shown
        .into_iter()
        .map(|(track, at)| (track, far(at)))
        .filter(|(_, far)| *far <= REACH_CELLS * lens.cell_px())
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((track, _)) = found {
        // The bone of its group is the one that is meant, no longer another.
        state.skeleton.chosen = None;
        time::select(state, track);
    }
}
