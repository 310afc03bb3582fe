//! Suspicion: the probability that a sample is off by more than [`BAD_PX`].
//!
//! A logistic model of the parts of the evidence. Every part adds to the log-odds what its measured value is worth, or
//! a constant where it is missing: `log(p / (1 - p)) = b + Σ (w_k φ_k(x_k) or m_k)`.

use honami_model::track::{Sample, Source, Status};

use crate::evidence::{Kind, Parts, is_judged};

pub mod fit;
mod weights;

use weights::{ANCHORED, STEPWISE};

/// A sample that is off by more is bad, pixels; a track is bad when any of its visible samples is.
pub const BAD_PX: f64 = 8.0;

/// Suspicion of a sample that is lost. There is surely something to do, but a gap does less harm than samples that
/// are almost surely wrong: it is looked at after them.
pub const LOST: f32 = 0.85;

/// Suspicion, at least, of a sample of a stepwise tracker that an anchored one sees farther away than [`BAD_PX`].
pub const CONTRADICTED: f64 = 0.5;

/// Number of parts.
pub const N_PARTS: usize = 8;

/// What a part is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Times the transformed value.
    pub slope: f64,
    /// Where the part is missing.
    pub missing: f64,
    /// What four of five good samples are below, transformed.
    pub ordinary: f64,
}

/// The model of trackers of one [kind](Kind): they err in different ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Log-odds before any part is looked at.
    pub base: f64,
    /// In the order of [`transformed`]: FB, NCC, jump, neighbours, disagreement, the tracker's own NCC, disagreement
    /// with anchored runs, group.
    pub parts: [Weight; N_PARTS],
    /// Offset and slope that turn the log-odds of a track's worst sample into those of the track.
    pub track: [f64; 2],
}

/// The parts on the scales on which the log-odds are all but straight lines.
#[must_use]
pub fn transformed(parts: &Parts) -> [Option<f64>; N_PARTS] {
    let log = |x: Option<f32>, floor: f64| x.map(|x| (f64::from(x) + floor).ln());
    [
        log(parts.fb_px, 0.02),
        parts.ncc.map(|ncc| 1.0 - f64::from(ncc)),
        log(parts.jump, 1.0),
        log(parts.nbr_px, 0.5),
        log(parts.dis_px, DISAGREED_PX),
        parts.own_ncc.map(|ncc| 1.0 - f64::from(ncc)),
        log(parts.anchored_px, DISAGREED_PX),
        log(parts.group_px, 0.5),
    ]
}

/// Runs that are no farther apart agree, pixels.
const DISAGREED_PX: f64 = 0.25;

/// The weights of trackers of a kind.
#[must_use]
pub fn weights(kind: Kind) -> &'static Weights {
    match kind {
        Kind::Stepwise => &STEPWISE,
        Kind::Anchored => &ANCHORED,
    }
}

/// Probability that a sample with this evidence is bad, 0..=1.
#[must_use]
pub fn probability(parts: &Parts) -> f64 {
    let fitted = weights(parts.kind).probability(parts);
    // Where all else looks right, as on a smooth clip, the sum of the parts would outvote a contradiction: two places
    // farther apart than a bad sample is off cannot both be right, and the anchored tracker is the one that seldom errs.
    let is_far = parts.anchored_px.is_some_and(|px| f64::from(px) > BAD_PX);
    if parts.kind == Kind::Stepwise && is_far { fitted.max(CONTRADICTED) } else { fitted }
}

impl Weights {
    /// Log-odds that a sample with this evidence is bad, and what each part adds to them.
    #[must_use]
    pub fn log_odds(&self, parts: &Parts) -> (f64, [f64; N_PARTS]) {
        let mut shares = [0.0; N_PARTS];
        for ((share, weight), x) in shares.iter_mut().zip(&self.parts).zip(transformed(parts)) {
            *share = x.map_or(weight.missing, |x| weight.slope * x);
        }
        (self.base + shares.iter().sum::<f64>(), shares)
    }

    /// Probability that a sample with this evidence is bad, 0..=1.
    #[must_use]
    pub fn probability(&self, parts: &Parts) -> f64 {
        logistic(self.log_odds(parts).0)
    }

    /// Probability that a track is bad whose worst sample is bad with probability `worst`.
    ///
    /// Errors last, so that the worst sample all but tells of the others: the two differ little.
    #[must_use]
    pub fn of_track(&self, worst: f64) -> f64 {
        let [offset, slope] = self.track;
        logistic(offset + slope * log_odds(worst))
    }
}

/// Suspicion of a sample, 0 (a person's word) to 1.
#[must_use]
pub fn of_sample(sample: &Sample, parts: &Parts) -> f32 {
    if is_judged(sample) {
        probability(parts) as f32
    } else if is_lost(sample) {
        LOST
    } else {
        0.0
    }
}

/// Whether the track is lost here, and nobody has said that this is as it should be.
#[must_use]
pub fn is_lost(sample: &Sample) -> bool {
    sample.status == Status::Lost && !matches!(sample.source, Source::Key | Source::Sketch)
}

/// Suspicion of a whole track, given those of its samples and the kind of its tracker: the probability that any of them
/// is bad.
#[must_use]
pub fn of_track(kind: Kind, samples: &[f32]) -> f32 {
    let worst = samples.iter().copied().fold(0.0, f32::max);
    if worst > 0.0 { weights(kind).of_track(f64::from(worst)) as f32 } else { 0.0 }
}

fn log_odds(p: f64) -> f64 {
    let p = p.clamp(1e-9, 1.0 - 1e-9);
    (p / (1.0 - p)).ln()
}

fn logistic(log_odds: f64) -> f64 {
    1.0 / (1.0 + (-log_odds).exp())
}

#[cfg(test)]
mod tests;
