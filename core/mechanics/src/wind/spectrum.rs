//! Turbulence by its spectrum: how much of its variance lies at which frequency (thesis 5.2.3).

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// A power spectral density: variance per hertz, one-sided, (m/s)^2/Hz.
pub trait Spectrum {
    /// At a frequency, hertz, more than 0.
    fn density(&self, hz: f64) -> f64;
}

/// a / (1 + b f)^beta (5.3), Kaimal's for beta = 5/3. Errata E24: it is a density of power and not the amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kaimal {
    /// Density at 0, (m/s)^2/Hz.
    pub a: f64,
    /// Seconds.
    pub b: f64,
    /// How it falls.
    pub beta: f64,
}

impl Kaimal {
    /// That of the wind along its mean: standard deviation s, mean speed U, length scale L (Burton and others, Wind Energy
    /// Handbook, 2.23): S = 4 s^2 L / U / (1 + 6 f L / U)^(5/3).
    #[must_use]
    pub fn along(deviation: f64, mean: f64, scale: f64) -> Self {
        let seconds = scale / mean;
        Self { a: 4.0 * deviation.powi(2) * seconds, b: 6.0 * seconds, beta: 5.0 / 3.0 }
    }
}

impl Spectrum for Kaimal {
    fn density(&self, hz: f64) -> f64 {
        self.a / (1.0 + self.b * hz).powf(self.beta)
    }
}

/// 1 / f^beta: noise that looks alike at all scales. Errata E24: its amplitude falls by half of beta.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Density at 1 Hz, (m/s)^2/Hz.
    pub at_1_hz: f64,
    /// How it falls.
    pub beta: f64,
}

impl Spectrum for Power {
    fn density(&self, hz: f64) -> f64 {
        self.at_1_hz * hz.powf(-self.beta)
    }
}

/// A draw of turbulence, `n` samples `step` seconds apart, mean 0, that repeats after its end: waves of all frequencies
/// with amplitudes sqrt(2 S df) and phases by chance.
#[must_use]
pub fn series(spectrum: &impl Spectrum, n: usize, step: f64, seed: u64) -> Vec<f64> {
    if n == 0 {
        return Vec::new();
    }
    let mut chance = Pcg64::seed_from_u64(seed);
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(n);
    let (mut waves, mut samples) = (inverse.make_input_vec(), inverse.make_output_vec());
    let df = 1.0 / (n as f64 * step);
    for (k, wave) in waves.iter_mut().enumerate().skip(1) {
        let phase = chance.random_range(0.0..TAU);
        // A wave of amplitude A is twice A / 2, at a frequency and at its negative.
        *wave = Complex::from_polar((2.0 * spectrum.density(k as f64 * df) * df).sqrt() / 2.0, phase);
    }
    // The highest of an even number has no phase.
    if n.is_multiple_of(2)
        && let Some(last) = waves.last_mut()
    {
        *last = Complex::new(last.norm(), 0.0);
    }
    match inverse.process(&mut waves, &mut samples) {
        Ok(()) => samples,
        // Lengths are those that the plan has made.
        Err(_) => Vec::new(),
    }
}
