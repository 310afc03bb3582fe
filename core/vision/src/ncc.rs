//! Normalised cross-correlation of two windows at sub-pixel positions.

use honami_model::picture::Gray;

use crate::{Point, sample};

/// A window whose brightness varies less than this (standard deviation, gray levels) has nothing to correlate:
/// below it rounding to 8 bits alone makes the pattern.
const FLAT_GRAY: f32 = 0.3;

/// Compares windows of one radius; keeps its buffers between calls.
#[derive(Debug)]
pub struct Ncc {
    radius_px: u32,
    first: Vec<f32>,
    second: Vec<f32>,
}

impl Ncc {
    /// For windows of this radius.
    #[must_use]
    pub fn new(radius_px: u32) -> Self {
        Self { radius_px, first: Vec::new(), second: Vec::new() }
    }

    /// How long it takes to compare two windows, roughly, nanoseconds.
    #[must_use]
    pub fn cost_ns(&self) -> f64 {
        const PIXEL_NS: f64 = 4.0;
        PIXEL_NS * f64::from(2 * self.radius_px + 1).powi(2)
    }

    /// Cuts a window out of a picture, to be compared with many others.
    ///
    /// `None` where it is flat.
    ///
    /// # Panics
    /// When the picture has no pixels.
    #[must_use]
    #[track_caller]
    pub fn template(&mut self, picture: &Gray<'_>, at: Point) -> Option<Template> {
        sample::patch(picture, at, self.radius_px, &mut self.first);
        let power = centre(&mut self.first)?;
        Some(Template { pixels: self.first.clone(), power })
    }

    /// As [`compare`](Self::compare), with a template that was cut before; the same bits.
    ///
    /// # Panics
    /// When the picture has no pixels, or the template was cut with another radius.
    #[must_use]
    #[track_caller]
    pub fn against(&mut self, template: &Template, picture: &Gray<'_>, to: Point) -> Option<f32> {
        sample::patch(picture, to, self.radius_px, &mut self.second);
        assert_eq!(template.pixels.len(), self.second.len(), "a template of another radius");
        let power = centre(&mut self.second)?;
        let together = sum(&template.pixels, &self.second, |p, q| p * q);
        Some((together / (template.power * power).sqrt()).clamp(-1.0, 1.0))
    }

    /// Correlation of the window around `at` in `a` with that around `to` in `b`, -1..=1, 1 for the same pattern
    /// whatever its brightness and contrast: `Σ(p-p̄)(q-q̄) / √(Σ(p-p̄)² Σ(q-q̄)²)`.
    ///
    /// `None` where either window is flat. Beyond the border a picture goes on as its outermost pixels.
    ///
    /// # Panics
    /// When a picture has no pixels.
    #[must_use]
    #[track_caller]
    pub fn compare(&mut self, a: &Gray<'_>, at: Point, b: &Gray<'_>, to: Point) -> Option<f32> {
        sample::patch(a, at, self.radius_px, &mut self.first);
        sample::patch(b, to, self.radius_px, &mut self.second);
        let (power_first, power_second) = (centre(&mut self.first)?, centre(&mut self.second)?);
        let together = sum(&self.first, &self.second, |p, q| p * q);
        Some((together / (power_first * power_second).sqrt()).clamp(-1.0, 1.0))
    }
}

/// A window with its mean taken off, and the sum of its squares.
#[derive(Clone, Debug)]
pub struct Template {
    pixels: Vec<f32>,
    power: f32,
}

/// Takes the mean off and gives the sum of squares; `None` where the window is flat.
fn centre(pixels: &mut [f32]) -> Option<f32> {
    let n = pixels.len() as f32;
    let mean = sum(pixels, pixels, |p, _| p) / n;
    for p in &mut *pixels {
        *p -= mean;
    }
    let power = sum(pixels, pixels, |p, q| p * q);
    (power >= n * FLAT_GRAY * FLAT_GRAY).then_some(power)
}

