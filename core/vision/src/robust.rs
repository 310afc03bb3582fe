//! Where most of the displacements of a region agree, and tracking by it.
//!
//! J. Diener's thesis, 2.5.2: displacements `x_i` of many places of a region are draws from the distribution of the
//! region's motion, some of them far off. With the Gaussian kernel `k_i = exp(-½ (x_i - x)ᵀ Σ⁻¹ (x_i - x))` (distances
//! are P. C. Mahalanobis's) mean shift (K. Fukunaga, L. D. Hostetler, IEEE Trans. Inf. Theory 21, 1975) climbs the
//! density of E. Parzen (Ann. Math. Stat. 33, 1962):
//!
//! - errata E5: its gradient is `(1/n) Σ k_i Σ⁻¹ (x_i - x) = f(x) Σ⁻¹ m(x)` with `m(x) = Σ k_i x_i / Σ k_i - x`; the
//!   step is `x ← x + m(x)`, so to the weighted mean. The printed sign descends.
//! - errata E6: with `w_i = k_i / Σ k_j` the new `Σ = Σ w_i (x_i - x)(x_i - x)ᵀ / (1 - Σ w_i²)`, centred on that mean;
//!   the first one is the centred covariance of all samples. Printed without centring.
//! - errata E7: repeated, `Σ` shrinks as `Σ_data / (k + 1)` and the mode becomes whichever sample is nearest. The noise of
//!   a measurement, `floor_px²`, is therefore added to each `Σ`, which ends near the geometric mean of both, and a step
//!   that fewer than `min_effective` samples would decide, `1 / Σ w_i²`, is not taken.

mod region;
#[cfg(test)]
mod tests;

pub use region::{Moved, Region, State, follow};

/// How the mode is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Standard deviation of the noise of one displacement, pixels; 0 lets the covariance collapse (errata E7).
    pub floor_px: f64,
    /// So many samples must decide, at least 2: fewer have no mode, and the search ends before a step of fewer.
    pub min_effective: f64,
    /// A step shorter than this, and that changes the spread by less, ends the search, pixels.
    pub epsilon_px: f64,
    /// Steps at most.
    pub max_iterations: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self { floor_px: 0.4, min_effective: 3.0, epsilon_px: 1e-3, max_iterations: 50 }
    }
}

impl Params {
    /// So many samples must decide: a single one has no covariance.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.min_effective.max(2.0)
    }
}

/// A symmetric 2x2 matrix `[xx, xy, yy]`, pixels².
pub type Covariance = [f64; 3];

/// What a region's samples agree on, or one step on the way there.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Where the density is largest, pixels.
    pub at: [f64; 2],
    /// Of the samples there, weighted by the kernel, floor included.
    pub covariance: Covariance,
    /// How many samples decided, `1 / Σ w²`, 1 to their number.
    pub effective: f64,
    /// Share of each sample in `at`; they sum to 1.
    pub weights: Vec<f64>,
}

/// Why samples have no mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degenerate {
    /// There are none.
    Empty,
    /// There are fewer than must decide: [`Params::least`].
    Few,
    /// All are the same, and the floor is 0.
    Equal,
    /// All lie on a line, and the floor is 0.
    Collinear,
    /// A number is not finite, or too large for its square to be.
    NotFinite,
}

impl std::fmt::Display for Degenerate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Empty => "there are no samples",
            Self::Few => "there are fewer samples than must decide",
            Self::Equal => "all samples are equal: give a floor above 0",
            Self::Collinear => "all samples lie on a line: give a floor above 0",
            Self::NotFinite => "samples must be finite",
        })
    }
}

impl std::error::Error for Degenerate {}

/// The mode of the density of displacements, from their mean on.
///
/// # Errors
/// [`Degenerate`] for samples without a metric of their own.
pub fn mode(samples: &[[f64; 2]], params: &Params) -> Result<Mode, Degenerate> {
    let mut now = start(samples, params.floor_px)?;
    if now.effective < params.least() {
        return Err(Degenerate::Few);
    }
    for _ in 0..params.max_iterations {
        let Some(next) = step(samples, &now, params.floor_px) else { break };
        if next.effective < params.least() {
            break;
        }
        let moved = (next.at[0] - now.at[0]).hypot(next.at[1] - now.at[1]);
        let narrowed = (spread_px(now.covariance) - spread_px(next.covariance)).abs();
        now = next;
        if moved.max(narrowed) < params.epsilon_px {
            break;
        }
    }
    Ok(now)
}

