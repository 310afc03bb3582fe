//! The kernels of [`super`] with 512-bit vectors: a strip, 32 pixels, at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{Cut, FEW, LANES, ROWS_A_LOOK, Source, Strip, Sums};

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

#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn difference(cut: &Cut, source: Source<'_>, start: u32, rows: Range<usize>) -> u32 {
    let mut acc = _mm512_setzero_si512();
    for i in 0..cut.mask.len() {
        let strips = &cut.rows[i * cut.side..][..cut.side];
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
        for i in 0..cut.mask.len() {
            let strips = &cut.rows[i * cut.side..][..cut.side];
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

/// See [`super::all_differences`]: 32 windows of two rows at a time, two of their pixels together.
///
/// A 32-bit lane holds two neighbours. Read from the first pixel on, lanes belong to the windows 0, 2, 4...; from the
/// second on, to the others.
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn all_differences(
    cut: &Cut,
    source: Source<'_>,
    start: usize,
    [columns, rows]: [usize; 2],
    out: &mut [u32],
) {
    let mut squares = Vec::with_capacity(rows + cut.side);
    for x in (0..columns).step_by(LANES) {
        let n = (columns - x).min(LANES);
        if n <= FEW || rows < 2 {
            for y in 0..rows {
                for x in x..x + n {
                    let start = (start + y * source.stride + x) as u32;
                    out[y * columns + x] = difference(cut, source, start, 0..cut.side);
                }
            }
            continue;
        }
        sum_squares(cut, source, start + x, rows, &mut squares);
        for y in (0..rows).step_by(2) {
            // Of an odd number of rows the last but one is done twice.
            let y = y.min(rows - 2);
            let products = products(cut, source, start + y * source.stride + x);
            for (y, [even, odd]) in (y..).zip(products) {
                let even = _mm512_sub_epi32(squares[y][0], _mm512_slli_epi32::<1>(even));
                let odd = _mm512_sub_epi32(squares[y][1], _mm512_slli_epi32::<1>(odd));
                out[y * columns + x..][..n].copy_from_slice(&in_turn(even, odd)[..n]);
            }
        }
    }
}

/// `Σ I² + Σ J²` of the windows that start here, and of those in the rows beneath; what is behind them is left over.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn sum_squares(cut: &Cut, source: Source<'_>, at: usize, rows: usize, squares: &mut Vec<[__m512i; 2]>) {
    let mut sums = [_mm512_set1_epi32(cut.squares as i32); 2];
    squares.clear();
    for y in 0..rows + cut.side - 1 {
        let mut row = [_mm512_setzero_si512(); 2];
        for x in (0..cut.side).step_by(2) {
            // Of the last pair of an odd side only the left one counts.
            let counts = _mm512_set1_epi32(if x + 1 < cut.side { -1 } else { 0xffff });
            for (i, sum) in row.iter_mut().enumerate() {
                let pair = _mm512_and_si512(bytes(source, at + y * source.stride + x + i), counts);
                *sum = _mm512_add_epi32(*sum, _mm512_madd_epi16(pair, pair));
            }
        }
        squares.push(row);
        for i in 0..2 {
            sums[i] = _mm512_add_epi32(sums[i], row[i]);
            if y + 1 >= cut.side {
                // A window is whole; its first row leaves.
                let first = std::mem::replace(&mut squares[y + 1 - cut.side][i], sums[i]);
                sums[i] = _mm512_sub_epi32(sums[i], first);
            }
        }
    }
}

/// `Σ I J` of the windows that start here, and of those a row beneath.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn products(cut: &Cut, source: Source<'_>, at: usize) -> [[__m512i; 2]; 2] {
    let mut sums = [[_mm512_setzero_si512(); 2]; 2];
    let n = cut.side.div_ceil(2);
    for y in 0..=cut.side {
        // The picture's row lies under one of the template's, and in the lower window under the one before.
        let (upper, lower) = (&cut.pairs[(y + 1) * n..][..n], &cut.pairs[y * n..][..n]);
        let at = at + y * source.stride;
        for i in 0..n {
            let (upper, lower) = (_mm512_set1_epi32(upper[i]), _mm512_set1_epi32(lower[i]));
            let (even, odd) = (bytes(source, at + 2 * i), bytes(source, at + 2 * i + 1));
            sums[0][0] = _mm512_add_epi32(sums[0][0], _mm512_madd_epi16(even, upper));
            sums[0][1] = _mm512_add_epi32(sums[0][1], _mm512_madd_epi16(odd, upper));
            sums[1][0] = _mm512_add_epi32(sums[1][0], _mm512_madd_epi16(even, lower));
            sums[1][1] = _mm512_add_epi32(sums[1][1], _mm512_madd_epi16(odd, lower));
        }
    }
    sums
}

/// Costs in the order of their windows, of even ones and odd ones.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn in_turn(even: __m512i, odd: __m512i) -> [u32; LANES] {
    let first = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    let second = _mm512_add_epi32(first, _mm512_set1_epi32(8));
    let mut all = [0; LANES];
    // SAFETY: either half is 64 bytes.
    unsafe {
        _mm512_storeu_si512(all.as_mut_ptr().cast(), _mm512_permutex2var_epi32(even, first, odd));
        _mm512_storeu_si512(
            all[LANES / 2..].as_mut_ptr().cast(),
            _mm512_permutex2var_epi32(even, second, odd),
        );
    }
    all
}

/// 32 pixels from a byte on.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn bytes(source: Source<'_>, at: usize) -> __m512i {
    debug_assert!(at + LANES <= source.data.len());
    // SAFETY: that the source holds windows up to the end of the last vector of them was asserted.
    _mm512_cvtepu8_epi16(unsafe { _mm256_loadu_si256(source.data.as_ptr().add(at).cast()) })
}
