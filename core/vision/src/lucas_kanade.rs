//! Dense Lucas-Kanade: the motion of every pixel, by least squares over the window around it.
//!
//! B. D. Lucas, T. Kanade, "An iterative image registration technique", IJCAI 1981; J. Diener's thesis, 2.4.3 (errata
//! E1: the constraint is `I_x u + I_y v + I_t = 0`).
//!
//! Where the pixels `q` of a window have moved by `w(q)` so far, `δ(q) = J(q + w(q)) - I(q)` is left. To first order
//! a common displacement `w` of the window leaves `δ(q) + g(q)·(w - w(q))`, with `g = ∇I`; its weighted squares over
//! the window are least (equation 2.9) where
//!
//! `(Σ k g gᵀ) w = Σ k (g gᵀ w(q) - g δ)`, with Gaussian weights `k`.
//!
//! These sums are filters over the whole picture, so that a larger window costs little more. The pyramid begins at
//! its coarsest level at rest; each finer one begins from the coarser one's solution (errata E4).

#[cfg(test)]
mod tests;

use crate::field::{Field, Grid};
use crate::plane::{Border, Motion, Plane, Scales, bands, descend, gaussian, greater};

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Radius of the window, pixels; the standard deviation of its weights is half of it.
    pub radius_px: u32,
    /// Levels of the pyramid to use, at least 1.
    pub levels: u32,
    /// Steps on each level, each with the second picture warped anew.
    pub iterations: u32,
    /// From a node of the field to the next, pixels, at least 1.
    pub step_px: u32,
    /// The motion of a window whose gradient matrix has a smaller eigenvalue is not known. The measure is that of
    /// [`crate::klt::Params`]: 1e-4 is a mean square gradient of 0.1 (gray levels per pixel)².
    pub min_eigenvalue: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self { radius_px: 7, levels: 5, iterations: 4, step_px: 2, min_eigenvalue: 1e-4 }
    }
}

/// (Gray levels per pixel)² to the measure of [`Params::min_eigenvalue`]: Scharr's 32², by 2²⁰.
const UNIT: f32 = 1.0 / 1024.0;

/// What rounding leaves of a matrix that cannot be solved, as a share of its trace; and of one that is nothing, (gray
/// levels per pixel)². No eigenvalue is taken as less.
const ROUNDING: f32 = 1e-6;

/// The standard deviation by which pictures are best smoothed, pixels: differences of neighbours are noise without.
pub const SMOOTHING_PX: f32 = 0.8;

/// Displacements from one picture to the next, on up to `n_threads` threads; `None` where `go_on`, which is told the
/// share of the work that is done, said no.
///
/// # Panics
/// When the pictures differ in size.
#[must_use]
#[track_caller]
pub fn measure(
    from: &Scales,
    to: &Scales,
    params: &Params,
    n_threads: usize,
    go_on: &dyn Fn(f64) -> bool,
) -> Option<Field> {
    let mut certain = Plane::blank(1, 1);
    let motion = descend([from, to], params.levels, n_threads, go_on, |mut motion, i, j, go_on| {
        let windows = Windows::new(i, params, n_threads);
        for n in 0..params.iterations {
            if !go_on(f64::from(n) / f64::from(params.iterations)) {
                return None;
            }
            windows.refine(&mut motion, i, j, n_threads);
        }
        certain = windows.certain;
        Some(motion)
    })?;
    let grid = Grid::over(certain.width as u32, certain.height as u32, params.step_px);
    let known = grid.nodes().map(|[x, y]| {
        (certain.at(x, y) >= params.min_eigenvalue).then(|| [motion.u.at(x, y), motion.v.at(x, y)])
    });
    Some(Field::new(grid, known))
}

/// The matrices of all windows of a picture.
struct Windows {
    weights: Vec<f32>,
    gradient: [Plane; 2],
    /// Weighted means of `g_x²`, `g_x g_y`, `g_y²` over each window.
    matrix: [Plane; 3],
    /// The smaller eigenvalue of each, in the measure of [`Params::min_eigenvalue`].
    certain: Plane,
    /// Added to both eigenvalues: what a window cannot tell stays as it was.
    damping: f32,
}

impl Windows {
    fn new(i: &Plane, params: &Params, n_threads: usize) -> Self {
        let weights = gaussian(params.radius_px as f32 / 2.0, params.radius_px as usize);
        let gradient = i.gradient(n_threads);
        let matrix = [(0, 0), (0, 1), (1, 1)].map(|(a, b)| {
            let mut product = gradient[a].clone();
            product.data.iter_mut().zip(&gradient[b].data).for_each(|(a, b)| *a *= b);
            product.filtered(&weights, Border::Nothing, n_threads)
        });
        let mut certain = matrix[1].clone();
        for ((xy, xx), yy) in certain.data.iter_mut().zip(&matrix[0].data).zip(&matrix[2].data) {
            let apart = ((xx - yy) * (xx - yy) + 4.0 * *xy * *xy).sqrt();
            *xy = UNIT * (xx + yy - apart) / 2.0;
        }
        let damping = (params.min_eigenvalue / UNIT).max(ROUNDING);
        Self { weights, gradient, matrix, certain, damping }
    }

    /// One step: the second picture warped by the motion so far, and every window solved.
    fn refine(&self, motion: &mut Motion, i: &Plane, j: &Plane, n_threads: usize) {
        let [bx, by] = self.asked(motion, i, j, n_threads);
        // What goes farther is out of the picture wherever it began, and no motion that was measured.
        let farthest = (i.width + i.height) as f32;
        bands([&mut motion.u.data, &mut motion.v.data], i.width, n_threads, |first, [u, v]| {
            let [xx, xy, yy] = self.matrix.each_ref().map(|plane| plane.rows(first, u.len()));
            let b = bx.rows(first, u.len()).iter().zip(by.rows(first, u.len()));
            let a = xx.iter().zip(xy).zip(yy);
            for (((u, v), (bx, by)), ((xx, xy), yy)) in u.iter_mut().zip(v).zip(b).zip(a) {
                let damping = greater(self.damping, ROUNDING * (xx + yy));
                let (xx, yy) = (xx + damping, yy + damping);
                let (bx, by) = (bx + damping * *u, by + damping * *v);
                let scale = 1.0 / (xx * yy - xy * xy);
                let (x, y) = ((yy * bx - xy * by) * scale, (xx * by - xy * bx) * scale);
                // Not so of what is no number.
                let is_known = (x.abs() <= farthest) & (y.abs() <= farthest);
                (*u, *v) = if is_known { (x, y) } else { (*u, *v) };
            }
        });
    }

    /// The right-hand sides, `Σ k (g gᵀ w - g δ)`. A pixel that went beyond the picture is for what it does already.
    fn asked(&self, motion: &Motion, i: &Plane, j: &Plane, n_threads: usize) -> [Plane; 2] {
        let [mut bx, mut by] = motion.mismatch(i, j, n_threads);
        bands([&mut bx.data, &mut by.data], i.width, n_threads, |first, [bx, by]| {
            let [gx, gy] = self.gradient.each_ref().map(|plane| plane.rows(first, bx.len()));
            let [u, v] = [&motion.u, &motion.v].map(|plane| plane.rows(first, bx.len()));
            let g = gx.iter().zip(gy).zip(u.iter().zip(v));
            for ((bx, by), ((gx, gy), (u, v))) in bx.iter_mut().zip(by).zip(g) {
                let along = gx * u + gy * v - *bx;
                (*bx, *by) = (gx * along, gy * along);
            }
        });
        [bx, by].map(|b| b.filtered(&self.weights, Border::Nothing, n_threads))
    }
}
