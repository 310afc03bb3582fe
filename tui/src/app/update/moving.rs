//! Moving a sample, in space or in time, with the correction previewed until it is kept.

use std::sync::Arc;

use honami_model::correct::Layers;
use honami_model::document::Key;
use honami_workbench::offer::Model;

use super::{Effect, Mode, State, UNDO, complain, edit, say};
use crate::app::correcting::{Moving, Tool, nudge_px};
use crate::app::layout::Lens;

/// Begins to move the selected track's sample here to another place.
pub(super) fn begin(state: &mut State) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    // Before its first and after its last sample a track can be continued from the nearest.
    let frames = row.span.frames();
    let nearest = state.frame.clamp(frames.start, frames.end.saturating_sub(1).max(frames.start));
    let Some(from) = row.at(nearest) else { return Vec::new() };
    open(state, Moving::new(row.id, state.frame, from, &row.span))
}

/// Begins to slide the selected track's sample here along its curve.
pub(super) fn begin_slide(state: &mut State) -> Vec<Effect> {
    let Some(row) = edit::selected(state) else { return Vec::new() };
    let Some(from) = row.at(state.frame) else {
        let line = format!("track {} has no sample at {}: there is nothing to slide", row.id, state.frame);
        complain(state, line);
        return Vec::new();
    };
    let moving = Moving { tool: Tool::Slide(0.0), ..Moving::new(row.id, state.frame, from, &row.span) };
    open(state, moving)
}

fn open(state: &mut State, moving: Moving) -> Vec<Effect> {
    super::time::stop(state);
    let track = moving.track;
    // What is moved must be seen.
    if Lens::shown(state).pixel_of(moving.from).is_none() {
        state.centre = moving.from;
    }
    state.mode = Mode::Move(Box::new(moving));
    vec![Effect::Study(track)]
}

/// The layers of a track have come.
pub(super) fn on_layers(state: &mut State, layers: Option<Arc<Layers>>) {
    let State { mode, clip, .. } = state;
    if let (Mode::Move(moving), Some(layers)) = (mode, layers)
        && moving.track == layers.id
    {
        moving.study(layers, &clip.times);
    }
}

/// Nudges by image pixels, or slides by frames.
pub(super) fn nudge(state: &mut State, [dx, dy]: [f32; 2]) {
    let px = nudge_px(state.zoom);
    let State { mode, clip, .. } = state;
    let Mode::Move(moving) = mode else { return };
    match &mut moving.tool {
        Tool::Place { to, .. } => *to = edit::within(clip, [to[0] + dx * px, to[1] + dy * px]),
        Tool::Slide(frames) => *frames += f64::from(dx),
    }
    moving.preview(&clip.times);
}

/// Puts the sample where the mouse points.
pub(super) fn point(state: &mut State, at: [f32; 2]) {
    let State { mode, clip, .. } = state;
    if let Mode::Move(moving) = mode
        && let Tool::Place { to, .. } = &mut moving.tool
    {
        *to = at;
        moving.preview(&clip.times);
    }
}

/// Offers the next model.
pub(super) fn next_model(state: &mut State) {
    let State { mode, clip, .. } = state;
    if let Mode::Move(moving) = mode
        && let Some(model) = moving.model()
    {
        let models: Vec<Model> = moving.models().collect();
        let at = models.iter().position(|other| *other == model).unwrap_or(0);
        moving.choose(models[(at + 1) % models.len()]);
        moving.preview(&clip.times);
    }
}

/// Walks along the path, while the picture stays.
pub(super) fn walk(state: &mut State, by: i64) {
    let (here, last) = (state.frame, state.last_frame());
    let Mode::Move(moving) = &mut state.mode else { return };
    let from = i64::from(moving.walked.unwrap_or(here));
    let to = u32::try_from((from + by).clamp(0, i64::from(last))).unwrap_or(0);
    moving.walked = (to != moving.frame).then_some(to);
}

/// Makes the sample that was walked to, or is looked at, a key-frame as it is; or no longer.
pub(super) fn pin(state: &mut State) {
    let here = state.frame;
    let State { mode, clip, .. } = state;
    let Mode::Move(moving) = mode else { return };
    let frame = moving.walked.unwrap_or(here);
    let known = moving.layers.as_ref().map(|layers| {
        let shown = layers.shown(&clip.times);
        (shown.span().get(frame).copied(), shown.track().keys.contains_key(&frame))
    });
    let line = match known {
        _ if frame == moving.frame => {
            "( and ) walk to another sample of the path; * makes it a key-frame".to_owned()
        }
        Some((_, true)) => format!("frame {frame} is a key-frame already: corrections end there"),
        Some((Some(sample), false)) => {
            let word = match Key::confirming(&sample) {
                None => "shows the feature nowhere: what is not seen is no key-frame",
                Some(_) if moving.pins.remove(&frame).is_some() => "is no key-frame any more",
                Some(key) => {
                    moving.pins.insert(frame, key);
                    "becomes a key-frame as it is: the correction ends there"
                }
            };
            moving.preview(&clip.times);
            format!("frame {frame} {word}")
        }
        _ => format!("track {} has no sample at {frame}", moving.track),
    };
    say(state, line);
}

/// Keeps what is previewed.
pub(super) fn keep(state: &mut State) -> Vec<Effect> {
    let Mode::Move(moving) = &state.mode else { return Vec::new() };
    if let (Some(wish), Some(Ok(_))) = (moving.wish(), &moving.ghost) {
        leave(state);
        return vec![Effect::Keep(wish, UNDO)];
    }
    if moving.is_pending() {
        complain(state, "it is still being worked out: look at it before it is kept");
        return Vec::new();
    }
    let (moving, hint) = match moving.tool {
        Tool::Place { .. } => (moving, "t t tracks again round it, u undoes"),
        Tool::Slide(_) => (moving, UNDO),
    };
    let transaction = match &moving.ghost {
        Some(Ok(ghost)) => ghost.transaction.clone(),
        Some(Err(why)) => {
            let line = why.clone();
            complain(state, line);
            return Vec::new();
        }
        None => {
            let line = format!("track {} could not be read: Esc, and then again", moving.track);
            complain(state, line);
            return Vec::new();
        }
    };
    leave(state);
    vec![Effect::Commit(transaction, hint)]
}

/// Goes back to reviewing, at the sample that was moved.
fn leave(state: &mut State) {
    if let Mode::Move(moving) = std::mem::replace(&mut state.mode, Mode::Review) {
        state.frame = moving.frame;
        state.corrected = Some(moving.track);
        super::time::keep_in_view(state);
    }
}
