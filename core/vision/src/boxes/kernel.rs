//! How alike a template and windows of a picture are: exact integer sums over all their pixels.
//!
//! Sums are whole numbers, so that the plain kernel and the fast ones give the same bits.
#![allow(unsafe_code, reason = "calls to functions for instructions that the processor was asked about")]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::planes::Plane;
use crate::simd::{self, Set};

/// Pixels of a row that are worked on together.
const LANES: usize = 32;

/// So few columns of windows are compared one by one: most of a vector of them would be for nothing.
#[cfg(target_arch = "x86_64")]
const FEW: usize = 2;

/// Rows that are summed up before a window may be given up.
const ROWS_A_LOOK: usize = 8;

/// Pixels of a template's row, or which of them count.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct Strip([i16; LANES]);

/// A template, ready to be compared.
#[derive(Clone, Debug, Default)]
pub(super) struct Cut {
    /// `(strips, side)`: a strip's rows, then those of the next; 0 beyond the side.
    rows: Vec<Strip>,
    /// All bits where a pixel counts, `(strips)`.
    mask: Vec<Strip>,
    side: usize,
    /// `(side, side)`, row-major.
    pixels: Vec<u8>,
    /// Two neighbours of a row together, the left one in the lower half; 0 beyond the side, and in a row above and
    /// one beneath. `(side + 2, side / 2)`, the latter rounded up.
    pairs: Vec<i32>,
    /// `Σ I²`
    squares: u32,
}

/// Sums over a window `J` under a template `I`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    /// `Σ J`
    pub(super) sum: u32,
    /// `Σ J²`
    pub(super) squares: u32,
    /// `Σ I J`
    pub(super) products: u32,
}

impl Sums {
    /// Sums of pixels under themselves.
    pub(super) fn of(pixels: &[u8]) -> Self {
        let sum = pixels.iter().map(|&p| u32::from(p)).sum();
        let squares = pixels.iter().map(|&p| u32::from(p).pow(2)).sum();
        Self { sum, squares, products: squares }
    }

    /// `n ΣJ² - (ΣJ)²`, the variance of `n` pixels times n²: 0 for flat ones.
    pub(super) fn spread(&self, n: usize) -> u64 {
        n as u64 * u64::from(self.squares) - u64::from(self.sum) * u64::from(self.sum)
    }

    /// Correlation of `n` pixels with a template of these sums, `Σ(I-Ī)(J-J̄) / √(Σ(I-Ī)² Σ(J-J̄)²)`; `None` where
    /// either is flat.
    pub(super) fn correlation(&self, template: &Self, n: usize) -> Option<f64> {
        let together = n as i64 * i64::from(self.products) - i64::from(template.sum) * i64::from(self.sum);
        let [a, b] = [template, self].map(|sums| sums.spread(n) as f64);
        (a > 0.0 && b > 0.0).then(|| (together as f64 / (a * b).sqrt()).clamp(-1.0, 1.0))
    }
}

impl Cut {
    /// Takes a template of `side * side` pixels, row-major.
    pub(super) fn take(&mut self, pixels: &[u8], side: usize) {
        if self.side != side {
            let strips = side.div_ceil(LANES);
            let counts = |i: usize| Strip(std::array::from_fn(|lane| -i16::from(i * LANES + lane < side)));
            self.side = side;
            self.mask = (0..strips).map(counts).collect();
            self.rows = vec![Strip([0; LANES]); side * strips];
        }
        for (y, pixels) in pixels.chunks_exact(side).enumerate() {
            for (i, pixels) in pixels.chunks(LANES).enumerate() {
                let Strip(lanes) = &mut self.rows[i * side + y];
                lanes.iter_mut().zip(pixels).for_each(|(lane, &pixel)| *lane = i16::from(pixel));
            }
        }
        self.pixels.clear();
        self.pixels.extend_from_slice(pixels);
        self.pairs.clear();
    }

    /// Makes the pairs of a template that was taken, for [`all_differences`].
    fn pair(&mut self) {
        let pair = |two: &[u8]| i32::from(two[0]) | two.get(1).map_or(0, |&right| i32::from(right) << 16);
        let n = self.side.div_ceil(2);
        self.pairs.resize(n, 0);
        self.pixels.chunks_exact(self.side).for_each(|row| self.pairs.extend(row.chunks(2).map(pair)));
        self.pairs.resize((self.side + 2) * n, 0);
        self.squares = self.pixels.iter().map(|&p| u32::from(p).pow(2)).sum();
    }
}

/// A picture's bytes, in which windows lie whole, the vectors that they are read by included.
#[derive(Clone, Copy)]
struct Source<'a> {
    data: &'a [u8],
    stride: usize,
}

impl<'a> Source<'a> {
    /// For windows that start at these bytes of a plane.
    #[track_caller]
    fn of(cut: &Cut, plane: &'a Plane, starts: &[u32]) -> Self {
        let last = starts.iter().max().map_or(0, |&start| start as usize);
        Self::up_to(cut, plane, last)
    }

    /// For windows that start at this byte of a plane, or before.
    #[track_caller]
    fn up_to(cut: &Cut, plane: &'a Plane, last: usize) -> Self {
        let Plane { data, stride, .. } = plane;
        let vectors = cut.mask.len() * LANES;
        assert!(
            cut.side > 0 && last + (cut.side - 1) * stride + vectors <= data.len(),
            "a window beyond its margin"
        );
        Self { data, stride: *stride }
    }
}

