//! Looks for a template on every whole pixel around a place, by weighted normalised cross-correlation.

use super::kernel::{LANES, MID_GRAY, Tap};
use super::template::{Desk, FLAT_GRAY2};
use super::warp::{Warp, apply, inverse};
use crate::{Gray, Point};

/// Pixels that count less are left out of a search.
const LEAST_WEIGHT: f32 = 0.02;

/// Places around one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// No nearer than this, pixels.
    pub(super) from_px: f32,
    /// No farther on either axis, pixels.
    pub(super) reach_px: u32,
}

/// Sums over a template that is searched for.
#[derive(Clone, Copy)]
struct Sought {
    weight: f32,
    mean: f32,
    /// Weighted sum of squares about the mean.
    spread: f32,
}

impl Desk<'_> {
    /// The pixel around a place where the warped template correlates best, and how well.
    ///
    /// `None` where the template is flat, or the picture is all around.
    pub(super) fn search(
        &mut self,
        gray: &Gray<'_>,
        around: Point,
        warp: Warp,
        Ring { from_px, reach_px }: Ring,
    ) -> Option<(Point, f32)> {
        let side = 2 * self.params.radius_px as usize + 1;
        let n = 2 * reach_px as usize + 1;
        let stride = side + n.next_multiple_of(LANES);
        let sought = self.warped(warp, stride)?;
        let centre = self.centre(around, warp);
        let centre = [0, 1].map(|axis| {
            let last = [gray.width, gray.height][axis] - 1;
            centre[axis].round().clamp(0.0, last as f32) as i32
        });
        let first = centre.map(|c| c - (self.params.radius_px + reach_px) as i32);
        self.gather(gray, first, [side + n, side + n - 1], stride, sought.mean);
        let mut best: Option<(usize, usize, f32)> = None;
        for y in 0..n {
            for x in (0..n).step_by(LANES) {
                let sums = self.kernel.slide(&self.taps, &self.region[y * stride + x..]);
                for lane in 0..LANES.min(n - x) {
                    let [common, light, square] = [0, 1, 2].map(|sum| sums[sum][lane]);
                    let spread = square - light * light / sought.weight;
                    if spread > FLAT_GRAY2 * sought.weight {
                        let ncc = common / (spread * sought.spread).sqrt();
                        let off = [x + lane, y].map(|c| c as f32 - reach_px as f32);
                        if best.is_none_or(|(.., most)| ncc > most) && off[0].hypot(off[1]) >= from_px {
                            best = Some((x + lane, y, ncc));
                        }
                    }
                }
            }
        }
        let corner = centre.map(|c| c as f32 - reach_px as f32);
        best.map(|(x, y, ncc)| (self.point([corner[0] + x as f32, corner[1] + y as f32], warp), ncc))
    }

    /// Lays out the taps of the template as the picture would show it: on whole pixels, through its warp.
    fn warped(&mut self, warp: Warp, stride: usize) -> Option<Sought> {
        let radius = self.params.radius_px as i32;
        let side = 2 * radius as usize + 1;
        let back = inverse(warp)?;
        let (mut weight, mut sum, mut square) = (0.0_f32, 0.0_f32, 0.0_f32);
        self.taps.clear();
        for v in -radius..=radius {
            for u in -radius..=radius {
                let [x, y] = apply(back, [u as f32, v as f32]).map(|c| c + radius as f32);
                let Some((t, w)) = self.blend(x, y, side).filter(|&(_, w)| w >= LEAST_WEIGHT) else {
                    continue;
                };
                (weight, sum, square) = (weight + w, sum + w * t, square + w * t * t);
                let index = (v + radius) as usize * stride + (u + radius) as usize;
                self.taps.push(Tap { index, w, wt: w * t });
            }
        }
        let mean = sum / weight;
        let spread = square - sum * mean;
        for tap in &mut self.taps {
            tap.wt -= tap.w * mean;
        }
        (weight >= 1.0 && spread > FLAT_GRAY2 * weight).then_some(Sought { weight, mean, spread })
    }

    /// Brightness and weight of the template between its pixels; `None` beyond them.
    fn blend(&self, x: f32, y: f32, side: usize) -> Option<(f32, f32)> {
        let last = (side - 1) as f32;
        if !(0.0..=last).contains(&x) || !(0.0..=last).contains(&y) {
            return None;
        }
        let (column, row) = ((x as usize).min(side - 2), (y as usize).min(side - 2));
        let (fx, fy) = (x - column as f32, y - row as f32);
        let pixel = |k: usize| {
            let cell = self.cells.get(k / LANES)?;
            Some([cell.value[k % LANES], cell.weight[k % LANES]])
        };
        let k = row * side + column;
        let (a, b, c, d) = (pixel(k)?, pixel(k + 1)?, pixel(k + side)?, pixel(k + side + 1)?);
        let mix = |i: usize| {
            let (top, bottom) = (a[i] + (b[i] - a[i]) * fx, c[i] + (d[i] - c[i]) * fx);
            top + (bottom - top) * fy
        };
        Some((mix(0), mix(1)))
    }

    /// Copies the part of the picture that is searched, its outermost pixels repeated beyond it.
    fn gather(&mut self, gray: &Gray<'_>, first: [i32; 2], size: [usize; 2], stride: usize, mean: f32) {
        let base = MID_GRAY + mean;
        let [right, below] = [gray.width, gray.height].map(|n| n as i32 - 1);
        self.region.clear();
        self.region.resize(size[1] * stride + LANES, 0.0);
        for y in 0..size[1] {
            let row = gray.row((first[1] + y as i32).clamp(0, below) as u32);
            let out = &mut self.region[y * stride..][..size[0]];
            let start = first[0];
            if start >= 0 && start + size[0] as i32 - 1 <= right {
                for (out, byte) in out.iter_mut().zip(&row[start as usize..]) {
                    *out = f32::from(*byte) - base;
                }
            } else {
                for (x, out) in out.iter_mut().enumerate() {
                    *out = f32::from(row[(start + x as i32).clamp(0, right) as usize]) - base;
                }
            }
        }
    }
}
