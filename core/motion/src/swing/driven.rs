//! What the wind drives: its spectrum about a resonance, by Whittle's likelihood.
//!
//! A r^-D / ((1 - r^2)^2 + (2 zeta r)^2) + B, r = f / f0; D is how steeply the wind falls with frequency, 5/3 in
//! turbulence. The likelihood's errors are those of a spectrum that was drawn (Whittle, Ark. Mat. 2, 1953), and its
//! curvature tells how far off the numbers are.

use nalgebra::{DMatrix, SMatrix};

use super::{Manner, Swing, Told};

/// Dampings to begin with.
const RATIOS: [f64; 3] = [0.01, 0.05, 0.15];
/// Steps of the search.
const STEPS: usize = 500;
/// Of fewer frequencies D would be a guess: it is 0.
const SLOPED: usize = 20;
/// Dampings that are one.
const DAMPED: std::ops::Range<f64> = 1e-5..1.0;

/// A resonance among rows of frequency and power.
pub(super) struct Fit {
    rows: Vec<(f64, f64)>,
    /// Logarithms of f0, zeta, B / A; and D.
    at: [f64; 4],
    /// Minus the logarithm of the likelihood.
    pub(super) misfit: f64,
}

impl Fit {
    pub(super) fn new(rows: &[(f64, f64)], hz: f64) -> Self {
        let fit = |ratio: f64| {
            let start = [hz.ln(), ratio.ln(), (1e-3 / (4.0 * ratio.powi(2))).ln(), 0.0];
            smallest(start, [0.02, 0.5, 1.0, 1.0], |at| misfit(rows, |f| resonance(rows.len(), at, f)))
        };
        let found = RATIOS.map(fit).into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let (misfit, at) = found.unwrap_or((f64::MAX, [hz.ln(), 0.0, 0.0, 0.0]));
        Self { rows: rows.to_vec(), at, misfit }
    }

    /// What was found, where it is a swing among the rows.
    pub(super) fn swing(&self) -> Option<Swing> {
        let [hz, ratio, ..] = self.at.map(f64::exp);
        let is_within = (self.rows[0].0..=self.rows[self.rows.len() - 1].0).contains(&hz);
        let [of_hz, of_ratio] = self.errors()?;
        (is_within && DAMPED.contains(&ratio)).then_some(Swing {
            manner: Manner::Driven,
            hz: Told { value: hz, error: hz * of_hz },
            ratio: Told { value: ratio, error: ratio * of_ratio },
            n_cycles: 0.0,
            first: 0,
        })
    }

    /// Standard errors of the logarithms of frequency and damping: the inverse of Fisher's information, which is the sum
    /// over frequencies of products of the logarithmic spectrum's slopes.
    fn errors(&self) -> Option<[f64; 2]> {
        const STEP: f64 = 1e-5;
        let mut information = SMatrix::<f64, 5, 5>::zeros();
        for (f, _) in &self.rows {
            let slope = |k: usize| {
                let shape = |by: f64| {
                    let mut at = self.at;
                    at[k] += by;
                    resonance(self.rows.len(), at, *f).ln()
                };
                (shape(STEP) - shape(-STEP)) / (2.0 * STEP)
            };
            let slopes = SMatrix::<f64, 5, 1>::from([slope(0), slope(1), slope(2), slope(3), 1.0]);
            information += slopes * slopes.transpose();
        }
        // A number on which nothing depends, as the noise below all else, is not sought.
        let sought: Vec<usize> = (0..5).filter(|k| information[(*k, *k)] > 1e-9).collect();
        if !sought.starts_with(&[0, 1]) {
            return None;
        }
        let information =
            DMatrix::from_fn(sought.len(), sought.len(), |i, j| information[(sought[i], sought[j])]);
        let covariance = information.try_inverse()?;
        let errors = [0, 1].map(|k| covariance[(k, k)].sqrt());
        errors.iter().all(|error| error.is_finite()).then_some(errors)
    }
}

/// The misfit of power that only falls with frequency, or rises.
pub(super) fn noise(rows: &[(f64, f64)]) -> f64 {
    smallest([0.0], [1.0], |[slope]| misfit(rows, |f| f.powf(-slope))).0
}

/// The spectrum over A at a frequency.
fn resonance(n_rows: usize, at: [f64; 4], f: f64) -> f64 {
    let slope = if n_rows < SLOPED { 0.0 } else { at[3] };
    let [hz, ratio, floor, _] = at.map(f64::exp);
    let r = f / hz;
    r.powf(-slope) / ((1.0 - r * r).powi(2) + (2.0 * ratio * r).powi(2)) + floor
}

/// Minus the logarithm of the likelihood of rows, with the best A.
fn misfit(rows: &[(f64, f64)], shape: impl Fn(f64) -> f64) -> f64 {
    let (mut scale, mut sum) = (0.0, 0.0);
    for (f, power) in rows {
        let shape = shape(*f);
        scale += power / shape;
        sum += shape.ln();
    }
    let n = rows.len() as f64;
    let cost = n * (scale / n).max(f64::MIN_POSITIVE).ln() + sum;
    if cost.is_finite() { cost } else { f64::MAX }
}

/// Where a function of some numbers is smallest, and how small (Nelder and Mead, Comput. J. 7, 1965).
fn smallest<const N: usize>(
    start: [f64; N],
    away: [f64; N],
    of: impl Fn([f64; N]) -> f64,
) -> (f64, [f64; N]) {
    let valued = |at: [f64; N]| (of(at), at);
    let mut corners: Vec<(f64, [f64; N])> = vec![valued(start)];
    for (axis, away) in away.into_iter().enumerate() {
        let mut at = start;
        at[axis] += away;
        corners.push(valued(at));
    }
    for _ in 0..STEPS {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        if corners[N].0 - corners[0].0 < 1e-9 {
            break;
        }
        let centre: [f64; N] =
            std::array::from_fn(|k| corners[..N].iter().map(|corner| corner.1[k]).sum::<f64>() / N as f64);
        let worst = corners[N];
        let towards =
            |share: f64| valued(std::array::from_fn(|k| centre[k] + share * (worst.1[k] - centre[k])));
        let mirrored = towards(-1.0);
        let next = if mirrored.0 < corners[0].0 {
            let farther = towards(-2.0);
            if farther.0 < mirrored.0 { farther } else { mirrored }
        } else if mirrored.0 < corners[N - 1].0 {
            mirrored
        } else {
            towards(if mirrored.0 < worst.0 { -0.5 } else { 0.5 })
        };
        if next.0 < worst.0 {
            corners[N] = next;
        } else {
            let best = corners[0].1;
            for corner in &mut corners[1..] {
                *corner = valued(std::array::from_fn(|k| f64::midpoint(best[k], corner.1[k])));
            }
        }
    }
    let start = (f64::MAX, start);
    corners.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(start)
}
