//! The kernel of [`super::all_differences`] for processors that sum up four products of bytes (AVX-512 VNNI).

use std::arch::x86_64::*;

use super::avx512::along;
use super::beside::{Beside, Block, Halves, Memory};
use super::vector::Along;
use super::{Cut, LANES, Rows, Source, Strip, Windows};

/// Whether a processor with AVX-512 has these instructions, too.
pub(super) fn is_there() -> bool {
    is_x86_feature_detected!("avx512vnni")
}

/// See [`super::all_differences`].
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
pub(super) fn all_differences(cut: &Cut, block: &Block<'_>, memory: &mut Memory, out: &mut [u32]) {
    block.all(cut.side, &Quads(along(cut, block.source)), memory, out);
}

/// 32 windows at a time, and four of their pixels together; the upper half of a vector is of the rows beneath.
///
/// A 32-bit lane holds four neighbours: read from the first pixel on, lanes belong to the windows 0, 4, 8..., from the
/// second on to 1, 5, 9..., and so on. The instruction multiplies bytes without a sign by bytes with one, so that there
/// is `J - 128` for `J`: `Σ (I - J)² = Σ I² - 256 Σ I - 2 Σ I (J - 128) + Σ J²`.
struct Quads<'a>(Along<'a, __m512i>);

impl Windows for Quads<'_> {
    #[inline(always)]
    fn difference(&self, start: u32, rows: Rows) -> u32 {
        self.0.difference(start, rows)
    }
}

impl Beside<LANES> for Quads<'_> {
    #[inline(always)]
    fn own(&self) -> u32 {
        self.0.cut.squares.wrapping_sub(self.0.cut.sum.wrapping_mul(256))
    }

    #[inline(always)]
    fn n_strips(&self) -> usize {
        self.0.cut.side.next_multiple_of(4)
    }

    #[inline(always)]
    fn take(&self, at: usize, beneath: usize, strips: &mut [Strip]) -> Halves<LANES> {
        let Along { cut, source, .. } = self.0;
        // SAFETY: windows in quads are made where the processor has the instructions.
        unsafe { take(cut.side, source, at, beneath, strips) }
    }

    #[inline(always)]
    fn products(&self, strips: &[Strip]) -> [Halves<LANES>; 2] {
        // SAFETY: as above.
        unsafe { products(self.0.cut, strips) }
    }

    #[inline(always)]
    fn in_turn(&self, sums: Halves<LANES>) -> Halves<LANES> {
        // SAFETY: as above.
        unsafe { in_turn(sums) }
    }
}

/// See [`Beside::take`]; pixels less 128.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
fn take(side: usize, source: Source<'_>, at: usize, beneath: usize, strips: &mut [Strip]) -> Halves<LANES> {
    // J² = J (J - 128) - J (-128)
    let [mut plus, mut minus] = [[_mm512_setzero_si512(); 4]; 2];
    let least = _mm512_set1_epi8(-128);
    for (strips, x) in strips.as_chunks_mut::<4>().0.iter_mut().zip((0..).step_by(4)) {
        // Of the last pixels only those that are in the window count.
        let counts = _mm512_set1_epi32((u32::MAX >> (8 * 4_usize.saturating_sub(side - x))) as i32);
        for phase in 0..4 {
            let pixels = pixels(source, at + x + phase, beneath);
            let signed = _mm512_xor_si512(pixels, least);
            let pixels = _mm512_and_si512(pixels, counts);
            // SAFETY: a strip is 64 bytes.
            unsafe { _mm512_storeu_si512(strips[phase].0.as_mut_ptr().cast(), signed) };
            plus[phase] = _mm512_dpbusd_epi32(plus[phase], pixels, signed);
            minus[phase] = _mm512_dpbusd_epi32(minus[phase], pixels, least);
        }
    }
    stored(std::array::from_fn(|phase| _mm512_sub_epi32(plus[phase], minus[phase])))
}

/// See [`Beside::products`]; `Σ I (J - 128)`.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
fn products(cut: &Cut, strips: &[Strip]) -> [Halves<LANES>; 2] {
    let mut sums = [[_mm512_setzero_si512(); 4]; 2];
    let n = cut.side.div_ceil(4);
    let (strips, _) = strips.as_chunks::<4>();
    for (y, strips) in strips.chunks_exact(n).enumerate().take(cut.side + 1) {
        // The picture's row lies under one of the template's, and in the lower window under the one before.
        let (upper, lower) = (&cut.groups[(y + 1) * n..][..n], &cut.groups[y * n..][..n]);
        for (strips, (upper, lower)) in strips.iter().zip(upper.iter().zip(lower)) {
            let (upper, lower) = (_mm512_set1_epi32(*upper), _mm512_set1_epi32(*lower));
            for (phase, Strip(pixels)) in strips.iter().enumerate() {
                // SAFETY: a strip is 64 bytes.
                let pixels = unsafe { _mm512_loadu_si512(pixels.as_ptr().cast()) };
                sums[0][phase] = _mm512_dpbusd_epi32(sums[0][phase], upper, pixels);
                sums[1][phase] = _mm512_dpbusd_epi32(sums[1][phase], lower, pixels);
            }
        }
    }
    sums.map(|sums| stored(sums))
}

/// 32 pixels from a byte on, and so many bytes beneath.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn pixels(source: Source<'_>, at: usize, beneath: usize) -> __m512i {
    debug_assert!(at + beneath + LANES <= source.data.len());
    // SAFETY: that the source holds windows up to the end of the last vector of them was asserted.
    let [upper, lower] =
        [at, at + beneath].map(|at| unsafe { _mm256_loadu_si256(source.data.as_ptr().add(at).cast()) });
    _mm512_inserti64x4::<1>(_mm512_castsi256_si512(upper), lower)
}

/// The lanes of four vectors.
#[inline]
#[target_feature(enable = "avx512f")]
fn stored(vectors: [__m512i; 4]) -> Halves<LANES> {
    // SAFETY: they are that many 32-bit numbers, whatever their bits.
    unsafe { std::mem::transmute(vectors) }
}

/// Those of the lower halves of four vectors in the order of their windows, then those of the upper ones.
#[inline]
#[target_feature(enable = "avx512f")]
fn in_turn(sums: Halves<LANES>) -> Halves<LANES> {
    // SAFETY: they are four vectors of 32-bit numbers, whatever their bits.
    let [a, b, c, d]: [__m512i; 4] = unsafe { std::mem::transmute(sums) };
    // Four neighbours together, in quarters of vectors: of every fourth lane.
    let [ab, cd] = [[a, b], [c, d]].map(|[a, b]| [_mm512_unpacklo_epi32(a, b), _mm512_unpackhi_epi32(a, b)]);
    let [p, q] = [_mm512_unpacklo_epi64(ab[0], cd[0]), _mm512_unpackhi_epi64(ab[0], cd[0])];
    let [r, s] = [_mm512_unpacklo_epi64(ab[1], cd[1]), _mm512_unpackhi_epi64(ab[1], cd[1])];
    // Then the quarters in turn.
    let [pq, rs] = [[p, q], [r, s]]
        .map(|[a, b]| [_mm512_shuffle_i32x4::<0x44>(a, b), _mm512_shuffle_i32x4::<0xee>(a, b)]);
    let [upper, lower] = [0, 1]
        .map(|i| [_mm512_shuffle_i32x4::<0x88>(pq[i], rs[i]), _mm512_shuffle_i32x4::<0xdd>(pq[i], rs[i])]);
    stored([upper[0], upper[1], lower[0], lower[1]])
}
