//! What tracks are like: their loadings on the components, or what can be made of these.

use rayon::prelude::*;

use super::pairs::Features;
use crate::bod::{Bod, Table};

/// Strongest components of the likeness that no rotation changes.
const TURNED_MOST: usize = 15;
/// Weights fall with the singular value to this power.
const FALL: f64 = 0.25;

/// How far tracks go with the first components, x and y of each: topoi, or means of them over neighbours.
pub(super) struct Topoi(Vec<[Vec<f64>; 2]>);

impl Topoi {
    /// Of the components that tracks are made of without noise, `most` at most.
    pub(super) fn new(bod: &Bod, most: usize) -> Self {
        let n = if bod.n_above() > 0 { bod.n_denoised().min(most) } else { 0 };
        Self((0..n).map(|k| bod.topos(k).map(<[f64]>::to_vec)).collect())
    }

    /// With something else in place of each list.
    pub(super) fn each(mut self, of: impl Fn(&[f64]) -> Vec<f64> + Sync) -> Self {
        self.0.par_iter_mut().flatten().for_each(|list| *list = of(list));
        self
    }

    /// Number of components.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

/// Weighted loadings of the first components that have any weight, a list for x and y of each.
fn weighted(bod: &Bod, topoi: &Topoi, most: usize, fall: f64) -> Vec<[Vec<f64>; 2]> {
    let of = |(k, topos): (usize, &[Vec<f64>; 2])| {
        let weight = bod.share(k).sqrt() * (bod.singular[k] / bod.singular[0]).powf(fall);
        topos.each_ref().map(|loadings| loadings.iter().map(|v| weight * v).collect())
    };
    topoi.0.iter().take(bod.n_above().min(most)).enumerate().map(of).collect()
}

/// See [`Likeness::Loadings`](super::Likeness).
pub(super) fn loadings(bod: &Bod, topoi: &Topoi) -> Features {
    let weighted = weighted(bod, topoi, topoi.len(), FALL);
    Features::apart(weighted.into_iter().flatten().collect()).unit()
}

/// See [`Likeness::Turned`](super::Likeness).
pub(super) fn turned(bod: &Bod, topoi: &Topoi) -> Features {
    let weighted = weighted(bod, topoi, TURNED_MOST, 0.0);
    let n = weighted.len();
    let n_tracks = weighted.first().map_or(0, |[x, _]| x.len());
    let traces: Vec<f64> =
        (0..n_tracks).map(|i| weighted.iter().map(|[x, y]| x[i].powi(2) + y[i].powi(2)).sum()).collect();
    let mut products = Vec::new();
    for k in 0..n {
        for l in k..n {
            // Those off the diagonal are there twice.
            let twice = if k == l { 1.0 } else { std::f64::consts::SQRT_2 };
            let ([kx, ky], [lx, ly]) = (&weighted[k], &weighted[l]);
            let product = |i: usize| match traces[i] {
                trace if trace > 0.0 => twice * (kx[i] * lx[i] + ky[i] * ly[i]) / trace,
                _ => 0.0,
            };
            products.push((0..n_tracks).map(product).collect());
        }
    }
    Features::apart(products)
}

/// Steps without their mean, as what they are of an orthonormal basis: as many complex numbers as components.
pub(super) fn steps(table: &Table, bod: &Bod, topoi: &Topoi) -> Features {
    let step = |k: usize| -> Vec<f64> {
        let steps = table.steps(bod.chronos(k));
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        steps.iter().map(|v| bod.singular[k] * (v - mean)).collect()
    };
    // Gram and Schmidt, twice over each: steps of components are nearly orthogonal already.
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut lists = Vec::new();
    let all: Vec<Vec<f64>> = (0..topoi.len()).map(step).collect();
    for steps in &all {
        let mut own = steps.clone();
        for _ in 0..2 {
            for other in &basis {
                let shared: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
                own.iter_mut().zip(other).for_each(|(a, b)| *a -= shared * b);
            }
        }
        let length = own.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length > 1e-9 * bod.singular[0] {
            basis.push(own.iter().map(|v| v / length).collect());
        }
    }
    for axis in &basis {
        let shares: Vec<f64> =
            all.iter().map(|steps| steps.iter().zip(axis).map(|(a, b)| a * b).sum()).collect();
        for side in 0..2 {
            let n_tracks = topoi.0[0][side].len();
            let at =
                |i: usize| shares.iter().zip(&topoi.0).map(|(share, topos)| share * topos[side][i]).sum();
            lists.push((0..n_tracks).map(at).collect());
        }
    }
    Features::correlated(lists).unit()
}
