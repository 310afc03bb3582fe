//! Tracks smoothed by their neighbours: what noise does to one it does not do to those around it.
//!
//! A branch has more tips than one, and what they share is what it does. So every track's loadings are replaced by the mean
//! of its own and of those of its k nearest, by the distance of loadings and places, with the weights exp(-(d / d_k)^2),
//! twice: the second time the nearest are those of smoothed tracks. Tracks at rest and those never seen stay as they are, and
//! are nobody's neighbours.

use super::features::{Topoi, loadings};
use super::pairs::{Features, Pairs};
use crate::MotionError;
use crate::bod::Bod;

/// How often.
const ROUNDS: usize = 2;
/// Neighbours are no more than one in so many of the tracks that move: of fewer each would be averaged with another branch.
const ONE_IN: usize = 12;

/// Each track with its neighbours, and weights that sum to 1.
pub(super) struct Neighbourhoods(Vec<Vec<(u32, f64)>>);

impl Neighbourhoods {
    /// Of each track's nearest, the nearest first.
    pub(super) fn new(nearest: Vec<Vec<(u32, f64)>>) -> Self {
        let weighed = |(track, others): (u32, Vec<(u32, f64)>)| {
            let farthest = others.last().map_or(0.0, |(_, d)| *d);
            // Where all are in the same place each counts the same.
            let weight = |d: f64| if farthest > 0.0 { (-(d / farthest).powi(2)).exp() } else { 1.0 };
            let mut all = vec![(track, 1.0)];
            all.extend(others.into_iter().map(|(other, d)| (other, weight(d))));
            let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
            all.iter_mut().for_each(|(_, weight)| *weight /= sum);
            all
        };
        Self((0..).zip(nearest).map(weighed).collect())
    }

    /// The mean of a number a track over each neighbourhood.
    pub(super) fn means(&self, list: &[f64]) -> Vec<f64> {
        self.0
            .iter()
            .map(|row| row.iter().map(|(track, weight)| weight * list[*track as usize]).sum())
            .collect()
    }
}

/// Loadings of tracks as features and as they are, both smoothed. `keep_going` is told the share of the work that is done.
pub(super) fn smoothed(
    bod: &Bod,
    mut topoi: Topoi,
    places: &[Option<[f64; 2]>],
    position_weight: f64,
    n_neighbours: usize,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<(Features, Topoi), MotionError> {
    let mut features = loadings(bod, &topoi);
    for round in 0..if n_neighbours > 0 { ROUNDS } else { 0 } {
        let mut told = |done: f64| keep_going((round as f64 + done) / ROUNDS as f64);
        let pairs = Pairs::new(&features, places, position_weight);
        let n_moving = (0..places.len()).filter(|track| pairs.moves(*track)).count();
        let scales = pairs.scales(&mut |done| told(0.4 * done))?;
        let n = n_neighbours.min(n_moving / ONE_IN);
        let near = Neighbourhoods::new(pairs.nearest(n, scales, &mut |done| told(0.4 + 0.6 * done))?);
        features = features.each(|list| near.means(list)).unit();
        topoi = topoi.each(|list| near.means(list));
    }
    Ok((features, topoi))
}
