//! Welch's spectra: power, coherence and phase over frequency, averaged over pieces of a series, with how sure they are.
//!
//! P. D. Welch, "The use of fast Fourier transform for the estimation of power spectra", IEEE Trans. Audio Electroacoust. 15
//! (1967) 70; J. S. Bendat and A. G. Piersol, "Random Data", 4th ed. (2010), chapters 8 and 9. A series is evenly sampled;
//! where it has gaps, its unbroken stretches are given one by one, and pieces lie within them. Each piece loses its
//! straight line, is weighted by a window, overlaps the one before by half, and is padded fourfold before its transform.

mod chi_squared;
mod cross;
mod window;

use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

use crate::swing::straightened;

pub use cross::Cross;
pub use window::Window;

/// A piece of fewer samples says nothing of frequencies.
pub const FEWEST: usize = 8;
/// Frequencies for each that a piece tells apart.
const PADDING: usize = 4;

/// A piece that is no piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a piece has at least {FEWEST} samples, came {came}")]
pub struct TooShort {
    /// Its samples.
    pub came: usize,
}

/// Takes Welch's spectra of series of one rate.
#[derive(Clone)]
pub struct Welch {
    fps: f64,
    window: Window,
    weights: Vec<f64>,
    fft: Arc<dyn RealToComplex<f64>>,
}

impl std::fmt::Debug for Welch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (fps, window, n_piece) = (self.fps, self.window, self.weights.len());
        f.debug_struct("Welch")
            .field("fps", &fps)
            .field("window", &window)
            .field("n_piece", &n_piece)
            .finish_non_exhaustive()
    }
}

/// Power over frequency, one-sided: the sum over all frequencies times their step is the mean square of the series.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Distance between two frequencies; the first is 0. A fourth of what pieces tell apart.
    pub step_hz: f64,
    /// The series' unit squared for each hertz, finite, 0 or more.
    pub per_hz: Vec<f64>,
    /// Pieces that it is the mean of; of several series, of each.
    pub n_pieces: usize,
    /// Equivalent degrees of freedom: of noise, each value is distributed as its mean times chi squared of so many over so many.
    /// Half of it at 0 Hz and half the rate.
    pub freedom: f64,
    /// How wide a band of white noise has the power that a value times it has, Hz.
    pub noise_hz: f64,
    /// How broad a steady sine is at half its power, Hz: nothing narrower is ever seen.
    pub window_hz: f64,
}

/// A peak of a density and how broad it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfPower {
    /// Where it is highest, Hz.
    pub hz: f64,
    /// Distance of the frequencies below and above at which the density is half of that, Hz.
    pub width_hz: f64,
    /// What the window alone makes of it, Hz (see [`Density::window_hz`]).
    pub window_hz: f64,
}

impl Welch {
    /// Pieces of so many samples, `fps` of them a second.
    ///
    /// # Errors
    /// [`TooShort`] of fewer than 8.
    pub fn new(fps: f64, window: Window, n_piece: usize) -> Result<Self, TooShort> {
        if n_piece < FEWEST {
            return Err(TooShort { came: n_piece });
        }
        let fft = RealFftPlanner::new().plan_fft_forward(PADDING * n_piece);
        Ok(Self { fps, window, weights: window.weights(n_piece), fft })
    }

    /// Length of a piece, seconds.
    #[must_use]
    pub fn piece_s(&self) -> f64 {
        self.weights.len() as f64 / self.fps
    }

    /// The density of a series, given by its unbroken stretches; `None` where none is as long as a piece.
    ///
    /// # Panics
    /// When a sample is not finite.
    #[must_use]
    #[track_caller]
    pub fn density(&self, stretches: &[&[f64]]) -> Option<Density> {
        let mut per_hz = vec![0.0; self.fft.len() / 2 + 1];
        let mut tally = Tally::default();
        for stretch in stretches {
            tally.add(self.starts(stretch.len()).len());
            for start in self.starts(stretch.len()) {
                let bins = self.transformed(&stretch[start..start + self.weights.len()]);
                per_hz.iter_mut().zip(&bins).for_each(|(sum, bin)| *sum += bin.norm_sqr());
            }
        }
        if tally.n_pieces == 0 {
            return None;
        }
        let scale = 1.0 / (self.fps * self.squares() * tally.n_pieces as f64);
        let last = per_hz.len() - 1;
        for (k, value) in per_hz.iter_mut().enumerate() {
            *value *= if k == 0 || k == last { scale } else { 2.0 * scale };
        }
        let sum: f64 = self.weights.iter().sum();
        Some(Density {
            step_hz: self.step_hz(),
            per_hz,
            n_pieces: tally.n_pieces,
            freedom: self.freedom(tally),
            noise_hz: self.fps * self.squares() / (sum * sum),
            window_hz: self.window.half_power_cells() * self.fps / self.weights.len() as f64,
        })
    }

