//! All pairs of tracks: distances of features, and of places. Each sum has one order, whatever the threads and vectors.

use rayon::prelude::*;

use crate::MotionError;

/// Tracks that one is compared with at a time: their sums stay in the nearest cache.
const PART: usize = 512;
/// Rows of the matrix between two calls for progress.
const BATCH: usize = 256;
/// Marks a pair without a distance until the largest one is known.
const APART: f64 = -1.0;

/// Numbers of every track, a list a number.
pub(super) struct Features {
    lists: Vec<Vec<f64>>,
    /// Pairs of lists are complex numbers, and tracks are correlated; else their difference counts.
    are_complex: bool,
}

impl Features {
    pub(super) fn apart(lists: Vec<Vec<f64>>) -> Self {
        Self { lists, are_complex: false }
    }

    pub(super) fn correlated(lists: Vec<Vec<f64>>) -> Self {
        Self { lists, are_complex: true }
    }

    /// Each track's numbers scaled to a sum of squares of 1; zeros stay.
    pub(super) fn unit(mut self) -> Self {
        for i in 0..self.lists.first().map_or(0, Vec::len) {
            let length = self.lists.iter().map(|list| list[i] * list[i]).sum::<f64>().sqrt();
            if length > 0.0 {
                self.lists.iter_mut().for_each(|list| list[i] /= length);
            }
        }
        self
    }

    fn is_still(&self, i: usize) -> bool {
        self.lists.iter().all(|list| list[i] == 0.0)
    }
}

/// Sums over pairs of a distance and of its square.
#[derive(Clone, Copy, Default)]
struct Moments {
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, d: f64) {
        self.sum += d;
        self.squares += d * d;
    }

    fn plus(self, other: Self) -> Self {
        Self { sum: self.sum + other.sum, squares: self.squares + other.squares }
    }

    /// One over the standard deviation over all n x n pairs, those of a track with itself among them; 0 where all are
    /// the same.
    fn inverse_sd(&self, n: usize) -> f64 {
        let all = (n * n) as f64;
        let (mean, square) = (2.0 * self.sum / all, 2.0 * self.squares / all);
        let variance = square - mean * mean;
        if variance > 1e-24 * square { variance.sqrt().recip() } else { 0.0 }
    }
}

/// Distances of all pairs, condensed; pairs with a track that has no place are as far apart as any.
pub(super) fn distances(
    features: &Features,
    places: &[Option<[f64; 2]>],
    position_weight: f64,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<f64>, MotionError> {
    let n = places.len();
    let mut condensed = crate::composite::zeros(n)?;
    let still: Vec<bool> = (0..n).map(|i| features.is_still(i)).collect();
    let between = |i: usize, j: usize| match (places[i], places[j]) {
        (Some(a), Some(b)) => Some((a[0] - b[0]).hypot(a[1] - b[1])),
        _ => None,
    };
    let first = |i: usize, row: &mut [f64]| {
        pulp::Arch::new().dispatch(Row { features, i, out: row });
        let (mut feature, mut place) = (Moments::default(), Moments::default());
        for (d, j) in row.iter_mut().zip(i + 1..) {
            if still[i] && still[j] {
                *d = 0.0;
            }
            if let Some(apart) = between(i, j) {
                feature.add(*d);
                place.add(apart);
            }
        }
        [feature, place]
    };
    let moments = each_row(&mut condensed, n, &first, &mut |done| keep_going(0.8 * done))?;
    let n_known = places.iter().flatten().count();
    let sum = |which: usize| moments.iter().fold(Moments::default(), |sum, row| sum.plus(row[which]));
    let [k_feature, k_place] = [0, 1].map(|which| sum(which).inverse_sd(n_known));
    let second = |i: usize, row: &mut [f64]| {
        let mut largest = 0.0_f64;
        for (d, j) in row.iter_mut().zip(i + 1..) {
            *d = between(i, j).map_or(APART, |apart| k_feature * *d + position_weight * k_place * apart);
            largest = largest.max(*d);
        }
        largest
    };
    let largest = each_row(&mut condensed, n, &second, &mut |done| keep_going(0.8 + 0.2 * done))?;
    let largest = largest.into_iter().fold(0.0, f64::max);
    condensed.iter_mut().filter(|d| **d < 0.0).for_each(|d| *d = largest);
    Ok(condensed)
}

/// Does something with every row of the condensed matrix, and returns what came of each, in order.
fn each_row<R: Send>(
    condensed: &mut [f64],
    n: usize,
    work: &(impl Fn(usize, &mut [f64]) -> R + Sync),
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<R>, MotionError> {
    let mut rows = Vec::with_capacity(n);
    let mut rest = condensed;
    for i in 0..n {
        let (row, after) = rest.split_at_mut(n - 1 - i);
        rows.push((i, row));
        rest = after;
    }
    let mut results = Vec::with_capacity(n);
    for batch in rows.chunks_mut(BATCH) {
        let done: Vec<R> = batch.par_iter_mut().map(|(i, row)| work(*i, row)).collect();
        results.extend(done);
        if !keep_going(results.len() as f64 / n as f64) {
            return Err(MotionError::Stopped);
        }
    }
    Ok(results)
}

/// Distances of the features of track i and all after it.
struct Row<'a> {
    features: &'a Features,
    i: usize,
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { features, i, out } = self;
        for (part, out) in out.chunks_mut(PART).enumerate() {
            let from = i + 1 + part * PART;
            if features.are_complex {
                correlate(&features.lists, i, from, out);
            } else {
                difference(&features.lists, i, from, out);
            }
        }
    }
}

#[inline(always)]
fn difference(lists: &[Vec<f64>], i: usize, from: usize, out: &mut [f64]) {
    for list in lists {
        let own = list[i];
        for (sum, other) in out.iter_mut().zip(&list[from..]) {
            *sum += (own - other) * (own - other);
        }
    }
    out.iter_mut().for_each(|sum| *sum = sum.sqrt());
}

/// sqrt(1 - |sum a conj(b)|) of unit vectors of complex numbers.
#[inline(always)]
fn correlate(lists: &[Vec<f64>], i: usize, from: usize, out: &mut [f64]) {
    let mut imaginary = [0.0; PART];
    for pair in lists.chunks_exact(2) {
        let [real, imag] = pair else { continue };
        let own = (real[i], imag[i]);
        let others = real[from..].iter().zip(&imag[from..]);
        for ((re, im), (x, y)) in out.iter_mut().zip(&mut imaginary).zip(others) {
            *re += own.0 * x + own.1 * y;
            *im += own.1 * x - own.0 * y;
        }
    }
    for (re, im) in out.iter_mut().zip(&imaginary) {
        *re = (1.0 - (*re * *re + im * im).sqrt()).max(0.0).sqrt();
    }
}
