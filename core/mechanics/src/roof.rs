//! What a machine can do at most, measured: multiplications with addition, and writing to memory.

use crate::threads::Threads;
use pulp::{Arch, Simd, WithSimd};
use std::hint::black_box;
use std::time::Instant;

/// Sums at a time: more than two units that each take four steps can be kept busy with.
const SUMS: usize = 16;
/// Multiplications of each sum in a run.
const ROUNDS: usize = 2_000_000;
/// Memory that is written, bytes; far more than caches hold.
const WRITTEN: usize = 512 << 20;
/// Runs of which the best counts: whatever else runs only takes away.
const RUNS: usize = 5;

/// The most that a machine can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roof {
    /// Single-precision multiplications and additions a second, two for each done together.
    pub flops: f64,
    /// Bytes written a second, to memory that nobody has read.
    pub written: f64,
}

impl Roof {
    /// Measures it on so many threads, in a second or two.
    #[must_use]
    pub fn measured(threads: &Threads, n_threads: usize) -> Self {
        let best = |amount: f64, work: &mut dyn FnMut()| {
            (0..RUNS).fold(0.0_f64, |best, _| {
                let begun = Instant::now();
                work();
                best.max(amount / begun.elapsed().as_secs_f64())
            })
        };
        let lanes = Arch::new().dispatch(Lanes);
        let amount = (2 * SUMS * ROUNDS * lanes * n_threads) as f64;
        let flops = best(amount, &mut || {
            threads.each(0..n_threads, |_| {
                black_box(Arch::new().dispatch(Busy));
            });
        });
        let mut memory = vec![1_u8; WRITTEN];
        let piece = WRITTEN / n_threads.max(1);
        let mut round = 0;
        let written = best(WRITTEN as f64, &mut || {
            round += 1;
            threads.each(memory.chunks_mut(piece), |piece| piece.fill(round));
            black_box(&memory);
        });
        Self { flops, written }
    }
}

struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F32_LANES
    }
}

struct Busy;

impl WithSimd for Busy {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let (factor, more) = (simd.splat_f32s(black_box(0.999)), simd.splat_f32s(black_box(0.1)));
        let mut sums = [more; SUMS];
        for _ in 0..ROUNDS {
            for sum in &mut sums {
                *sum = simd.mul_add_f32s(*sum, factor, more);
            }
        }
        sums.into_iter()
            .map(
                #[inline(always)]
                |sum| simd.reduce_sum_f32s(sum),
            )
            .sum()
    }
}
