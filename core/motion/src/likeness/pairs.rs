//! All pairs of tracks: distances of features, and of places. Each sum has one order, whatever the threads and vectors.

use std::ops::Range;

use rayon::prelude::*;

use crate::MotionError;
use crate::pool::blocks;

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

    /// With something else in place of each list.
    pub(super) fn each(mut self, of: impl Fn(&[f64]) -> Vec<f64> + Sync) -> Self {
        self.lists.par_iter_mut().for_each(|list| *list = of(list));
        self
    }

    fn is_still(&self, i: usize) -> bool {
        self.lists.iter().all(|list| list[i] == 0.0)
    }

    /// How alike tracks of this distance are, 0 to 1: |rho|, or the cosine of unit vectors.
    fn alike(&self, d: f64) -> f64 {
        (1.0 - if self.are_complex { d * d } else { 0.5 * d * d }).max(0.0)
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

/// Tracks whose features and places are compared.
pub(super) struct Pairs<'a> {
    features: &'a Features,
    /// Mean positions, pixels; `None` of one never seen.
    places: &'a [Option<[f64; 2]>],
    is_still: Vec<bool>,
    position_weight: f64,
}

/// What a distance of features, and one of places times their weight, is multiplied with.
#[derive(Clone, Copy)]
pub(super) struct Scales {
    feature: f64,
    place: f64,
}

impl<'a> Pairs<'a> {
    pub(super) fn new(features: &'a Features, places: &'a [Option<[f64; 2]>], position_weight: f64) -> Self {
        let is_still = (0..places.len()).map(|i| features.is_still(i)).collect();
        Self { features, places, is_still, position_weight }
    }

    fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether a track moves and has a place.
    pub(super) fn moves(&self, i: usize) -> bool {
        self.places[i].is_some() && !self.is_still[i]
    }

    fn between(&self, i: usize, j: usize) -> Option<f64> {
        let (a, b) = (self.places[i]?, self.places[j]?);
        let [x, y] = [a[0] - b[0], a[1] - b[1]];
        // Pixels: nothing that `hypot`, which is many times slower, would be needed for.
        Some((x * x + y * y).sqrt())
    }

    /// Distances of the features of some tracks to all from one on, a row a track.
    fn block(&self, tracks: Range<usize>, from: usize, out: &mut [f64]) {
        pulp::Arch::new().dispatch(Block { features: self.features, tracks: tracks.clone(), from, out });
        for (i, row) in tracks.zip(out.chunks_mut(self.len() - from)) {
            if !self.is_still[i] {
                continue;
            }
            row.iter_mut()
                .zip(&self.is_still[from..])
                .filter(|(_, still)| **still)
                .for_each(|(d, _)| *d = 0.0);
        }
    }

    /// Sums over the pairs of a track with all after it, of which the features are this far.
    fn moments(&self, i: usize, row: &[f64]) -> [Moments; 2] {
        let (mut feature, mut place) = (Moments::default(), Moments::default());
        for (d, j) in row.iter().zip(i + 1..) {
            if let Some(apart) = self.between(i, j) {
                feature.add(*d);
                place.add(apart);
            }
        }
        [feature, place]
    }

    fn scaled(&self, moments: &[[Moments; 2]]) -> Scales {
        let n_known = self.places.iter().flatten().count();
        let sum = |which: usize| moments.iter().fold(Moments::default(), |sum, row| sum.plus(row[which]));
        let [feature, place] = [0, 1].map(|which| sum(which).inverse_sd(n_known));
        Scales { feature, place: self.position_weight * place }
    }

    /// Distances of all pairs, condensed; pairs with a track that has no place are as far apart as any.
    pub(super) fn distances(&self, keep_going: &mut dyn FnMut(f64) -> bool) -> Result<Vec<f64>, MotionError> {
        let n = self.len();
        let mut condensed = crate::composite::zeros(n)?;
        let first = |i: usize, row: &mut [f64]| {
            if i + 1 < n {
                self.block(i..i + 1, i + 1, row);
            }
            self.moments(i, row)
        };
        let moments = each_row(&mut condensed, n, &first, &mut |done| keep_going(0.8 * done))?;
        let scales = self.scaled(&moments);
        let second = |i: usize, row: &mut [f64]| {
            let mut largest = 0.0_f64;
            for (d, j) in row.iter_mut().zip(i + 1..) {
                *d = self.between(i, j).map_or(APART, |apart| scales.feature * *d + scales.place * apart);
                largest = largest.max(*d);
            }
            largest
        };
        let largest = each_row(&mut condensed, n, &second, &mut |done| keep_going(0.8 + 0.2 * done))?;
        let largest = largest.into_iter().fold(0.0, f64::max);
        condensed.iter_mut().filter(|d| **d < 0.0).for_each(|d| *d = largest);
        Ok(condensed)
    }

