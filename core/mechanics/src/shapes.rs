//! A motion as sums of few shapes, each frame as near as is wanted.
//!
//! Frames come one after another and are not kept. Of a frame that the shapes so far do not make, what they leave becomes
//! one more; in the end all are turned to the principal axes of what frames have of them, and those that no frame misses
//! are left out: the proper orthogonal decomposition (Sirovich, Q. Appl. Math. 45 (1987) 561) of a motion of any length,
//! with a bound for every node in every frame in place of one for their sum.

#[cfg(test)]
mod tests;

use crate::factor::WIDE;
use crate::modes::eigen;
use crate::simd::{accumulate, dot, products};
use crate::threads::Threads;
use nalgebra::{DMatrix, Vector3};

/// Frames are gathered so many times as near as they are wanted: the rest is for shapes that are left out.
const NEARER: f64 = 4.0;
/// Frames that are looked at before one more shape is kept.
const BATCH: usize = 64;

/// Numbers that are none, in a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("frame {frame} of a motion has displacements that are no numbers")]
pub struct ShapesError {
    frame: usize,
}

/// Shapes, while frames still come.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// Numbers of a frame: three a node.
    height: usize,
    /// Metres.
    near: f64,
    /// Columns of length 1, at right angles to each other.
    basis: Vec<f64>,
    /// What every frame has of those that there were when it came.
    shares: Vec<Vec<f32>>,
    /// How far its nodes are off by these, metres, at most.
    off: Vec<f64>,
}

/// A motion as sums of shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Displacements of all nodes, metres, at a weight of 1: the first has the greatest part in the motion.
    pub shapes: Vec<Vec<Vector3<f64>>>,
    /// What parts they have, by squares of displacements; 1 in all, but for shapes that were left out.
    pub parts: Vec<f64>,
    /// `(n_frames, n_shapes)`, the farthest of each shape 1.
    pub weights: Vec<f32>,
    /// How far nodes are off in any frame, metres, at most.
    pub off: f64,
}

impl Shapes {
    /// Of a motion of so many nodes, each of which is wanted as near as this, metres.
    #[must_use]
    pub fn new(n_nodes: usize, near: f64) -> Self {
        Self { height: 3 * n_nodes, near, basis: Vec::new(), shares: Vec::new(), off: Vec::new() }
    }

    /// How many there are so far: in the end there may be fewer.
    #[must_use]
    pub fn len(&self) -> usize {
        self.basis.len() / self.height
    }

