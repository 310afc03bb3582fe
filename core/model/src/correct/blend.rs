//! What a tracker found from the key-frames of a track, laid over it: one way, or both ways and blended.

use std::ops::Range;

use super::{Correction, Refused, Shown, is_placed, position};
use crate::clip::FrameTimes;
use crate::curve::{Knot, Segment};
use crate::document::RunId;
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Span, Status};

/// Steepness of the two sigmoids over the blended range: the middle 60 % hold nine tenths of the change.
const STEEPNESS: f64 = 10.0;

/// Lays what was found forwards from a frame, until it is lost or up to the next key-frame.
///
/// # Errors
/// [`Refused::NoSamples`] when it is lost at once.
pub fn forward(shown: &Shown<'_>, found: &Span, run: RunId, from: u32) -> Result<Correction, Refused> {
    let end = shown.keys_around(from).1.unwrap_or(shown.times.len());
    let n = (from + 1..end).take_while(|&frame| placed(found, frame).is_some()).count();
    let frames = from + 1..from + 1 + u32::try_from(n).unwrap_or(0);
    let asked = from + 1..end;
    laid(shown, found, Some(run), frames, asked, "re-tracked forward")
}

/// Lays what was found backwards from a frame, until it is lost or down to the previous key-frame.
///
/// # Errors
/// [`Refused::NoSamples`] when it is lost at once.
pub fn backward(shown: &Shown<'_>, found: &Span, run: RunId, from: u32) -> Result<Correction, Refused> {
    let start = shown.keys_around(from).0.map_or(0, |before| before + 1);
    let n = (start..from).rev().take_while(|&frame| placed(found, frame).is_some()).count();
    let frames = from - u32::try_from(n).unwrap_or(0)..from;
    laid(shown, found, Some(run), frames, start..from, "re-tracked backward")
}

/// Lays what was found over a range as it is; frames that it does not reach stay, and so do key-frames.
///
/// # Errors
/// [`Refused::NoSamples`] when it reaches none.
pub fn lay(
    shown: &Shown<'_>,
    found: &Span,
    run: Option<RunId>,
    frames: Range<u32>,
) -> Result<Correction, Refused> {
    laid(shown, found, run, frames.clone(), frames, "re-tracked")
}

fn laid(
    shown: &Shown<'_>,
    found: &Span,
    run: Option<RunId>,
    frames: Range<u32>,
    asked: Range<u32>,
    words: &str,
) -> Result<Correction, Refused> {
    let over = |frame| Some(found.get(frame).map(|&sample| Over::Sample(Laid { sample, run })));
    let edit = shown.relay(frames, |frame| over(frame).filter(Option::is_some));
    shown.correct(vec![edit.ok_or(Refused::NoSamples { track: shown.id, frames: asked })?], words)
}

/// Which of two passes a sample counts to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The one from the first key-frame on.
    Forward,
    /// The one from the second key-frame back.
    Backward,
}

/// A frame between two key-frames, as two passes together have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blended {
    /// The frame.
    pub frame: u32,
    /// What is laid there.
    pub sample: Sample,
    /// The pass that weighs more; `None` where neither has seen the feature.
    pub side: Option<Side>,
}

/// The path between two key-frames, given by frame and position: what was found forwards from the first blended with
/// what was found backwards from the second.
///
/// Each weighs by a sigmoid that falls along its way; the two sum to one, and are stretched so that each is
/// exactly one at its own key-frame and zero at the other (the "reverse sigmoid tracking correction" of LK-RSTC, in DUSTrack).
/// Where one of them is lost the other counts alone, and the sigmoids run over the frames that both have
/// seen; where both are, a curve bridges them. Status and quality are those of the heavier one.
#[must_use]
pub fn blended(
    forward: &Span,
    backward: &Span,
    keys: [(u32, [f64; 2]); 2],
    times: &FrameTimes,
) -> Vec<Blended> {
    let [(from, _), (to, _)] = keys;
    let inner = from + 1..to;
    // The last frame that is followed from the first key-frame on, and the first one that is from the second.
    let followed = inner.clone().take_while(|&frame| placed(forward, frame).is_some()).last().unwrap_or(from);
    let reached =
        inner.clone().rev().take_while(|&frame| placed(backward, frame).is_some()).last().unwrap_or(to);
    let start = if reached <= from + 1 { from } else { reached };
    let end = if followed + 1 >= to { to } else { followed };
    let bridge = bridge(forward, backward, keys, (followed, reached), times);
    let at = |frame: u32| -> Option<(Sample, Option<Side>)> {
        if reached > followed && frame > followed && frame < reached {
            let [x, y] = bridge.as_ref()?.at(times.get(frame)?);
            let (status, source, quality) = (Status::Tracked, Source::Interpolated, Quality::default());
            return Some((Sample { x: x as f32, y: y as f32, status, source, quality }, None));
        }
        match (forward.get(frame), backward.get(frame)) {
            (Some(ahead), Some(back)) if (reached..=followed).contains(&frame) => {
                let share = share(times, (start, end), frame);
                let side = if share < 0.5 { Side::Forward } else { Side::Backward };
                Some((mixed(ahead, back, share), Some(side)))
            }
            (Some(ahead), _) if frame <= followed => Some((*ahead, Some(Side::Forward))),
            (_, back) => Some((*back?, Some(Side::Backward))),
        }
    };
    inner.filter_map(|frame| at(frame).map(|(sample, side)| Blended { frame, sample, side })).collect()
}