    fn step_hz(&self) -> f64 {
        self.fps / self.fft.len() as f64
    }

    fn squares(&self) -> f64 {
        self.weights.iter().map(|w| w * w).sum()
    }

    /// How far a piece begins after the one before, samples.
    fn hop(&self) -> usize {
        self.weights.len() - self.weights.len() / 2
    }

    /// Where pieces begin in a stretch of so many samples.
    fn starts(&self, n: usize) -> std::iter::StepBy<std::ops::Range<usize>> {
        (0..(n + 1).saturating_sub(self.weights.len())).step_by(self.hop())
    }

    fn transformed(&self, piece: &[f64]) -> Vec<Complex<f64>> {
        assert!(piece.iter().all(|v| v.is_finite()), "series are finite");
        let mut input = self.fft.make_input_vec();
        let mut output = self.fft.make_output_vec();
        let mut straight = straightened(piece);
        // What is left of a series that stands still is rounding.
        let rounding = piece.iter().fold(0.0_f64, |most, v| most.max(v.abs())) * ROUNDING;
        if straight.iter().all(|value| value.abs() <= rounding) {
            straight.fill(0.0);
        }
        input.iter_mut().zip(&straight).zip(&self.weights).for_each(|((x, value), w)| *x = value * w);
        // Only wrong lengths fail, and these are the transform's own.
        let done = self.fft.process(&mut input, &mut output);
        debug_assert!(done.is_ok(), "{done:?}");
        output
    }

    /// 2 n² / (n + 2 m ρ) of n pieces, m of which overlap the one before, whose powers then correlate by ρ (Welch 1967).
    fn freedom(&self, Tally { n_pieces, n_overlaps }: Tally) -> f64 {
        let both = self.weights.iter().zip(&self.weights[self.hop()..]);
        let shared = both.map(|(a, b)| a * b).sum::<f64>() / self.squares();
        let n = n_pieces as f64;
        2.0 * n * n / (n + 2.0 * n_overlaps as f64 * shared * shared)
    }
}

/// How many pieces there are, and how many of them overlap the one before.
#[derive(Clone, Copy, Default)]
struct Tally {
    n_pieces: usize,
    n_overlaps: usize,
}

impl Tally {
    /// A stretch of so many pieces.
    fn add(&mut self, n: usize) {
        self.n_pieces += n;
        self.n_overlaps += n.saturating_sub(1);
    }
}

/// How far a series that stands still may seem to move, of its value.
const ROUNDING: f64 = 1e-12;

impl Density {
    /// By what a value is to be multiplied for the lower and the upper end of the band that has the true density with this
    /// probability, 0 to 1: the band of 95 % of values of `freedom` 20 is 0.59 to 2.09 times them.
    #[must_use]
    pub fn band(&self, share: f64) -> [f64; 2] {
        [1.0 + share, 1.0 - share].map(|ends| self.freedom / chi_squared::quantile(ends / 2.0, self.freedom))
    }

    /// As [`Density::band`], at the frequency of this number: at 0 and at half the rate there are half as many degrees of freedom.
    #[must_use]
    pub fn band_at(&self, bin: usize, share: f64) -> [f64; 2] {
        let is_end = bin == 0 || bin + 1 == self.per_hz.len();
        let freedom = if is_end { self.freedom / 2.0 } else { self.freedom };
        [1.0 + share, 1.0 - share].map(|ends| freedom / chi_squared::quantile(ends / 2.0, freedom))
    }

