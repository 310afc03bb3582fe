//! What a tracker found from two key-frames, blended into one path.

use super::{is_placed, position};
use crate::clip::FrameTimes;
use crate::curve::{Knot, Segment};
use crate::track::{Quality, Sample, Source, Span, Status};

/// Steepness of the two sigmoids over the blended range: the middle 60 % hold nine tenths of the change.
const STEEPNESS: f64 = 10.0;

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
