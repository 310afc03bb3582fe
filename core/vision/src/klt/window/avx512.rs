//! The kernels of [`super`] with 512-bit vectors: a strip of 32 pixels at a time.
#![allow(unsafe_code, reason = "loads and stores through pointers; every range is asserted at entry")]

use std::arch::x86_64::*;
use std::ops::Range;

use super::{BITS, LANES, MIDDLE_WEIGHT, ROWS_A_SUM, SIDE_WEIGHT, Source, Sums, Window};

/// Fills a window from a picture; see [`Window::cut`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn cut(window: &mut Window, picture: Source<'_>, rows: Range<usize>) -> Sums {
    interpolate(window, picture);
    differentiate(window, rows)
}

#[target_feature(enable = "avx512f,avx512bw")]
fn interpolate(window: &mut Window, picture: Source<'_>) {
    let rows = window.side + 2;
    let width = rows.div_ceil(LANES) * LANES;
    assert!(picture.covers(rows + 1, width + 1), "picture too small for its window");
    assert!(width <= window.patch_stride && rows * window.patch_stride <= window.patch.len());
    let [fx, fy] = picture.fraction.map(|f| _mm512_set1_epi16(f));
    for x in (0..width).step_by(LANES) {
        // SAFETY: `covers` was asserted for `rows + 1` rows of `width + 1` bytes, and `x + LANES <= width`.
        let mut upper = unsafe { row(picture.bytes.as_ptr().add(x), fx) };
        for y in 0..rows {
            // SAFETY: as above; `y + 1 <= rows`.
            let lower = unsafe { row(picture.bytes.as_ptr().add((y + 1) * picture.stride + x), fx) };
            let value = _mm512_add_epi16(upper, _mm512_mulhrs_epi16(_mm512_sub_epi16(lower, upper), fy));
            // SAFETY: row `y < rows` of the patch has `patch_stride >= width` numbers.
            unsafe {
                let out = window.patch.as_mut_ptr().add(y * window.patch_stride + x);
                _mm512_storeu_si512(out.cast(), value);
            }
            upper = lower;
        }
    }
}

#[target_feature(enable = "avx512f,avx512bw")]
fn differentiate(window: &mut Window, rows: Range<usize>) -> Sums {
    let stride = window.patch_stride;
    assert!(rows.end <= window.side && window.strips * LANES + 2 <= stride);
    assert!((window.side + 2) * stride <= window.patch.len());
    let mut sums = Sums::default();
    for strip in 0..window.strips {
        let on = load(&window.mask[strip].0);
        let patch = window.patch.as_ptr();
        // SAFETY: rows up to `side + 1` of the patch, and `strips * LANES + 2` of their numbers, exist.
        let three = |y: usize| unsafe {
            let at = patch.add(y * stride + strip * LANES);
            [0, 1, 2].map(|dx| _mm512_loadu_si512(at.add(dx).cast()))
        };
        for start in rows.clone().step_by(ROWS_A_SUM) {
            let (mut above, mut here) = (three(start), three(start + 1));
            let mut acc = [_mm512_setzero_si512(); 3];
            for y in start..rows.end.min(start + ROWS_A_SUM) {
                let below = three(y + 2);
                let across = |[left, _, right]: [__m512i; 3]| _mm512_sub_epi16(right, left);
                let down = |i: usize| _mm512_sub_epi16(below[i], above[i]);
                let dx = slope(_mm512_add_epi16(across(above), across(below)), across(here));
                let dy = slope(_mm512_add_epi16(down(0), down(2)), down(1));
                let (dx, dy) = (_mm512_and_si512(dx, on), _mm512_and_si512(dy, on));
                let block = &mut window.blocks[y * window.strips + strip];
                store(&mut block.value, here[1]);
                store(&mut block.dx, dx);
                store(&mut block.dy, dy);
                acc[0] = _mm512_add_epi32(acc[0], _mm512_madd_epi16(dx, dx));
                acc[1] = _mm512_add_epi32(acc[1], _mm512_madd_epi16(dx, dy));
                acc[2] = _mm512_add_epi32(acc[2], _mm512_madd_epi16(dy, dy));
                (above, here) = (here, below);
            }
            sums.xx += total(acc[0]);
            sums.xy += total(acc[1]);
            sums.yy += total(acc[2]);
        }
    }
    sums
}