/// Sum of `f(p, q)` in sixteen fixed lanes: the same order, hence the same bits, however it is compiled.
fn sum(p: &[f32], q: &[f32], f: impl Fn(f32, f32) -> f32) -> f32 {
    const LANES: usize = 16;
    let mut lanes = [0.0_f32; LANES];
    let (p, q) = (p.chunks_exact(LANES), q.chunks_exact(LANES));
    let tail: f32 = p.remainder().iter().zip(q.remainder()).map(|(&p, &q)| f(p, q)).sum();
    for (p, q) in p.zip(q) {
        for lane in 0..LANES {
            lanes[lane] += f(p[lane], q[lane]);
        }
    }
    lanes.iter().sum::<f32>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture;

    const SIZE: u32 = 64;

    fn picture(shift: Point, gain: f64, offset: f64) -> Vec<u8> {
        texture::render(SIZE, SIZE, |x, y| {
            offset + gain * texture::value(3, x - f64::from(shift[0]), y - f64::from(shift[1]))
        })
    }

    #[test]
    fn same_pattern_is_one_whatever_gain_offset_and_shift() {
        let a = picture([0.0, 0.0], 1.0, 0.0);
        let gray_a = Gray::packed(&a, SIZE, SIZE);
        for (shift, gain, offset, want) in [
            ([0.0, 0.0], 1.0, 0.0, 0.9999),
            ([0.0, 0.0], 0.5, 60.0, 0.997),
            ([1.5, -0.75], 1.0, 0.0, 0.998),
            ([1.5, -0.75], 0.6, 40.0, 0.998),
        ] {
            let b = picture(shift, gain, offset);
            let to = [32.0 + shift[0], 32.0 + shift[1]];
            let ncc = Ncc::new(7).compare(&gray_a, [32.0, 32.0], &Gray::packed(&b, SIZE, SIZE), to);
            assert!(ncc.is_some_and(|c| c >= want), "{shift:?} {gain} {offset}: {ncc:?}");
        }
        let negative: Vec<u8> = a.iter().map(|p| 255 - p).collect();
        let ncc =
            Ncc::new(7).compare(&gray_a, [32.0, 32.0], &Gray::packed(&negative, SIZE, SIZE), [32.0, 32.0]);
        assert!(ncc.is_some_and(|c| c < -0.9999), "{ncc:?}");
    }

    #[test]
    fn three_by_three_by_hand() {
        let ramp = [1, 2, 3, 4, 5, 6, 7, 8, 9]; // less its mean 5: -4..=4, squares 60
        let dot = [9, 0, 0, 0, 0, 0, 0, 0, 0]; // less its mean 1: 8 and eight times -1, squares 72
        for (p, q, want) in [
            (ramp, [1, 4, 7, 2, 5, 8, 3, 6, 9], 0.6), // 16+3-4+3+0+3-4+3+16 = 36, of 60
            (ramp, [7, 8, 9, 4, 5, 6, 1, 2, 3], -0.8), // -8-9-8+1+0+1-8-9-8 = -48, of 60
            (ramp, [30, 28, 26, 24, 22, 20, 18, 16, 14], -1.0),
            (dot, [0, 0, 0, 0, 9, 0, 0, 0, 0], -0.125), // -8-8+7 = -9, of 72
            (dot, ramp, -0.547_723),                    // 8*-4 - 4 = -36, of √(72*60)
            ([1, 2, 3, 1, 2, 3, 1, 2, 3], [1, 1, 1, 2, 2, 2, 3, 3, 3], 0.0),
        ] {
            let (a, b) = (Gray::packed(&p, 3, 3), Gray::packed(&q, 3, 3));
            let got = Ncc::new(1).compare(&a, [1.0, 1.0], &b, [1.0, 1.0]);
            assert!(got.is_some_and(|ncc| (ncc - want).abs() < 1e-6), "{p:?} {q:?}: {got:?} not {want}");
            let cut = Ncc::new(1).template(&a, [1.0, 1.0]);
            assert_eq!(cut.and_then(|cut| Ncc::new(1).against(&cut, &b, [1.0, 1.0])), got);
        }
    }

    #[test]
    fn flat_windows_have_none() {
        let (flat, textured) = (vec![90; 64 * 64], picture([0.0, 0.0], 1.0, 0.0));
        let (flat, textured) = (Gray::packed(&flat, SIZE, SIZE), Gray::packed(&textured, SIZE, SIZE));
        for (a, b) in [(&flat, &textured), (&textured, &flat), (&flat, &flat)] {
            assert_eq!(Ncc::new(5).compare(a, [30.0, 30.0], b, [30.0, 30.0]), None);
        }
        // Windows of radius 0 have one pixel: no variance, no correlation.
        let corners = Gray::packed(&[0, 255, 255, 0], 2, 2);
        assert_eq!(Ncc::new(0).compare(&corners, [0.0, 0.0], &corners, [1.0, 0.0]), None);
        let dot = Gray::packed(&[7], 1, 1);
        assert_eq!(Ncc::new(3).compare(&dot, [0.0, 0.0], &dot, [0.0, 0.0]), None);
    }
}