/// Lays the [`blended`] path of two passes between two key-frames.
///
/// # Errors
/// [`Refused::NoKey`] when one of the two is no key-frame; [`Refused::NoSamples`] when they are neighbours.
pub fn blend(
    shown: &Shown<'_>,
    forward: &Span,
    backward: &Span,
    run: RunId,
    keys: (u32, u32),
) -> Result<Correction, Refused> {
    let key = |frame: u32| {
        let key = shown.track.keys.get(&frame).ok_or(Refused::NoKey { track: shown.id, frame })?;
        Ok::<_, Refused>((frame, [f64::from(key.x), f64::from(key.y)]))
    };
    let inner = keys.0 + 1..keys.1;
    let path = blended(forward, backward, [key(keys.0)?, key(keys.1)?], shown.times);
    let over = |frame: u32| {
        let at = path.binary_search_by_key(&frame, |blended| blended.frame).ok()?;
        let Blended { sample, side, .. } = path[at];
        Some(Some(Over::Sample(Laid { sample, run: side.map(|_| run) })))
    };
    let edit = shown.relay(inner.clone(), over);
    shown.correct(
        vec![edit.ok_or(Refused::NoSamples { track: shown.id, frames: inner })?],
        "re-tracked both ways",
    )
}

/// The sample in a frame where the feature is seen or predicted.
fn placed(span: &Span, frame: u32) -> Option<&Sample> {
    span.get(frame).filter(|sample| is_placed(sample.status))
}

/// The backward one's share at a frame of the blended range: 0 at its start, 1 at its end, and
/// `share(tau) + share(1 - tau) = 1`.
fn share(times: &FrameTimes, (start, end): (u32, u32), frame: u32) -> f64 {
    let time = |frame: u32| times.get(frame).unwrap_or_default();
    let dt_s = time(end) - time(start);
    if dt_s <= 0.0 {
        return 0.5;
    }
    rising((time(frame) - time(start)) / dt_s)
}

/// A sigmoid on 0..=1, stretched to reach 0 and 1 at its ends.
pub(super) fn rising(tau: f64) -> f64 {
    let sigmoid = |x: f64| 1.0 / (1.0 + (-x).exp());
    let (low, high) = (sigmoid(-STEEPNESS / 2.0), sigmoid(STEEPNESS / 2.0));
    ((sigmoid(STEEPNESS * (tau - 0.5)) - low) / (high - low)).clamp(0.0, 1.0)
}

fn mixed(ahead: &Sample, back: &Sample, share: f64) -> Sample {
    let (a, b) = (position(ahead), position(back));
    let [x, y] = [0, 1].map(|axis| ((1.0 - share) * a[axis] + share * b[axis]) as f32);
    Sample { x, y, ..if share < 0.5 { *ahead } else { *back } }
}

/// The curve over the frames that neither has seen, with the speed that each has there.
fn bridge(
    forward: &Span,
    backward: &Span,
    keys: [(u32, [f64; 2]); 2],
    (followed, reached): (u32, u32),
    times: &FrameTimes,
) -> Option<Segment> {
    let knot = |span: &Span, frame: u32| {
        let key = keys.iter().find(|(at, _)| *at == frame).map(|(_, at)| *at);
        let at = key.or_else(|| span.get(frame).map(position))?;
        Some(Knot { t_s: times.get(frame)?, at })
    };
    let (from, to) = (knot(forward, followed)?, knot(backward, reached)?);
    let speed = |a: Option<Knot>, b: Option<Knot>| match (a, b) {
        (Some(a), Some(b)) => [0, 1].map(|axis| (b.at[axis] - a.at[axis]) / (b.t_s - a.t_s)),
        _ => [0.0, 0.0],
    };
    let before = followed.checked_sub(1).and_then(|frame| knot(forward, frame));
    let from_speed = speed(before, Some(from));
    let to_speed = speed(Some(to), knot(backward, reached + 1));
    (from.t_s < to.t_s).then_some(Segment { from, from_speed, to, to_speed })
}
