//! Bi-orthogonal decomposition of tracks: what moves together, and how it moves.
//!
//! The positions of N tracks in T frames, less each track's mean, are a table Y of T rows and 2 N columns (x of all
//! tracks, then y). Y = U S V^T: each component k has a chronos, how it moves in time (a column of U), a topos, how
//! far each track goes with it in x and y (a column of V), and a singular value, how much of the motion it is
//! (Aubry, Guyonnet and Lima, J. Stat. Phys. 64, 1991). White noise alone has singular values up to an edge that follows
//! from their median ([`noise`]): components above it are motion.
//!
//! The decomposition is that of the smaller Gram matrix, Y Y^T or Y^T Y, in f64. Squaring loses singular values below
//! 1e-8 of the largest; positions in f32 have fewer digits than that, so nothing that could be motion is lost, and it takes
//! a tenth of the time of a decomposition of the table itself.

pub mod noise;
mod product;
mod table;
#[cfg(test)]
mod tests;
mod topos;
mod whiten;

use nalgebra::{DMatrix, SymmetricEigen};

pub use table::Table;
pub use topos::Axis;
pub use whiten::{Residual, residual, whitened};

use crate::{MotionError, Positions, pool};

/// Components that are kept, if there are so many, however little of them is motion.
const FEWEST_KEPT: usize = 15;
/// And when tracks are made of what is above the noise.
const FEWEST_DENOISED: usize = 4;

/// The components of tracks, the strongest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Bod {
    /// All singular values, pixels, falling: min(T, 2 N) of them; one that rounding alone could make is 0.
    pub singular: Vec<f64>,
    /// The largest that noise could make, pixels.
    pub edge: f64,
    n_tracks: usize,
    /// Unit vectors, T numbers a component.
    chronos: Vec<Vec<f64>>,
    /// Unit vectors, 2 N numbers a component: x of all tracks, then y.
    topos: Vec<Vec<f64>>,
}

impl Bod {
    /// Decomposes a table. Its components are those above the edge, and 15 at least where there are so many.
    #[must_use]
    pub fn new(table: &Table) -> Self {
        let (n_frames, n_series) = (table.n_frames(), 2 * table.n_tracks());
        let frames = product::transposed(table.series(), n_frames);
        let (rows, n_rows) =
            if n_frames <= n_series { (&*frames, n_frames) } else { (table.series(), n_series) };
        let eigen = SymmetricEigen::new(DMatrix::from_vec(n_rows, n_rows, product::gram(rows, n_rows)));
        let mut order: Vec<usize> = (0..n_rows).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let largest = eigen.eigenvalues[order[0]].max(0.0).sqrt();
        // Squares of what is smaller drown in the rounding of the largest square.
        let rounding = largest * (f64::EPSILON * n_rows as f64).sqrt();
        let value = |&k: &usize| Some(eigen.eigenvalues[k].max(0.0).sqrt()).filter(|s| *s > rounding);
        let singular: Vec<f64> = order.iter().map(|k| value(k).unwrap_or(0.0)).collect();
        // Positions have the digits of f32: what these leave is no motion either.
        let digits = table.rounding_px() * ((n_frames as f64).sqrt() + (n_series as f64).sqrt());
        let edge = noise::edge(&singular, n_frames, n_series).max(rounding).max(digits);
        let n_kept = count_above(&singular, edge).max(FEWEST_KEPT).min(count_above(&singular, 0.0));
        let vectors = order[..n_kept].iter().map(|&k| eigen.eigenvectors.column(k).iter().copied().collect());
        let mut chronos: Vec<Vec<f64>> = vectors.collect();
        if n_frames > n_series {
            chronos = product::combine(table.series(), n_series, &chronos);
            shrink(&mut chronos, &singular);
        }
        // From the table in any case: a track that stands still has a part in nothing, not even by rounding.
        let mut topos = product::combine(&frames, n_frames, &chronos);
        shrink(&mut topos, &singular);
        for (time, place) in chronos.iter_mut().zip(&mut topos) {
            // The sign is free: most goes right or down.
            if place.iter().sum::<f64>() < 0.0 {
                time.iter_mut().chain(place).for_each(|v| *v = -*v);
            }
        }
        Self { singular, edge, n_tracks: table.n_tracks(), chronos, topos }
    }

    /// Number of components that are kept.
    #[must_use]
    pub fn len(&self) -> usize {
        self.topos.len()
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.topos.is_empty()
    }

    /// Number of components above the edge of noise.
    #[must_use]
    pub fn n_above(&self) -> usize {
        count_above(&self.singular, self.edge)
    }

    /// How a component moves in time: a unit vector, a number a frame of the table.
    #[must_use]
    pub fn chronos(&self, component: usize) -> &[f64] {
        &self.chronos[component]
    }

    /// How far each track goes with a component, in x and in y: together a unit vector.
    #[must_use]
    pub fn topos(&self, component: usize) -> [&[f64]; 2] {
        let (x, y) = self.topos[component].split_at(self.n_tracks);
        [x, y]
    }

    /// How much of a component is motion and not noise, 0 to 1: 1 - (edge / S)^2.
    #[must_use]
    pub fn share(&self, component: usize) -> f64 {
        (1.0 - (self.edge / self.singular[component]).powi(2)).max(0.0)
    }

    /// Number of components that tracks are made of once noise is taken off: those above the edge, 4 at least.
    #[must_use]
    pub fn n_denoised(&self) -> usize {
        self.n_above().max(FEWEST_DENOISED).min(self.len())
    }

    /// The sum of the first components, each times a factor: a table of 2 N series of T numbers.
    pub(crate) fn sum(&self, n: usize, factor: impl Fn(usize) -> f64) -> Vec<f64> {
        let weights: Vec<f64> = (0..n).map(|k| factor(k) * self.singular[k]).collect();
        product::sum(&self.topos[..n], &self.chronos[..n], &weights)
    }
}

fn shrink(vectors: &mut [Vec<f64>], singular: &[f64]) {
    for (vector, s) in vectors.iter_mut().zip(singular) {
        vector.iter_mut().for_each(|v| *v /= s);
    }
}

fn count_above(singular: &[f64], edge: f64) -> usize {
    singular.iter().take_while(|s| **s > edge).count()
}

/// Positions of which noise is taken off: the mean of each track and its components above the edge, 4 at least, where
/// it was seen; a gap stays a gap. Also how many components. `n_threads` as everywhere: 0 for those there are.
///
/// # Errors
/// [`MotionError`], as [`Table::new`].
pub fn denoised(
    positions: &Positions,
    n_threads: usize,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<(Positions, usize), MotionError> {
    pool::within(n_threads, keep_going, |keep_going| {
        let table = Table::new(positions, keep_going)?;
        let bod = Bod::new(&table);
        let n = bod.n_denoised();
        Ok((table.positions(&bod.sum(n, |_| 1.0), positions), n))
    })
}
