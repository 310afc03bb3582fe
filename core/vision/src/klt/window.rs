//! The inner loops of the tracker: cut a window from a picture, and compare another picture with it.
//!
//! Fixed point: brightness has 5 fractional bits (0..=8160), a position 15, gradients are Scharr's with weights
//! `(3, 10, 3)` (32 times gray levels per pixel, |g| <= 4080). Products of two are rounded as `(a * b + 2¹⁴) >> 15`,
//! which x86 has as one instruction; sums are exact. So the plain kernel here and the fast ones in
//! [`avx2`] and [`avx512`] agree bit for bit, and this file is the one to read.

#![allow(unsafe_code, reason = "calls kernels that need an instruction set")]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::Corner;
use crate::pyramid::Level;
use crate::simd::{self, Set};

/// Pixels in a block: one 512-bit vector of 16-bit numbers.
const LANES: usize = 32;
/// Fractional bits of brightness.
const BITS: u32 = 5;
/// Scharr's weights, with the division by 2⁵ that brings brightness differences to gradient units: `3/32`, `10/32`
/// in 2¹⁵ths.
const SIDE_WEIGHT: i16 = 3 << 10;
const MIDDLE_WEIGHT: i16 = 10 << 10;
/// Rows whose sums fit 32 bits in each lane: `32 · 2 · 8160 · 4080 < 2³¹`.
const ROWS_A_SUM: usize = 32;

/// Sums of products of gradients over a window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    pub(super) xx: i64,
    pub(super) xy: i64,
    pub(super) yy: i64,
}

/// Up to 32 neighbouring pixels of a window. Lanes beyond the window have no gradient, so they never count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(64))]
struct Block {
    value: [i16; LANES],
    dx: [i16; LANES],
    dy: [i16; LANES],
}

const BLANK: Block = Block { value: [0; LANES], dx: [0; LANES], dy: [0; LANES] };

/// 32 lanes of all ones or zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C, align(64))]
struct Mask([i16; LANES]);

