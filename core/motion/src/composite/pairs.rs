//! All pairs of tracks, sixteen by sixteen: the loops that take the time.
//!
//! The inner loops run over plain arrays of 16 numbers, which compile to whatever vectors the processor has
//! (chosen at run time). Every sum has one fixed order: the
//! bits depend neither on the vectors nor on the threads.

use std::marker::PhantomData;

use rayon::prelude::*;

use super::steps::{Block, Distance, LANES, Lanes, ZERO};
use crate::MotionError;

/// Rows of a block that are compared with another block at once: their sums fit in registers.
const ROWS: usize = 4;
/// Steps after which f32 sums move to f64: they keep their seven digits.
const RUN: usize = 64;
/// Blocks of rows between two calls for progress.
const BATCH: usize = 16;

/// Sums a distance over the steps for every pair of n tracks, and hands each pair's element and sum to `put`.
///
/// Returns the sum over all pairs for every step (zeros where the distance does not ask for it).
pub(super) fn add<D: Distance>(
    n_tracks: usize,
    blocks: &[Block],
    condensed: &mut [f64],
    put: impl Fn(&mut f64, usize, usize, f64) + Sync,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<f64>, MotionError> {
    let n_pairs = condensed.len() as f64;
    let mut rows = rows_by_block(condensed, n_tracks);
    let mut step_sums = vec![0.0; blocks.first().map_or(0, Vec::len)];
    let mut n_done = 0;
    for batch in rows.chunks_mut(BATCH) {
        let sum = |(block, rows): &mut (usize, &mut [f64])| {
            let (first, put, distance) = (*block, &put, PhantomData);
            let job = BlockRow::<D, _> { blocks, first, n_tracks, rows, put, distance };
            pulp::Arch::new().dispatch(job)
        };
        let sums: Vec<Vec<f64>> = batch.par_iter_mut().map(sum).collect();
        for sums in sums {
            step_sums.iter_mut().zip(sums).for_each(|(total, sum)| *total += sum);
        }
        n_done += batch.iter().map(|(_, rows)| rows.len()).sum::<usize>();
        if !keep_going(n_done as f64 / n_pairs) {
            return Err(MotionError::Stopped);
        }
    }
    Ok(step_sums)
}

/// Splits the condensed matrix where a new block of 16 rows starts.
pub(super) fn rows_by_block(mut condensed: &mut [f64], n_tracks: usize) -> Vec<(usize, &mut [f64])> {
    let mut rows = Vec::new();
    for block in 0..n_tracks.div_ceil(LANES) {
        let tracks = block * LANES..n_tracks.min((block + 1) * LANES);
        let len = tracks.map(|i| n_tracks - 1 - i).sum();
        let (these, rest) = condensed.split_at_mut(len);
        rows.push((block, these));
        condensed = rest;
    }
    rows
}

/// One block of rows against itself and all later blocks; returns the sums of each step.
///
/// A type and not a closure: a closure's body is not inlined into the function that has the vectors.
struct BlockRow<'a, D, P> {
    blocks: &'a [Block],
    first: usize,
    n_tracks: usize,
    rows: &'a mut [f64],
    put: &'a P,
    distance: PhantomData<D>,
}

impl<D: Distance, P: Fn(&mut f64, usize, usize, f64)> pulp::NullaryFnOnce for BlockRow<'_, D, P> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn call(self) -> Vec<f64> {
        let Self { blocks, first, n_tracks, rows, put, .. } = self;
        block_row::<D>(blocks, first, n_tracks, rows, put)
    }
}

