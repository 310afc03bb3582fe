//! Correction in time: samples slide along the curve and never leave it (Diener 2009, 3.5.2).

use std::cmp::Ordering;

use super::{Correction, Refused, Shown, moved, position};
use crate::curve::{Knot, through};

/// The slowest that a slid curve may run against the original: what keeps its order in time.
const LEAST_PACE: f64 = 0.05;

/// A correction in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Slid {
    /// The correction.
    pub correction: Correction,
    /// The shift, seconds: smaller than asked for where samples would have changed their order.
    pub shift_s: f64,
}

/// Gives a frame the position that the curve has `shift_s` later (earlier where negative); it becomes a
/// key-frame.
///
/// The shift falls linearly to zero at the key-frames on both sides, where the feature is lost if that is
/// nearer, at the track's ends where there are none: frame k takes the position at `t_k + shift w_k`, on the Hermite curve through the shown samples.
/// The time map keeps a pace of 1/20 at least, so that samples cannot change their order; a larger shift is
/// cut to that. What is shown beyond the bounds stays as it is, interpolated samples too.
///
/// # Errors
/// [`Refused::NoSample`] where the feature is lost or not shown, [`Refused::NoRoom`] where it is so on both
/// sides.
pub fn time(shown: &Shown<'_>, frame: u32, shift_s: f64) -> Result<Slid, Refused> {
    if shown.placed(frame).is_none() {
        return Err(Refused::NoSample { track: shown.id, frame });
    }
    let frames = shown.span.frames();
    let (before, after) = shown.keys_around(frame);
    let is_placed = |at: &u32| shown.placed(*at).is_some();
    let back = before.unwrap_or(0).max(frames.start)..frame;
    let start = back.rev().take_while(is_placed).last().unwrap_or(frame);
    let ahead = frame + 1..after.map_or(frames.end, |after| frames.end.min(after + 1));
    let last = ahead.take_while(is_placed).last().unwrap_or(frame);
    if start == last {
        return Err(Refused::NoRoom { track: shown.id, frame });
    }
    let [t0_s, t_s, t1_s] = [start, frame, last].map(|frame| shown.time(frame));
    let room = 1.0 - LEAST_PACE;
    let shift_s = if shift_s.is_finite() { shift_s } else { 0.0 };
    let shift_s = shift_s.clamp((t0_s - t_s) * room, (t1_s - t_s) * room);
    let source_s = |at_s: f64| {
        at_s + shift_s
            * match at_s.total_cmp(&t_s) {
                Ordering::Less => (at_s - t0_s) / (t_s - t0_s),
                Ordering::Equal => 1.0,
                Ordering::Greater => (t1_s - at_s) / (t1_s - t_s),
            }
    };
    let knot = |frame: u32| Some(Knot { t_s: shown.time(frame), at: position(shown.span.get(frame)?) });
    let path = through(&(start..=last).filter_map(knot).collect::<Vec<_>>());
    let along = |at_s: f64| {
        let segment = path.partition_point(|segment| segment.to.t_s < at_s).min(path.len() - 1);
        path[segment].at(at_s)
    };
    let mut edits = Vec::new();
    edits.extend(shown.relay(start..last + 1, |at| {
        let sample = moved(shown.placed(at)?, along(source_s(shown.time(at))));
        (at != frame).then(|| shown.laid(at, sample))
    }));
    let [x, y] = along(source_s(t_s));
    edits.push(shown.key(frame, [x as f32, y as f32]));
    edits.extend(shown.held(&edits, start..last + 1)?);
    let correction = shown.correct(edits, "shifted in time")?;
    Ok(Slid { correction, shift_s })
}