/// The two inner loops, as compiled for one instruction set; to call them, the processor must have it.
#[derive(Clone, Copy, Debug)]
struct Kernel {
    cut: unsafe fn(&mut Window, Source<'_>, Range<usize>) -> Sums,
    mismatch: unsafe fn(&mut Window, Source<'_>) -> [i64; 2],
}

impl Kernel {
    fn of(level: simd::Level) -> Self {
        match level.set() {
            Set::Scalar => Self { cut: Window::cut_plainly, mismatch: Window::mismatch_plainly },
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => Self { cut: avx2::cut, mismatch: avx2::mismatch },
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => Self { cut: avx512::cut, mismatch: avx512::mismatch },
        }
    }
}

/// A window cut from a picture: brightness and gradients.
#[derive(Debug)]
pub(super) struct Window {
    kernel: Kernel,
    side: usize,
    /// `(side, strips)`, row-major.
    blocks: Vec<Block>,
    /// Blocks in a row.
    strips: usize,
    /// Brightness of the window and one pixel around it, and a row more to work in: `(side + 3, patch_stride)`.
    patch: Vec<i16>,
    patch_stride: usize,
    /// Which columns lie on the picture, `(strips)`.
    mask: Vec<Mask>,
}

impl Window {
    pub(super) fn new(level: simd::Level, radius_px: u32) -> Self {
        let side = 2 * radius_px as usize + 1;
        let strips = side.div_ceil(LANES);
        // A strip's three columns of neighbours end two pixels behind it.
        let patch_stride = (side + 2).div_ceil(LANES) * LANES + LANES;
        Self {
            kernel: Kernel::of(level),
            side,
            blocks: vec![BLANK; side * strips],
            strips,
            patch: vec![0; (side + 3) * patch_stride],
            patch_stride,
            mask: vec![Mask([0; LANES]); strips],
        }
    }

    /// Takes the window at a corner; returns the sums of its gradients.
    ///
    /// Pixels beyond the picture keep their mirrored brightness but have no gradient: they say nothing.
    pub(super) fn cut(&mut self, level: &Level, corner: Corner) -> Sums {
        let columns = inside(corner.x, corner.fraction[0], self.side, level.width());
        let rows = inside(corner.y, corner.fraction[1], self.side, level.height());
        for (strip, mask) in self.mask.iter_mut().enumerate() {
            for (lane, bits) in mask.0.iter_mut().enumerate() {
                *bits = -i16::from(columns.contains(&(strip * LANES + lane)));
            }
        }
        self.blocks[..rows.start * self.strips].fill(BLANK);
        self.blocks[rows.end * self.strips..].fill(BLANK);
        let picture = Source::at(level, corner.x - 1, corner.y - 1, corner.fraction);
        // SAFETY: the level that made this window says that the processor has what its kernel needs.
        unsafe { (self.kernel.cut)(self, picture, rows) }
    }

    /// Sums of mismatch times gradient, `Σ (J - I) (I_x, I_y)`, with the other picture's window at a corner.
    pub(super) fn mismatch(&mut self, level: &Level, corner: Corner) -> [i64; 2] {
        let picture = Source::at(level, corner.x, corner.y, corner.fraction);
        // SAFETY: as in `cut`.
        unsafe { (self.kernel.mismatch)(self, picture) }
    }

    fn cut_plainly(&mut self, picture: Source<'_>, rows: Range<usize>) -> Sums {
        self.interpolate(picture, self.side + 2);
        self.differentiate(rows)
    }

    /// Brightness of `n` by `n` pixels, filled up to whole blocks, from the start of a picture on into the patch:
    /// linear along the rows, then between them.
    fn interpolate(&mut self, picture: Source<'_>, n: usize) {
        let stride = self.patch_stride;
        let [fx, fy] = picture.fraction;
        let width = n.next_multiple_of(LANES);
        for (y, row) in self.patch.chunks_exact_mut(stride).enumerate().take(n + 1) {
            let bytes = &picture.bytes[y * picture.stride..][..=width];
            for ((value, left), right) in row.iter_mut().zip(bytes).zip(&bytes[1..]) {
                let [left, right] = [left, right].map(|byte| i16::from(*byte) << BITS);
                *value = left + scaled(right - left, fx);
            }
        }
        for y in 0..n {
            let (upper, lower) = self.patch[y * stride..].split_at_mut(stride);
            for (upper, lower) in upper[..width].iter_mut().zip(lower) {
                *upper += scaled(*lower - *upper, fy);
            }
        }
    }

    /// Brightness and gradients of the window from the patch.
    fn differentiate(&mut self, rows: Range<usize>) -> Sums {
        let slope = |side: i16, middle: i16| scaled(side, SIDE_WEIGHT) + scaled(middle, MIDDLE_WEIGHT);
        let mut sums = Sums::default();
        for y in rows {
            let blocks = &mut self.blocks[y * self.strips..][..self.strips];
            for (strip, (block, mask)) in blocks.iter_mut().zip(&self.mask).enumerate() {
                let row =
                    |dy: usize| &self.patch[(y + dy) * self.patch_stride + strip * LANES..][..LANES + 2];
                let (above, here, below) = (row(0), row(1), row(2));
                // 32 squares of at most 4080 fit 32 bits.
                let mut few = [0_i32; 3];
                for (i, on) in mask.0.iter().enumerate() {
                    let across = |row: &[i16]| row[i + 2] - row[i];
                    let down = |dx: usize| below[i + dx] - above[i + dx];
                    let dx = on & slope(across(above) + across(below), across(here));
                    let dy = on & slope(down(0) + down(2), down(1));
                    (block.value[i], block.dx[i], block.dy[i]) = (here[i + 1], dx, dy);
                    let (dx, dy) = (i32::from(dx), i32::from(dy));
                    few = [few[0] + dx * dx, few[1] + dx * dy, few[2] + dy * dy];
                }
                let [xx, xy, yy] = few.map(i64::from);
                sums = Sums { xx: sums.xx + xx, xy: sums.xy + xy, yy: sums.yy + yy };
            }
        }
        sums
    }

    fn mismatch_plainly(&mut self, picture: Source<'_>) -> [i64; 2] {
        self.interpolate(picture, self.side);
        let mut sums = [0; 2];
        for (row, blocks) in
            self.patch.chunks_exact(self.patch_stride).zip(self.blocks.chunks_exact(self.strips))
        {
            for (values, block) in row.chunks_exact(LANES).zip(blocks) {
                // 32 products of at most 8160 · 4080 fit 32 bits.
                let mut few = [0_i32; 2];
                for (i, value) in values.iter().enumerate() {
                    let difference = i32::from(value - block.value[i]);
                    few[0] += difference * i32::from(block.dx[i]);
                    few[1] += difference * i32::from(block.dy[i]);
                }
                sums[0] += i64::from(few[0]);
                sums[1] += i64::from(few[1]);
            }
        }
        sums
    }
}

/// Which of `side` positions, from `start + fraction` on, lie between the outermost of `n` pixel centres.
fn inside(start: i32, fraction: i16, side: usize, n: u32) -> Range<usize> {
    let first = (-start).max(0) as usize;
    // With a fraction, the last position that counts lies before the last pixel centre.
    let end = i64::from(n) - i64::from(start) - i64::from(fraction > 0);
    let end = end.clamp(0, side as i64) as usize;
    first.min(end)..end
}

/// A picture from some pixel on, and how far between the pixels to look.
#[derive(Clone, Copy)]
struct Source<'a> {
    bytes: &'a [u8],
    stride: usize,
    fraction: [i16; 2],
}

impl<'a> Source<'a> {
    fn at(level: &'a Level, x: i32, y: i32, fraction: [i16; 2]) -> Self {
        Self { bytes: level.bytes_from(x, y), stride: level.stride(), fraction }
    }

    /// Whether reading `rows` rows of `columns` bytes stays within the picture's memory.
    #[cfg(target_arch = "x86_64")]
    fn covers(&self, rows: usize, columns: usize) -> bool {
        (rows - 1) * self.stride + columns <= self.bytes.len()
    }
}

/// `a * b / 2¹⁵`, rounded.
fn scaled(a: i16, b: i16) -> i16 {
    ((i32::from(a) * i32::from(b) + (1 << 14)) >> 15) as i16
}
