//! The kernels of [`super`] with 512-bit vectors: a strip, 32 pixels, at a time.

use std::arch::x86_64::*;

use super::vector::{self, Along, Vector};
use super::{Cut, LANES, Rows, Source, Strip, Sums, each_difference, least_difference};

impl Vector for __m512i {
    const N: usize = LANES;

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn zeros() -> Self {
        _mm512_setzero_si512()
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn ones() -> Self {
        _mm512_set1_epi16(1)
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn of(Strip(lanes): &Strip, lane: usize) -> Self {
        debug_assert_eq!(lane, 0);
        // SAFETY: a strip is 64 bytes.
        unsafe { _mm512_loadu_si512(lanes.as_ptr().cast()) }
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn under(source: Source<'_>, at: usize) -> Self {
        debug_assert!(at + LANES <= source.data.len());
        // SAFETY: that windows lie in the picture with whole vectors was asserted for the source.
        _mm512_cvtepu8_epi16(unsafe { _mm256_loadu_si256(source.data.as_ptr().add(at).cast()) })
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn and(self, mask: Self) -> Self {
        _mm512_and_si512(self, mask)
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn minus(self, other: Self) -> Self {
        _mm512_sub_epi16(self, other)
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn plus_products(self, a: Self, b: Self) -> Self {
        _mm512_add_epi32(self, _mm512_madd_epi16(a, b))
    }

    #[inline]
    #[target_feature(enable = "avx512f,avx512bw")]
    unsafe fn total(self) -> u32 {
        _mm512_reduce_add_epi32(self) as u32
    }
}

/// See [`super::differences`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    each_difference(&along(cut, source), starts, Rows::ALL, out);
}

/// See [`super::least_differences`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn least_differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    least_difference(cut.side, &along(cut, source), starts, out);
}

/// See [`super::sums`].
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn sums(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<Sums>) {
    // SAFETY: the processor has AVX-512.
    unsafe { vector::sums::<__m512i>(cut, source, starts, out) }
}

/// A template compared along rows.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
pub(super) fn along<'a>(cut: &'a Cut, source: Source<'a>) -> Along<'a, __m512i> {
    // SAFETY: the processor has AVX-512.
    unsafe { Along::new(cut, source) }
}
