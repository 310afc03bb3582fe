//! The kernels of [`super`] with 256-bit vectors: half a strip, 16 pixels, at a time.

use std::arch::x86_64::*;
use std::ops::Range;

use super::{Cut, FEW, LANES, ROWS_A_LOOK, Source, Sums};

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

/// See [`super::all_differences`]: 16 windows of two rows at a time, two of their pixels together.
///
/// A 32-bit lane holds two neighbours. Read from the first pixel on, lanes belong to the windows 0, 2, 4...; from the
/// second on, to the others.
#[target_feature(enable = "avx2")]
pub(super) fn all_differences(
    cut: &Cut,
    source: Source<'_>,
    start: usize,
    [columns, rows]: [usize; 2],
    out: &mut [u32],
) {
    let mut squares = Vec::with_capacity(rows + cut.side);
    for x in (0..columns).step_by(HALF) {
        let n = (columns - x).min(HALF);
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
                let even = _mm256_sub_epi32(squares[y][0], _mm256_slli_epi32::<1>(even));
                let odd = _mm256_sub_epi32(squares[y][1], _mm256_slli_epi32::<1>(odd));
                out[y * columns + x..][..n].copy_from_slice(&in_turn(even, odd)[..n]);
            }
        }
    }
}

/// `Σ I² + Σ J²` of the windows that start here, and of those in the rows beneath; what is behind them is left over.
#[inline]
#[target_feature(enable = "avx2")]
fn sum_squares(cut: &Cut, source: Source<'_>, at: usize, rows: usize, squares: &mut Vec<[__m256i; 2]>) {
    let mut sums = [_mm256_set1_epi32(cut.squares as i32); 2];
    squares.clear();
    for y in 0..rows + cut.side - 1 {
        let mut row = [_mm256_setzero_si256(); 2];
        for x in (0..cut.side).step_by(2) {
            // Of the last pair of an odd side only the left one counts.
            let counts = _mm256_set1_epi32(if x + 1 < cut.side { -1 } else { 0xffff });
            for (i, sum) in row.iter_mut().enumerate() {
                let pair = _mm256_and_si256(bytes(source, at + y * source.stride + x + i), counts);
                *sum = _mm256_add_epi32(*sum, _mm256_madd_epi16(pair, pair));
            }
        }
        squares.push(row);
        for i in 0..2 {
            sums[i] = _mm256_add_epi32(sums[i], row[i]);
            if y + 1 >= cut.side {
                // A window is whole; its first row leaves.
                let first = std::mem::replace(&mut squares[y + 1 - cut.side][i], sums[i]);
                sums[i] = _mm256_sub_epi32(sums[i], first);
            }
        }
    }
}

/// `Σ I J` of the windows that start here, and of those a row beneath.
#[inline]
#[target_feature(enable = "avx2")]
fn products(cut: &Cut, source: Source<'_>, at: usize) -> [[__m256i; 2]; 2] {
    let mut sums = [[_mm256_setzero_si256(); 2]; 2];
    let n = cut.side.div_ceil(2);
    for y in 0..=cut.side {
        // The picture's row lies under one of the template's, and in the lower window under the one before.
        let (upper, lower) = (&cut.pairs[(y + 1) * n..][..n], &cut.pairs[y * n..][..n]);
        let at = at + y * source.stride;
        for i in 0..n {
            let (upper, lower) = (_mm256_set1_epi32(upper[i]), _mm256_set1_epi32(lower[i]));
            let (even, odd) = (bytes(source, at + 2 * i), bytes(source, at + 2 * i + 1));
            sums[0][0] = _mm256_add_epi32(sums[0][0], _mm256_madd_epi16(even, upper));
            sums[0][1] = _mm256_add_epi32(sums[0][1], _mm256_madd_epi16(odd, upper));
            sums[1][0] = _mm256_add_epi32(sums[1][0], _mm256_madd_epi16(even, lower));
            sums[1][1] = _mm256_add_epi32(sums[1][1], _mm256_madd_epi16(odd, lower));
        }
    }
    sums
}

/// Costs in the order of their windows, of even ones and odd ones.
#[inline]
#[target_feature(enable = "avx2")]
fn in_turn(even: __m256i, odd: __m256i) -> [u32; HALF] {
    let [low, high] = [_mm256_unpacklo_epi32(even, odd), _mm256_unpackhi_epi32(even, odd)];
    let mut all = [0; HALF];
    // SAFETY: either half is 32 bytes.
    unsafe {
        _mm256_storeu_si256(all.as_mut_ptr().cast(), _mm256_permute2x128_si256::<0x20>(low, high));
        _mm256_storeu_si256(
            all[HALF / 2..].as_mut_ptr().cast(),
            _mm256_permute2x128_si256::<0x31>(low, high),
        );
    }
    all
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