    /// One over the standard deviations over all pairs, without a matrix of them.
    pub(super) fn scales(&self, keep_going: &mut dyn FnMut(f64) -> bool) -> Result<Scales, MotionError> {
        let n = self.len();
        let of = |tracks: Range<usize>| -> Vec<[Moments; 2]> {
            let from = tracks.start;
            let mut out = vec![0.0; tracks.len() * (n - from)];
            self.block(tracks.clone(), from, &mut out);
            let rows = tracks.zip(out.chunks(n - from));
            rows.map(|(i, row)| self.moments(i, &row[i + 1 - from..])).collect()
        };
        Ok(self.scaled(&blocks(n, &of, keep_going)?))
    }

    /// The nearest others of every track that moves, of those that do, the nearest first, of equal ones the first: their
    /// numbers and distances. Nothing of tracks at rest.
    pub(super) fn nearest(
        &self,
        n_nearest: usize,
        scales: Scales,
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Vec<Vec<(u32, f64)>>, MotionError> {
        let n = self.len();
        let of = |tracks: Range<usize>| -> Vec<Vec<(u32, f64)>> {
            let mut out = vec![0.0; tracks.len() * n];
            self.block(tracks.clone(), 0, &mut out);
            let rows = tracks.zip(out.chunks(n));
            rows.map(|(i, row)| self.nearest_of(i, row, n_nearest, scales)).collect()
        };
        blocks(n, &of, keep_going)
    }

    fn nearest_of(&self, i: usize, row: &[f64], n_nearest: usize, scales: Scales) -> Vec<(u32, f64)> {
        if !self.moves(i) || n_nearest == 0 {
            return Vec::new();
        }
        let far = |(j, d): (usize, &f64)| {
            let apart = self.between(i, j).filter(|_| j != i && !self.is_still[j])?;
            Some((j as u32, scales.feature * d + scales.place * apart))
        };
        let mut all: Vec<(u32, f64)> = row.iter().enumerate().filter_map(far).collect();
        let by = |a: &(u32, f64), b: &(u32, f64)| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0));
        if n_nearest < all.len() {
            all.select_nth_unstable_by(n_nearest - 1, by);
            all.truncate(n_nearest);
        }
        all.sort_unstable_by(by);
        // With no room left for those that were not taken.
        all.as_slice().to_vec()
    }

    /// Rows of how alike some tracks are to all, to a power, times how near they are: `r^sharpness exp(-(w_pos d / s)^2)`. One
    /// without a place is like itself alone.
    pub(super) fn affinities(&self, tracks: Range<usize>, sharpness: i32, scales: Scales) -> Vec<f64> {
        let n = self.len();
        let mut out = vec![0.0; tracks.len() * n];
        self.block(tracks.clone(), 0, &mut out);
        for (i, row) in tracks.zip(out.chunks_mut(n)) {
            for (j, d) in row.iter_mut().enumerate() {
                *d = match self.between(i, j) {
                    _ if i == j => 1.0,
                    Some(apart) => {
                        self.features.alike(*d).powi(sharpness) * (-(scales.place * apart).powi(2)).exp()
                    }
                    None => 0.0,
                };
            }
        }
        out
    }
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

/// Distances of the features of some tracks to all from one on.
struct Block<'a> {
    features: &'a Features,
    tracks: Range<usize>,
    from: usize,
    /// A row a track.
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { features, tracks, from, out } = self;
        let len = out.len() / tracks.len();
        for part in (0..len).step_by(PART) {
            for (i, row) in tracks.clone().zip(out.chunks_exact_mut(len)) {
                let out = &mut row[part..(part + PART).min(len)];
                if features.are_complex {
                    correlate(&features.lists, i, from + part, out);
                } else {
                    difference(&features.lists, i, from + part, out);
                }
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
