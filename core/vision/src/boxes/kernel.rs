//! How alike a template and windows of a picture are: exact integer sums over all their pixels.
//!
//! Sums are whole numbers, so that the plain kernel and the fast ones give the same bits.
#![allow(unsafe_code, reason = "calls to functions for instructions that the processor was asked about")]
#![cfg_attr(
    not(target_arch = "x86_64"),
    allow(dead_code, reason = "only vectors need groups, halves and their memory")
)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod beside;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod vector;
#[cfg(target_arch = "x86_64")]
mod vnni;

use super::planes::Plane;
use crate::simd::{self, Set};
use beside::Block;
pub(super) use beside::Memory;

/// Pixels of a row that are worked on together.
pub(super) const LANES: usize = 32;

/// Rows, at most, that are summed up before a window may be given up.
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
    /// A few neighbours of a row together, the left one lowest; 0 beyond the side, and in a row above and one beneath.
    /// `(side + 2, groups of a row)`.
    groups: Vec<i32>,
    /// `Σ I`, with the groups.
    sum: u32,
    /// `Σ I²`, with the groups.
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
    /// Takes a template of `side * side` pixels, row-major; what is behind them does not count.
    pub(super) fn take(&mut self, pixels: &[u8], side: usize) {
        if self.side != side {
            let strips = side.div_ceil(LANES);
            let counts = |i: usize| Strip(std::array::from_fn(|lane| -i16::from(i * LANES + lane < side)));
            self.side = side;
            self.mask = (0..strips).map(counts).collect();
            self.rows = vec![Strip([0; LANES]); side * strips];
        }
        for (i, (Strip(mask), rows)) in self.mask.iter().zip(self.rows.chunks_exact_mut(side)).enumerate() {
            for (y, Strip(lanes)) in rows.iter_mut().enumerate() {
                let pixels = &pixels[y * side + i * LANES..];
                *lanes = match pixels.first_chunk::<LANES>() {
                    Some(pixels) => std::array::from_fn(|i| i16::from(pixels[i]) & mask[i]),
                    None => {
                        std::array::from_fn(|i| pixels.get(i).map_or(0, |&pixel| i16::from(pixel)) & mask[i])
                    }
                };
            }
        }
        self.pixels.clear();
        self.pixels.extend_from_slice(&pixels[..side * side]);
    }

    /// Makes the groups of a template that was taken, for [`all_differences`].
    #[cfg(target_arch = "x86_64")]
    fn group<const N: usize>(&mut self, together: fn([u8; N]) -> i32) {
        let group = |some: &[u8]| together(std::array::from_fn(|i| some.get(i).copied().unwrap_or(0)));
        let n = self.side.div_ceil(N);
        self.groups.clear();
        self.groups.resize(n, 0);
        for row in self.pixels.chunks_exact(self.side) {
            self.groups.extend(row.chunks(N).map(group));
        }
        self.groups.resize((self.side + 2) * n, 0);
        Sums { sum: self.sum, squares: self.squares, .. } = Sums::of(&self.pixels);
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
        let last = starts.iter().fold(0, |last, &start| start.max(last));
        Self::up_to(cut, plane, last as usize)
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
        Set::Scalar => each_difference(&Plain(cut, source), starts, Rows::ALL, out),
        // SAFETY: a level is the proof that the processor has these instructions.
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 => unsafe { avx2::differences(cut, source, starts, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 => unsafe { avx512::differences(cut, source, starts, out) },
    }
}

/// [`differences`] as far as the least of them is wanted: a window is looked at a few rows at a time, of all parts
/// of it, and given up once they alone differ by more than the least window before it. The one that differs least at
/// the first look is the first, the others follow in order.
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
        Set::Scalar => least_difference(cut.side, &Plain(cut, source), starts, out),
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
    (start, [columns, rows]): (usize, [usize; 2]),
    memory: &mut Memory,
    out: &mut Vec<u32>,
) {
    out.resize(columns * rows, 0);
    if out.is_empty() {
        return;
    }
    // The last vector of windows is read whole, too.
    let last = start + (rows - 1) * plane.stride + columns.next_multiple_of(LANES);
    let source = Source::up_to(cut, plane, last);
    let block = Block { source, start, columns, rows };
    match level.set() {
        Set::Scalar => block.each(0..columns, &Plain(cut, source), out),
        #[cfg(target_arch = "x86_64")]
        Set::Avx512 if vnni::is_there() => {
            cut.group(i32::from_le_bytes);
            // SAFETY: a level is the proof that the processor has AVX-512, and whether it has VNNI was asked.
            unsafe { vnni::all_differences(cut, &block, memory, out) }
        }
        #[cfg(target_arch = "x86_64")]
        Set::Avx2 | Set::Avx512 => {
            cut.group(|[left, right]| i32::from(left) | i32::from(right) << 16);
            // SAFETY: a level is the proof that the processor has these instructions, or more.
            unsafe { avx2::all_differences(cut, &block, memory, out) }
        }
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

/// Rows of a template: every so many, from one of the first on.
#[derive(Clone, Copy)]
struct Rows {
    first: usize,
    step: usize,
}

impl Rows {
    const ALL: Self = Self { first: 0, step: 1 };

    /// Those of a template of this side.
    fn of(self, side: usize) -> impl Iterator<Item = usize> {
        (self.first..side).step_by(self.step)
    }
}

/// A template beside windows of a picture, one after the other.
trait Windows {
    /// `Σ (I - J)²` of some rows of the window that starts at a byte.
    fn difference(&self, start: u32, rows: Rows) -> u32;
}

/// [`Windows`] whose pixels are compared one by one.
struct Plain<'a>(&'a Cut, Source<'a>);

impl Windows for Plain<'_> {
    fn difference(&self, start: u32, rows: Rows) -> u32 {
        pixels(self.0, self.1, start, rows).map(|(i, j)| i.abs_diff(j).pow(2)).sum()
    }
}

/// See [`differences`].
#[inline(always)]
fn each_difference(windows: &impl Windows, starts: &[u32], rows: Rows, out: &mut Vec<u32>) {
    for &start in starts {
        out.push(windows.difference(start, rows));
    }
}

/// See [`least_differences`].
#[inline(always)]
fn least_difference(side: usize, windows: &impl Windows, starts: &[u32], out: &mut Vec<u32>) {
    // Rows from all over the window tell more than neighbours.
    let step = side.div_ceil(ROWS_A_LOOK);
    each_difference(windows, starts, Rows { first: 0, step }, out);
    // The less there is to beat, the sooner others are given up.
    let best = (0..out.len()).min_by_key(|&i| out[i]);
    let mut least = u32::MAX;
    for i in best.into_iter().chain((0..out.len()).filter(|&i| Some(i) != best)) {
        let mut first = 1;
        while first < step && out[i] <= least {
            out[i] += windows.difference(starts[i], Rows { first, step });
            first += 1;
        }
        least = least.min(out[i]);
    }
}

/// Template and picture, pixel by pixel, of some rows of a window.
fn pixels<'a>(
    cut: &'a Cut,
    source: Source<'a>,
    start: u32,
    rows: Rows,
) -> impl Iterator<Item = (u32, u32)> + 'a {
    rows.of(cut.side).flat_map(move |y| {
        let template = &cut.pixels[y * cut.side..][..cut.side];
        let picture = &source.data[start as usize + y * source.stride..][..cut.side];
        template.iter().zip(picture).map(|(&i, &j)| (u32::from(i), u32::from(j)))
    })
}

fn sum(cut: &Cut, source: Source<'_>, start: u32) -> Sums {
    pixels(cut, source, start, Rows::ALL).fold(Sums::default(), |sums, (i, j)| Sums {
        sum: sums.sum + j,
        squares: sums.squares + j * j,
        products: sums.products + i * j,
    })
}
