//! All windows of some columns and rows, many of them side by side in the lanes of vectors.
//!
//! What all rows have in common is summed up once: `Σ (I - J)² = Σ I² - 2 Σ I J + Σ J²`.

use std::ops::Range;

use super::{LANES, Rows, Source, Strip, Windows};

/// So few columns of windows are compared one by one: most of a vector of them would be for nothing.
const FEW: usize = 2;

/// All windows of some columns and rows.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub(super) source: Source<'a>,
    /// Byte of the first.
    pub(super) start: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
}

/// Sums of N windows side by side in the upper half of the rows, and of those as far beneath in the lower one.
pub(super) type Halves<const N: usize> = [[u32; N]; 2];

/// A template beside N windows at a time.
pub(super) trait Beside<const N: usize>: Windows {
    /// What belongs to the template alone, of `Σ (I - J)²`.
    fn own(&self) -> u32;

    /// Strips of a row of pixels under the windows.
    fn n_strips(&self) -> usize;

    /// Takes the pixels under one row of the windows that start at a byte, and of those so many bytes beneath; `Σ J²`
    /// over them, in the order of lanes.
    fn take(&self, at: usize, beneath: usize, strips: &mut [Strip]) -> Halves<N>;

    /// `Σ I J` of the windows whose first row of pixels is the first of these strips, and of those in the next row.
    fn products(&self, strips: &[Strip]) -> [Halves<N>; 2];

    /// Puts lanes in the order of windows.
    fn in_turn(&self, sums: Halves<N>) -> Halves<N>;
}

/// Memory of [`Block::all`].
#[derive(Debug, Default)]
pub(in super::super) struct Memory {
    /// Pixels under windows, the rows of the lower half beside those of the upper one.
    strips: Vec<Strip>,
    /// `Σ J²` of the windows, and what belongs to the template: [`Halves`] after [`Halves`].
    squares: Vec<u32>,
}

impl Block<'_> {
    /// Compares the windows of some columns one by one.
    #[inline(always)]
    pub(super) fn each(&self, columns: Range<usize>, windows: &impl Windows, out: &mut [u32]) {
        for (y, out) in out.chunks_exact_mut(self.columns).enumerate() {
            let starts = self.start + y * self.source.stride + columns.start..;
            let windows_at = out[columns.clone()].iter_mut().zip(starts);
            windows_at.for_each(|(out, start)| *out = windows.difference(start as u32, Rows::ALL));
        }
    }

    /// Compares all windows.
    #[inline(always)]
    pub(super) fn all<const N: usize>(
        &self,
        side: usize,
        windows: &impl Beside<N>,
        memory: &mut Memory,
        out: &mut [u32],
    ) {
        // The upper half of the rows, and how far beneath the lower half is, which has as many: of an odd number of
        // rows the middle one is in both.
        let (half, beneath) = (self.rows.div_ceil(2), self.rows / 2);
        for x in (0..self.columns).step_by(N) {
            let n = (self.columns - x).min(N);
            if n <= FEW || half < 2 {
                self.each(x..x + n, windows, out);
                continue;
            }
            self.take(x, side, windows, memory);
            let (squares, _) = memory.squares.as_chunks::<N>().0.as_chunks::<2>();
            for y in (0..half).step_by(2) {
                // Of an odd number the last but one is done twice.
                let y = y.min(half - 2);
                let products = windows.products(&memory.strips[y * windows.n_strips()..]);
                for (y, products) in (y..).zip(products) {
                    let costs = together(squares[y], products, |s, p| s.wrapping_sub(p.wrapping_mul(2)));
                    for (y, costs) in [y, y + beneath].into_iter().zip(windows.in_turn(costs)) {
                        let out = &mut out[y * self.columns + x..][..n];
                        match out.first_chunk_mut() {
                            Some(out) => *out = costs,
                            None => out.copy_from_slice(&costs[..n]),
                        }
                    }
                }
            }
        }
    }

    /// Takes the pixels under N columns of windows; `Σ J²` of these windows and what belongs to the template.
    #[inline(always)]
    fn take<const N: usize>(&self, x: usize, side: usize, windows: &impl Beside<N>, memory: &mut Memory) {
        let (rows, beneath) = (self.rows.div_ceil(2) + side - 1, self.rows / 2 * self.source.stride);
        // What earlier ones left over is written over.
        memory.squares.resize(memory.squares.len().max(rows * 2 * N), 0);
        memory.strips.resize(memory.strips.len().max(rows * windows.n_strips()), Strip([0; LANES]));
        let (squares, _) = memory.squares.as_chunks_mut::<N>().0.as_chunks_mut::<2>();
        let mut sums = [[windows.own(); N]; 2];
        for (y, strips) in memory.strips.chunks_exact_mut(windows.n_strips()).enumerate().take(rows) {
            squares[y] = windows.take(self.start + x + y * self.source.stride, beneath, strips);
            sums = together(sums, squares[y], u32::wrapping_add);
            if y + 1 >= side {
                // A window is whole; its first row leaves.
                let first = std::mem::replace(&mut squares[y + 1 - side], sums);
                sums = together(sums, first, u32::wrapping_sub);
            }
        }
    }
}

#[inline(always)]
fn together<const N: usize>(mut a: Halves<N>, b: Halves<N>, of: impl Fn(u32, u32) -> u32) -> Halves<N> {
    for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
        *a = of(*a, *b);
    }
    a
}
