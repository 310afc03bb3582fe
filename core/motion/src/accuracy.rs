//! How close tracks come to the truth: the measures of TAP-Vid (Doersch et al. 2022), on native pixels.

use honami_model::track::Span;

/// Distances in pixels within which a position counts, averaged in [`Accuracy::delta_avg`].
pub const THRESHOLDS_PX: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

/// Where a feature truly was in consecutive frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TruePath {
    /// Frame of the first position.
    pub first_frame: u32,
    /// x, y in pixels, and whether the feature can be seen.
    pub positions: Vec<(f64, f64, bool)>,
}

/// How close a set of tracks came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// Share of visible samples within 1, 2, 4, 8, 16 px, averaged over the five; a lost sample is a miss.
    pub delta_avg: f64,
    /// Share of visible samples within 1 px.
    pub within_1px: f64,
    /// Mean over tracks of the share of frames before the first error above 16 px or loss.
    pub survival: f64,
    /// Share of tracks within 8 px on every visible frame.
    pub ok_tracks: f64,
    /// Median error of the visible samples that were not lost, pixels; `None` when all were lost.
    pub median_px: Option<f64>,
    /// Share of samples whose visibility was told rightly.
    pub visibility: f64,
    /// Visible samples measured, the query frames aside.
    pub n_samples: u64,
    /// Visible samples that were lost or missing.
    pub n_lost: u64,
}

/// Compares tracks with their true paths; `None` when there is no visible sample to compare.
///
/// `query_frame` of a pair is the frame in which the tracker was given the position; only later frames count.
#[must_use]
pub fn accuracy<'a>(pairs: impl IntoIterator<Item = (&'a TruePath, u32, &'a Span)>) -> Option<Accuracy> {
    let mut sum = Sums::default();
    for (truth, query_frame, track) in pairs {
        sum.add(truth, query_frame, track);
    }
    sum.finish()
}

#[derive(Default)]
struct Sums {
    within: [u64; THRESHOLDS_PX.len()],
    errors: Vec<f64>,
    n_visible: u64,
    n_all: u64,
    n_told: u64,
    survival: f64,
    n_ok: u64,
    n_tracks: u64,
}

impl Sums {
    fn add(&mut self, truth: &TruePath, query_frame: u32, track: &Span) {
        let (mut survived, mut n_frames, mut alive, mut ok) = (0_u64, 0_u64, true, true);
        let after_query =
            (truth.first_frame..).zip(&truth.positions).filter(|(frame, _)| *frame > query_frame);
        for (frame, &(x, y, visible)) in after_query {
            let seen = track.get(frame).filter(|sample| sample.status.is_seen());
            self.n_all += 1;
            self.n_told += u64::from(seen.is_some() == visible);
            n_frames += 1;
            if visible {
                self.n_visible += 1;
                let error = seen.map(|s| (f64::from(s.x) - x).hypot(f64::from(s.y) - y));
                for (count, threshold) in self.within.iter_mut().zip(THRESHOLDS_PX) {
                    *count += u64::from(error.is_some_and(|e| e < threshold));
                }
                alive &= error.is_some_and(|e| e <= 16.0);
                ok &= error.is_some_and(|e| e <= 8.0);
                self.errors.extend(error);
            }
            survived += u64::from(alive);
        }
        if n_frames > 0 {
            self.n_tracks += 1;
            self.n_ok += u64::from(ok);
            self.survival += survived as f64 / n_frames as f64;
        }
    }

    fn finish(mut self) -> Option<Accuracy> {
        if self.n_visible == 0 {
            return None;
        }
        let n_visible = self.n_visible as f64;
        let n_tracks = self.n_tracks as f64;
        self.errors.sort_by(f64::total_cmp);
        Some(Accuracy {
            delta_avg: self.within.iter().sum::<u64>() as f64 / (n_visible * THRESHOLDS_PX.len() as f64),
            within_1px: self.within[0] as f64 / n_visible,
            survival: self.survival / n_tracks,
            ok_tracks: self.n_ok as f64 / n_tracks,
            median_px: self.errors.get(self.errors.len() / 2).copied(),
            visibility: self.n_told as f64 / self.n_all as f64,
            n_samples: self.n_visible,
            n_lost: self.n_visible - self.errors.len() as u64,
        })
    }
}

#[cfg(test)]
mod tests;
