//! The windows that pieces are seen through.

use std::f64::consts::TAU;

/// How a piece fades at its ends: what keeps a strong peak from hiding weak ones farther off makes each of them broader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Window {
    /// Side lobes below 0.7 ‰ of a peak's power, and less and less farther off: fit for nearly all.
    #[default]
    Hann,
    /// Side lobes below 0.05 ‰, but those far off stay as high.
    Hamming,
    /// Side lobes below 0.002 ‰; peaks are an eighth broader.
    Blackman,
    /// None at all: the narrowest peaks, and side lobes of 5 %.
    Rect,
}

impl Window {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::Hann, Self::Hamming, Self::Blackman, Self::Rect];

    /// Its name.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Hann => "hann",
            Self::Hamming => "hamming",
            Self::Blackman => "blackman",
            Self::Rect => "rect",
        }
    }

    /// Its weights for a piece of n samples; it would begin again at the next.
    pub(super) fn weights(self, n: usize) -> Vec<f64> {
        let [mean, once, twice] = match self {
            Self::Hann => [0.5, 0.5, 0.0],
            Self::Hamming => [0.54, 0.46, 0.0],
            Self::Blackman => [0.42, 0.5, 0.08],
            Self::Rect => [1.0, 0.0, 0.0],
        };
        let phase = |k: usize| TAU * k as f64 / n as f64;
        (0..n).map(|k| mean - once * phase(k).cos() + twice * (2.0 * phase(k)).cos()).collect()
    }

    /// How broad a sine is at half its power, in parts of 1 / duration (F. J. Harris, Proc. IEEE 66 (1978) 51, table 1).
    pub(super) fn half_power_cells(self) -> f64 {
        match self {
            Self::Hann => 1.441,
            Self::Hamming => 1.303,
            Self::Blackman => 1.644,
            Self::Rect => 0.886,
        }
    }
}
