//! Dense motion by Horn and Schunck: as constant a brightness and as smooth a motion as agree with each other.
//!
//! B. K. P. Horn, B. G. Schunck, "Determining optical flow", Artificial Intelligence 17, 1981; J. Diener's thesis,
//! 2.4.3. The motion `(u, v)` makes
//!
//! `∬ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²) dx dy`
//!
//! least (errata E2: the smoothness is quadratic already, and α is squared; errata E1: the constraint is
//! `I_x u + I_y v + I_t = 0`). α is in gray levels: where motion differs by 1 px from a pixel to the next, that costs
//! as much as a brightness that is off by α.
//!
//! The first order holds for small motion only. So the pyramid begins at its coarsest level at rest; on each level the
//! second picture is warped by the motion so far, several times, and what is left is brought to first order anew. The
//! smoothness is that of the whole motion, not of the step.

mod solver;
#[cfg(test)]
mod tests;

use crate::field::{Field, Grid};
use crate::plane::{Motion, Plane, Scales, bands, descend};
use solver::System;

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Weight of the smoothness, gray levels, more than 0.
    pub alpha_gray: f32,
    /// Levels of the pyramid to use, at least 1.
    pub levels: u32,
    /// How often the second picture is warped on each level.
    pub warps: u32,
    /// Sweeps over all pixels after each warp, at most.
    pub max_sweeps: u32,
    /// Sweeps end when pixels are off what their neighbours and their brightness ask for by less than this, root of
    /// the mean square, pixels.
    pub tolerance_px: f32,
    /// A brightness that is off by more than this many gray levels counts ever less (Charbonnier's law); 0: as much as
    /// its square.
    pub robust_gray: f32,
    /// Whether the motion goes through a 3x3 median after each warp, which keeps edges of motion sharp.
    pub median: bool,
    /// From a node of the field to the next, pixels, at least 1.
    pub step_px: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            alpha_gray: 10.0,
            levels: 6,
            warps: 3,
            max_sweeps: 40,
            tolerance_px: 1e-3,
            robust_gray: 5.0,
            median: true,
            step_px: 2,
        }
    }
}

/// The standard deviation by which pictures are best smoothed, pixels: differences of neighbours are noise without.
pub const SMOOTHING_PX: f32 = 0.8;

/// Displacements from one picture to the next, on up to `n_threads` threads; `None` where `go_on`, which is told the
/// share of the work that is done, said no. Every node is known.
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
    let motion = descend([from, to], params.levels, n_threads, go_on, |mut motion, i, j, go_on| {
        for n in 0..params.warps {
            let share = |done: f64| (f64::from(n) + done) / f64::from(params.warps);
            let mut system =
                System::new(&constraint(&motion, i, j, params, n_threads), &motion, params.alpha_gray);
            system.solve(params.max_sweeps, params.tolerance_px, n_threads, &|done| go_on(share(done)))?;
            motion = system.motion();
            if params.median {
                motion = Motion { u: motion.u.median(n_threads), v: motion.v.median(n_threads) };
            }
        }
        Some(motion)
    })?;
    let grid = Grid::over(motion.u.width as u32, motion.u.height as u32, params.step_px);
    Some(Field::new(grid, grid.nodes().map(|[x, y]| Some([motion.u.at(x, y), motion.v.at(x, y)]))))
}

/// What brightness asks of every pixel: `gx u + gy v + rest = 0`, each equation times its own weight.
pub(super) struct Constraint {
    gx: Plane,
    gy: Plane,
    rest: Plane,
}

/// The constancy of brightness around the motion so far, to first order.
///
/// The gradient is that of the mean of the first picture and the second, warped: an error of second order cancels. A
/// pixel that went beyond the picture asks for nothing.
fn constraint(motion: &Motion, i: &Plane, j: &Plane, params: &Params, n_threads: usize) -> Constraint {
    let [delta, inside] = motion.mismatch(i, j, n_threads);
    let mut mean = i.clone();
    mean.data.iter_mut().zip(&delta.data).for_each(|(mean, delta)| *mean += delta / 2.0);
    let [mut gx, mut gy] = mean.gradient(n_threads);
    let mut rest = delta;
    let sharpness = if params.robust_gray > 0.0 { params.robust_gray.powi(-2) } else { 0.0 };
    bands([&mut gx.data, &mut gy.data, &mut rest.data], i.width, n_threads, |first, [gx, gy, rest]| {
        let [inside, u, v] = [&inside, &motion.u, &motion.v].map(|plane| plane.rows(first, gx.len()));
        let pixels = gx.iter_mut().zip(gy).zip(rest);
        for (((gx, gy), rest), ((inside, u), v)) in pixels.zip(inside.iter().zip(u).zip(v)) {
            // The root of the weight 1 / √(1 + (δ/ε)²).
            let weight = inside / (1.0 + sharpness * *rest * *rest).sqrt().sqrt();
            (*gx, *gy) = (*gx * weight, *gy * weight);
            *rest = *rest * weight - *gx * u - *gy * v;
        }
    });
    Constraint { gx, gy, rest }
}
