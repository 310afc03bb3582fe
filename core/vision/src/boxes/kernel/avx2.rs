//! The kernels of [`super`] with 256-bit vectors: half a strip, 16 pixels, at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{Cut, LANES, ROWS_A_LOOK, Source, Sums};

const HALF: usize = LANES / 2;

/// See [`super::differences`].
#[target_feature(enable = "avx2")]
pub(super) fn differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    for &start in starts {
        out.push(difference(cut, source, start, 0..cut.side));
    }
}

/// See [`super::least_differences`].
#[target_feature(enable = "avx2")]
pub(super) fn least_differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    let mut least = u32::MAX;
    for &start in starts {
        let mut cost = 0;
        for first in (0..cut.side).step_by(ROWS_A_LOOK) {
            cost += difference(cut, source, start, first..cut.side.min(first + ROWS_A_LOOK));
            if cost > least {
                break;
            }
        }
        least = least.min(cost);
        out.push(cost);
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn difference(cut: &Cut, source: Source<'_>, start: u32, rows: Range<usize>) -> u32 {
    let mut acc = _mm256_setzero_si256();
    for x in (0..cut.side).step_by(HALF) {
        let mask = half(&cut.mask[x / LANES].0, x);
        for y in rows.clone() {
            let template = half(&cut.rows[x / LANES * cut.side + y].0, x);
            let picture = _mm256_and_si256(bytes(source, start as usize + y * source.stride + x), mask);
            let difference = _mm256_sub_epi16(picture, template);
            acc = _mm256_add_epi32(acc, _mm256_madd_epi16(difference, difference));
        }
    }
    total(acc)
}

/// See [`super::sums`].
#[target_feature(enable = "avx2")]
pub(super) fn sums(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<Sums>) {
    let ones = _mm256_set1_epi16(1);
    for &start in starts {
        let [mut sum, mut squares, mut products] = [_mm256_setzero_si256(); 3];
        for x in (0..cut.side).step_by(HALF) {
            let mask = half(&cut.mask[x / LANES].0, x);
            for y in 0..cut.side {
                let template = half(&cut.rows[x / LANES * cut.side + y].0, x);
                let picture = _mm256_and_si256(bytes(source, start as usize + y * source.stride + x), mask);
                sum = _mm256_add_epi32(sum, _mm256_madd_epi16(picture, ones));
                squares = _mm256_add_epi32(squares, _mm256_madd_epi16(picture, picture));
                products = _mm256_add_epi32(products, _mm256_madd_epi16(picture, template));
            }
        }
        out.push(Sums { sum: total(sum), squares: total(squares), products: total(products) });
    }
}

/// See [`super::row_of_differences`]: 16 windows at a time, two of their pixels together.
#[target_feature(enable = "avx2")]
pub(super) fn row_of_differences(cut: &Cut, source: Source<'_>, start: usize, n: usize, out: &mut Vec<u32>) {
    for x in (0..n).step_by(HALF) {
        let [mut low, mut high] = [_mm256_setzero_si256(); 2];
        for (y, row) in cut.pixels.chunks_exact(cut.side).enumerate() {
            let at = start + y * source.stride + x;
            for (i, pair) in row.chunks(2).enumerate() {
                let first = apart(source, at + 2 * i, pair[0]);
                let second =
                    pair.get(1).map_or(_mm256_setzero_si256(), |&p| apart(source, at + 2 * i + 1, p));
                let [a, b] = [_mm256_unpacklo_epi16(first, second), _mm256_unpackhi_epi16(first, second)];
                low = _mm256_add_epi32(low, _mm256_madd_epi16(a, a));
                high = _mm256_add_epi32(high, _mm256_madd_epi16(b, b));
            }
        }
        let [mut lows, mut highs] = [[0_u32; HALF / 2]; 2];
        // SAFETY: each array is 32 bytes.
        unsafe {
            _mm256_storeu_si256(lows.as_mut_ptr().cast(), low);
            _mm256_storeu_si256(highs.as_mut_ptr().cast(), high);
        }
        // Of every eight windows, the first four are in the one, the others in the other.
        let mut all = [0; HALF];
        for ((eight, low), high) in
            all.chunks_exact_mut(8).zip(lows.chunks_exact(4)).zip(highs.chunks_exact(4))
        {
            eight[..4].copy_from_slice(low);
            eight[4..].copy_from_slice(high);
        }
        out.extend_from_slice(&all[..HALF.min(n - x)]);
    }
}

/// A pixel of the template taken off 16 pixels from a byte on.
#[inline]
#[target_feature(enable = "avx2")]
fn apart(source: Source<'_>, at: usize, pixel: u8) -> __m256i {
    _mm256_sub_epi16(bytes(source, at), _mm256_set1_epi16(i16::from(pixel)))
}

/// 16 pixels from a byte on.
#[inline]
#[target_feature(enable = "avx2")]
fn bytes(source: Source<'_>, at: usize) -> __m256i {
    debug_assert!(at + HALF <= source.data.len());
    // SAFETY: that windows lie in the picture, vectors of whole strips included, was asserted for the source.
    _mm256_cvtepu8_epi16(unsafe { _mm_loadu_si128(source.data.as_ptr().add(at).cast()) })
}

/// The half of a strip that a column is in.
#[inline]
#[target_feature(enable = "avx2")]
fn half(lanes: &[i16; LANES], x: usize) -> __m256i {
    // SAFETY: either half is 32 bytes.
    unsafe { _mm256_loadu_si256(lanes.as_ptr().add(x % LANES / HALF * HALF).cast()) }
}

/// Sum of eight 32-bit lanes.
#[inline]
#[target_feature(enable = "avx2")]
fn total(v: __m256i) -> u32 {
    let four = _mm_add_epi32(_mm256_castsi256_si128(v), _mm256_extracti128_si256::<1>(v));
    let two = _mm_add_epi32(four, _mm_unpackhi_epi64(four, four));
    let one = _mm_add_epi32(two, _mm_shuffle_epi32::<1>(two));
    _mm_cvtsi128_si32(one) as u32
}
