//! Angles that scatter about one: the distribution of von Mises (Zeng 2.25, 5.5), fitted to angles, and cut off where it is
//! thin.

mod bessel;
#[cfg(test)]
mod tests;
mod truncated;

use std::f64::consts::{PI, TAU};

pub use truncated::Truncated;

/// How close together the closest angles are taken to be: a hundred-millionth of a radian squared, 0.006 degrees, is less
/// than any film tells.
pub const MAX_KAPPA: f64 = 1e8;

/// A distribution of angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VonMises {
    /// The angle that they scatter about, radians, above -π, at most π (errata Z11).
    pub mu: f64,
    /// How close to it they are, 0 (anywhere alike) to [`MAX_KAPPA`]; of large ones, one over the variance.
    pub kappa: f64,
}

impl VonMises {
    /// The most likely one: μ is the direction of the mean of unit vectors, κ that at which I₁(κ) / I₀(κ) is its length. κ is
    /// 0 where angles cancel, and [`MAX_KAPPA`] where all are one; `None` of no angles, or if one is not finite.
    #[must_use]
    pub fn fit(angles_rad: &[f64]) -> Option<Self> {
        if angles_rad.is_empty() || !angles_rad.iter().all(|angle| angle.is_finite()) {
            return None;
        }
        let n = angles_rad.len() as f64;
        let cos = angles_rad.iter().map(|angle| angle.cos()).sum::<f64>() / n;
        let sin = angles_rad.iter().map(|angle| angle.sin()).sum::<f64>() / n;
        let mu = sin.atan2(cos);
        // What the length lacks to 1, summed as such: of close angles nothing else would be left of it.
        let gap = angles_rad.iter().map(|angle| lack(angle - mu)).sum::<f64>() / n;
        Some(Self { mu: wrapped(mu), kappa: bessel::inverse(sin.hypot(cos), gap) })
    }

    /// How dense angles are here, per radian.
    #[must_use]
    pub fn density(&self, angle_rad: f64) -> f64 {
        (-self.kappa * lack(angle_rad - self.mu)).exp() * self.peak()
    }

    /// How dense they are where they are densest, at μ: 1/2π at least.
    #[must_use]
    pub fn peak(&self) -> f64 {
        1.0 / (TAU * bessel::i0_scaled(self.kappa))
    }

    /// The same without the angles that are less dense than a threshold, per radian; `None` where that leaves none, for it
    /// is above [`peak`](Self::peak) or no number.
    #[must_use]
    pub fn above(&self, threshold: f64) -> Option<Truncated> {
        Truncated::of(*self, threshold)
    }
}

/// What the cosine lacks to 1.
fn lack(angle_rad: f64) -> f64 {
    let half = (angle_rad / 2.0).sin();
    2.0 * half * half
}

/// The same direction, above -π and at most π.
fn wrapped(angle_rad: f64) -> f64 {
    let turn = angle_rad.rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}
