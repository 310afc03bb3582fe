//! Multigrid: what is wrong with a solution, told by ever coarser grids.
//!
//! On every grid errors that a matrix feels are smoothed away (Chebyshev's polynomial in the matrix over its diagonal), and
//! the rest is found on the coarser grid, by two steps of conjugate gradients there, each begun by a cycle (the K-cycle of
//! Notay & Vassilevski 2008). The coarsest matrix is factorised.

#[cfg(test)]
mod tests;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::grid::Grid;
use crate::tiles::{KEPT, Share, Tiles};
use crate::work::{dot, each, made};

/// Nodes that are few enough for a dense matrix.
const FEW: usize = 64;
/// Times that a cycle multiplies with the matrix to smooth.
const DEGREE: usize = 2;
/// Smoothed is what the matrix feels more than this part of the most.
const FELT: f64 = 0.1;
/// Steps by which the most is found, and what may be missing then.
const POWER_STEPS: usize = 12;
const MARGIN: f64 = 1.1;
/// A step on the coarser grid that leaves less than this of the fault is enough.
const ENOUGH: f64 = 0.25;

/// A grid, the way to the coarser one, and room for vectors.
struct Level<const K: usize> {
    matrix: Grid<K>,
    /// One over the diagonal.
    inverse: Vec<[f64; K]>,
    /// The largest eigenvalue of the matrix over its diagonal, or a little more.
    most: f64,
    tiles: Tiles<K>,
    fault: Vec<[f64; K]>,
    step: Vec<[f64; K]>,
    /// What the coarser grid is asked, and what it answers.
    asked: Vec<[f64; KEPT]>,
    answer: Vec<[f64; KEPT]>,
}

/// A grid below the pixels, and room for conjugate gradients.
struct Below {
    level: Level<KEPT>,
    felt: Vec<[f64; KEPT]>,
    left: Vec<[f64; KEPT]>,
    second: Vec<[f64; KEPT]>,
    felt_again: Vec<[f64; KEPT]>,
}

/// All grids of a matrix.
pub(crate) struct Cycle {
    pixels: Level<1>,
    /// From fine to coarse.
    below: Vec<Below>,
    coarsest: Cholesky<f64, Dyn>,
}

impl Cycle {
    /// The grids of a matrix over pixels, with the vectors that it all but loses.
    pub(crate) fn new(matrix: Grid<1>, vectors: &[Share<1>]) -> Self {
        let (pixels, mut coarser, mut vectors) = Level::new(matrix, vectors);
        let mut below = Vec::new();
        while coarser.size.n_nodes() > FEW {
            let level;
            (level, coarser, vectors) = Level::new(coarser, &vectors);
            below.push(Below::new(level));
        }
        Self { pixels, below, coarsest: factor(&coarser.dense()) }
    }

    pub(crate) fn matrix(&self) -> &Grid<1> {
        &self.pixels.matrix
    }

    /// Nearly the solution for a right side.
    pub(crate) fn solve(&mut self, right: &[[f64; 1]], x: &mut [[f64; 1]]) {
        let (below, coarsest) = (&mut self.below, &self.coarsest);
        self.pixels.round(right, x, |right, x| solve_below(below, coarsest, right, x));
    }
}

/// Nearly the solution on the coarser grids that are left.
fn solve_below(
    levels: &mut [Below],
    coarsest: &Cholesky<f64, Dyn>,
    right: &[[f64; KEPT]],
    x: &mut [[f64; KEPT]],
) {
    if let Some((below, coarser)) = levels.split_first_mut() {
        below.two_steps(right, x, |right, x| solve_below(coarser, coarsest, right, x));
    } else {
        let solved = coarsest.solve(&DVector::from_column_slice(right.as_flattened()));
        x.as_flattened_mut().copy_from_slice(solved.as_slice());
    }
}

impl<const K: usize> Level<K> {
    /// A level, and what the coarser one is made of.
    fn new(matrix: Grid<K>, vectors: &[Share<K>]) -> (Self, Grid<KEPT>, Vec<Share<KEPT>>) {
        let inverse: Vec<[f64; K]> = matrix.diagonal().iter().map(|d| d.map(|d| 1.0 / d)).collect();
        let most = most(&matrix, &inverse);
        let (tiles, coarser_vectors) = Tiles::new(matrix.size, vectors);
        let coarser = tiles.coarser(&matrix);
        let [fault, step] = [0, 1].map(|_| vec![[0.0; K]; inverse.len()]);
        let [asked, answer] = [0, 1].map(|_| vec![[0.0; KEPT]; coarser.size.n_nodes()]);
        let level = Self { matrix, inverse, most, tiles, fault, step, asked, answer };
        (level, coarser, coarser_vectors)
    }

