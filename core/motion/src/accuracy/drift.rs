//! How errors grow with the time since a tracker was given the position.

use super::{Pair, compared, median};

/// A curve has at most so many points.
const N_POINTS: u32 = 12;

/// The error some frames after the query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// From so many frames after the query
    pub first: u32,
    /// to so many.
    pub last: u32,
    /// Median error of the visible samples, pixels; lost ones are farther off than any other, and `None` says that they
    /// are the half.
    pub median_px: Option<f64>,
    /// Share of the visible samples that were lost.
    pub lost: f64,
    /// Visible samples.
    pub n_samples: u64,
}

/// The drift curve of some tracks: equal stretches of time, at most twelve, those with no visible sample left out.
#[must_use]
pub fn drift<'a>(pairs: impl IntoIterator<Item = Pair<'a>>) -> Vec<Drift> {
    let mut errors: Vec<Vec<f64>> = Vec::new();
    for (truth, query_frame, track) in pairs {
        for sample in compared(truth, query_frame, track) {
            // Frames before the query are not among them.
            let since = (sample.frame - query_frame) as usize;
            if errors.len() <= since {
                errors.resize(since + 1, Vec::new());
            }
            if sample.visible {
                errors[since].push(sample.far_px());
            }
        }
    }
    let last_since = u32::try_from(errors.len().saturating_sub(1)).unwrap_or(u32::MAX);
    let n_points = N_POINTS.min(last_since);
    let end = |k: u32| (u64::from(last_since) * u64::from(k) / u64::from(n_points)) as u32;
    let point = |k: u32| {
        let (first, last) = (end(k) + 1, end(k + 1));
        let errors = errors[first as usize..=last as usize].concat();
        let n_samples = errors.len();
        let n_lost = errors.iter().filter(|px| px.is_infinite()).count();
        let lost = n_lost as f64 / n_samples as f64;
        let median_px = median(errors)?;
        let median_px = median_px.is_finite().then_some(median_px);
        Some(Drift { first, last, median_px, lost, n_samples: n_samples as u64 })
    };
    (0..n_points).filter_map(point).collect()
}
