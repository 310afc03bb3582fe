//! A matrix in tiles, and what is multiplied by it.

use pulp::{Arch, Simd, WithSimd};

/// Columns of a tile: four vectors of sixteen numbers, or eight of eight.
pub(super) const COLUMNS: usize = 64;
/// Rows of the product whose sums are in registers together.
pub(super) const PANEL: usize = 6;

/// A matrix by tiles of 64 columns: all rows of the first tile, then all of the next. The last is filled with zeros.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    n_rows: usize,
    rows: Vec<Row>,
}

/// A row of a tile, in lines of memory of its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Row([f32; COLUMNS]);

impl Tiles {
    pub(super) fn new(rows: &[Vec<f32>], n_columns: usize) -> Self {
        let mut made = vec![Row([0.0; COLUMNS]); rows.len() * n_columns.div_ceil(COLUMNS)];
        for (row, from) in rows.iter().enumerate() {
            for (tile, part) in from.chunks(COLUMNS).enumerate() {
                made[tile * rows.len() + row].0[..part.len()].copy_from_slice(part);
            }
        }
        Self { n_rows: rows.len(), rows: made }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.rows.as_slice())
    }

    /// Panels times the first so many rows and columns of this, to `(n, n_columns)`: a panel has six numbers for each of
    /// these rows, one for each of six rows of the product.
    pub(super) fn multiply(
        &self,
        panels: &[[f32; PANEL]],
        n_rows: usize,
        n_columns: usize,
        product: &mut [f32],
    ) {
        if n_rows == 0 {
            return product.fill(0.0);
        }
        Arch::new().dispatch(Multiply { tiles: self, panels, n_rows, n_columns, product });
    }
}

impl Tiles {
    /// Panels times the first so many rows of this, three tiles at a time: what is done with six rows of 192 sums, for each
    /// of so many groups of tiles with every panel.
    #[inline(always)]
    pub(super) fn by_groups(
        &self,
        panels: &[[f32; PANEL]],
        n_rows: usize,
        n_groups: usize,
        each: impl FnMut(usize, usize, &mut [[[f32; COLUMNS]; 3]; PANEL]),
    ) {
        Arch::new().dispatch(Groups { tiles: self, panels, n_rows, n_groups, each });
    }
}

struct Groups<'a, F> {
    tiles: &'a Tiles,
    panels: &'a [[f32; PANEL]],
    n_rows: usize,
    n_groups: usize,
    each: F,
}

impl<F: FnMut(usize, usize, &mut [[[f32; COLUMNS]; 3]; PANEL])> WithSimd for Groups<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F32_LANES {
            16 => in_groups::<S, 4, F>(simd, self),
            _ => in_groups::<S, 2, F>(simd, self),
        }
    }
}

#[inline(always)]
fn in_groups<S: Simd, const C: usize, F: FnMut(usize, usize, &mut [[[f32; COLUMNS]; 3]; PANEL])>(
    simd: S,
    Groups { tiles, panels, n_rows, n_groups, mut each }: Groups<'_, F>,
) {
    let mut stage = [[[0.0; COLUMNS]; 3]; PANEL];
    for (group, tiles) in tiles.rows.chunks_exact(3 * tiles.n_rows).take(n_groups).enumerate() {
        for (k, panel) in panels.chunks_exact(n_rows).enumerate() {
            for (axis, tile) in tiles.chunks_exact(tiles.len() / 3).enumerate() {
                for part in (0..COLUMNS).step_by(C * S::F32_LANES) {
                    let sums = sums::<S, C>(simd, tile, part, panel);
                    put::<S, C>(stage.iter_mut().map(|rows| &mut rows[axis][part..]), &sums);
                }
            }
            each(group, k, &mut stage);
        }
    }
}

struct Multiply<'a> {
    tiles: &'a Tiles,
    panels: &'a [[f32; PANEL]],
    n_rows: usize,
    n_columns: usize,
    product: &'a mut [f32],
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // As many sums as there are registers for: of 32, or of 16.
        match S::F32_LANES {
            16 => by_tiles::<S, 4>(simd, self),
            _ => by_tiles::<S, 2>(simd, self),
        }
    }
}

/// `C` vectors of columns at a time.
#[inline(always)]
fn by_tiles<S: Simd, const C: usize>(
    simd: S,
    Multiply { tiles: Tiles { n_rows: height, rows }, panels, n_rows, n_columns, product }: Multiply<'_>,
) {
    let mut stage = [[0.0; COLUMNS]; PANEL];
    for (tile, first) in rows.chunks_exact(*height).zip((0..n_columns).step_by(COLUMNS)) {
        let n = COLUMNS.min(n_columns - first);
        for (panel, product) in panels.chunks_exact(n_rows).zip(product.chunks_mut(PANEL * n_columns)) {
            for part in (0..COLUMNS).step_by(C * S::F32_LANES) {
                let sums = sums::<S, C>(simd, tile, part, panel);
                // The last tile is broader than what is left of a row.
                if n < COLUMNS {
                    put::<S, C>(stage.iter_mut().map(|row| &mut row[part..]), &sums);
                } else {
                    put::<S, C>(product.chunks_mut(n_columns).map(|row| &mut row[first + part..]), &sums);
                }
            }
            if n < COLUMNS {
                for (row, from) in product.chunks_mut(n_columns).zip(&stage) {
                    row[first..].copy_from_slice(&from[..n]);
                }
            }
        }
    }
}

/// Puts sums where their rows begin.
#[inline(always)]
fn put<'a, S: Simd, const C: usize>(rows: impl Iterator<Item = &'a mut [f32]>, sums: &[[S::f32s; C]; PANEL]) {
    for (row, sums) in rows.zip(sums) {
        let vectors = S::as_mut_simd_f32s(&mut row[..C * S::F32_LANES]).0;
        for (vector, sum) in vectors.iter_mut().zip(sums) {
            *vector = *sum;
        }
    }
}

#[inline(always)]
fn sums<S: Simd, const C: usize>(
    simd: S,
    rows: &[Row],
    part: usize,
    panel: &[[f32; PANEL]],
) -> [[S::f32s; C]; PANEL] {
    let mut sums = [[simd.splat_f32s(0.0); C]; PANEL];
    for (row, shares) in rows.iter().zip(panel) {
        let vectors = S::as_simd_f32s(&row.0[part..part + C * S::F32_LANES]).0;
        for (sums, share) in sums.iter_mut().zip(shares) {
            let share = simd.splat_f32s(*share);
            for (sum, vector) in sums.iter_mut().zip(vectors) {
                *sum = simd.mul_add_f32s(share, *vector, *sum);
            }
        }
    }
    sums
}