    /// Smooths from nought, lets the coarser grid find the rest, and smooths again.
    fn round(
        &mut self,
        right: &[[f64; K]],
        x: &mut [[f64; K]],
        coarser: impl FnOnce(&[[f64; KEPT]], &mut [[f64; KEPT]]),
    ) {
        x.fill([0.0; K]);
        self.fault.copy_from_slice(right);
        self.smooth(x, right);
        self.matrix.fault(x, right, &mut self.fault);
        self.tiles.gather(&self.fault, &mut self.asked);
        coarser(&self.asked, &mut self.answer);
        self.tiles.add_to(x, &self.answer);
        self.matrix.fault(x, right, &mut self.fault);
        self.smooth(x, right);
    }

    /// Chebyshev's iteration for eigenvalues from a part of the most to the most; the fault is that of `x`.
    fn smooth(&mut self, x: &mut [[f64; K]], right: &[[f64; K]]) {
        let [middle, half] = [1.0 + FELT, 1.0 - FELT].map(|of| of * self.most / 2.0);
        let (mut keep, mut take, mut ratio) = (0.0, 1.0 / middle, half / middle);
        for k in 0..DEGREE {
            if k > 0 {
                self.matrix.fault(x, right, &mut self.fault);
                let next = 1.0 / (2.0 * middle / half - ratio);
                (keep, take, ratio) = (next * ratio, 2.0 * next / half, next);
            }
            each(&mut self.step, &self.fault, &self.inverse, |step, fault, inverse| {
                *step = keep * *step + take * fault * inverse;
            });
            each(x, &self.step, &self.step, |x, step, _| *x += step);
        }
    }
}

impl Below {
    fn new(level: Level<KEPT>) -> Self {
        let [felt, left, second, felt_again] = [0, 1, 2, 3].map(|_| vec![[0.0; KEPT]; level.inverse.len()]);
        Self { level, felt, left, second, felt_again }
    }

    /// Two steps of conjugate gradients, each begun by a round; one, where it leaves little.
    fn two_steps(
        &mut self,
        right: &[[f64; KEPT]],
        x: &mut [[f64; KEPT]],
        mut coarser: impl FnMut(&[[f64; KEPT]], &mut [[f64; KEPT]]),
    ) {
        self.level.round(right, x, &mut coarser);
        let matrix = &self.level.matrix;
        matrix.times(x, &mut self.felt);
        let power = dot(x, &self.felt);
        if power <= 0.0 {
            return;
        }
        let along = dot(x, right) / power;
        each(&mut self.left, &self.felt, right, |left, felt, right| *left = right - along * felt);
        if dot(&self.left, &self.left) <= ENOUGH * ENOUGH * dot(right, right) {
            each(x, right, right, |x, _, _| *x *= along);
            return;
        }
        self.level.round(&self.left, &mut self.second, &mut coarser);
        self.level.matrix.times(&self.second, &mut self.felt_again);
        let shared = dot(&self.second, &self.felt) / power;
        // What the second step adds is the part of it that the first does not feel.
        let own = dot(&self.second, &self.felt_again) - shared * shared * power;
        let of_second = if own > 0.0 { dot(&self.second, &self.left) / own } else { 0.0 };
        let of_first = along - shared * of_second;
        each(x, &self.second, &self.second, |x, second, _| *x = of_first * *x + of_second * second);
    }
}

/// The largest eigenvalue of a matrix over its diagonal, or a little more, by powers of it.
fn most<const K: usize>(matrix: &Grid<K>, inverse: &[[f64; K]]) -> f64 {
    // Any vector will do that no eigenvector is likely to be free of: digits of the golden ratio.
    let digit = |k: usize| (k as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
    let mut x: Vec<[f64; K]> = made(inverse.len(), |node| std::array::from_fn(|k| digit(node * K + k + 1)));
    let mut next = x.clone();
    let mut most = 1.0;
    for _ in 0..POWER_STEPS {
        let length = dot(&x, &x).sqrt();
        matrix.times(&x, &mut next);
        each(&mut x, &next, inverse, |x, next, inverse| *x = next * inverse / length);
        most = dot(&x, &x).sqrt();
    }
    MARGIN * most
}

/// The factors of a small matrix. Where rounding has made it indefinite, its diagonal grows until it is not.
fn factor(matrix: &DMatrix<f64>) -> Cholesky<f64, Dyn> {
    let largest = matrix.diagonal().max();
    let mut more = 1e-14 * largest;
    loop {
        let mut lifted = matrix.clone();
        lifted.set_diagonal(&lifted.diagonal().add_scalar(more));
        if let Some(factors) = Cholesky::new(lifted) {
            return factors;
        }
        more *= 10.0;
    }
}
