//! Pictures of floats, for methods that look at every pixel: pyramids, filters, gradients, warping.
//!
//! Every pixel is computed by itself in the same order of operations, so that results are the same bits for any number
//! of threads. A pixel `(x, y)` of a level lies at `(2x, 2y)` of the finer one.

#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

use crate::pyramid::mirrored;
use crate::work::{shared, threads};

/// Calls `work` on bands of rows of several arrays of one size, as [`shared`] does, on as many threads as are worth it.
pub(crate) fn bands<const N: usize>(
    arrays: [&mut [f32]; N],
    width: usize,
    max_threads: usize,
    work: impl Fn(usize, [&mut [f32]; N]) + Sync,
) {
    /// A filter or a warp takes as long for a value, nanoseconds, or less.
    const VALUE_NS: f64 = 8.0;
    let n = arrays.first().map_or(0, |array| array.len());
    shared(arrays, width, threads(n, VALUE_NS, max_threads), work);
}

/// A picture of floats: `height` rows of `width`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) data: Vec<f32>,
}

impl Plane {
    pub(crate) fn blank(width: usize, height: usize) -> Self {
        Self { width, height, data: vec![0.0; width * height] }
    }

    pub(crate) fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.width..][..self.width]
    }

    /// `n` values from row `y` on.
    pub(crate) fn rows(&self, y: usize, n: usize) -> &[f32] {
        &self.data[y * self.width..][..n]
    }

    /// Value between the pixels; beyond the outermost ones, that of the nearest.
    pub(crate) fn at(&self, x: f32, y: f32) -> f32 {
        let x = x.clamp(0.0, (self.width - 1) as f32);
        let y = y.clamp(0.0, (self.height - 1) as f32);
        let (x0, y0) = (x as usize, y as usize);
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let right = usize::from(x0 + 1 < self.width);
        let below = if y0 + 1 < self.height { self.width } else { 0 };
        let i = y0 * self.width + x0;
        let top = self.data[i] + fx * (self.data[i + right] - self.data[i]);
        let bottom = self.data[i + below] + fx * (self.data[i + below + right] - self.data[i + below]);
        top + fy * (bottom - top)
    }

    /// Every second pixel of the picture under the binomial filter `[1 4 6 4 1] / 16`.
    fn halved(&self, n_threads: usize) -> Self {
        let smooth = self.filtered(&[6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0], Border::Mirrored, n_threads);
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let rows = (0..height).flat_map(|y| smooth.row(2 * y).iter().step_by(2));
        Self { width, height, data: rows.copied().collect() }
    }

    /// The picture under a filter that is the same to all sides: its middle weight, then those outward.
    pub(crate) fn filtered(&self, weights: &[f32], border: Border, n_threads: usize) -> Self {
        let mut out = Self::blank(self.width, self.height);
        let width = self.width;
        let radius = weights.len() - 1;
        bands([&mut out.data], width, n_threads, |first, [out]| {
            let mut row = vec![0.0; width + 2 * radius];
            for (y, out) in (first..).zip(out.chunks_exact_mut(width)) {
                self.filter_down(y, weights, border, &mut row[radius..radius + width]);
                extend(&mut row, radius, border);
                across(&row, weights, out);
            }
        });
        out
    }

    /// Weighted sum of the rows around row `y`.
    fn filter_down(&self, y: usize, weights: &[f32], border: Border, out: &mut [f32]) {
        for (out, value) in out.iter_mut().zip(self.row(y)) {
            *out = weights[0] * value;
        }
        for (k, &weight) in weights.iter().enumerate().skip(1) {
            let row = |y: isize| match border {
                Border::Mirrored => Some(self.row(mirrored(y, self.height))),
                Border::Nothing => usize::try_from(y).ok().filter(|&y| y < self.height).map(|y| self.row(y)),
            };
            let (above, below) = (row(y as isize - k as isize), row(y as isize + k as isize));
            match (above, below) {
                (Some(above), Some(below)) => {
                    for ((out, above), below) in out.iter_mut().zip(above).zip(below) {
                        *out += weight * (above + below);
                    }
                }
                (Some(one), None) | (None, Some(one)) => {
                    for (out, one) in out.iter_mut().zip(one) {
                        *out += weight * one;
                    }
                }
                (None, None) => {}
            }
        }
    }

    /// The middle of the nine values around each pixel, mirrored at the border.
    pub(crate) fn median(&self, n_threads: usize) -> Self {
        let mut out = Self::blank(self.width, self.height);
        let width = self.width;
        bands([&mut out.data], width, n_threads, |first, [out]| {
            let mut rows = [0, 1, 2].map(|_| vec![0.0; width + 2]);
            for (y, out) in (first..).zip(out.chunks_exact_mut(width)) {
                for (dy, row) in (-1..).zip(&mut rows) {
                    row[1..=width].copy_from_slice(self.row(mirrored(y as isize + dy, self.height)));
                    extend(row, 1, Border::Mirrored);
                }
                let [above, here, below] = &rows;
                for (x, out) in out.iter_mut().enumerate() {
                    let columns = [0, 1, 2].map(|dx| sorted(above[x + dx], here[x + dx], below[x + dx]));
                    let [a, b, c] = columns;
                    let low = greater(greater(a[0], b[0]), c[0]);
                    let middle = sorted(a[1], b[1], c[1])[1];
                    let high = lesser(lesser(a[2], b[2]), c[2]);
                    *out = sorted(low, middle, high)[1];
                }
            }
        });
        out
    }

    /// Derivatives to the right and down, per pixel, by `[1 -8 0 8 -1] / 12`, mirrored at the border.
    pub(crate) fn gradient(&self, n_threads: usize) -> [Self; 2] {
        let [mut dx, mut dy] = [0, 1].map(|_| Self::blank(self.width, self.height));
        let width = self.width;
        let slope = |a: f32, b: f32, c: f32, d: f32| (a - d + 8.0 * (c - b)) / 12.0;
        bands([&mut dx.data, &mut dy.data], width, n_threads, |first, [dx, dy]| {
            let mut row = vec![0.0; width + 4];
            for ((y, dx), dy) in (first..).zip(dx.chunks_exact_mut(width)).zip(dy.chunks_exact_mut(width)) {
                row[2..2 + width].copy_from_slice(self.row(y));
                extend(&mut row, 2, Border::Mirrored);
                for (x, dx) in dx.iter_mut().enumerate() {
                    *dx = slope(row[x], row[x + 1], row[x + 3], row[x + 4]);
                }
                let down = |k: isize| self.row(mirrored(y as isize + k, self.height));
                let rows = down(-2).iter().zip(down(-1)).zip(down(1)).zip(down(2));
                for (dy, (((a, b), c), d)) in dy.iter_mut().zip(rows) {
                    *dy = slope(*a, *b, *c, *d);
                }
            }
        });
        [dx, dy]
    }
}

fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

pub(crate) fn greater(a: f32, b: f32) -> f32 {
    if a < b { b } else { a }
}

fn sorted(a: f32, b: f32, c: f32) -> [f32; 3] {
    let (a, b) = (lesser(a, b), greater(a, b));
    let (b, c) = (lesser(b, c), greater(b, c));
    [lesser(a, b), greater(a, b), c]
}

/// What a filter finds beyond the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Border {
    /// The picture's mirror image.
    Mirrored,
    /// Nothing that counts.
    Nothing,
}

/// Fills the `radius` values before and after a row.
fn extend(row: &mut [f32], radius: usize, border: Border) {
    let width = row.len() - 2 * radius;
    for k in 0..radius {
        let (before, after) = match border {
            Border::Mirrored => (
                row[radius + mirrored(k as isize - radius as isize, width)],
                row[radius + mirrored((width + k) as isize, width)],
            ),
            Border::Nothing => (0.0, 0.0),
        };
        (row[k], row[radius + width + k]) = (before, after);
    }
}

/// Weighted sums along a row that is longer by the filter's radius at either end.
fn across(row: &[f32], weights: &[f32], out: &mut [f32]) {
    let radius = weights.len() - 1;
    for (out, value) in out.iter_mut().zip(&row[radius..]) {
        *out = weights[0] * value;
    }
    for (k, &weight) in weights.iter().enumerate().skip(1) {
        for ((out, before), after) in out.iter_mut().zip(&row[radius - k..]).zip(&row[radius + k..]) {
            *out += weight * (before + after);
        }
    }
}

/// Half of a Gaussian of this standard deviation, pixels, cut at `radius`; the whole adds to 1.
pub(crate) fn gaussian(sigma_px: f32, radius: usize) -> Vec<f32> {
    let weight = |k: usize| (-((k * k) as f64) / (2.0 * f64::from(sigma_px).powi(2))).exp();
    let half: Vec<f64> = (0..=radius).map(|k| if k == 0 { 1.0 } else { weight(k) }).collect();
    let total = half[0] + 2.0 * half[1..].iter().sum::<f64>();
    half.iter().map(|w| (w / total) as f32).collect()
}

/// A picture at several sizes, full size first.
#[derive(Clone, Debug)]
pub struct Scales {
    levels: Vec<Plane>,
    /// The 8-bit picture, packed rows.
    picture: Vec<u8>,
}

/// No level is smaller than this, pixels: what moves there is told by the border.
const SMALLEST_PX: usize = 12;

