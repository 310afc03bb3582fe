//! What is left of angles above a threshold of density, drawn by the inverse of its cumulative: one number between 0 and 1
//! gives an angle, where drawing and rejecting may go on for ever (errata Z5).

use std::f64::consts::PI;

use super::{VonMises, lack, wrapped};

/// Equal parts of the half that is integrated.
const PARTS: usize = 128;
/// Where a density has fallen to e^-REACH of its peak, there is nothing beyond.
const REACH: f64 = 42.0;
/// Halvings of a part that leave no digit open.
const HALVINGS: u32 = 50;
/// Where a part is looked at, of its half from the middle, and weights (Gauss and Legendre, 3 points).
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];

/// A distribution of angles that ends on both sides of μ where it gets less dense than a threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct Truncated {
    of: VonMises,
    /// How far it goes on either side, radians.
    half_width: f64,
    /// Width of a part.
    step: f64,
    /// At the end of every part, the integral from μ of the density over its peak.
    sums: Vec<f64>,
}

impl Truncated {
    pub(super) fn of(of: VonMises, threshold: f64) -> Option<Self> {
        let peak = of.peak();
        // A threshold that is no number leaves nothing, either.
        let is_below = threshold <= peak;
        if !is_below {
            return None;
        }
        // 1 - cos of the half width: Zeng's acos, without what that loses where it is narrow.
        let width = |drop: f64| {
            if drop < 2.0 { 2.0 * (drop / 2.0).sqrt().asin() } else { PI }
        };
        let half_width =
            if threshold <= of.density(of.mu + PI) { PI } else { width((peak / threshold).ln() / of.kappa) };
        let reach = half_width.min(if of.kappa > 0.0 { width(REACH / of.kappa) } else { PI });
        let mut truncated = Self { of, half_width, step: reach / PARTS as f64, sums: Vec::new() };
        let mut sum = 0.0;
        for part in 0..PARTS {
            let from = part as f64 * truncated.step;
            sum += truncated.between(from, from + truncated.step);
            truncated.sums.push(sum);
        }
        Some(truncated)
    }

    /// How far angles go from μ, radians: 0 to π.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The share of all angles that is left, above 0 unless the threshold is the peak.
    #[must_use]
    pub fn share(&self) -> f64 {
        2.0 * self.total() * self.of.peak()
    }

    /// The angle that a share of those left lies below, 0 to 1, counted from μ less the half width; radians, above -π, at most
    /// π. With equally likely shares these are angles of the distribution.
    #[must_use]
    pub fn quantile(&self, share: f64) -> f64 {
        let from_middle = 2.0 * share.clamp(0.0, 1.0) - 1.0;
        let wanted = from_middle.abs() * self.total();
        let part = self.sums.partition_point(|&sum| sum < wanted).min(PARTS - 1);
        let before = part.checked_sub(1).map_or(0.0, |part| self.sums[part]);
        let from = part as f64 * self.step;
        let (mut low, mut high) = (from, from + self.step);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if before + self.between(from, middle) < wanted { low = middle } else { high = middle }
        }
        wrapped(self.of.mu + f64::midpoint(low, high).copysign(from_middle))
    }

    /// The share of those left that is below an angle, radians, less than a turn away from μ; what
    /// [`quantile`](Self::quantile) takes back.
    #[must_use]
    pub fn share_below(&self, angle_rad: f64) -> f64 {
        let apart = angle_rad - self.of.mu;
        let far = apart.abs().min(self.half_width).min(self.step * PARTS as f64);
        let part = ((far / self.step) as usize).min(PARTS - 1);
        let before = part.checked_sub(1).map_or(0.0, |part| self.sums[part]);
        let reached = before + self.between(part as f64 * self.step, far);
        // Where only μ is left, all of it is on one side.
        let of_half = if self.total() > 0.0 { (reached / self.total()).min(1.0) } else { 1.0 };
        f64::midpoint(1.0, of_half.copysign(apart))
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or_default()
    }

    /// The integral of the density over its peak, between two angles from μ.
    fn between(&self, low: f64, high: f64) -> f64 {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        let at = |angle: f64| (-self.of.kappa * lack(angle)).exp();
        GAUSS.iter().map(|(place, weight)| weight * at(middle + half * place)).sum::<f64>() * (high - low)
    }
}
