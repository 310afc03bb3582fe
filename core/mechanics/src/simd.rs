//! Inner products and sums of long columns, a few columns at a time so that each is read once.

use crate::factor::WIDE;
use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Rows that are worked on at a time: what is read twice stays in the nearest cache.
const ROWS: usize = 512;
/// Columns of the basis that are added at a time.
const GROUP: usize = 4;

/// Inner products of every column of `basis` with each of two: `(n_basis, 2)`.
pub(crate) fn products(height: usize, basis: &[f64], wide: &[f64]) -> Vec<[f64; WIDE]> {
    let mut sums = vec![[0.0; WIDE]; basis.len() / height];
    Arch::new().dispatch(Products { height, basis, wide, sums: &mut sums });
    sums
}

/// The inner product of two columns.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [[0.0; WIDE]];
    Arch::new().dispatch(Products { height: a.len(), basis: a, wide: b, sums: &mut sums });
    sums[0][0]
}

struct Products<'a> {
    height: usize,
    basis: &'a [f64],
    /// Two columns, or one.
    wide: &'a [f64],
    sums: &'a mut [[f64; WIDE]],
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // Where there is no second column the first stands in for it, and its sum is not read.
        let second = self.wide.len() - self.height;
        for from in (0..self.height).step_by(ROWS) {
            let n = self.height.min(from + ROWS) - from;
            let (a, a_rest) = S::as_simd_f64s(&self.wide[from..from + n]);
            let (b, b_rest) = S::as_simd_f64s(&self.wide[second + from..second + from + n]);
            for (k, sums) in self.sums.iter_mut().enumerate() {
                let (v, v_rest) = S::as_simd_f64s(&self.basis[k * self.height + from..][..n]);
                let [more_a, more_b] = two(simd, v, a, b);
                sums[0] += more_a;
                sums[1] += more_b;
                for ((v, a), b) in v_rest.iter().zip(a_rest).zip(b_rest) {
                    sums[0] += v * a;
                    sums[1] += v * b;
                }
            }
        }
    }
}

/// Inner products of one with two.
#[inline(always)]
fn two<S: Simd>(simd: S, v: &[S::f64s], a: &[S::f64s], b: &[S::f64s]) -> [f64; 2] {
    // Two sums of each go on at a time: one alone waits for itself.
    let mut lanes = [simd.splat_f64s(0.0); 4];
    let ((v_pairs, v_last), (a_pairs, a_last), (b_pairs, b_last)) =
        (v.as_chunks::<2>(), a.as_chunks::<2>(), b.as_chunks::<2>());
    for ((v, a), b) in v_pairs.iter().zip(a_pairs).zip(b_pairs) {
        lanes[0] = simd.mul_add_f64s(v[0], a[0], lanes[0]);
        lanes[1] = simd.mul_add_f64s(v[0], b[0], lanes[1]);
        lanes[2] = simd.mul_add_f64s(v[1], a[1], lanes[2]);
        lanes[3] = simd.mul_add_f64s(v[1], b[1], lanes[3]);
    }
    for ((v, a), b) in v_last.iter().zip(a_last).zip(b_last) {
        lanes[0] = simd.mul_add_f64s(*v, *a, lanes[0]);
        lanes[1] = simd.mul_add_f64s(*v, *b, lanes[1]);
    }
    [0, 1].map(
        #[inline(always)]
        |k| simd.reduce_sum_f64s(simd.add_f64s(lanes[k], lanes[k + 2])),
    )
}

/// Columns that are sums of those of `basis`: `basis * shares`, with no shares of columns beyond the rows of `shares`.
pub(crate) fn combined(height: usize, basis: &[f64], shares: &DMatrix<f64>) -> Vec<f64> {
    let mut sums = Vec::with_capacity((shares.ncols() + 1) * height);
    for from in (0..shares.ncols()).step_by(WIDE) {
        let share = |row: usize| -> [f64; WIDE] {
            std::array::from_fn(|k| shares.get((row, from + k)).copied().unwrap_or_default())
        };
        let shares: Vec<[f64; WIDE]> = (0..shares.nrows()).map(share).collect();
        let mut wide = vec![0.0; WIDE * height];
        accumulate(height, &basis[..shares.len() * height], &shares, &mut wide);
        sums.extend_from_slice(&wide);
    }
    sums.truncate(shares.ncols() * height);
    sums
}

/// Adds to each of two columns what `shares` says of every column of `basis`: `wide += basis * shares`.
pub(crate) fn accumulate(height: usize, basis: &[f64], shares: &[[f64; WIDE]], wide: &mut [f64]) {
    Arch::new().dispatch(Accumulate { height, basis, shares, wide });
}

struct Accumulate<'a> {
    height: usize,
    basis: &'a [f64],
    shares: &'a [[f64; WIDE]],
    wide: &'a mut [f64],
}

impl WithSimd for Accumulate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for from in (0..self.height).step_by(ROWS) {
            let rows = from..self.height.min(from + ROWS);
            for (group, shares) in self.shares.chunks(GROUP).enumerate() {
                // Where there are less than four more, the first counts for those that lack, with a share of 0.
                let column = |k: usize| (group * GROUP + k.min(shares.len() - 1)) * self.height;
                let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] = [0, 1, 2, 3].map(
                    #[inline(always)]
                    |k| S::as_simd_f64s(&self.basis[column(k)..][rows.clone()]),
                );
                for k in 0..WIDE {
                    let share = |row: usize| shares.get(row).map_or(0.0, |share| share[k]);
                    let share = [share(0), share(1), share(2), share(3)];
                    let [s0, s1, s2, s3] = [
                        simd.splat_f64s(share[0]),
                        simd.splat_f64s(share[1]),
                        simd.splat_f64s(share[2]),
                        simd.splat_f64s(share[3]),
                    ];
                    let w = &mut self.wide[k * self.height..][rows.clone()];
                    let (w, w_rest) = S::as_mut_simd_f64s(w);
                    for ((((w, &a), &b), &c), &d) in w.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                        let sum = simd.mul_add_f64s(b, s1, simd.mul_add_f64s(a, s0, *w));
                        *w = simd.mul_add_f64s(d, s3, simd.mul_add_f64s(c, s2, sum));
                    }
                    for ((((w, a), b), c), d) in
                        w_rest.iter_mut().zip(a_rest).zip(b_rest).zip(c_rest).zip(d_rest)
                    {
                        *w += a * share[0] + b * share[1] + c * share[2] + d * share[3];
                    }
                }
            }
        }
    }
}