    /// The mean square of the series, of all frequencies.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.per_hz.iter().sum::<f64>() * self.step_hz
    }

    /// Makes it that of the series in another unit, of which one of its own has so many.
    pub fn scale(&mut self, times: f64) {
        self.per_hz.iter_mut().for_each(|value| *value *= times * times);
    }

    /// The sum of the densities of two series with the same pieces, as of the x and y of what moves: of two that have no
    /// more to do with one another its freedom is as much again, of one straight motion it is not.
    ///
    /// # Panics
    /// When they are not on the same frequencies.
    #[must_use]
    #[track_caller]
    pub fn plus(mut self, other: &Self) -> Self {
        assert_eq!(self.per_hz.len(), other.per_hz.len(), "densities of one Welch");
        self.per_hz.iter_mut().zip(&other.per_hz).for_each(|(sum, value)| *sum += value);
        self
    }

    /// The median at each frequency, which a few that are quite otherwise do not move; freedom and pieces are the fewest of
    /// one, for what moves together is known no better by being seen more often. `None` of none.
    ///
    /// # Panics
    /// When they are not on the same frequencies.
    #[must_use]
    #[track_caller]
    pub fn median(of: &[Self]) -> Option<Self> {
        let mut median = of.iter().min_by(|a, b| a.freedom.total_cmp(&b.freedom))?.clone();
        let mut values = vec![0.0; of.len()];
        for (bin, middle) in median.per_hz.iter_mut().enumerate() {
            values.iter_mut().zip(of).for_each(|(value, density)| *value = density.per_hz[bin]);
            values.sort_by(f64::total_cmp);
            *middle = f64::midpoint(values[(values.len() - 1) / 2], values[values.len() / 2]);
        }
        Some(median)
    }

    /// The highest peak between two frequencies; `None` where the density is highest at the end of them, or 0.
    #[must_use]
    pub fn peak(&self, [lowest, highest]: [f64; 2]) -> Option<HalfPower> {
        let first = (lowest / self.step_hz).ceil().max(1.0) as usize;
        let end = ((highest / self.step_hz).floor() as usize + 1).min(self.per_hz.len() - 1);
        let at = |k: &usize| self.per_hz[*k];
        let top = (first..end).max_by(|a, b| at(a).total_cmp(&at(b)))?;
        let [before, here, after] = [top - 1, top, top + 1].map(|k| self.per_hz[k]);
        if here <= 0.0 || before > here || after > here {
            return None;
        }
        // Between the last above half and the first below, on a straight line; at an end of the band, that end.
        let half = here / 2.0;
        let crossing = |inner: usize, outer: usize| {
            let share = (self.per_hz[inner] - half) / (self.per_hz[inner] - self.per_hz[outer]);
            inner as f64 + share * (outer as f64 - inner as f64)
        };
        let below = (0..top).rev().find(|k| at(k) < half).map_or(0.0, |k| crossing(k + 1, k));
        let last = self.per_hz.len() - 1;
        let above = (top + 1..=last).find(|k| at(k) < half).map_or(last as f64, |k| crossing(k - 1, k));
        let bend = before - 2.0 * here + after;
        let shift = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        Some(HalfPower {
            hz: (top as f64 + shift) * self.step_hz,
            width_hz: (above - below) * self.step_hz,
            window_hz: self.window_hz,
        })
    }
}

impl HalfPower {
    /// Damping that a resonance so broad would have, of critical: width / 2 f. Too large by about what the window alone
    /// has, [`HalfPower::window_damping`], and by what a frequency that changes adds.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.width_hz / (2.0 * self.hz)
    }

    /// The damping that a steady sine would seem to have.
    #[must_use]
    pub fn window_damping(&self) -> f64 {
        self.window_hz / (2.0 * self.hz)
    }

    /// The logarithm of a swing over the next at that damping, 2 pi zeta / sqrt(1 - zeta^2); `None` beyond critical.
    #[must_use]
    pub fn log_decrement(&self) -> Option<f64> {
        let zeta = self.damping();
        (zeta < 1.0).then(|| std::f64::consts::TAU * zeta / (1.0 - zeta * zeta).sqrt())
    }
}

#[cfg(test)]
mod tests;
