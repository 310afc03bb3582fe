//! The inner loops: sample a warped window, and sum what a fit and a search need.
//!
//! Each loop is written once, plainly, over sixteen lanes whose order of additions is fixed, and compiled for every
//! instruction set: so all of them give the same bits.

#![allow(unsafe_code, reason = "calls loops that were compiled for an instruction set")]

#[cfg(test)]
mod tests;

use crate::Gray;
use crate::simd::{self, Set};

/// Pixels in a cell.
pub(super) const LANES: usize = 16;
/// One number for each pixel of a cell.
pub(super) type Lanes = [f32; LANES];
/// Functions that a fit combines: two slopes times 1, u and v; the template; 1.
pub(super) const N_BASIS: usize = 8;
/// Products of two of them.
pub(super) const N_PRODUCTS: usize = N_BASIS * (N_BASIS + 1) / 2;
/// Taken off all brightness, so that sums stay small.
pub(super) const MID_GRAY: f32 = 128.0;

/// Sixteen pixels of a template. Pixels behind the last have no weight.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct Cell {
    /// Place in the window, -1..=1 from edge to edge.
    pub(super) u: Lanes,
    pub(super) v: Lanes,
    /// Brightness less [`MID_GRAY`].
    pub(super) value: Lanes,
    /// Slopes, gray levels per pixel.
    pub(super) dx: Lanes,
    pub(super) dy: Lanes,
    /// How much the pixel counts, 0..=1.
    pub(super) weight: Lanes,
}

/// Sums over a window of the products of basis functions with each other and with the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Normal {
    /// Row by row from the diagonal on.
    pub(super) products: [f32; N_PRODUCTS],
    pub(super) right: [f32; N_BASIS],
}

/// Weighted sums over a window of template `t` and picture `i`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    pub(super) w: f32,
    pub(super) t: f32,
    pub(super) i: f32,
    pub(super) tt: f32,
    pub(super) ii: f32,
    pub(super) ti: f32,
}

/// What a residual is held against: the picture is expected to be `gain · template + offset`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    pub(super) gain: f32,
    pub(super) offset: f32,
    /// One over the residual at which a pixel counts a quarter.
    pub(super) per_outlier: f32,
}

/// A window in a picture: its centre, and the 2x2 matrix from places -1..=1 to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) at: [f32; 2],
    pub(super) matrix: [f32; 4],
}

/// A pixel of a template that is searched for: where in the region, its weight, and weight times brightness.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tap {
    pub(super) index: usize,
    pub(super) w: f32,
    pub(super) wt: f32,
}

/// The loops as compiled for one instruction set; to call them, the processor must have it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    sample: unsafe fn(&Gray<'_>, Place, &[Cell], &mut [Lanes]),
    normal: unsafe fn(&[Cell], &[Lanes], Light) -> Normal,
    moments: unsafe fn(&[Cell], &[Lanes]) -> Moments,
    slide: unsafe fn(&[Tap], &[f32]) -> [Lanes; 3],
}

