//! A matrix in tiles, and what is multiplied by it.

use pulp::{Arch, Simd, WithSimd};

/// Columns of a tile: four vectors of sixteen numbers, or eight of eight.
pub(super) const COLUMNS: usize = 64;

/// A matrix by tiles of 64 columns: all rows of the first tile, then all of the next. The last is filled with zeros.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    n_rows: usize,
    n_columns: usize,
    numbers: Vec<f32>,
}

impl Tiles {
    pub(super) fn new(rows: &[Vec<f32>], n_columns: usize) -> Self {
        let mut numbers = vec![0.0; rows.len() * n_columns.next_multiple_of(COLUMNS)];
        for (row, from) in rows.iter().enumerate() {
            for (tile, part) in from.chunks(COLUMNS).enumerate() {
                let place = (tile * rows.len() + row) * COLUMNS;
                numbers[place..place + part.len()].copy_from_slice(part);
            }
        }
        Self { n_rows: rows.len(), n_columns, numbers }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.numbers.as_slice())
    }

    pub(super) fn at(&self, row: usize, column: usize) -> f32 {
        self.numbers[(column / COLUMNS * self.n_rows + row) * COLUMNS + column % COLUMNS]
    }

    /// `left` times this: `(n, n_rows)` to `(n, n_columns)`.
    pub(super) fn multiply(&self, left: &[f32], product: &mut [f32]) {
        Arch::new().dispatch(Multiply { tiles: self, left, product });
    }
}

struct Multiply<'a> {
    tiles: &'a Tiles,
    left: &'a [f32],
    product: &'a mut [f32],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // As many sums as there are registers for: of 32, or of 16.
        match S::F32_LANES {
            16 => by_tiles::<S, 6, 4>(simd, self),
            _ => by_tiles::<S, 6, 2>(simd, self),
        }
    }
}

/// `R` rows of the product at a time, `C` vectors of columns.
#[inline(always)]
fn by_tiles<S: Simd, const R: usize, const C: usize>(
    simd: S,
    Multiply { tiles, left, product }: Multiply<'_>,
) {
    let (n_rows, n_columns) = (tiles.n_rows, tiles.n_columns);
    for (tile, numbers) in tiles.numbers.chunks_exact(n_rows * COLUMNS).enumerate() {
        let first = tile * COLUMNS;
        for (left, product) in left.chunks(R * n_rows).zip(product.chunks_mut(R * n_columns)) {
            let n = left.len() / n_rows;
            for part in (0..COLUMNS).step_by(C * S::F32_LANES) {
                let sums = sums::<S, R, C>(simd, n_rows, numbers, part, left, n);
                for (k, sums) in sums.iter().enumerate().take(n) {
                    let from = first + part;
                    let to = n_columns.min(from + C * S::F32_LANES).max(from);
                    let row = &mut product[k * n_columns..(k + 1) * n_columns];
                    let Some(row) = row.get_mut(from..to) else { continue };
                    let (vectors, rest) = S::as_mut_simd_f32s(row);
                    let n_vectors = vectors.len();
                    for (vector, sum) in vectors.iter_mut().zip(sums) {
                        *vector = *sum;
                    }
                    if let Some(sum) = sums.get(n_vectors) {
                        simd.partial_store_f32s(rest, *sum);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn sums<S: Simd, const R: usize, const C: usize>(
    simd: S,
    n_rows: usize,
    numbers: &[f32],
    part: usize,
    left: &[f32],
    n: usize,
) -> [[S::f32s; C]; R] {
    let mut sums = [[simd.splat_f32s(0.0); C]; R];
    // Rows that are not there count as the first, and are not read.
    let rows: [&[f32]; R] = std::array::from_fn(
        #[inline(always)]
        |k| {
            let row = if k < n { k } else { 0 };
            &left[row * n_rows..(row + 1) * n_rows]
        },
    );
    for (m, columns) in numbers.chunks_exact(COLUMNS).enumerate() {
        let vectors = S::as_simd_f32s(&columns[part..part + C * S::F32_LANES]).0;
        for (sums, row) in sums.iter_mut().zip(&rows) {
            let share = simd.splat_f32s(row[m]);
            for (sum, vector) in sums.iter_mut().zip(vectors) {
                *sum = simd.mul_add_f32s(share, *vector, *sum);
            }
        }
    }
    sums
}
