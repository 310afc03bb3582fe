//! How errors are distributed, from a thirty-second of a pixel to 64.

use super::{Compared, Pair, compared};

/// Bins of a histogram.
const N_BINS: usize = 24;
/// Bins below one pixel that have a lower edge: half an octave each.
const N_BELOW_1PX: i32 = 10;

/// Shares of the visible samples by their error: the first below 1/32 px, the last from 64 px on, between them two bins
/// an octave. What lacks in their sum was lost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Histogram {
    /// One a bin.
    pub shares: [f64; N_BINS],
}

impl Histogram {
    /// The lower edge of a bin, pixels; that of the first is 0.
    #[must_use]
    pub fn edge_px(bin: usize) -> f64 {
        match i32::try_from(bin).unwrap_or(i32::MAX) {
            0 => 0.0,
            bin => 2_f64.powf(f64::from(bin - 1 - N_BELOW_1PX) / 2.0),
        }
    }

    /// Share of the visible samples that were lost.
    #[must_use]
    pub fn lost(&self) -> f64 {
        (1.0 - self.shares.iter().sum::<f64>()).clamp(0.0, 1.0)
    }
}

/// The errors of some tracks; `None` when there is no visible sample.
#[must_use]
pub fn histogram<'a>(pairs: impl IntoIterator<Item = Pair<'a>>) -> Option<Histogram> {
    let (mut counts, mut n_visible) = ([0_u64; N_BINS], 0_u64);
    for (truth, query_frame, track) in pairs {
        for sample in compared(truth, query_frame, track).iter().filter(|sample| sample.visible) {
            n_visible += 1;
            if let Some(px) = Compared::error_px(sample) {
                counts[bin(px)] += 1;
            }
        }
    }
    (n_visible > 0).then(|| Histogram { shares: counts.map(|n| n as f64 / n_visible as f64) })
}

/// The last bin whose lower edge is not above the error.
fn bin(error_px: f64) -> usize {
    (1..N_BINS).rev().find(|&bin| error_px >= Histogram::edge_px(bin)).unwrap_or(0)
}