/// `Σ (I - J)²` of every window that starts at one of these bytes of a plane.
///
/// # Panics
/// When a window does not lie in the plane.
#[track_caller]
pub(super) fn differences(level: simd::Level, cut: &Cut, plane: &Plane, starts: &[u32], out: &mut Vec<u32>) {
    let source = Source::of(cut, plane, starts);
    out.clear();
    match level.set() {
        Set::Scalar => out.extend(starts.iter().map(|&start| difference(cut, source, start, 0..cut.side))),
        // SAFETY: a level is the proof that the processor has these instructions.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2::differences(cut, source, starts, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512::differences(cut, source, starts, out) },
    }
}

/// [`differences`] as far as the least of them is wanted: a window may be given up after every [`ROWS_A_LOOK`] rows,
/// once they alone differ by more than the least window before it. The one that differs least in the first rows is the
/// first, the others follow in order.
///
/// # Panics
/// When a window does not lie in the plane.
#[track_caller]
pub(super) fn least_differences(
    level: simd::Level,
    cut: &Cut,
    plane: &Plane,
    starts: &[u32],
    out: &mut Vec<u32>,
) {
    let source = Source::of(cut, plane, starts);
    out.clear();
    match level.set() {
        Set::Scalar => least(cut, source, starts, out),
        // SAFETY: a level is the proof that the processor has these instructions.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2::least_differences(cut, source, starts, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512::least_differences(cut, source, starts, out) },
    }
}

/// [`differences`] of all windows of some columns and rows, `[columns, rows]`, the first at a byte of a plane; row-major.
///
/// Windows are in the lanes of vectors here, where [`differences`] has a window's pixels, and what all rows have in
/// common is summed up once: `Σ (I - J)² = Σ I² - 2 Σ I J + Σ J²`.
///
/// # Panics
/// When a window does not lie in the plane.
#[track_caller]
pub(super) fn all_differences(
    level: simd::Level,
    cut: &mut Cut,
    plane: &Plane,
    start: usize,
    size: [usize; 2],
    out: &mut Vec<u32>,
) {
    let [columns, rows] = size;
    out.clear();
    out.resize(columns * rows, 0);
    if out.is_empty() {
        return;
    }
    if cut.pairs.is_empty() {
        cut.pair();
    }
    // The last vector of windows is read whole, too.
    let last = start + (rows - 1) * plane.stride + columns.next_multiple_of(LANES);
    let source = Source::up_to(cut, plane, last);
    match level.set() {
        Set::Scalar => {
            for (y, out) in out.chunks_exact_mut(columns).enumerate() {
                let start = (start + y * plane.stride) as u32;
                let windows = out.iter_mut().zip(start..);
                windows.for_each(|(out, start)| *out = difference(cut, source, start, 0..cut.side));
            }
        }
        // SAFETY: a level is the proof that the processor has these instructions.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2::all_differences(cut, source, start, size, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512::all_differences(cut, source, start, size, out) },
    }
}

/// Sums of every window that starts at one of these bytes of a plane.
///
/// # Panics
/// When a window does not lie in the plane.
#[track_caller]
pub(super) fn sums(level: simd::Level, cut: &Cut, plane: &Plane, starts: &[u32], out: &mut Vec<Sums>) {
    let source = Source::of(cut, plane, starts);
    out.clear();
    match level.set() {
        Set::Scalar => out.extend(starts.iter().map(|&start| sum(cut, source, start))),
        // SAFETY: a level is the proof that the processor has these instructions.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2::sums(cut, source, starts, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512::sums(cut, source, starts, out) },
    }
}

/// See [`least_differences`].
fn least(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    let looks = cut.side.min(ROWS_A_LOOK);
    for &start in starts {
        out.push(difference(cut, source, start, 0..looks));
    }
    // The less there is to beat, the sooner others are given up.
    let first = (0..out.len()).min_by_key(|&i| out[i]);
    let mut least = u32::MAX;
    for i in first.into_iter().chain((0..out.len()).filter(|&i| Some(i) != first)) {
        let mut y = looks;
        while y < cut.side && out[i] <= least {
            let end = cut.side.min(y + ROWS_A_LOOK);
            out[i] += difference(cut, source, starts[i], y..end);
            y = end;
        }
        least = least.min(out[i]);
    }
}

/// Template and picture, pixel by pixel, of some rows of a window.
fn pixels<'a>(
    cut: &'a Cut,
    source: Source<'a>,
    start: u32,
    rows: Range<usize>,
) -> impl Iterator<Item = (u32, u32)> + 'a {
    rows.flat_map(move |y| {
        let template = &cut.pixels[y * cut.side..][..cut.side];
        let picture = &source.data[start as usize + y * source.stride..][..cut.side];
        template.iter().zip(picture).map(|(&i, &j)| (u32::from(i), u32::from(j)))
    })
}

fn difference(cut: &Cut, source: Source<'_>, start: u32, rows: Range<usize>) -> u32 {
    pixels(cut, source, start, rows).map(|(i, j)| i.abs_diff(j).pow(2)).sum()
}

fn sum(cut: &Cut, source: Source<'_>, start: u32) -> Sums {
    pixels(cut, source, start, 0..cut.side).fold(Sums::default(), |sums, (i, j)| Sums {
        sum: sums.sum + j,
        squares: sums.squares + j * j,
        products: sums.products + i * j,
    })
}
