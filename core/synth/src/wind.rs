//! Gusts that pass over the plant, and the sways that they drive.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// One sway: `amplitude · sin(2π · hz · t + phase)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mode {
    pub(crate) hz: f64,
    pub(crate) phase_rad: f64,
    /// At wind of strength 1; the level scales it.
    pub(crate) amplitude_rad: f64,
}

impl Mode {
    pub(crate) fn at(&self, t_secs: f64) -> f64 {
        self.amplitude_rad * (TAU * self.hz * t_secs + self.phase_rad).sin()
    }
}

/// Draws 1 to 3 modes: a fundamental near `hz` and weaker overtones.
pub(crate) fn modes(rng: &mut Pcg64Mcg, hz: f64, amplitude_rad: f64) -> Vec<Mode> {
    let n_modes = rng.random_range(1..=3);
    let mut hz = hz * rng.random_range(0.85..1.15);
    let mut amplitude_rad = amplitude_rad * rng.random_range(0.75..1.25);
    let mut modes = Vec::with_capacity(n_modes);
    for _ in 0..n_modes {
        modes.push(Mode { hz, phase_rad: rng.random_range(0.0..TAU), amplitude_rad });
        hz *= rng.random_range(1.35..1.48);
        amplitude_rad *= rng.random_range(0.3..0.45);
    }
    modes
}

/// The strength of the wind over time and across the picture: slow waves that travel to the right.
#[derive(Clone, Debug)]
pub(crate) struct Wind {
    /// Waves of strength: (Hz, phase, relative amplitude).
    gusts: [(f64, f64, f64); 2],
    /// Seconds that a gust takes from one edge of the picture to the other.
    crossing_secs: f64,
    /// Width of the picture, pixels.
    width_px: f64,
}

impl Wind {
    pub(crate) fn new(rng: &mut Pcg64Mcg, width_px: f64) -> Self {
        let mut gust = |hz: f64, amplitude| (hz, rng.random_range(0.0..TAU), amplitude);
        Self { gusts: [gust(0.07, 0.3), gust(0.16, 0.2)], crossing_secs: 1.4, width_px }
    }

    /// Strength at a column and a time, 0.5 to 1.5, mean 1.
    pub(crate) fn strength(&self, x_px: f64, t_secs: f64) -> f64 {
        let t_secs = t_secs - self.crossing_secs * x_px / self.width_px;
        let swell = |&(hz, phase, amplitude): &(f64, f64, f64)| amplitude * (TAU * hz * t_secs + phase).sin();
        1.0 + self.gusts.iter().map(swell).sum::<f64>()
    }
}
