//! How well scores tell the bad from the good: area under the curve, calibration, what must be opened.

use honami_review::evidence::Parts;
use honami_review::suspicion::Weights;
use serde_json::{Value, json};

use super::follow::{Case, Track};

/// Probabilities are compared with shares in so many bins.
const N_BINS: usize = 15;
/// The share of the bad tracks that is to be found.
const FOUND: f64 = 0.95;
/// The share of bad tracks for which the goal is set.
pub(super) const BAD_SHARE: f64 = 0.43;

/// Scores and whether they were of something bad.
type Scored = Vec<(f64, bool)>;

/// Suspicions of samples and tracks, with the truth.
#[derive(Default)]
pub(super) struct Tally {
    samples: Scored,
    tracks: Scored,
}

impl Tally {
    pub(super) fn of(case: &Case, weights: &Weights) -> Self {
        let tracks = worst(case, weights).map(|(p, is_bad)| (weights.of_track(p), is_bad)).collect();
        Self { samples: case.tracks.iter().flat_map(|track| suspicions(track, weights)).collect(), tracks }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.samples.extend(&other.samples);
        self.tracks.extend(&other.tracks);
    }

    /// Share of tracks to open to see the bad ones, and with a perfect order, were this share of them bad: every bad
    /// track counts as much more or less as it takes.
    pub(super) fn opened_where(&self, share: f64) -> (f64, f64) {
        let bad = self.tracks.iter().filter(|(_, is_bad)| *is_bad).count() as f64;
        let good = self.tracks.len() as f64 - bad;
        (opened(&self.tracks, [(1.0 - share) / good, share / bad]), FOUND * share)
    }

    pub(super) fn json(&self) -> Value {
        let bad = |scored: &Scored| scored.iter().filter(|(_, is_bad)| *is_bad).count() as f64;
        let n_tracks = self.tracks.len() as f64;
        json!({
            "n_tracks": self.tracks.len(), "bad_tracks": round(bad(&self.tracks) / n_tracks),
            "n_samples": self.samples.len(), "bad_samples": round(bad(&self.samples) / self.samples.len() as f64),
            "sample_auc": auc(&self.samples), "track_auc": auc(&self.tracks),
            "sample_ece": round(calibration_error(&self.samples)), "track_ece": round(calibration_error(&self.tracks)),
            "opened_for_95": round(opened(&self.tracks, [1.0 / n_tracks; 2])),
            "opened_for_95_ideal": round(FOUND * bad(&self.tracks) / n_tracks),
        })
    }
}

/// Suspicion of each track's worst sample, and whether the track is bad.
pub(super) fn worst(case: &Case, weights: &Weights) -> impl Iterator<Item = (f64, bool)> {
    let tracks = case.tracks.iter().filter(|track| judged(track).next().is_some());
    tracks.map(|track| {
        suspicions(track, weights)
            .fold((0.0, false), |worst, (p, is_bad)| (p.max(worst.0), is_bad || worst.1))
    })
}

fn suspicions(track: &Track, weights: &Weights) -> impl Iterator<Item = (f64, bool)> {
    judged(track).map(|(parts, is_bad)| (weights.probability(parts), *is_bad))
}

fn judged(track: &Track) -> impl Iterator<Item = &(Parts, bool)> {
    track.samples.iter().flatten()
}

/// Probability that a bad one scores higher than a good one (Mann-Whitney, ties count half); `None` with one kind.
fn auc(scored: &[(f64, bool)]) -> Option<f64> {
    let mut sorted = scored.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut good, mut wins) = (0.0, 0.0);
    for tied in sorted.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()) {
        let n_bad = tied.iter().filter(|(_, is_bad)| *is_bad).count() as f64;
        let n_good = tied.len() as f64 - n_bad;
        wins += n_bad * (good + n_good / 2.0);
        good += n_good;
    }
    let bad = sorted.len() as f64 - good;
    (bad * good > 0.0).then(|| round(wins / (bad * good)))
}

/// Expected calibration error: how far shares are from the probabilities they were given, averaged.
fn calibration_error(scored: &[(f64, bool)]) -> f64 {
    let mut bins = [(0.0, 0.0); N_BINS];
    for (p, is_bad) in scored {
        let bin = &mut bins[((p * N_BINS as f64) as usize).min(N_BINS - 1)];
        bin.0 += p;
        bin.1 += f64::from(u8::from(*is_bad));
    }
    bins.iter().map(|(p, bad)| (p - bad).abs()).sum::<f64>() / scored.len() as f64
}

/// Share of tracks to open, most suspicious first, until so many of the bad ones are found; what a good and a bad track
/// count.
fn opened(tracks: &[(f64, bool)], [good, bad]: [f64; 2]) -> f64 {
    let mut sorted = tracks.to_vec();
    sorted.sort_by(|a, b| b.0.total_cmp(&a.0));
    let n_bad = sorted.iter().filter(|(_, is_bad)| *is_bad).count();
    let wanted = (FOUND * n_bad as f64).ceil() as usize;
    let (mut found, mut share) = (0, 0.0);
    for (_, is_bad) in sorted {
        if found >= wanted {
            break;
        }
        found += usize::from(is_bad);
        share += if is_bad { bad } else { good };
    }
    share
}

fn round(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}