impl Scales {
    /// A pyramid of at most `n_levels` levels, at least one, of a picture smoothed by a Gaussian of this standard
    /// deviation (0: not at all), pixels.
    ///
    /// # Panics
    /// When the picture has no pixels.
    #[must_use]
    #[track_caller]
    pub fn new(picture: &Gray<'_>, n_levels: u32, smoothing_px: f32, n_threads: usize) -> Self {
        assert!(picture.width > 0 && picture.height > 0, "a pyramid needs a picture with pixels");
        let (width, height) = (picture.width as usize, picture.height as usize);
        let packed: Vec<u8> = (0..picture.height).flat_map(|y| picture.row(y)).copied().collect();
        let mut base = Plane { width, height, data: packed.iter().copied().map(f32::from).collect() };
        if smoothing_px > 0.0 {
            let radius = (3.0 * smoothing_px).ceil() as usize;
            base = base.filtered(&gaussian(smoothing_px, radius), Border::Mirrored, n_threads);
        }
        let mut levels = vec![base];
        while levels.len() < n_levels as usize {
            let Plane { width, height, .. } = levels[levels.len() - 1];
            if width.min(height) < 2 * SMALLEST_PX {
                break;
            }
            levels.push(levels[levels.len() - 1].halved(n_threads));
        }
        Self { levels, picture: packed }
    }

    /// The picture itself.
    #[must_use]
    pub fn picture(&self) -> Gray<'_> {
        Gray::packed(&self.picture, self.levels[0].width as u32, self.levels[0].height as u32)
    }
}

/// Displacements of every pixel, pixels: to the right, and down.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    pub(crate) u: Plane,
    pub(crate) v: Plane,
}

impl Motion {
    /// At rest.
    pub(crate) fn blank(like: &Plane) -> Self {
        let still = Plane::blank(like.width, like.height);
        Self { u: still.clone(), v: still }
    }

    /// The same motion on the next finer level, of this size.
    pub(crate) fn doubled(&self, width: usize, height: usize, n_threads: usize) -> Self {
        let mut fine = Self::blank(&Plane::blank(width, height));
        bands([&mut fine.u.data, &mut fine.v.data], width, n_threads, |first, [u, v]| {
            for ((y, u), v) in (first..).zip(u.chunks_exact_mut(width)).zip(v.chunks_exact_mut(width)) {
                for (x, (u, v)) in u.iter_mut().zip(v).enumerate() {
                    let (x, y) = (x as f32 / 2.0, y as f32 / 2.0);
                    (*u, *v) = (2.0 * self.u.at(x, y), 2.0 * self.v.at(x, y));
                }
            }
        });
        fine
    }

    /// What the second picture shows where each pixel of the first went, less the first: `J(x + w) - I(x)`, and whether
    /// that place is in the picture (1, or 0 and no difference).
    pub(crate) fn mismatch(&self, i: &Plane, j: &Plane, n_threads: usize) -> [Plane; 2] {
        let [mut delta, mut inside] = [0, 1].map(|_| Plane::blank(i.width, i.height));
        let (width, right, bottom) = (i.width, (i.width - 1) as f32, (i.height - 1) as f32);
        bands([&mut delta.data, &mut inside.data], width, n_threads, |first, [delta, inside]| {
            let rows = delta.chunks_exact_mut(width).zip(inside.chunks_exact_mut(width));
            for (y, (delta, inside)) in (first..).zip(rows) {
                let motion = self.u.row(y).iter().zip(self.v.row(y)).zip(i.row(y));
                for ((x, ((u, v), i)), (delta, inside)) in
                    motion.enumerate().zip(delta.iter_mut().zip(inside))
                {
                    let (x, y) = (x as f32 + u, y as f32 + v);
                    if (-0.5..=right + 0.5).contains(&x) && (-0.5..=bottom + 0.5).contains(&y) {
                        (*delta, *inside) = (j.at(x, y) - i, 1.0);
                    }
                }
            }
        });
        [delta, inside]
    }
}

/// Motion from one picture to another of its size: from the coarsest level at rest to the finest, each from the solution
/// of the coarser one (errata E4). `refine` betters the motion of a level, and asks with its share of that level whether
/// to go on; `None` where `go_on`, told the share of all the work, said no.
///
/// # Panics
/// When the pictures differ in size.
#[track_caller]
pub(crate) fn descend(
    [from, to]: [&Scales; 2],
    n_levels: u32,
    n_threads: usize,
    go_on: &dyn Fn(f64) -> bool,
    mut refine: impl FnMut(Motion, &Plane, &Plane, &dyn Fn(f64) -> bool) -> Option<Motion>,
) -> Option<Motion> {
    let pairs: Vec<_> = from.levels.iter().zip(&to.levels).take(n_levels.max(1) as usize).collect();
    let size = |plane: &Plane| (plane.width, plane.height);
    assert_eq!(size(pairs[0].0), size(pairs[0].1), "size of the two pictures");
    let mut motion = Motion::blank(pairs[pairs.len() - 1].0);
    for (k, &(i, j)) in pairs.iter().enumerate().rev() {
        if size(i) != size(&motion.u) {
            motion = motion.doubled(i.width, i.height, n_threads);
        }
        // A level has four times the pixels of the next coarser one.
        let all = 0.25_f64.powi(k as i32);
        motion = refine(motion, i, j, &|done| go_on(all * (0.25 + 0.75 * done)))?;
    }
    Some(motion)
}
