//! Sketching: the motion is drawn while the clip plays (Diener 2009, 3.4.2).

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{Correction, Refused, Shown};
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Status};

/// How late a hand follows what the eye sees, seconds (Diener 2009, 3.4.2, after K. C. Engel and J. F. Soechting,
/// Manual tracking in two dimensions, J. Neurophysiol. 83, 2000).
pub const HUMAN_DELAY_S: f64 = 0.115;

/// Clip times closer than this are one, seconds.
const GRAIN_S: f64 = 1e-9;

/// A point of a stroke. Written as `[elapsed_s, x, y]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Drawn {
    /// When it was drawn, seconds of the wall's clock since the clip began to play.
    pub elapsed_s: f64,
    /// Where, image pixels.
    pub at: [f64; 2],
}

/// How the clip played under a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Played {
    /// Time of the clip at which it began, seconds.
    pub from_s: f64,
    /// Seconds of the clip per second, negative backwards.
    pub rate: f64,
    /// How late the stroke is behind the clip's clock, seconds of the wall's.
    pub delay_s: f64,
}

/// A line drawn without a break while the clip played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// How it played.
    #[serde(flatten)]
    pub played: Played,
    /// What was drawn.
    pub drawn: Vec<Drawn>,
}

impl Played {
    /// The clip stood under every point: `elapsed_s` is the clip's own time, and nothing is late.
    pub const STEPWISE: Self = Self { from_s: 0.0, rate: 1.0, delay_s: 0.0 };

    /// The clip played under a hand; `link_s` is how late a picture reached the eye and the stroke came back, seconds.
    #[must_use]
    pub fn under_hand(from_s: f64, rate: f64, link_s: f64) -> Self {
        Self { from_s, rate, delay_s: HUMAN_DELAY_S + link_s }
    }

    /// How far a stroke is shifted in the clip's time, seconds.
    ///
    /// All delays pass on the wall's clock, so that they count `rate` times in the clip's: 57.5 ms of the
    /// hand's 115 at half speed (errata E10).
    #[must_use]
    pub fn shift_s(&self) -> f64 {
        self.delay_s * self.rate
    }
}

impl Stroke {
    /// The clip's times and the points at them, earliest first; numbers that are not finite are left out.
    fn path(&self) -> Vec<(f64, [f64; 2])> {
        let Played { from_s, rate, .. } = self.played;
        let clip_s = |drawn: &Drawn| from_s + rate * drawn.elapsed_s - self.played.shift_s();
        let mut path: Vec<(f64, [f64; 2])> =
            self.drawn.iter().map(|drawn| (clip_s(drawn), drawn.at)).collect();
        path.retain(|(t_s, at)| t_s.is_finite() && at.iter().all(|x| x.is_finite()));
        path.sort_by(|a, b| a.0.total_cmp(&b.0));
        path
    }

    /// The frames that it covers. What was drawn before the first picture could be answered shows nothing: the hand
    /// was where it had been put down, and the clip stood.
    fn frames(&self, path: &[(f64, [f64; 2])], times: &[f64]) -> Range<u32> {
        let (Some(first), Some(last)) = (path.first(), path.last()) else { return 0..0 };
        let Played { from_s, rate, .. } = self.played;
        let first_s = if rate > 0.0 { first.0.max(from_s) } else { first.0 };
        let last_s = if rate < 0.0 { last.0.min(from_s) } else { last.0 };
        let frame = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
        let end = times.partition_point(|&t| t <= last_s + GRAIN_S);
        frame(times.partition_point(|&t| t < first_s - GRAIN_S).min(end))..frame(end)
    }
}

impl From<[f64; 3]> for Drawn {
    fn from([elapsed_s, x, y]: [f64; 3]) -> Self {
        Self { elapsed_s, at: [x, y] }
    }
}

impl From<Drawn> for [f64; 3] {
    fn from(Drawn { elapsed_s, at: [x, y] }: Drawn) -> Self {
        [elapsed_s, x, y]
    }
}

/// Lays what was drawn over the frames that the strokes cover, later strokes over earlier ones; key-frames and what
/// is beside them stay.
///
/// Between two points of a stroke the hand is taken to go straight. The samples are no key-frames: a
/// stroke is a first guess, to be corrected in time.
///
/// # Errors
/// [`Refused::NoStroke`] when they cover no frame; what the document refuses.
pub fn sketch(shown: &Shown<'_>, strokes: &[Stroke]) -> Result<Correction, Refused> {
    let mut edits = Vec::new();
    for stroke in strokes {
        let path = stroke.path();
        let frames = stroke.frames(&path, shown.times.as_slice());
        edits.extend(shown.relay(frames, |frame| {
            let [x, y] = along(&path, shown.time(frame))?;
            let (status, source, quality) = (Status::Tracked, Source::Sketch, Quality::default());
            let sample = Sample { x, y, status, source, quality };
            Some(Some(Over::Sample(Laid { sample, run: None })))
        }));
    }
    if edits.is_empty() {
        return Err(Refused::NoStroke);
    }
    shown.correct(edits, "sketched")
}

/// Where a path is at a time, straight between its points and still beyond its ends.
fn along(path: &[(f64, [f64; 2])], t_s: f64) -> Option<[f32; 2]> {
    let after = path.partition_point(|(at_s, _)| *at_s < t_s);
    let b = path.get(after).or(path.last())?;
    let a = path.get(after.saturating_sub(1))?;
    let tau = if b.0 > a.0 { ((t_s - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
    Some([0, 1].map(|axis| (a.1[axis] + tau * (b.1[axis] - a.1[axis])) as f32))
}
