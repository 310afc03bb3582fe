//! Inner products and sums of long columns, a few columns at a time so that each is read once.

use crate::factor::WIDE;
use pulp::{Arch, Simd, WithSimd};

/// Rows that are worked on at a time: what is read twice stays in the nearest cache.
const ROWS: usize = 1024;
/// Columns of the basis at a time: memory gives several at once faster than one.
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
            for (group, sums) in self.sums.chunks_mut(GROUP).enumerate() {
                // Where there are less than four more, the first counts for those that lack, and their sums are not read.
                let column = |k: usize| (group * GROUP + if k < sums.len() { k } else { 0 }) * self.height;
                let columns = [0, 1, 2, 3].map(
                    #[inline(always)]
                    |k| S::as_simd_f64s(&self.basis[column(k) + from..][..n]),
                );
                let [more_a, more_b] = four_by_two(simd, columns.map(|column| column.0), a, b);
                for (k, sums) in sums.iter_mut().enumerate() {
                    sums[0] += more_a[k];
                    sums[1] += more_b[k];
                    for ((v, a), b) in columns[k].1.iter().zip(a_rest).zip(b_rest) {
                        sums[0] += v * a;
                        sums[1] += v * b;
                    }
                }
            }
        }
    }
}

/// Inner products of four with two.
#[inline(always)]
fn four_by_two<S: Simd>(
    simd: S,
    [v0, v1, v2, v3]: [&[S::f64s]; GROUP],
    a: &[S::f64s],
    b: &[S::f64s],
) -> [[f64; GROUP]; WIDE] {
    let mut of_a = [simd.splat_f64s(0.0); GROUP];
    let mut of_b = of_a;
    for (((((a, b), v0), v1), v2), v3) in a.iter().zip(b).zip(v0).zip(v1).zip(v2).zip(v3) {
        for (k, v) in [v0, v1, v2, v3].into_iter().enumerate() {
            of_a[k] = simd.mul_add_f64s(*v, *a, of_a[k]);
            of_b[k] = simd.mul_add_f64s(*v, *b, of_b[k]);
        }
    }
    [of_a, of_b].map(
        #[inline(always)]
        |sums| {
            sums.map(
                #[inline(always)]
                |sum| simd.reduce_sum_f64s(sum),
            )
        },
    )
}

/// Makes of two columns `a` and `b` these: `a * by[0]` and `a * by[1] + b * by[2]`.
pub(crate) fn mixed(wide: &mut [f64], by: [f64; 3]) {
    let (a, b) = wide.split_at_mut(wide.len() / WIDE);
    Arch::new().dispatch(
        #[inline(always)]
        || {
            for (a, b) in a.iter_mut().zip(b) {
                *b = *a * by[1] + *b * by[2];
                *a *= by[0];
            }
        },
    );
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