    /// Whether nothing has moved so far.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.basis.is_empty()
    }

    /// Takes frames, of which each has the displacements of all nodes, metres; the same shapes on any number of threads.
    ///
    /// # Errors
    /// [`ShapesError`]; frames before that one have been taken.
    pub fn take(&mut self, frames: &[[f32; 3]], threads: &Threads) -> Result<(), ShapesError> {
        let frames: Vec<&[f32]> = frames.as_flattened().chunks_exact(self.height).collect();
        let mut found = vec![(Vec::new(), 0.0); frames.len()];
        let pairs = frames.chunks(WIDE).zip(found.chunks_mut(WIDE));
        threads.each(pairs, |(frames, found)| {
            let (left, shares) = self.left(frames);
            for (k, (found, left)) in found.iter_mut().zip(left.chunks(self.height)).enumerate() {
                *found = (shares.iter().map(|shares| shares[k] as f32).collect(), farthest(left));
            }
        });
        for (frame, (mut shares, mut off)) in frames.into_iter().zip(found) {
            if !off.is_finite() {
                return Err(ShapesError { frame: self.shares.len() });
            }
            if off * NEARER > self.near {
                (shares, off) = self.grow(frame);
            }
            self.shares.push(shares);
            self.off.push(off);
        }
        Ok(())
    }

    /// What shapes leave of two frames, or of one, and what these have of every shape.
    fn left(&self, frames: &[&[f32]]) -> (Vec<f64>, Vec<[f64; WIDE]>) {
        let mut wide = vec![0.0; WIDE * self.height];
        for (column, frame) in wide.chunks_mut(self.height).zip(frames) {
            column.iter_mut().zip(*frame).for_each(|(to, from)| *to = f64::from(*from));
        }
        let shares = products(self.height, &self.basis, &wide);
        let taken: Vec<[f64; WIDE]> = shares.iter().map(|shares| shares.map(|share| -share)).collect();
        accumulate(self.height, &self.basis, &taken, &mut wide);
        (wide, shares)
    }

    /// What a frame has of every shape, and how far it is then off: where that is too far, of one more.
    fn grow(&mut self, frame: &[f32]) -> (Vec<f32>, f64) {
        let (mut left, mut shares) = self.left(&[frame]);
        let mut off = farthest(&left[..self.height]);
        if off * NEARER > self.near {
            // Twice: what rounding has left of the others is small beside all of the frame, not beside the rest of it.
            let more = products(self.height, &self.basis, &left);
            let taken: Vec<[f64; WIDE]> = more.iter().map(|more| more.map(|more| -more)).collect();
            accumulate(self.height, &self.basis, &taken, &mut left);
            left.truncate(self.height);
            let length = dot(&left, &left).sqrt();
            self.basis.extend(left.iter().map(|v| v / length));
            shares.iter_mut().zip(more).for_each(|(share, more)| share[0] += more[0]);
            shares.push([length, 0.0]);
            off = 0.0;
        }
        (shares.iter().map(|share| share[0] as f32).collect(), off)
    }

    /// The fewest, of those that are principal, by which all frames are as near as is wanted.
    #[must_use]
    pub fn fewest(mut self, threads: &Threads) -> Sums {
        let squares = self.turn_to_axes();
        let all = squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let (n_shapes, off) = self.kept(threads);
        let mut weights: Vec<f32> =
            self.shares.iter().flat_map(|shares| shares[..n_shapes].iter().copied()).collect();
        let mut shapes = Vec::with_capacity(n_shapes);
        for (k, shape) in self.basis.chunks(self.height).take(n_shapes).enumerate() {
            let of_shape = || weights.iter().skip(k).step_by(n_shapes);
            let far =
                of_shape().copied().fold(0.0, |most: f32, w| if w.abs() > most.abs() { w } else { most });
            let moved = shape.as_chunks::<3>().0.iter();
            shapes.push(moved.map(|moved| Vector3::from(*moved) * f64::from(far)).collect());
            weights.iter_mut().skip(k).step_by(n_shapes).for_each(|w| *w /= far);
        }
        let parts = squares[..n_shapes].iter().map(|square| square / all).collect();
        Sums { shapes, parts, weights, off }
    }

    /// Turns shapes to the principal axes of what frames have of them; the sum of squares of each.
    fn turn_to_axes(&mut self) -> Vec<f64> {
        let n = self.len();
        if n == 0 {
            return Vec::new();
        }
        let mut squares = DMatrix::zeros(n, n);
        for shares in &mut self.shares {
            shares.resize(n, 0.0);
            for (column, b) in shares.iter().enumerate() {
                for (row, a) in shares.iter().enumerate() {
                    squares[(row, column)] += f64::from(*a) * f64::from(*b);
                }
            }
        }
        // As they came they make all frames, too.
        let Ok(found) = eigen(squares.clone()) else { return squares.diagonal().as_slice().to_vec() };
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| found.eigenvalues[*b].total_cmp(&found.eigenvalues[*a]));
        let axes = found.eigenvectors.select_columns(&order);
        let mut turned = vec![0.0; n.next_multiple_of(WIDE) * self.height];
        for (pair, columns) in (0..).step_by(WIDE).zip(turned.chunks_mut(WIDE * self.height)) {
            let share = |row: usize, column: usize| axes.get((row, column)).copied().unwrap_or(0.0);
            let shares: Vec<[f64; WIDE]> =
                (0..n).map(|row| std::array::from_fn(|k| share(row, pair + k))).collect();
            accumulate(self.height, &self.basis, &shares, columns);
        }
        turned.truncate(n * self.height);
        self.basis = turned;
        for shares in &mut self.shares {
            let of_axis = |axis: usize| {
                let shares = shares.iter().zip(axes.column(axis));
                shares.map(|(share, along)| f64::from(*share) * along).sum::<f64>() as f32
            };
            *shares = (0..n).map(of_axis).collect();
        }
        order.iter().map(|k| found.eigenvalues[*k].max(0.0)).collect()
    }

    /// How many of the first shapes are wanted, and how far nodes are off by these.
    fn kept(&self, threads: &Threads) -> (usize, f64) {
        let n_batches = self.shares.len().div_ceil(BATCH);
        let (mut n_shapes, mut off, mut n_near) = (0, 0.0_f64, 0);
        // Round and round, until all are near with the same shapes.
        for batch in (0..n_batches).cycle() {
            let frames = batch * BATCH..self.shares.len().min((batch + 1) * BATCH);
            let mut far = self.without(frames.clone(), n_shapes, threads);
            while far > self.near && n_shapes < self.len() {
                (n_shapes, off, n_near) = (n_shapes + 1, 0.0, 0);
                far = self.without(frames.clone(), n_shapes, threads);
            }
            (off, n_near) = (off.max(far), n_near + 1);
            if n_near == n_batches {
                break;
            }
        }
        (n_shapes, off)
    }

    /// How far nodes are off in these frames, at most, without the shapes after so many.
    fn without(&self, frames: std::ops::Range<usize>, n_shapes: usize, threads: &Threads) -> f64 {
        let mut far = vec![0.0; frames.len()];
        let shares = self.shares[frames.clone()].chunks(WIDE).zip(self.off[frames].chunks(WIDE));
        threads.each(shares.zip(far.chunks_mut(WIDE)), |((shares, off), far)| {
            let mut wide = vec![0.0; WIDE * self.height];
            let share = |frame: usize, shape: usize| shares.get(frame).map_or(0.0, |s| f64::from(s[shape]));
            let lost: Vec<[f64; WIDE]> =
                (n_shapes..self.len()).map(|shape| [share(0, shape), share(1, shape)]).collect();
            accumulate(self.height, &self.basis[n_shapes * self.height..], &lost, &mut wide);
            for ((far, off), left) in far.iter_mut().zip(off).zip(wide.chunks(self.height)) {
                *far = off + farthest(left);
            }
        });
        far.into_iter().fold(0.0, f64::max)
    }
}

/// The longest of many displacements; no number where one has none.
fn farthest(numbers: &[f64]) -> f64 {
    let squares = numbers.as_chunks::<3>().0.iter().map(|[x, y, z]| x * x + y * y + z * z);
    squares.fold(0.0, |most: f64, square| if square > most || square.is_nan() { square } else { most }).sqrt()
}
