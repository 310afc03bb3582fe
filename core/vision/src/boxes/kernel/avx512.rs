//! The kernels of [`super`] with 512-bit vectors: a strip, 32 pixels, at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{Cut, LANES, ROWS_A_LOOK, Source, Strip, Sums};

/// See [`super::differences`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    for &start in starts {
        out.push(difference(cut, source, start, 0..cut.side));
    }
}

/// See [`super::least_differences`].
#[target_feature(enable = "avx512f,avx512bw")]
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
#[target_feature(enable = "avx512f,avx512bw")]
fn difference(cut: &Cut, source: Source<'_>, start: u32, rows: Range<usize>) -> u32 {
    let mut acc = _mm512_setzero_si512();
    for (i, strips) in cut.rows.chunks_exact(cut.side).enumerate() {
        let mask = mask(cut, i);
        for (y, template) in rows.clone().zip(&strips[rows.clone()]) {
            let (template, picture) =
                pixels(source, template, start as usize + y * source.stride + i * LANES, mask);
            let difference = _mm512_sub_epi16(picture, template);
            acc = _mm512_add_epi32(acc, _mm512_madd_epi16(difference, difference));
        }
    }
    _mm512_reduce_add_epi32(acc) as u32
}

/// See [`super::sums`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn sums(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<Sums>) {
    let ones = _mm512_set1_epi16(1);
    for &start in starts {
        let [mut sum, mut squares, mut products] = [_mm512_setzero_si512(); 3];
        for (i, strips) in cut.rows.chunks_exact(cut.side).enumerate() {
            let mask = mask(cut, i);
            for (y, template) in strips.iter().enumerate() {
                let (template, picture) =
                    pixels(source, template, start as usize + y * source.stride + i * LANES, mask);
                sum = _mm512_add_epi32(sum, _mm512_madd_epi16(picture, ones));
                squares = _mm512_add_epi32(squares, _mm512_madd_epi16(picture, picture));
                products = _mm512_add_epi32(products, _mm512_madd_epi16(picture, template));
            }
        }
        out.push(Sums {
            sum: _mm512_reduce_add_epi32(sum) as u32,
            squares: _mm512_reduce_add_epi32(squares) as u32,
            products: _mm512_reduce_add_epi32(products) as u32,
        });
    }
}

/// A bit for every pixel of a strip that counts.
#[inline]
fn mask(cut: &Cut, strip: usize) -> u32 {
    u32::MAX >> LANES.saturating_sub(cut.side - strip * LANES)
}

/// 32 pixels of a template and of the picture from a byte on, 0 where none counts.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn pixels(source: Source<'_>, Strip(template): &Strip, at: usize, mask: u32) -> (__m512i, __m512i) {
    debug_assert!(at + LANES <= source.data.len());
    // SAFETY: a strip is 64 bytes; that windows lie in the picture with whole vectors was asserted for the source.
    unsafe {
        let bytes = _mm256_loadu_si256(source.data.as_ptr().add(at).cast());
        (_mm512_loadu_si512(template.as_ptr().cast()), _mm512_maskz_cvtepu8_epi16(mask, bytes))
    }
}

/// See [`super::row_of_differences`]: 32 windows at a time, two of their pixels together.
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn row_of_differences(cut: &Cut, source: Source<'_>, start: usize, n: usize, out: &mut Vec<u32>) {
    for x in (0..n).step_by(LANES) {
        let [mut low, mut high] = [_mm512_setzero_si512(); 2];
        for (y, row) in cut.pixels.chunks_exact(cut.side).enumerate() {
            let at = start + y * source.stride + x;
            for (i, pair) in row.chunks(2).enumerate() {
                let first = apart(source, at + 2 * i, pair[0]);
                let second =
                    pair.get(1).map_or(_mm512_setzero_si512(), |&p| apart(source, at + 2 * i + 1, p));
                let [a, b] = [_mm512_unpacklo_epi16(first, second), _mm512_unpackhi_epi16(first, second)];
                low = _mm512_add_epi32(low, _mm512_madd_epi16(a, a));
                high = _mm512_add_epi32(high, _mm512_madd_epi16(b, b));
            }
        }
        let [mut lows, mut highs] = [[0_u32; LANES / 2]; 2];
        // SAFETY: each array is 64 bytes.
        unsafe {
            _mm512_storeu_si512(lows.as_mut_ptr().cast(), low);
            _mm512_storeu_si512(highs.as_mut_ptr().cast(), high);
        }
        // Of every eight windows, the first four are in the one, the others in the other.
        let mut all = [0; LANES];
        for ((eight, low), high) in
            all.chunks_exact_mut(8).zip(lows.chunks_exact(4)).zip(highs.chunks_exact(4))
        {
            eight[..4].copy_from_slice(low);
            eight[4..].copy_from_slice(high);
        }
        out.extend_from_slice(&all[..LANES.min(n - x)]);
    }
}

/// A pixel of the template taken off 32 pixels from a byte on.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn apart(source: Source<'_>, at: usize, pixel: u8) -> __m512i {
    debug_assert!(at + LANES <= source.data.len());
    // SAFETY: that the source holds windows up to the end of the last vector of them was asserted.
    let bytes = unsafe { _mm256_loadu_si256(source.data.as_ptr().add(at).cast()) };
    _mm512_sub_epi16(_mm512_cvtepu8_epi16(bytes), _mm512_set1_epi16(i16::from(pixel)))
}
