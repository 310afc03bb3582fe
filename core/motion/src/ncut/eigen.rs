//! The vector that tells two halves of a graph apart.
//!
//! Ncut is least, once nodes may lie between the halves, for the second smallest of
//!
//! ```text
//! (D - W) y = lambda D y
//! ```
//!
//! (Shi and Malik, IEEE PAMI 22, 2000, eq. 11), W the weights and D the nodes' degrees. With z = D^(1/2) y it is the second
//! largest of D^(-1/2) W D^(-1/2), of which the largest, 1, belongs to D^(1/2) 1 where the graph is connected: that one is
//! kept out. Small graphs are solved whole, large ones by Lanczos's method with every vector made orthogonal to all before
//! it, which goes on from the best of them when there are many (thick restart: Wu and Simon, SIAM J. Matrix Anal. Appl. 22,
//! 2000).

use nalgebra::{DMatrix, SymmetricEigen};

use super::RESIDUAL;
use super::graph::Graph;
use crate::MotionError;

/// Graphs of so many nodes are solved whole.
const WHOLE: usize = 40;
/// Vectors that are held, how many of them stay when there are so many, and how many are made in all.
const HELD: usize = 64;
const KEPT: usize = 12;
const MOST: usize = 3000;
/// Vectors between two looks at how good the best is.
const LOOK: usize = 8;

/// The second smallest lambda, and its vector.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Second {
    /// From 0, where the graph nearly falls apart, to 2; no Ncut is less.
    pub(super) lambda: f64,
    /// y, a number a node.
    pub(super) y: Vec<f64>,
    /// |A z - theta z| of what was found: more than [`RESIDUAL`] only where 3,000 vectors did not suffice.
    pub(super) residual: f64,
}

/// Solves a connected graph of two nodes or more. `keep_going` is asked now and then; `false` stops.
pub(super) fn second(
    graph: &Graph,
    seed: u64,
    keep_going: &mut dyn FnMut() -> bool,
) -> Result<Second, MotionError> {
    let matrix = Normalised::new(graph);
    let (theta, z, residual) =
        if graph.len() <= WHOLE { whole(&matrix) } else { lanczos(&matrix, seed, keep_going)? };
    let y = z.iter().zip(&matrix.scale).map(|(z, scale)| z * scale).collect();
    Ok(Second { lambda: 1.0 - theta, y, residual })
}

/// A = D^(-1/2) W D^(-1/2).
struct Normalised<'a> {
    graph: &'a Graph,
    /// D^(-1/2).
    scale: Vec<f64>,
    /// D^(1/2) 1, of length 1.
    first: Vec<f64>,
}

impl<'a> Normalised<'a> {
    fn new(graph: &'a Graph) -> Self {
        let degrees = graph.degrees();
        let all = degrees.iter().sum::<f64>().sqrt();
        Self {
            graph,
            scale: degrees.iter().map(|d| d.sqrt().recip()).collect(),
            first: degrees.iter().map(|d| d.sqrt() / all).collect(),
        }
    }

    fn times(&self, z: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> = z.iter().zip(&self.scale).map(|(z, scale)| z * scale).collect();
        let mut out = vec![0.0; z.len()];
        self.graph.times(&scaled, &mut out);
        out.iter_mut().zip(&self.scale).for_each(|(out, scale)| *out *= scale);
        out
    }
}

fn whole(matrix: &Normalised<'_>) -> (f64, Vec<f64>, f64) {
    let n = matrix.first.len();
    let mut dense = DMatrix::zeros(n, n);
    for node in 0..n {
        for (other, weight) in matrix.graph.edges(node) {
            dense[(node, other)] = weight * matrix.scale[node] * matrix.scale[other];
        }
        for other in 0..n {
            // The largest goes from 1 to below all.
            dense[(node, other)] -= 3.0 * matrix.first[node] * matrix.first[other];
        }
    }
    let eigen = SymmetricEigen::new(dense);
    let largest = eigen.eigenvalues.imax();
    (eigen.eigenvalues[largest], eigen.eigenvectors.column(largest).iter().copied().collect(), 0.0)
}

fn lanczos(
    matrix: &Normalised<'_>,
    seed: u64,
    keep_going: &mut dyn FnMut() -> bool,
) -> Result<(f64, Vec<f64>, f64), MotionError> {
    let n = matrix.first.len();
    let mut basis: Vec<Vec<f64>> = vec![matrix.first.clone()];
    // A in terms of the basis without its first, below the diagonal.
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut next = by_chance(n, seed);
    make_orthogonal(&mut next, &basis);
    let mut length = dot(&next, &next).sqrt();
    let mut n_made = 0;
    loop {
        next.iter_mut().for_each(|v| *v /= length);
        let image = matrix.times(&next);
        basis.push(std::mem::replace(&mut next, image));
        rows.push(make_orthogonal(&mut next, &basis).split_off(1));
        length = dot(&next, &next).sqrt();
        n_made += 1;
        let is_done = n_made == MOST || basis.len() == n || length < RESIDUAL;
        let is_full = rows.len() == HELD;
        if !(is_done || is_full || rows.len().is_multiple_of(LOOK)) {
            continue;
        }
        if !keep_going() {
            return Err(MotionError::Stopped);
        }
        let best = largest(&rows);
        let residual = length * best[0].1[rows.len() - 1].abs();
        let sum = |shares: &[f64]| sum(shares, &basis[1..]);
        if is_done || residual <= RESIDUAL {
            return Ok((best[0].0, sum(&best[0].1), residual));
        }
        if is_full {
            let kept: Vec<Vec<f64>> = best[..KEPT].iter().map(|(_, shares)| sum(shares)).collect();
            basis.truncate(1);
            basis.extend(kept);
            let diagonal = |k: usize| (0..=k).map(|j| if j == k { best[k].0 } else { 0.0 }).collect();
            rows = (0..KEPT).map(diagonal).collect();
        }
    }
}

/// Takes off a vector what it has of unit vectors, twice, because the first time leaves rounding; returns how much it had.
fn make_orthogonal(vector: &mut [f64], basis: &[Vec<f64>]) -> Vec<f64> {
    let mut take_off = || {
        let of = |other: &Vec<f64>| {
            let shared = dot(vector, other);
            vector.iter_mut().zip(other).for_each(|(v, other)| *v -= shared * other);
            shared
        };
        basis.iter().map(of).collect()
    };
    let shares = take_off();
    take_off();
    shares
}

fn sum(shares: &[f64], vectors: &[Vec<f64>]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors[0].len()];
    for (share, vector) in shares.iter().zip(vectors) {
        sum.iter_mut().zip(vector).for_each(|(sum, v)| *sum += share * v);
    }
    sum
}

/// Eigenvalues of a symmetric matrix, of which the part below the diagonal is given, with their vectors; the largest first.
fn largest(rows: &[Vec<f64>]) -> Vec<(f64, Vec<f64>)> {
    let n = rows.len();
    let eigen = SymmetricEigen::new(DMatrix::from_fn(n, n, |i, j| rows[i.max(j)][i.min(j)]));
    let pair = |k: usize| (eigen.eigenvalues[k], eigen.eigenvectors.column(k).iter().copied().collect());
    let mut pairs: Vec<(f64, Vec<f64>)> = (0..n).map(pair).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Numbers between -1 and 1 (SplitMix64: Steele, Lea and Flood, OOPSLA 2014).
fn by_chance(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut number = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| number()).collect()
}
