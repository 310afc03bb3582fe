//! Correction in space: what a person moves at one frame is carried along the curve (Diener 2009, 3.5.1).

use super::{Correction, Refused, Shown, is_placed, key_only, moved, position};
use crate::curve::basis;

/// Moves one sample, and those beside it with it, less and less up to the bounds of the correction.
///
/// The text displaces the curve by that of a virtual spline, `p* = p + (s* - s)`, between the moved sample
/// and the key-frames around it. Only one end of each spline moves and its speeds stay, so that the
/// displacement is the moved end's alone: `delta h01` before it, `delta h00` after it (errata E11).
///
/// Without a key-frame before, the track's first sample is the bound: the feature was chosen there, which
/// makes that sample right by definition. Without one after, the displacement is held to the end of the
/// track: a tracker that has drifted off stays off, and nothing says that it finds back.
///
/// A lost sample was displaced by nobody, so that it is placed [alone](key_only).
///
/// # Errors
/// [`Refused::NoSample`] where the track is not shown; what the document refuses.
pub fn space(shown: &Shown<'_>, frame: u32, to: [f32; 2]) -> Result<Correction, Refused> {
    let sample = shown.span.get(frame).ok_or(Refused::NoSample { track: shown.id, frame })?;
    if !is_placed(sample.status) {
        return key_only(shown, frame, to);
    }
    let from = position(sample);
    let delta = [f64::from(to[0]) - from[0], f64::from(to[1]) - from[1]];
    let (before, after) = shown.keys_around(frame);
    let start = before.unwrap_or(shown.span.first_frame).min(frame);
    let end = after.unwrap_or(shown.span.frames().end);
    let part = |at: u32| match after {
        _ if at < frame => rise(shown.time(start), shown.time(frame), shown.time(at)),
        Some(after) => 1.0 - rise(shown.time(frame), shown.time(after), shown.time(at)),
        None => 1.0,
    };
    let lay = shown.relay(start + 1..end, |at| {
        let sample = shown.carried(at).filter(|_| at != frame)?;
        let [x, y] = position(sample);
        let part = part(at);
        let sample = moved(sample, [x + part * delta[0], y + part * delta[1]]);
        Some(shown.laid(at, sample))
    });
    shown.correct(lay.into_iter().chain([shown.key(frame, to)]).collect(), "corrected")
}

/// h01 of a segment: from 0 at its start to 1 at its end.
fn rise(from_s: f64, to_s: f64, t_s: f64) -> f64 {
    let dt_s = to_s - from_s;
    basis((t_s - from_s) / dt_s, dt_s)[2]
}