/// Compares a picture with a window; see [`Window::mismatch`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn mismatch(window: &mut Window, picture: Source<'_>) -> [i64; 2] {
    let Window { side, strips, .. } = *window;
    assert!(picture.covers(side + 1, strips * LANES + 1), "picture too small for its window");
    let [fx, fy] = picture.fraction.map(|f| _mm512_set1_epi16(f));
    let mut sums = [0; 2];
    for strip in 0..strips {
        let column = picture.bytes.as_ptr().wrapping_add(strip * LANES);
        // SAFETY: `covers` was asserted for `side + 1` rows of `strips * LANES + 1` bytes.
        let mut upper = unsafe { row(column, fx) };
        for start in (0..side).step_by(ROWS_A_SUM) {
            let mut acc = [_mm512_setzero_si512(); 2];
            for y in start..side.min(start + ROWS_A_SUM) {
                // SAFETY: as above; `y + 1 <= side`.
                let lower = unsafe { row(column.add((y + 1) * picture.stride), fx) };
                let value = _mm512_add_epi16(upper, _mm512_mulhrs_epi16(_mm512_sub_epi16(lower, upper), fy));
                let block = &window.blocks[y * strips + strip];
                let difference = _mm512_sub_epi16(value, load(&block.value));
                acc[0] = _mm512_add_epi32(acc[0], _mm512_madd_epi16(difference, load(&block.dx)));
                acc[1] = _mm512_add_epi32(acc[1], _mm512_madd_epi16(difference, load(&block.dy)));
                upper = lower;
            }
            sums[0] += total(acc[0]);
            sums[1] += total(acc[1]);
        }
    }
    sums
}

/// 32 pixels between their left and right neighbours.
///
/// # Safety
/// `LANES + 1` bytes from `at` on are readable.
#[target_feature(enable = "avx512f,avx512bw")]
unsafe fn row(at: *const u8, fx: __m512i) -> __m512i {
    // SAFETY: the caller's.
    let bytes = unsafe { [_mm256_loadu_si256(at.cast()), _mm256_loadu_si256(at.add(1).cast())] };
    let [left, right] = bytes.map(|b| _mm512_slli_epi16::<BITS>(_mm512_cvtepu8_epi16(b)));
    _mm512_add_epi16(left, _mm512_mulhrs_epi16(_mm512_sub_epi16(right, left), fx))
}

#[target_feature(enable = "avx512f,avx512bw")]
fn slope(side: __m512i, middle: __m512i) -> __m512i {
    _mm512_add_epi16(
        _mm512_mulhrs_epi16(side, _mm512_set1_epi16(SIDE_WEIGHT)),
        _mm512_mulhrs_epi16(middle, _mm512_set1_epi16(MIDDLE_WEIGHT)),
    )
}

#[target_feature(enable = "avx512f")]
fn load(lanes: &[i16; LANES]) -> __m512i {
    // SAFETY: the array is 64 bytes.
    unsafe { _mm512_loadu_si512(lanes.as_ptr().cast()) }
}

#[target_feature(enable = "avx512f")]
fn store(lanes: &mut [i16; LANES], value: __m512i) {
    // SAFETY: the array is 64 bytes.
    unsafe { _mm512_storeu_si512(lanes.as_mut_ptr().cast(), value) }
}

/// Sum of sixteen 32-bit lanes in 64 bits.
#[target_feature(enable = "avx512f")]
fn total(v: __m512i) -> i64 {
    let low = _mm512_cvtepi32_epi64(_mm512_castsi512_si256(v));
    let high = _mm512_cvtepi32_epi64(_mm512_extracti64x4_epi64::<1>(v));
    _mm512_reduce_add_epi64(_mm512_add_epi64(low, high))
}
