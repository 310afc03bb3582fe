//! Curves on which nodes follow a mode that by itself would stretch branches (thesis 6.4.2).
//!
//! The thesis's are parabolas of s = atan(b q) with a b of its own for every node (6.31 - 6.35; errata E45: the factor a
//! of the text is in the vectors); with one b a mode, powers of s are a product of matrices for all nodes at once. Curves
//! come near what one mode does ([`Turning`]); where several act, what they do together is missing.

#[cfg(test)]
mod tests;

use crate::modes::Modes;
use crate::turning::Turning;
use nalgebra::{DMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Amplitudes, to either side, that the curves are fitted at.
const SAMPLES: usize = 12;
/// Tolerance of b, relative.
const B_TOLERANCE: f64 = 1e-3;

/// How a node moves with the amplitude of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Form {
    /// By its share in the mode: branches grow longer.
    Linear,
    /// The thesis's: an arc tangent a node and a parabola of it.
    Node,
    /// One arc tangent a mode, and so many powers of it, 2 or 3.
    Mode(usize),
    /// By turns of segments, all modes together ([`Turning`]): lengths are exact.
    Turn,
}

/// A mode's curves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bending {
    form: Form,
    /// One a mode, or one a node; none where it is linear. Per unit of amplitude.
    b: Vec<f64>,
    /// Of every power, of every node of the beams: metres per power of s.
    powers: Vec<Vec<Vector3<f64>>>,
}

impl Bending {
    /// Fits a mode's curves up to an amplitude to either side.
    ///
    /// # Panics
    /// For [`Form::Turn`], which has no curves.
    #[must_use]
    pub fn new(modes: &Modes, turning: &Turning, mode: usize, q_max: f64, form: Form) -> Self {
        assert!(form != Form::Turn, "turns are no curves of a mode");
        let n = turning.n_nodes();
        if form == Form::Linear {
            let linear = (0..n).map(|node| modes.displacement(mode, node)).collect();
            return Self { form, b: Vec::new(), powers: vec![linear] };
        }
        let amplitudes = amplitudes(q_max);
        let exact: Vec<Vec<Vector3<f64>>> = amplitudes.iter().map(|q| turning.of_mode(mode, *q)).collect();
        // A row an amplitude.
        let of_nodes = |nodes: std::ops::Range<usize>| {
            DMatrix::from_fn(exact.len(), 3 * nodes.len(), |row, column| {
                exact[row][nodes.start + column / 3][column % 3]
            })
        };
        let (n_powers, groups) = match form {
            Form::Mode(n_powers) => (n_powers, std::iter::once(0..n).collect()),
            _ => (2, (0..n).map(|node| node..node + 1).collect::<Vec<_>>()),
        };
        let (mut b, mut powers) = (Vec::new(), vec![Vec::with_capacity(n); n_powers]);
        for nodes in groups {
            let wanted = of_nodes(nodes);
            let best = best_b(&amplitudes, &wanted, q_max, n_powers);
            let (fitted, _) = fit(&amplitudes, &wanted, best, n_powers);
            for (power, row) in powers.iter_mut().zip(fitted.row_iter()) {
                power.extend(
                    row.iter()
                        .copied()
                        .collect::<Vec<f64>>()
                        .as_chunks()
                        .0
                        .iter()
                        .map(|v: &[f64; 3]| Vector3::from(*v)),
                );
            }
            b.push(best);
        }
        Self { form, b, powers }
    }

    /// Displacement of a node of the beams at an amplitude.
    #[must_use]
    pub fn displacement(&self, node: usize, q: f64) -> Vector3<f64> {
        let s = self.argument(node, q);
        // Horner's.
        self.powers.iter().rev().fold(Vector3::zeros(), |sum, power| (sum + power[node]) * s)
    }

    /// s, of which the powers are taken.
    fn argument(&self, node: usize, q: f64) -> f64 {
        match self.form {
            Form::Linear => q,
            Form::Node => (self.b[node] * q).atan(),
            Form::Mode(_) | Form::Turn => (self.b[0] * q).atan(),
        }
    }

    /// b of the mode, where it has one.
    #[must_use]
    pub fn b(&self) -> Option<f64> {
        matches!(self.form, Form::Mode(_)).then(|| self.b[0])
    }

    /// Whether all nodes have the same argument: then they move by a product of matrices.
    pub(crate) fn is_product(&self) -> bool {
        self.form != Form::Node
    }

    /// Displacements of all nodes for each power of s.
    #[must_use]
    pub fn powers(&self) -> &[Vec<Vector3<f64>>] {
        &self.powers
    }
}

/// To either side, closer to one another about 0 than a fit needs, and not at 0, where all curves are.
fn amplitudes(q_max: f64) -> Vec<f64> {
    let steps = (1..=SAMPLES).map(|k| q_max * k as f64 / SAMPLES as f64);
    steps.flat_map(|q| [-q, q]).collect()
}

/// The b for which powers of atan(b q) come nearest: by golden section, in units of the largest amplitude.
fn best_b(amplitudes: &[f64], wanted: &DMatrix<f64>, q_max: f64, n_powers: usize) -> f64 {
    let error = |b: f64| fit(amplitudes, wanted, b / q_max, n_powers).1;
    // From almost linear to almost saturated; coarse first, for the error may have more than one valley.
    let grid: Vec<f64> = (0..=16).map(|k| 0.02 * 200.0_f64.powf(f64::from(k) / 16.0)).collect();
    let best =
        grid.iter().map(|b| error(*b)).enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k);
    let (mut low, mut high) = (grid[best.saturating_sub(1)], grid[(best + 1).min(grid.len() - 1)]);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |low: f64, high: f64| [high - golden * (high - low), low + golden * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let (mut error_a, mut error_b) = (error(a), error(b));
    while high - low > B_TOLERANCE * low {
        if error_a < error_b {
            (high, b, error_b) = (b, a, error_a);
            a = inner(low, high)[0];
            error_a = error(a);
        } else {
            (low, a, error_a) = (a, b, error_b);
            b = inner(low, high)[1];
            error_b = error(b);
        }
    }
    f64::midpoint(low, high) / q_max
}

/// Powers of s = atan(b q) that come nearest in least squares; a row a power; and the sum of squares that is left.
fn fit(amplitudes: &[f64], wanted: &DMatrix<f64>, b: f64, n_powers: usize) -> (DMatrix<f64>, f64) {
    let powers = DMatrix::from_fn(amplitudes.len(), n_powers, |row, power| {
        (b * amplitudes[row]).atan().powi(power as i32 + 1)
    });
    let qr = powers.clone().qr();
    let mut fitted = qr.q().tr_mul(wanted);
    if !qr.r().solve_upper_triangular_mut(&mut fitted) {
        return (DMatrix::zeros(n_powers, wanted.ncols()), f64::INFINITY);
    }
    let left = (wanted - &powers * &fitted).norm_squared();
    (fitted, left)
}