macro_rules! compile {
    ($name:ident $(, $feature:literal)?) => {
        mod $name {
            use super::*;
            $(#[target_feature(enable = $feature)])?
            pub(super) fn sample(gray: &Gray<'_>, place: Place, cells: &[Cell], out: &mut [Lanes]) {
                super::sample(gray, place, cells, out);
            }
            $(#[target_feature(enable = $feature)])?
            pub(super) fn normal(cells: &[Cell], image: &[Lanes], light: Light) -> Normal {
                super::normal(cells, image, light)
            }
            $(#[target_feature(enable = $feature)])?
            pub(super) fn moments(cells: &[Cell], image: &[Lanes]) -> Moments {
                super::moments(cells, image)
            }
            $(#[target_feature(enable = $feature)])?
            pub(super) fn slide(taps: &[Tap], region: &[f32]) -> [Lanes; 3] {
                super::slide(taps, region)
            }
            pub(super) const KERNEL: Kernel = Kernel { sample, normal, moments, slide };
        }
    };
}

compile!(plain);
#[cfg(target_arch = "x86_64")]
compile!(avx2, "avx2");
#[cfg(target_arch = "x86_64")]
compile!(avx512, "avx512f,avx512bw");

impl Kernel {
    pub(super) fn of(level: simd::Level) -> Self {
        match level.set() {
            Set::Scalar => plain::KERNEL,
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::KERNEL,
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::KERNEL,
        }
    }

    /// Brightness less [`MID_GRAY`] where a window lies in a picture; beyond its border, that of the border.
    pub(super) fn sample(&self, gray: &Gray<'_>, place: Place, cells: &[Cell], out: &mut [Lanes]) {
        // SAFETY: the level that this was chosen for says that the processor has what its loops need.
        unsafe { (self.sample)(gray, place, cells, out) }
    }

    /// The sums of a fit; pixels far from what is expected count less.
    pub(super) fn normal(&self, cells: &[Cell], image: &[Lanes], light: Light) -> Normal {
        // SAFETY: as in `sample`.
        unsafe { (self.normal)(cells, image, light) }
    }

    /// The sums of a correlation.
    pub(super) fn moments(&self, cells: &[Cell], image: &[Lanes]) -> Moments {
        // SAFETY: as in `sample`.
        unsafe { (self.moments)(cells, image) }
    }

    /// `Σ wt I`, `Σ w I` and `Σ w I²` at sixteen neighbouring places, from the start of a region on.
    pub(super) fn slide(&self, taps: &[Tap], region: &[f32]) -> [Lanes; 3] {
        // SAFETY: as in `sample`.
        unsafe { (self.slide)(taps, region) }
    }
}

impl Place {
    /// How far the window reaches from its centre, and one pixel more.
    fn reach(&self) -> [f32; 2] {
        let [a, b, c, d] = self.matrix.map(f32::abs);
        [a + b + 1.0, c + d + 1.0]
    }

    /// Whether all of the window, and one pixel more, lies on the picture's pixels.
    pub(super) fn is_inside(&self, gray: &Gray<'_>) -> bool {
        let size = [gray.width, gray.height];
        let inside = |at: f32, reach: f32, size: u32| at - reach >= 0.0 && at + reach + 1.0 < size as f32;
        self.at.iter().zip(self.reach()).zip(size).all(|((&at, reach), size)| inside(at, reach, size))
    }

    /// Where a place of the window lies in the picture.
    pub(super) fn of(&self, u: f32, v: f32) -> [f32; 2] {
        let [a, b, c, d] = self.matrix;
        [self.at[0] + a * u + b * v, self.at[1] + c * u + d * v]
    }
}

#[inline(always)]
fn sample(gray: &Gray<'_>, place: Place, cells: &[Cell], out: &mut [Lanes]) {
    let Place { at, matrix: [a, b, c, d] } = place;
    if !place.is_inside(gray) {
        for (cell, out) in cells.iter().zip(out) {
            for l in 0..LANES {
                out[l] = crate::sample::bilinear(gray, place.of(cell.u[l], cell.v[l])) - MID_GRAY;
            }
        }
        return;
    }
    // Places relative to the box around the window: small positive numbers.
    let reach = place.reach();
    let origin = [0, 1].map(|axis| (at[axis] - reach[axis]) as usize);
    let data = &gray.data[origin[1] * gray.stride + origin[0]..];
    let at = [at[0] - origin[0] as f32, at[1] - origin[1] as f32];
    for (cell, out) in cells.iter().zip(out) {
        let (mut fx, mut fy, mut index) = ([0.0; LANES], [0.0; LANES], [0_usize; LANES]);
        for l in 0..LANES {
            let x = at[0] + a * cell.u[l] + b * cell.v[l];
            let y = at[1] + c * cell.u[l] + d * cell.v[l];
            let (column, row) = (x as i32, y as i32);
            (fx[l], fy[l]) = (x - column as f32, y - row as f32);
            index[l] = row as usize * gray.stride + column as usize;
        }
        for l in 0..LANES {
            let (upper, lower) = (&data[index[l]..][..2], &data[index[l] + gray.stride..][..2]);
            let mix = |row: &[u8]| {
                let (left, right) = (f32::from(row[0]), f32::from(row[1]));
                left + (right - left) * fx[l]
            };
            let (top, bottom) = (mix(upper), mix(lower));
            out[l] = top + (bottom - top) * fy[l] - MID_GRAY;
        }
    }
}

#[inline(always)]
fn normal(cells: &[Cell], image: &[Lanes], light: Light) -> Normal {
    let mut products = [[0.0_f32; LANES]; N_PRODUCTS];
    let mut right = [[0.0_f32; LANES]; N_BASIS];
    for (cell, image) in cells.iter().zip(image) {
        let mut basis = [[0.0_f32; LANES]; N_BASIS];
        let mut weight = [0.0_f32; LANES];
        for l in 0..LANES {
            let (u, v, t, dx, dy) = (cell.u[l], cell.v[l], cell.value[l], cell.dx[l], cell.dy[l]);
            let off = (image[l] - light.gain * t - light.offset) * light.per_outlier;
            // Geman-McClure's weight.
            let trust = 1.0 / (1.0 + off * off);
            weight[l] = cell.weight[l] * trust * trust;
            let all = [dx, dy, dx * u, dx * v, dy * u, dy * v, t, 1.0];
            for (function, value) in basis.iter_mut().zip(all) {
                function[l] = value;
            }
        }
        let mut k = 0;
        for i in 0..N_BASIS {
            let mut weighted = [0.0_f32; LANES];
            for l in 0..LANES {
                weighted[l] = weight[l] * basis[i][l];
                right[i][l] += weighted[l] * image[l];
            }
            for function in &basis[i..] {
                for l in 0..LANES {
                    products[k][l] += weighted[l] * function[l];
                }
                k += 1;
            }
        }
    }
    Normal { products: products.each_ref().map(sum), right: right.each_ref().map(sum) }
}

#[inline(always)]
fn moments(cells: &[Cell], image: &[Lanes]) -> Moments {
    let mut sums = [[0.0_f32; LANES]; 6];
    for (cell, image) in cells.iter().zip(image) {
        for l in 0..LANES {
            let (w, t, i) = (cell.weight[l], cell.value[l], image[l]);
            for (sum, value) in sums.iter_mut().zip([w, w * t, w * i, w * t * t, w * i * i, w * t * i]) {
                sum[l] += value;
            }
        }
    }
    let [w, t, i, tt, ii, ti] = sums.each_ref().map(sum);
    Moments { w, t, i, tt, ii, ti }
}

#[inline(always)]
fn slide(taps: &[Tap], region: &[f32]) -> [Lanes; 3] {
    let mut sums = [[0.0_f32; LANES]; 3];
    for tap in taps {
        let row = &region[tap.index..][..LANES];
        for l in 0..LANES {
            let weighted = tap.w * row[l];
            sums[0][l] += tap.wt * row[l];
            sums[1][l] += weighted;
            sums[2][l] += weighted * row[l];
        }
    }
    sums
}

/// Lanes added in pairs, always the same ones.
fn sum(lanes: &Lanes) -> f32 {
    let mut half = *lanes;
    for n in [8, 4, 2, 1] {
        for l in 0..n {
            half[l] += half[l + n];
        }
    }
    half[0]
}
