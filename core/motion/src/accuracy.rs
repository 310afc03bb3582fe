//! How close tracks come to the truth: the measures of TAP-Vid (Doersch et al. 2022), on native pixels, and what else
//! says whether they can be trusted.

use honami_model::track::Span;

pub use compared::{Compared, compared};
pub use drift::{Drift, drift};
pub use histogram::{Histogram, histogram};

mod compared;
mod drift;
mod histogram;

/// Distances in pixels within which a position counts, averaged in [`Accuracy::delta_avg`].
pub const THRESHOLDS_PX: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

/// A sample that is called seen is right within this distance, pixels.
pub const RIGHT_PX: f64 = 8.0;

/// Where a feature truly was in consecutive frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruePath {
    /// Frame of the first position.
    pub first_frame: u32,
    /// x, y in pixels, and whether the feature can be seen.
    pub positions: Vec<(f64, f64, bool)>,
}

/// A track beside its truth: the true path, the query frame, in which the tracker was given the position, and what it
/// made of it. Only frames after the query count.
pub type Pair<'a> = (&'a TruePath, u32, &'a Span);

/// How close a set of tracks came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// The mean of [`within`](Self::within).
    pub delta_avg: f64,
    /// Share of visible samples within 1, 2, 4, 8, 16 px; a lost sample is a miss.
    pub within: [f64; THRESHOLDS_PX.len()],
    /// Mean over tracks of the share of frames before the first error above 16 px or loss.
    pub survival: f64,
    /// Share of tracks within 8 px on every visible frame.
    pub ok_tracks: f64,
    /// Median error of the visible samples that were not lost, pixels; `None` when all were lost, as in what follows.
    pub median_px: Option<f64>,
    /// Median over tracks of the median error of a track, pixels, a lost sample being farther off than any other;
    /// `None` when half the tracks were lost for half of their frames.
    pub trajectory_px: Option<f64>,
    /// Mean error of the visible samples that were not lost, pixels.
    pub mean_px: Option<f64>,
    /// Root of their mean squared error, pixels.
    pub rms_px: Option<f64>,
    /// The same of their offsets right and down, each for itself, pixels.
    pub axis_rms_px: Option<[f64; 2]>,
    /// Their mean offset from the truth, right and down, pixels.
    pub bias_px: Option<[f64; 2]>,
    /// Share of samples whose visibility was told rightly: occlusion accuracy.
    pub visibility: f64,
    /// Of the samples called seen, the share within 8 px; `None` when none was. Whether the feature could be seen there
    /// is another question, which [`visibility`](Self::visibility) answers: half a leaf can be followed well.
    pub precision: Option<f64>,
    /// Of the visible samples, the share that was called seen and is within 8 px.
    pub recall: f64,
    /// Visible samples measured, the query frames aside.
    pub n_samples: u64,
    /// Visible samples that were lost or missing.
    pub n_lost: u64,
}

/// Compares tracks with their true paths; `None` when there is no visible sample to compare.
#[must_use]
pub fn accuracy<'a>(pairs: impl IntoIterator<Item = Pair<'a>>) -> Option<Accuracy> {
    let mut sum = Sums::default();
    for (truth, query_frame, track) in pairs {
        sum.add(&compared(truth, query_frame, track));
    }
    sum.finish()
}

#[derive(Default)]
struct Sums {
    within: [u64; THRESHOLDS_PX.len()],
    /// Of the visible samples that were not lost.
    errors: Vec<f64>,
    offset: [f64; 2],
    squared: [f64; 2],
    /// One a track that has visible samples.
    medians: Vec<f64>,
    n_visible: u64,
    n_all: u64,
    n_told: u64,
    n_seen: u64,
    /// Of those called seen, within 8 px; and of these, those that are visible.
    n_near: u64,
    n_right: u64,
    survival: f64,
    n_ok: u64,
    n_tracks: u64,
}

impl Sums {
    fn add(&mut self, samples: &[Compared]) {
        let (mut survived, mut alive, mut ok) = (0_u64, true, true);
        for sample in samples {
            let seen = sample.offset_px.is_some();
            self.n_all += 1;
            self.n_seen += u64::from(seen);
            self.n_near += u64::from(sample.far_px() <= RIGHT_PX);
            self.n_told += u64::from(seen == sample.visible);
            if sample.visible {
                let error_px = sample.far_px();
                self.n_visible += 1;
                for (count, threshold) in self.within.iter_mut().zip(THRESHOLDS_PX) {
                    *count += u64::from(error_px < threshold);
                }
                self.n_right += u64::from(error_px <= RIGHT_PX);
                alive &= error_px <= 16.0;
                ok &= error_px <= 8.0;
                if let Some([x, y]) = sample.offset_px {
                    self.errors.push(error_px);
                    self.offset = [self.offset[0] + x, self.offset[1] + y];
                    self.squared = [self.squared[0] + x * x, self.squared[1] + y * y];
                }
            }
            survived += u64::from(alive);
        }
        if !samples.is_empty() {
            self.n_tracks += 1;
            self.n_ok += u64::from(ok);
            self.survival += survived as f64 / samples.len() as f64;
        }
        let visible = samples.iter().filter(|sample| sample.visible).map(Compared::far_px);
        self.medians.extend(median(visible.collect()));
    }

    fn finish(self) -> Option<Accuracy> {
        if self.n_visible == 0 {
            return None;
        }
        let (n_visible, n_found) = (self.n_visible as f64, self.errors.len() as f64);
        let n_tracks = self.n_tracks as f64;
        let found = |sum: f64| (n_found > 0.0).then_some(sum / n_found);
        let on_axes = |sums: [f64; 2]| found(sums[0]).zip(found(sums[1])).map(<[f64; 2]>::from);
        Some(Accuracy {
            delta_avg: self.within.iter().sum::<u64>() as f64 / (n_visible * THRESHOLDS_PX.len() as f64),
            within: self.within.map(|n| n as f64 / n_visible),
            survival: self.survival / n_tracks,
            ok_tracks: self.n_ok as f64 / n_tracks,
            trajectory_px: median(self.medians).filter(|px| px.is_finite()),
            mean_px: found(self.errors.iter().sum()),
            rms_px: found(self.errors.iter().map(|px| px * px).sum()).map(f64::sqrt),
            axis_rms_px: on_axes(self.squared).map(|squares| squares.map(f64::sqrt)),
            bias_px: on_axes(self.offset),
            visibility: self.n_told as f64 / self.n_all as f64,
            precision: (self.n_seen > 0).then_some(self.n_near as f64 / self.n_seen as f64),
            recall: self.n_right as f64 / n_visible,
            n_samples: self.n_visible,
            n_lost: self.n_visible - self.errors.len() as u64,
            median_px: median(self.errors),
        })
    }
}

/// The middle one of some numbers, of an even count the mean of the two in the middle; `None` of none.
#[must_use]
pub fn median(mut numbers: Vec<f64>) -> Option<f64> {
    let middle = numbers.len() / 2;
    if numbers.is_empty() {
        return None;
    }
    let is_odd = numbers.len() % 2 == 1;
    let (below, &mut upper, _) = numbers.select_nth_unstable_by(middle, f64::total_cmp);
    let lower = below.iter().copied().max_by(f64::total_cmp).filter(|_| !is_odd);
    Some(lower.map_or(upper, |lower| f64::midpoint(lower, upper)))
}

#[cfg(test)]
mod tests;
