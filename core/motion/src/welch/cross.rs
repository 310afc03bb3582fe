//! What two series have in common at each frequency, and how far the second is behind the first.

use realfft::num_complex::Complex;

use super::{Tally, Welch};

/// Coherence and phase of two series over frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Cross {
    /// Distance between two frequencies; the first is 0. A fourth of what pieces tell apart.
    pub step_hz: f64,
    /// Magnitude-squared coherence, 0 to 1: the share of the power of one that is the other's, through whatever linear way.
    pub coherence: Vec<f64>,
    /// How far the second is behind the first, radians, -π to π: 2π f τ for a copy that comes τ later.
    pub phase_rad: Vec<f64>,
    /// Pieces that count as independent. With one coherence is 1 always.
    pub n_pieces: f64,
}

impl Welch {
    /// Coherence and phase of two series, given by stretches of the same times; `None` where none is as long as two pieces
    /// that overlap by half, or where nothing moves.
    ///
    /// # Panics
    /// When stretches of a pair differ in length, or a sample is not finite.
    #[must_use]
    #[track_caller]
    pub fn cross(&self, stretches: &[[&[f64]; 2]]) -> Option<Cross> {
        let n_bins = self.fft.len() / 2 + 1;
        let mut sums = vec![([0.0_f64; 2], Complex::<f64>::default()); n_bins];
        let mut tally = Tally::default();
        for [first, second] in stretches {
            assert_eq!(first.len(), second.len(), "stretches of the same times");
            tally.add(self.starts(first.len()).len());
            for start in self.starts(first.len()) {
                let of = |series: &[f64]| self.transformed(&series[start..start + self.weights.len()]);
                for (([aa, bb], ab), (a, b)) in sums.iter_mut().zip(of(first).iter().zip(&of(second))) {
                    *aa += a.norm_sqr();
                    *bb += b.norm_sqr();
                    *ab += a * b.conj();
                }
            }
        }
        let moves = |which: usize| sums.iter().any(|(own, _)| own[which] > 0.0);
        if tally.n_pieces < 2 || !moves(0) || !moves(1) {
            return None;
        }
        let coherence = sums.iter().map(|([aa, bb], ab)| {
            // Where one of them has no power at all, there is nothing in common.
            let both = aa * bb;
            if both > 0.0 { (ab.norm_sqr() / both).min(1.0) } else { 0.0 }
        });
        Some(Cross {
            step_hz: self.step_hz(),
            coherence: coherence.collect(),
            phase_rad: sums.iter().map(|(_, ab)| ab.arg()).collect(),
            n_pieces: self.freedom(tally) / 2.0,
        })
    }
}

impl Cross {
    /// What the coherence of two series that have nothing in common is on average: 1 / n.
    #[must_use]
    pub fn bias(&self) -> f64 {
        1.0 / self.n_pieces
    }

    /// What it stays below with this probability, 0 to 1, where they have nothing in common: `1 - (1 - share)^(1 / (n - 1))`.
    #[must_use]
    pub fn chance(&self, share: f64) -> f64 {
        1.0 - (1.0 - share).powf(1.0 / (self.n_pieces - 1.0).max(f64::MIN_POSITIVE))
    }

    /// Standard error of the phase at a frequency's number, radians: `sqrt((1 - c) / (2 n c))` (Bendat and Piersol, eq. 9.91),
    /// and at most that of a phase of which nothing is known, π / √3.
    #[must_use]
    pub fn phase_error_rad(&self, bin: usize) -> f64 {
        let most = std::f64::consts::PI / 3.0_f64.sqrt();
        let coherence = self.coherence.get(bin).copied().unwrap_or(0.0);
        let error = ((1.0 - coherence) / (2.0 * self.n_pieces * coherence.max(f64::MIN_POSITIVE))).sqrt();
        error.min(most)
    }

    /// The number of the frequency nearest to one.
    #[must_use]
    pub fn bin(&self, hz: f64) -> usize {
        ((hz / self.step_hz).round().max(0.0) as usize).min(self.coherence.len().saturating_sub(1))
    }
}
