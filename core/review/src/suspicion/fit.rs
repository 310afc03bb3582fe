//! Fitting the weights: logistic regression by Newton's method.

use super::{N_PARTS, Weight, log_odds, logistic, transformed};
use crate::evidence::Parts;

/// Terms of the model: the base, and for every part its slope and its constant.
const N_TERMS: usize = 1 + 2 * N_PARTS;
/// Keeps a term that no sample speaks of at 0, and the system solvable.
const RIDGE: f64 = 1e-3;
const N_STEPS: usize = 30;

/// The weights of parts that make the given samples likeliest: their evidence, and whether they were bad.
#[must_use]
pub fn parts(samples: &[(Parts, bool)]) -> (f64, [Weight; N_PARTS]) {
    let beta: [f64; N_TERMS] = likeliest(samples.iter().map(|(parts, is_bad)| (terms(parts), *is_bad)));
    let mut base = beta[0];
    let weight = |k: usize| {
        let good = samples.iter().filter(|(_, is_bad)| !is_bad);
        let measured: Vec<f64> = good.filter_map(|(parts, _)| transformed(parts)[k]).collect();
        let (slope, mut missing) = (beta[1 + 2 * k], beta[2 + 2 * k]);
        if measured.is_empty() {
            // What is never measured says nothing of any sample: its constant belongs to all.
            base += std::mem::take(&mut missing);
        }
        Weight { slope, missing, ordinary: below(measured) }
    };
    let weights = std::array::from_fn(weight);
    (base, weights)
}

/// What four of five values are below; 0 where there is none.
fn below(mut values: Vec<f64>) -> f64 {
    let at = values.len() * 4 / 5;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(at, f64::total_cmp).1 }
}

/// What turns the suspicion of a track's worst sample into that of the track ([`Weights::track`]); from the suspicions
/// of worst samples, and whether the tracks were bad.
///
/// [`Weights::track`]: super::Weights::track
#[must_use]
pub fn track(worst: &[(f64, bool)]) -> [f64; 2] {
    likeliest(worst.iter().map(|(p, is_bad)| ([1.0, log_odds(*p)], *is_bad)))
}

/// The coefficients of a logistic model that make the given cases likeliest.
fn likeliest<const N: usize>(cases: impl Iterator<Item = ([f64; N], bool)> + Clone) -> [f64; N] {
    let mut beta = [0.0; N];
    for _ in 0..N_STEPS {
        let mut gradient = beta.map(|b| -RIDGE * b);
        let mut curvature = [[0.0; N]; N];
        for (k, row) in curvature.iter_mut().enumerate() {
            row[k] = RIDGE;
        }
        for (x, is_bad) in cases.clone() {
            let p = logistic(x.iter().zip(&beta).map(|(x, b)| x * b).sum());
            for (k, row) in curvature.iter_mut().enumerate() {
                gradient[k] += x[k] * (f64::from(u8::from(is_bad)) - p);
                let weighted = x[k] * p * (1.0 - p);
                row.iter_mut().zip(&x).for_each(|(h, x)| *h += weighted * x);
            }
        }
        let step = solve(curvature, gradient);
        beta.iter_mut().zip(&step).for_each(|(b, step)| *b += step);
        if step.iter().all(|step| step.abs() < 1e-9) {
            break;
        }
    }
    beta
}

fn terms(parts: &Parts) -> [f64; N_TERMS] {
    let mut terms = [0.0; N_TERMS];
    terms[0] = 1.0;
    for (k, x) in transformed(parts).into_iter().enumerate() {
        match x {
            Some(x) => terms[1 + 2 * k] = x,
            None => terms[2 + 2 * k] = 1.0,
        }
    }
    terms
}

/// Solves a symmetric positive definite system: Cholesky, `A = L Lᵀ`.
fn solve<const N: usize>(mut a: [[f64; N]; N], b: [f64; N]) -> [f64; N] {
    for j in 0..N {
        for i in j..N {
            let dot: f64 = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            a[i][j] = if i == j { (a[i][i] - dot).sqrt() } else { (a[i][j] - dot) / a[j][j] };
        }
    }
    let mut x = b;
    for i in 0..N {
        let dot: f64 = (0..i).map(|k| a[i][k] * x[k]).sum();
        x[i] = (x[i] - dot) / a[i][i];
    }
    for i in (0..N).rev() {
        let dot: f64 = (i + 1..N).map(|k| a[k][i] * x[k]).sum();
        x[i] = (x[i] - dot) / a[i][i];
    }
    x
}
