//! Fits a template to a picture: position, warp, gain and offset together, to a fraction of a pixel.
//!
//! With `I(W(u))` the picture seen through the warp and `t(u)` the template, each step finds by least squares
//! `I(W(u)) ≈ g t(u) + b + g ∇t(u)·(ΔA u + Δc)`, so that `I(W(u)) ≈ g t((1 + ΔA) u + Δc) + b`, and takes the step back
//! out of the warp: `A ← A (1 + ΔA)⁻¹`, `c ← c - A Δc`. The slopes are the template's, which do not change: S. Baker,
//! I. Matthews, "Lucas-Kanade 20 years on", IJCV 56, 2004 (inverse composition); pixels that are off are weighed down
//! by Geman-McClure's function. Turning, growing and shearing cost more, in this order.

use super::kernel::{Light, N_BASIS, Normal};
use super::template::{Desk, Fit, line};
use super::warp::{Warp, apply, determinant, inverse, product};
use crate::{Gray, Point};

/// Normal equations.
type Matrix = [[f64; N_BASIS]; N_BASIS];
type Vector = [f64; N_BASIS];

/// The longest step, of the centre or of an edge, pixels of the template.
const STRIDE_PX: f32 = 2.0;

impl Desk<'_> {
    /// Fits the template that lies on the desk, from a guess; `expected` is what the warp is likely to be.
    pub(super) fn refine(&mut self, gray: &Gray<'_>, from: Point, expected: Warp) -> Fit {
        let from = self.centre(from, expected);
        let (mut at, mut warp) = (from, expected);
        let per_outlier = 1.0 / self.params.outlier_gray;
        let mut light: Option<Light> = None;
        for _ in 0..self.params.max_steps {
            self.look(gray, at, warp);
            let now = light.unwrap_or_else(|| {
                let line = line(&self.moments());
                Light { gain: line.gain, offset: line.offset, per_outlier }
            });
            let sums = self.kernel.normal(&self.cells, &self.image, now);
            let Some(step) = self.step(&sums, warp, expected, now.gain) else { break };
            light = Some(Light { gain: step.gain, offset: step.offset, per_outlier });
            let Some(back) = inverse(step.warp) else { break };
            let next = product(warp, back);
            let moved = apply(next, step.move_px);
            let to = [at[0] - moved[0], at[1] - moved[1]];
            let is_sound = (0.3..3.0).contains(&determinant(next)) && to.iter().all(|c| c.is_finite());
            if !is_sound || (to[0] - from[0]).hypot(to[1] - from[1]) > self.params.radius_px as f32 {
                break;
            }
            (at, warp) = (to, next);
            if step.is_small(self.params.epsilon_px) {
                break;
            }
        }
        self.look(gray, at, warp);
        let (ncc, contrast) = self.likeness();
        Fit { at: self.point(at, warp), warp, ncc, contrast }
    }

    /// The step that the sums ask for.
    fn step(&self, sums: &Normal, warp: Warp, expected: Warp, gain: f32) -> Option<Step> {
        let mut matrix = [[0.0; N_BASIS]; N_BASIS];
        let mut k = 0;
        for i in 0..N_BASIS {
            for j in i..N_BASIS {
                matrix[i][j] = f64::from(sums.products[k]);
                matrix[j][i] = matrix[i][j];
                k += 1;
            }
        }
        let mut right = sums.right.map(f64::from);
        self.expect(&mut matrix, &mut right, product(inverse(warp)?, expected), gain);
        let solution = solve(matrix, right)?;
        let gain = solution[6];
        // A picture that is the template's negative, or has none of its contrast, is not it.
        if gain < 0.2 {
            return None;
        }
        let change: [f32; 6] = std::array::from_fn(|i| (solution[i] / gain) as f32);
        let edge_px = change[2..].iter().fold(0.0_f32, |most, c| most.max(c.abs()));
        let share = (STRIDE_PX / edge_px.max(change[0].hypot(change[1]))).min(1.0);
        let radius = self.params.radius_px as f32;
        let [a, b, c, d] = [2, 3, 4, 5].map(|i| share * change[i] / radius);
        Some(Step {
            move_px: [share * change[0], share * change[1]],
            warp: [1.0 + a, b, c, 1.0 + d],
            edge_px: share * edge_px,
            gain: (gain as f32).clamp(0.4, 2.5),
            offset: solution[7] as f32,
        })
    }

    /// Adds what speaks against turning, growing and shearing away from what is expected: `rest` is still to go.
    fn expect(&self, matrix: &mut Matrix, right: &mut Vector, rest: Warp, gain: f32) {
        let slope = (matrix[0][0] + matrix[1][1]) / 2.0;
        let edge = f64::from(self.params.radius_px as f32 * gain);
        let wanted =
            [1.0 - rest[0], -rest[1], -rest[2], 1.0 - rest[3]].map(|change| f64::from(change) * edge);
        let [turn, growth, shear] = self.params.stiffness.map(|s| f64::from(s) * slope);
        let ways = [
            ([0.0, -1.0, 1.0, 0.0], turn),
            ([1.0, 0.0, 0.0, 1.0], growth),
            ([1.0, 0.0, 0.0, -1.0], shear),
            ([0.0, 1.0, 1.0, 0.0], shear),
        ];
        for (way, cost) in ways {
            let target: f64 = way.iter().zip(&wanted).map(|(w, t)| w * t).sum();
            for i in 0..4 {
                for j in 0..4 {
                    matrix[2 + i][2 + j] += cost * way[i] * way[j];
                }
                right[2 + i] += cost * way[i] * target;
            }
        }
    }
}

/// How the template is to change to look like the picture.
struct Step {
    move_px: Point,
    warp: Warp,
    /// How far the edge of the window moves, pixels.
    edge_px: f32,
    gain: f32,
    offset: f32,
}

impl Step {
    fn is_small(&self, epsilon_px: f32) -> bool {
        self.move_px[0].hypot(self.move_px[1]) < epsilon_px && self.edge_px < 5.0 * epsilon_px
    }
}

/// Gauss's elimination; the matrix is symmetric and has no negative eigenvalue. `None` where it has a zero one.
fn solve(mut matrix: Matrix, mut right: Vector) -> Option<Vector> {
    for i in 0..N_BASIS {
        let pivot = matrix[i][i];
        if pivot <= 1e-9 || !pivot.is_finite() {
            return None;
        }
        for j in i + 1..N_BASIS {
            let share = matrix[j][i] / pivot;
            for k in i..N_BASIS {
                matrix[j][k] -= share * matrix[i][k];
            }
            right[j] -= share * right[i];
        }
    }
    for i in (0..N_BASIS).rev() {
        let known: f64 = (i + 1..N_BASIS).map(|k| matrix[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / matrix[i][i];
    }
    Some(right)
}