/// Mean and covariance of all samples, which weigh the same.
///
/// # Errors
/// As [`mode`].
pub fn start(samples: &[[f64; 2]], floor_px: f64) -> Result<Mode, Degenerate> {
    let n = samples.len() as f64;
    match samples {
        [] => return Err(Degenerate::Empty),
        [_] => return Err(Degenerate::Few),
        [first, ..] if floor_px <= 0.0 && samples.iter().all(|x| is_same(x, first)) => {
            return Err(Degenerate::Equal);
        }
        _ => {}
    }
    let weights = vec![1.0 / n; samples.len()];
    let (at, covariance) = moments(samples, &weights, floor_px);
    let [xx, xy, yy] = covariance;
    if !(xx * yy).is_finite() || !at.iter().all(|c| c.is_finite()) {
        return Err(Degenerate::NotFinite);
    }
    // Rounding may leave a line as wide as this.
    if xx * yy - xy * xy <= f64::EPSILON * n * (xx + yy).powi(2) {
        return Err(Degenerate::Collinear);
    }
    Ok(Mode { at, covariance, effective: n, weights })
}

/// One step: weights in the present metric, then their mean and covariance. `None` where the metric has collapsed
/// onto a single sample.
#[must_use]
pub fn step(samples: &[[f64; 2]], now: &Mode, floor_px: f64) -> Option<Mode> {
    let metric = inverse(now.covariance)?;
    let mut weights: Vec<f64> = samples.iter().map(|x| mahalanobis2(metric, minus(*x, now.at))).collect();
    // Only ratios of weights count: with the nearest sample at 1 they cannot all vanish.
    let nearest = weights.iter().copied().fold(f64::INFINITY, f64::min);
    weights.iter_mut().for_each(|d2| *d2 = (-0.5 * (*d2 - nearest)).exp());
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    if effective <= 1.0 + SINGLE {
        return None;
    }
    let (at, covariance) = moments(samples, &weights, floor_px);
    Some(Mode { at, covariance, effective, weights })
}

/// So close to one sample the unbiased covariance divides by nothing but rounding.
const SINGLE: f64 = 1e-9;

/// Weighted mean and unbiased covariance (errata E6); the weights sum to 1.
fn moments(samples: &[[f64; 2]], weights: &[f64], floor_px: f64) -> ([f64; 2], Covariance) {
    let weighted = || samples.iter().zip(weights);
    let at = [0, 1].map(|axis| weighted().map(|(x, w)| w * x[axis]).sum::<f64>());
    let mut covariance = [0.0; 3];
    for (x, w) in weighted() {
        let [dx, dy] = minus(*x, at);
        covariance[0] += w * dx * dx;
        covariance[1] += w * dx * dy;
        covariance[2] += w * dy * dy;
    }
    let rest = 1.0 - weights.iter().map(|w| w * w).sum::<f64>();
    let [xx, xy, yy] = covariance.map(|c| c / rest);
    let noise = floor_px * floor_px;
    (at, [xx + noise, xy, yy + noise])
}

/// Bit by bit; numbers that differ in their last bit have a spread.
fn is_same(a: &[f64; 2], b: &[f64; 2]) -> bool {
    (0..2).all(|axis| a[axis].total_cmp(&b[axis]).is_eq())
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn inverse([xx, xy, yy]: Covariance) -> Option<Covariance> {
    let determinant = xx * yy - xy * xy;
    let inverse = [yy / determinant, -xy / determinant, xx / determinant];
    (determinant > 0.0 && inverse.iter().all(|c| c.is_finite())).then_some(inverse)
}

/// `dᵀ A d`.
fn mahalanobis2([xx, xy, yy]: Covariance, [dx, dy]: [f64; 2]) -> f64 {
    xx * dx * dx + 2.0 * xy * dx * dy + yy * dy * dy
}

/// Radius of the circle with the area of the ellipse of one standard deviation, pixels.
#[must_use]
pub fn spread_px([xx, xy, yy]: Covariance) -> f64 {
    (xx * yy - xy * xy).max(0.0).sqrt().sqrt()
}
