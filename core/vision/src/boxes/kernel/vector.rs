//! The kernels of [`super`] that go along the rows of a window, for vectors of any width.

use std::marker::PhantomData;

use super::{Cut, LANES, Rows, Source, Strip, Sums, Windows};

/// Pixels side by side, 16 bits each.
///
/// # Safety
/// All functions here need a processor with the vector's instructions.
pub(super) trait Vector: Copy {
    /// Pixels of a vector; [`LANES`] are a multiple of it.
    const N: usize;

    unsafe fn zeros() -> Self;

    unsafe fn ones() -> Self;

    /// Those of a strip from a lane on, which is a multiple of [`Self::N`].
    unsafe fn of(strip: &Strip, lane: usize) -> Self;

    /// Those of a picture from a byte on, where a window lies.
    unsafe fn under(source: Source<'_>, at: usize) -> Self;

    unsafe fn and(self, mask: Self) -> Self;

    unsafe fn minus(self, other: Self) -> Self;

    /// Sums of two products of neighbours, added to 32-bit lanes.
    unsafe fn plus_products(self, a: Self, b: Self) -> Self;

    /// Sum of all 32-bit lanes.
    unsafe fn total(self) -> u32;
}

/// [`Windows`] whose pixels are compared a vector at a time.
pub(super) struct Along<'a, V> {
    pub(super) cut: &'a Cut,
    pub(super) source: Source<'a>,
    vector: PhantomData<V>,
}

impl<'a, V: Vector> Along<'a, V> {
    /// # Safety
    /// The processor has the vector's instructions.
    #[inline(always)]
    pub(super) unsafe fn new(cut: &'a Cut, source: Source<'a>) -> Self {
        Self { cut, source, vector: PhantomData }
    }
}

impl<V: Vector> Windows for Along<'_, V> {
    #[inline(always)]
    fn difference(&self, start: u32, rows: Rows) -> u32 {
        // SAFETY: these are the proof that the processor has the vector's instructions.
        unsafe { difference::<V>(self.cut, self.source, start, rows) }
    }
}

/// `Σ (I - J)²` of some rows of a window.
///
/// # Safety
/// The processor has the vector's instructions.
#[inline(always)]
unsafe fn difference<V: Vector>(cut: &Cut, source: Source<'_>, start: u32, rows: Rows) -> u32 {
    // SAFETY: the caller's; that windows lie in the picture was asserted for the source.
    unsafe {
        let mut sum = V::zeros();
        for x in (0..cut.side).step_by(V::N) {
            let (strips, mask, lane) = strips::<V>(cut, x);
            let mut y = rows.first;
            while y < strips.len() {
                let picture = V::under(source, start as usize + y * source.stride + x).and(mask);
                let difference = picture.minus(V::of(&strips[y], lane));
                sum = sum.plus_products(difference, difference);
                y += rows.step;
            }
        }
        sum.total()
    }
}

/// See [`super::sums`].
///
/// # Safety
/// The processor has the vector's instructions.
#[inline(always)]
pub(super) unsafe fn sums<V: Vector>(cut: &Cut, source: Source<'_>, starts: &[u32], out: &mut Vec<Sums>) {
    for &start in starts {
        // SAFETY: the caller's; that windows lie in the picture was asserted for the source.
        unsafe {
            let [mut sum, mut squares, mut products] = [V::zeros(); 3];
            for x in (0..cut.side).step_by(V::N) {
                let (strips, mask, lane) = strips::<V>(cut, x);
                for (y, strip) in strips.iter().enumerate() {
                    let picture = V::under(source, start as usize + y * source.stride + x).and(mask);
                    sum = sum.plus_products(picture, V::ones());
                    squares = squares.plus_products(picture, picture);
                    products = products.plus_products(picture, V::of(strip, lane));
                }
            }
            out.push(Sums { sum: sum.total(), squares: squares.total(), products: products.total() });
        }
    }
}

/// The strips that a column of pixels is in, which of a vector from there on count, and the column's lane.
///
/// # Safety
/// The processor has the vector's instructions.
#[inline(always)]
unsafe fn strips<V: Vector>(cut: &Cut, x: usize) -> (&[Strip], V, usize) {
    let (i, lane) = (x / LANES, x % LANES);
    // SAFETY: the caller's.
    (&cut.rows[i * cut.side..][..cut.side], unsafe { V::of(&cut.mask[i], lane) }, lane)
}
