//! How alike tracks are: the correlation of their steps, times how near they are.

use rayon::prelude::*;

use super::graph::Graph;
use crate::MotionError;
use crate::bod::Table;

/// Sums of a product that go on side by side.
const LANES: usize = 8;
/// Tracks that one is correlated with at a time: it is read once for all of them.
const ROWS: usize = 4;
/// Tracks that some are correlated with while they are in a thread's cache.
const TILE: usize = 64;

/// Steps of tracks, and where they are.
pub(super) struct Tracks {
    /// Per track the x of all steps, then y, each filled up with zeros to whole lanes: of length 1, or 0 of one at rest.
    steps: Vec<f64>,
    /// Lanes of x, and of y.
    n_chunks: usize,
    is_still: Vec<bool>,
    /// Mean positions over what is far: exp(-d^2 / 2) is how near two are. `None` of one never seen.
    places: Vec<Option<[f64; 2]>>,
}

impl Tracks {
    /// Of displacements laid out as the table's own. `position_weight` is w_pos.
    pub(super) fn new(table: &Table, displacements: &[f64], position_weight: f64) -> Self {
        let (n_tracks, n_frames) = (table.n_tracks(), table.n_frames());
        let n_steps = n_frames - table.runs().len();
        let n_chunks = n_steps.div_ceil(LANES);
        let len = n_chunks * LANES;
        let mut steps = vec![0.0; n_tracks * 2 * len];
        // A difference of two positions is off by the digits of both.
        let rounding = 2.0 * table.rounding_px();
        let least = rounding * rounding * 2.0 * n_frames as f64;
        let of = |(track, out): (usize, &mut [f64])| {
            for (axis, out) in out.chunks_mut(len).enumerate() {
                let row = &displacements[(axis * n_tracks + track) * n_frames..][..n_frames];
                let steps = table.steps(row);
                let mean = steps.iter().sum::<f64>() / n_steps as f64;
                out.iter_mut().zip(steps).for_each(|(out, step)| *out = step - mean);
            }
            let square: f64 = out.iter().map(|v| v * v).sum();
            let is_still = square <= least;
            let factor = if is_still { 0.0 } else { square.sqrt().recip() };
            out.iter_mut().for_each(|v| *v *= factor);
            is_still
        };
        let is_still = steps.par_chunks_mut(2 * len).enumerate().map(of).collect();
        Self { steps, n_chunks, is_still, places: scaled(table, position_weight) }
    }

    fn len(&self) -> usize {
        self.places.len()
    }

    fn row(&self, track: usize) -> [&[[f64; LANES]]; 2] {
        let both = self.steps.as_chunks().0;
        let (x, y) = both[2 * track * self.n_chunks..][..2 * self.n_chunks].split_at(self.n_chunks);
        [x, y]
    }

    /// The affinity of two tracks of which the steps have this correlation.
    fn affinity(&self, i: usize, j: usize, correlation: f64) -> f64 {
        let (Some(a), Some(b)) = (self.places[i], self.places[j]) else { return f64::from(i == j) };
        let alike = if self.is_still[i] && self.is_still[j] { 1.0 } else { correlation.min(1.0) };
        let far = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        if i == j { 1.0 } else { alike * (-0.5 * far).exp() }
    }

    /// Affinities of some tracks to all.
    fn affinities(&self, tracks: std::ops::Range<usize>) -> Vec<f64> {
        let n = self.len();
        let mut out = vec![0.0; tracks.len() * n];
        for first in (0..n).step_by(TILE) {
            let tile = first..(first + TILE).min(n);
            for (rows, out) in tracks.clone().step_by(ROWS).zip(out.chunks_mut(ROWS * n)) {
                // Beyond the last track the last is read again.
                let four = std::array::from_fn(|k| self.row((rows + k).min(n - 1)));
                for other in tile.clone() {
                    let found = pulp::Arch::new().dispatch(Correlations { four, other: self.row(other) });
                    for ((k, out), found) in out.chunks_mut(n).enumerate().zip(found) {
                        out[other] = self.affinity(rows + k, other, found);
                    }
                }
            }
        }
        out
    }

    /// The graph of the tracks, each joined to so many at the least ([`Graph::of_largest`]).
    pub(super) fn graph(
        &self,
        n_neighbours: usize,
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Graph, MotionError> {
        Graph::of_largest(self.len(), n_neighbours, &|tracks| self.affinities(tracks), keep_going)
    }
}

/// Mean positions in terms of s / w_pos, with s^2 the mean of squared distances over all pairs of tracks (a track with itself
/// among them), which is twice the mean square from their centre.
fn scaled(table: &Table, position_weight: f64) -> Vec<Option<[f64; 2]>> {
    let places: Vec<Option<[f64; 2]>> = (0..table.n_tracks()).map(|track| table.place(track)).collect();
    let n = places.iter().flatten().count() as f64;
    let centre = [0, 1].map(|axis| places.iter().flatten().map(|at| at[axis]).sum::<f64>() / n);
    let from = |at: &[f64; 2]| [at[0] - centre[0], at[1] - centre[1]];
    let square = |at: [f64; 2]| at[0] * at[0] + at[1] * at[1];
    let all = 2.0 * places.iter().flatten().map(|at| square(from(at))).sum::<f64>() / n;
    let factor = if all > 0.0 { position_weight / all.sqrt() } else { 0.0 };
    places.iter().map(|at| at.as_ref().map(|at| from(at).map(|v| factor * v))).collect()
}

/// The modulus of the correlation of four tracks with another (Zeng 2.20, 5.1; errata Z1): |sum v conj(w)| of steps, which
/// are complex numbers, and of length 1 together.
struct Correlations<'a> {
    four: [[&'a [[f64; LANES]]; 2]; ROWS],
    other: [&'a [[f64; LANES]]; 2],
}

impl pulp::NullaryFnOnce for Correlations<'_> {
    type Output = [f64; ROWS];

    #[inline(always)]
    fn call(self) -> [f64; ROWS] {
        let (mut real, mut imaginary) = ([[0.0; LANES]; ROWS], [[0.0; LANES]; ROWS]);
        let [other_x, other_y] = self.other;
        for (k, (other_x, other_y)) in other_x.iter().zip(other_y).enumerate() {
            for row in 0..ROWS {
                let [x, y] = self.four[row];
                let (x, y) = (&x[k], &y[k]);
                for lane in 0..LANES {
                    real[row][lane] += x[lane] * other_x[lane] + y[lane] * other_y[lane];
                    imaginary[row][lane] += y[lane] * other_x[lane] - x[lane] * other_y[lane];
                }
            }
        }
        std::array::from_fn(|row| {
            let (re, im) = (real[row].iter().sum::<f64>(), imaginary[row].iter().sum::<f64>());
            (re * re + im * im).sqrt()
        })
    }
}
