//! Sketching: the motion is drawn while the clip plays (Diener 2009, 3.4.2).

use super::{Correction, Refused, Shown};
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Status};

/// How late a hand follows what the eye sees, seconds (Diener 2009, 3.4.2, after its reference ES00).
pub const HUMAN_DELAY_S: f64 = 0.115;

/// A point of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// When it was drawn, seconds of the wall's clock since the clip began to play.
    pub elapsed_s: f64,
    /// Where, image pixels.
    pub at: [f64; 2],
}

/// How the clip played under the stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Played {
    /// Time of the clip at which it began, seconds.
    pub from_s: f64,
    /// Seconds of the clip per second, negative backwards.
    pub rate: f64,
    /// How late a picture reaches the eye and a stroke comes back, seconds.
    pub link_s: f64,
}

impl Played {
    /// How far a stroke is shifted in the clip's time, seconds.
    ///
    /// Both delays pass on the wall's clock, so that they count `rate` times in the clip's: 57.5 ms of the
    /// hand's 115 at half speed (errata E10).
    #[must_use]
    pub fn shift_s(&self) -> f64 {
        (HUMAN_DELAY_S + self.link_s) * self.rate
    }
}

/// Lays what was drawn over the frames that the stroke covers; key-frames and what is beside it stay.
///
/// Between two points of the stroke the hand is taken to go straight. The samples are no key-frames: a
/// stroke is a first guess, to be corrected in time.
///
/// # Errors
/// [`Refused::NoStroke`] when it covers no frame; what the document refuses.
pub fn sketch(shown: &Shown<'_>, drawn: &[Drawn], played: Played) -> Result<Correction, Refused> {
    let clip_s = |drawn: &Drawn| played.from_s + played.rate * drawn.elapsed_s - played.shift_s();
    let mut stroke: Vec<(f64, [f64; 2])> = drawn.iter().map(|drawn| (clip_s(drawn), drawn.at)).collect();
    stroke.retain(|(t_s, at)| t_s.is_finite() && at.iter().all(|x| x.is_finite()));
    stroke.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(first), Some(last)) = (stroke.first(), stroke.last()) else { return Err(Refused::NoStroke) };
    let times = shown.times.as_slice();
    let frame = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
    let frames =
        frame(times.partition_point(|&t| t < first.0))..frame(times.partition_point(|&t| t <= last.0));
    let at = |t_s: f64| {
        let after = stroke.partition_point(|(stroke_s, _)| *stroke_s < t_s).clamp(1, stroke.len().max(2) - 1);
        let (a, b) = (stroke[after - 1], stroke.get(after).copied().unwrap_or(stroke[after - 1]));
        let tau = if b.0 > a.0 { ((t_s - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
        [0, 1].map(|axis| (a.1[axis] + tau * (b.1[axis] - a.1[axis])) as f32)
    };
    let lay = shown.relay(frames, |frame| {
        let [x, y] = at(shown.time(frame));
        let (status, source, quality) = (Status::Tracked, Source::Sketch, Quality::default());
        Some(Some(Over::Sample(Laid { sample: Sample { x, y, status, source, quality }, run: None })))
    });
    shown.correct(vec![lay.ok_or(Refused::NoStroke)?], "sketched")
}
