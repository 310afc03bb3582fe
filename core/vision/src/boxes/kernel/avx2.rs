//! The kernels of [`super`] with 256-bit vectors: half a strip, 16 pixels, at a time.

use std::arch::x86_64::*;

use super::beside::{self, Beside, Block, Memory};
use super::vector::{self, Along, Vector};
use super::{Cut, LANES, Rows, Source, Strip, Sums, Windows, each_difference, least_difference};

const HALF: usize = LANES / 2;

impl Vector for __m256i {
    const N: usize = HALF;

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn zeros() -> Self {
        _mm256_setzero_si256()
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn ones() -> Self {
        _mm256_set1_epi16(1)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn of(Strip(lanes): &Strip, lane: usize) -> Self {
        debug_assert!(lane + HALF <= LANES);
        // SAFETY: either half of a strip is 32 bytes.
        unsafe { _mm256_loadu_si256(lanes.as_ptr().add(lane).cast()) }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn under(source: Source<'_>, at: usize) -> Self {
        debug_assert!(at + HALF <= source.data.len());
        // SAFETY: that windows lie in the picture, vectors of whole strips included, was asserted for the source.
        _mm256_cvtepu8_epi16(unsafe { _mm_loadu_si128(source.data.as_ptr().add(at).cast()) })
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn and(self, mask: Self) -> Self {
        _mm256_and_si256(self, mask)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn minus(self, other: Self) -> Self {
        _mm256_sub_epi16(self, other)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn plus_products(self, a: Self, b: Self) -> Self {
        _mm256_add_epi32(self, _mm256_madd_epi16(a, b))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn total(self) -> u32 {
        let four = _mm_add_epi32(_mm256_castsi256_si128(self), _mm256_extracti128_si256::<1>(self));
        let two = _mm_add_epi32(four, _mm_unpackhi_epi64(four, four));
        let one = _mm_add_epi32(two, _mm_shuffle_epi32::<1>(two));
        _mm_cvtsi128_si32(one) as u32
    }
}

/// See [`super::differences`].
#[target_feature(enable = "avx2")]
pub(super) fn differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    each_difference(&along(cut, source), starts, Rows::ALL, out);
}

/// See [`super::least_differences`].
#[target_feature(enable = "avx2")]
pub(super) fn least_differences(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<u32>) {
    least_difference(cut.side, &along(cut, source), starts, out);
}

/// See [`super::sums`].
#[target_feature(enable = "avx2")]
pub(super) fn sums(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<Sums>) {
    // SAFETY: the processor has AVX2.
    unsafe { vector::sums::<__m256i>(cut, source, starts, out) }
}

/// See [`super::all_differences`].
#[target_feature(enable = "avx2")]
pub(super) fn all_differences(cut: &Cut, block: &Block<'_>, memory: &mut Memory, out: &mut [u32]) {
    block.all(cut.side, &Pairs(along(cut, block.source)), memory, out);
}

#[inline]
#[target_feature(enable = "avx2")]
fn along<'a>(cut: &'a Cut, source: Source<'a>) -> Along<'a, __m256i> {
    // SAFETY: the processor has AVX2.
    unsafe { Along::new(cut, source) }
}

/// 16 windows at a time, and two of their pixels together.
///
/// A 32-bit lane holds two neighbours. Read from the first pixel on, lanes belong to the windows 0, 2, 4...; from the
/// second on, to the others.
struct Pairs<'a>(Along<'a, __m256i>);

impl Windows for Pairs<'_> {
    #[inline(always)]
    fn difference(&self, start: u32, rows: Rows) -> u32 {
        self.0.difference(start, rows)
    }
}

impl Beside<HALF> for Pairs<'_> {
    #[inline(always)]
    fn own(&self) -> u32 {
        self.0.cut.squares
    }

    #[inline(always)]
    fn n_strips(&self) -> usize {
        self.0.cut.side.next_multiple_of(2)
    }

    #[inline(always)]
    fn take(&self, at: usize, beneath: usize, strips: &mut [Strip]) -> beside::Halves<HALF> {
        let Along { cut, source, .. } = self.0;
        // SAFETY: what is compared along rows with AVX2 is the proof that the processor has it.
        [(at, 0), (at + beneath, HALF)].map(|(at, lane)| unsafe { take(cut.side, source, at, strips, lane) })
    }

    #[inline(always)]
    fn products(&self, strips: &[Strip]) -> [beside::Halves<HALF>; 2] {
        // SAFETY: as above.
        let [[a, b], [c, d]] = [0, HALF].map(|lane| unsafe { products(self.0.cut, strips, lane) });
        [[a, c], [b, d]]
    }

    #[inline(always)]
    fn in_turn(&self, sums: beside::Halves<HALF>) -> beside::Halves<HALF> {
        sums.map(|sums| std::array::from_fn(|i| sums[i % 2 * HALF / 2 + i / 2]))
    }
}

/// See [`Beside::take`], for one of the halves, which begins at a lane.
#[inline]
#[target_feature(enable = "avx2")]
fn take(side: usize, source: Source<'_>, at: usize, strips: &mut [Strip], lane: usize) -> [u32; HALF] {
    let mut sums = [_mm256_setzero_si256(); 2];
    for (strips, x) in strips.as_chunks_mut::<2>().0.iter_mut().zip((0..).step_by(2)) {
        // Of the last pair of an odd side only the left one counts.
        let counts = _mm256_set1_epi32(if x + 1 < side { -1 } else { 0xffff });
        for (i, sum) in sums.iter_mut().enumerate() {
            // SAFETY: the processor has AVX2; half a strip is 32 bytes.
            let pixels = unsafe {
                let pixels = __m256i::under(source, at + x + i);
                _mm256_storeu_si256(strips[i].0[lane..][..HALF].as_mut_ptr().cast(), pixels);
                pixels
            };
            let pixels = _mm256_and_si256(pixels, counts);
            *sum = _mm256_add_epi32(*sum, _mm256_madd_epi16(pixels, pixels));
        }
    }
    stored(sums)
}

/// See [`Beside::products`], for one of the halves.
#[inline]
#[target_feature(enable = "avx2")]
fn products(cut: &Cut, strips: &[Strip], lane: usize) -> [[u32; HALF]; 2] {
    let mut sums = [[_mm256_setzero_si256(); 2]; 2];
    let n = cut.side.div_ceil(2);
    let (strips, _) = strips.as_chunks::<2>();
    for (y, strips) in strips.chunks_exact(n).enumerate().take(cut.side + 1) {
        // The picture's row lies under one of the template's, and in the lower window under the one before.
        let (upper, lower) = (&cut.groups[(y + 1) * n..][..n], &cut.groups[y * n..][..n]);
        for (strips, (upper, lower)) in strips.iter().zip(upper.iter().zip(lower)) {
            let (upper, lower) = (_mm256_set1_epi32(*upper), _mm256_set1_epi32(*lower));
            for (i, strip) in strips.iter().enumerate() {
                // SAFETY: the processor has AVX2.
                let pixels = unsafe { __m256i::of(strip, lane) };
                sums[0][i] = _mm256_add_epi32(sums[0][i], _mm256_madd_epi16(pixels, upper));
                sums[1][i] = _mm256_add_epi32(sums[1][i], _mm256_madd_epi16(pixels, lower));
            }
        }
    }
    sums.map(|sums| stored(sums))
}

/// The lanes of two vectors.
#[inline]
#[target_feature(enable = "avx2")]
fn stored(vectors: [__m256i; 2]) -> [u32; HALF] {
    // SAFETY: either is that many 32-bit numbers, whatever their bits.
    unsafe { std::mem::transmute(vectors) }
}