#[inline(always)]
pub(super) fn block_row<D: Distance>(
    blocks: &[Block],
    first: usize,
    n_tracks: usize,
    rows: &mut [f64],
    put: &impl Fn(&mut f64, usize, usize, f64),
) -> Vec<f64> {
    let n_steps = blocks[first].len();
    let mut totals = vec![0.0_f64; n_steps];
    let mut lanes = vec![ZERO; if D::SUM_STEPS { n_steps } else { 0 }];
    for second in first..blocks.len() {
        for group in 0..LANES / ROWS {
            let tile = tile::<D>(&blocks[first], group * ROWS, &blocks[second], &mut lanes);
            for (r, sums) in tile.iter().enumerate() {
                let i = first * LANES + group * ROWS + r;
                if i >= n_tracks {
                    break; // the last block may not be full
                }
                // Start of row i within these rows, less the i + 1 columns it does not have.
                let row = (first * LANES..i).map(|k| n_tracks - 1 - k).sum::<usize>();
                for (lane, &sum) in sums.iter().enumerate() {
                    let j = second * LANES + lane;
                    if i < j && j < n_tracks {
                        put(&mut rows[row + j - i - 1], i, j, sum);
                    }
                }
            }
        }
        // A block against itself counts every pair twice. Sums of few blocks at a time keep f32 exact enough.
        if second == first || (second - first).is_multiple_of(16) || second + 1 == blocks.len() {
            let share = if second == first { 0.5 } else { 1.0 };
            for (total, lanes) in totals.iter_mut().zip(&mut lanes) {
                *total += share * lanes.0.iter().map(|&sum| f64::from(sum)).sum::<f64>();
                *lanes = ZERO;
            }
        }
    }
    totals
}

/// Four tracks of a block against the 16 of another: sums over the steps, and onto the sums of each step.
#[inline(always)]
fn tile<D: Distance>(a: &Block, row: usize, b: &Block, step_sums: &mut [Lanes]) -> [[f64; LANES]; ROWS] {
    let mut totals = [[0.0_f64; LANES]; ROWS];
    let n_steps = a.len().min(b.len());
    for start in (0..n_steps).step_by(RUN) {
        let run = start..n_steps.min(start + RUN);
        // Four variables and not an array of them, so that they stay in registers.
        let (mut s0, mut s1, mut s2, mut s3) = (ZERO, ZERO, ZERO, ZERO);
        let (a, b) = (&a[run.clone()], &b[run.clone()]);
        let step_sums = if D::SUM_STEPS { &mut step_sums[run] } else { &mut [] };
        let mut step_sums = step_sums.iter_mut();
        for (a, b) in a.iter().zip(b) {
            let [u, v, w] =
                a.each_ref().map(|lanes| lanes.0[row..row + ROWS].try_into().unwrap_or([0.0; ROWS]));
            let d0 = distances::<D>([u[0], v[0]], w[0], b);
            let d1 = distances::<D>([u[1], v[1]], w[1], b);
            let d2 = distances::<D>([u[2], v[2]], w[2], b);
            let d3 = distances::<D>([u[3], v[3]], w[3], b);
            (s0, s1, s2, s3) = (plus(s0, d0), plus(s1, d1), plus(s2, d2), plus(s3, d3));
            if D::SUM_STEPS
                && let Some(sum) = step_sums.next()
            {
                *sum = plus(*sum, plus(plus(d0, d1), plus(d2, d3)));
            }
        }
        for (totals, sums) in totals.iter_mut().zip([s0, s1, s2, s3]) {
            totals.iter_mut().zip(sums.0).for_each(|(total, sum)| *total += f64::from(sum));
        }
    }
    totals
}

/// From one track to the 16 of a block.
#[inline(always)]
fn distances<D: Distance>(own: [f32; 2], weight: f32, b: &[Lanes; 3]) -> Lanes {
    let mut out = ZERO;
    for lane in 0..LANES {
        out.0[lane] = D::between(own, [b[0].0[lane], b[1].0[lane]]) * (weight * b[2].0[lane]);
    }
    out
}

#[inline(always)]
fn plus(mut a: Lanes, b: Lanes) -> Lanes {
    for lane in 0..LANES {
        a.0[lane] += b.0[lane];
    }
    a
}
