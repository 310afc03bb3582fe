//! Products of long rows. Each sum has one order, so that neither threads nor vectors change its bits.

use rayon::prelude::*;

/// Sums of a product that go on side by side.
const LANES: usize = 8;
/// Rows that one row is multiplied with at a time: it is read once for all of them.
const ROWS: usize = 4;
/// Numbers of a row that are worked on at a time: what is added to stays in the nearest cache.
const PART: usize = 512;

/// The same table with rows as columns.
pub(super) fn transposed(rows: &[f64], len: usize) -> Vec<f64> {
    let n_rows = rows.len() / len;
    let mut turned = vec![0.0; rows.len()];
    for (row, values) in rows.chunks(len).enumerate() {
        for (column, value) in values.iter().enumerate() {
            turned[column * n_rows + row] = *value;
        }
    }
    turned
}

/// Inner products of all rows with all rows, a symmetric matrix.
pub(super) fn gram(rows: &[f64], n_rows: usize) -> Vec<f64> {
    let len = rows.len() / n_rows;
    let row = |k: usize| &rows[k * len..(k + 1) * len];
    let mut gram = vec![0.0; n_rows * n_rows];
    gram.par_chunks_mut(ROWS * n_rows).enumerate().for_each(|(block, out)| {
        let first = block * ROWS;
        // Beyond the last row the last is read again.
        let four = std::array::from_fn(|k| row((first + k).min(n_rows - 1)));
        for other in first..n_rows {
            let products = pulp::Arch::new().dispatch(Products { four, other: row(other) });
            for (out, product) in out.chunks_mut(n_rows).zip(products) {
                out[other] = product;
            }
        }
    });
    for i in 0..n_rows {
        for j in 0..i {
            gram[i * n_rows + j] = gram[j * n_rows + i];
        }
    }
    gram
}

struct Products<'a> {
    four: [&'a [f64]; ROWS],
    other: &'a [f64],
}

impl pulp::NullaryFnOnce for Products<'_> {
    type Output = [f64; ROWS];

    #[inline(always)]
    fn call(self) -> [f64; ROWS] {
        let (other, rest) = self.other.as_chunks::<LANES>();
        let mut sums = [[0.0; LANES]; ROWS];
        let parts = self.four.map(|row| row.as_chunks::<LANES>());
        for (k, other) in other.iter().enumerate() {
            for (sums, (row, _)) in sums.iter_mut().zip(&parts) {
                let row = &row[k];
                for lane in 0..LANES {
                    sums[lane] += row[lane] * other[lane];
                }
            }
        }
        let mut products = [0.0; ROWS];
        for ((product, sums), (_, row)) in products.iter_mut().zip(sums).zip(parts) {
            let tail: f64 = row.iter().zip(rest).map(|(a, b)| a * b).sum();
            *product = sums.iter().sum::<f64>() + tail;
        }
        products
    }
}

/// Sums of all rows, each times a factor of its own, once for each list of factors.
pub(super) fn combine(rows: &[f64], n_rows: usize, factors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let len = rows.len() / n_rows;
    let starts: Vec<usize> = (0..len).step_by(PART).collect();
    let part = |&from: &usize| {
        let n = PART.min(len - from);
        let mut sums = vec![0.0; factors.len() * n];
        pulp::Arch::new().dispatch(Combine { rows, len, from, factors, sums: &mut sums, n });
        sums
    };
    let parts: Vec<Vec<f64>> = starts.par_iter().map(part).collect();
    let whole = |k: usize| {
        let pieces = parts.iter().flat_map(|sums| {
            let n = sums.len() / factors.len();
            &sums[k * n..(k + 1) * n]
        });
        pieces.copied().collect()
    };
    (0..factors.len()).map(whole).collect()
}

struct Combine<'a> {
    rows: &'a [f64],
    len: usize,
    from: usize,
    factors: &'a [Vec<f64>],
    sums: &'a mut [f64],
    n: usize,
}

impl pulp::NullaryFnOnce for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (factors, sums) in self.factors.iter().zip(self.sums.chunks_mut(self.n)) {
            for (row, factor) in self.rows.chunks(self.len).zip(factors) {
                let row = &row[self.from..self.from + self.n];
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += factor * value;
                }
            }
        }
    }
}

/// The sum over components of weight times topos times chronos: a row of T numbers for each number of the topoi.
pub(super) fn sum(topos: &[Vec<f64>], chronos: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
    let (Some(n_rows), Some(len)) = (topos.first().map(Vec::len), chronos.first().map(Vec::len)) else {
        return Vec::new();
    };
    let mut rows = vec![0.0; n_rows * len];
    rows.par_chunks_mut(len).enumerate().for_each(|(k, row)| {
        for ((place, time), weight) in topos.iter().zip(chronos).zip(weights) {
            let factor = weight * place[k];
            row.iter_mut().zip(time).for_each(|(sum, value)| *sum += factor * value);
        }
    });
    rows
}
