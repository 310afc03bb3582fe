//! Windows that turn, stretch and shear: the affine refinement of points that [`track`](super::track) found.
//!
//! A pixel `x` of the window (from its centre) is looked for at `to + A x`. Each step solves the six unknowns of a small
//! motion of the *first* window, `x ↦ x + d + D x`, from which the mismatch `δ(x) = J(to + A x) - I(from + x)` comes:
//!
//! `(Σ s sᵀ) p = Σ s δ`, with `s = (g_x, g_y, x g_x, y g_x, x g_y, y g_y)`, `g = ∇I` and `p = (d, D row by row)`,
//!
//! and undoes it: `(to, A) ← (to, A) ∘ (x ↦ x + d + D x)⁻¹`. The matrix is that of J. Shi, C. Tomasi, "Good features to
//! track", CVPR 1994 (equation 7); to turn the roles of the pictures round so that it is made once is S. Baker,
//! I. Matthews, "Lucas-Kanade 20 years on", IJCV 56, 2004.

#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

use super::{Flow, Params, State};
use crate::pyramid::Pyramid;
use crate::work::{shared, threads};
use crate::{Point, sample};

/// Steps at most; one that goes on longer swings.
const MAX_STEPS: u32 = 20;
/// A window that is stretched or shorn by more in one frame is no window of this leaf any more.
const MOST_CHANGE: f64 = 0.5;

/// Refines the points that were found, each from where translation has brought it; the picture is looked at in full size
/// only.
///
/// A point stays as it is where its window, there or here, is not whole in the picture, where the window's texture
/// cannot tell six unknowns, and where the refined window fits worse than the one that was only moved. The answer is the
/// same bits for any number of threads.
///
/// # Panics
/// When there is not one flow a point.
#[track_caller]
pub fn refine(
    prev: &Pyramid,
    next: &Pyramid,
    from: &[Point],
    flows: &mut [Flow],
    params: &Params,
    max_threads: usize,
) {
    assert_eq!(from.len(), flows.len(), "one flow a point");
    let (prev, next) = (prev.picture(), next.picture());
    let n_threads = threads(from.len(), cost_ns(params), max_threads);
    shared([flows], 1, n_threads, |first, [flows]| {
        let mut window = Window::default();
        let points = flows.iter_mut().zip(&from[first..]);
        for (flow, &from) in points.filter(|(flow, _)| flow.state == State::Tracked) {
            if window.cut(&prev, from, params.radius_px)
                && let Some(to) = window.search(&next, flow.to, params)
            {
                flow.to = to;
            }
        }
    });
}

/// How long one point takes on one thread, roughly, nanoseconds.
#[must_use]
pub fn cost_ns(params: &Params) -> f64 {
    const PIXEL_NS: f64 = 30.0;
    PIXEL_NS * f64::from(2 * params.radius_px + 1).powi(2)
}

/// Where a window is, and how it lies there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    to: [f64; 2],
    /// Row by row.
    a: [f64; 4],
}

impl Pose {
    /// This pose after the inverse of `x ↦ x + d + D x`; `None` where that turns the window inside out.
    fn undone(self, [dx, dy, xx, xy, yx, yy]: [f64; 6]) -> Option<Self> {
        let [a, b, c, d] = [1.0 + xx, xy, yx, 1.0 + yy];
        let determinant = a * d - b * c;
        if determinant.is_nan() || determinant <= 0.1 {
            return None;
        }
        let inverse = [d, -b, -c, a].map(|entry| entry / determinant);
        let [p, q, r, s] = self.a;
        let a = [
            p * inverse[0] + q * inverse[2],
            p * inverse[1] + q * inverse[3],
            r * inverse[0] + s * inverse[2],
            r * inverse[1] + s * inverse[3],
        ];
        let to = [self.to[0] - a[0] * dx - a[1] * dy, self.to[1] - a[2] * dx - a[3] * dy];
        let change = a.iter().zip([1.0, 0.0, 0.0, 1.0]).map(|(a, one)| (a - one).abs()).fold(0.0, f64::max);
        (change <= MOST_CHANGE).then_some(Self { to, a })
    }
}

/// A window of the first picture.
#[derive(Default)]
struct Window {
    radius: i32,
    /// Brightness of the window and one pixel around it.
    patch: Vec<f32>,
    /// Brightness, `g_x` and `g_y` of every pixel, row by row.
    pixels: Vec<[f32; 3]>,
    /// Of the six unknowns, factored: `L` of `L Lᵀ`, row by row.
    factor: [[f64; 6]; 6],
}

impl Window {
    /// Takes the window around a point; `false` where it is not whole, or cannot tell six unknowns.
    fn cut(&mut self, picture: &Gray<'_>, at: Point, radius_px: u32) -> bool {
        let reach = radius_px as f32 + 1.0;
        let whole = |at: f32, n: u32| at - reach >= 0.0 && at + reach <= n as f32 - 1.0;
        if radius_px == 0 || !(whole(at[0], picture.width) && whole(at[1], picture.height)) {
            return false;
        }
        self.radius = radius_px as i32;
        sample::patch(picture, at, radius_px + 1, &mut self.patch);
        let side = 2 * radius_px as usize + 1;
        let stride = side + 2;
        self.pixels.clear();
        let mut matrix = [[0.0; 6]; 6];
        for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
            let at = |dy: usize, dx: usize| self.patch[(row + dy) * stride + column + dx];
            // Scharr's weights.
            let slope = |a: f32, b: f32, c: f32| (3.0 * (a + c) + 10.0 * b) / 32.0;
            let across = |dy: usize| at(dy, 2) - at(dy, 0);
            let down = |dx: usize| at(2, dx) - at(0, dx);
            let (gx, gy) = (slope(across(0), across(1), across(2)), slope(down(0), down(1), down(2)));
            self.pixels.push([at(1, 1), gx, gy]);
            let s = unknowns(column as i32 - self.radius, row as i32 - self.radius, gx, gy).map(f64::from);
            for (i, entries) in matrix.iter_mut().enumerate() {
                for (entry, other) in entries[..=i].iter_mut().zip(s) {
                    *entry += s[i] * other;
                }
            }
        }
        factored(&matrix).map(|factor| self.factor = factor).is_some()
    }

    /// The refined position, where it fits better than `start`.
    fn search(&self, picture: &Gray<'_>, start: Point, params: &Params) -> Option<Point> {
        let mut pose = Pose { to: start.map(f64::from), a: [1.0, 0.0, 0.0, 1.0] };
        let (mut asked, begun) = self.mismatch(picture, &pose)?;
        let mut fit = begun;
        for _ in 0..MAX_STEPS.min(params.max_iterations) {
            let step = solved(&self.factor, asked);
            let next = pose.undone(step)?;
            let (next_asked, next_fit) = self.mismatch(picture, &next)?;
            if next_fit >= fit {
                break;
            }
            let length = (next.to[0] - pose.to[0]).hypot(next.to[1] - pose.to[1]);
            (pose, asked, fit) = (next, next_asked, next_fit);
            if length <= f64::from(params.epsilon_px) {
                break;
            }
        }
        let to = pose.to.map(|c| c as f32);
        let astray = (to[0] - start[0]).hypot(to[1] - start[1]) > params.radius_px as f32 / 2.0;
        (fit < begun && !astray).then_some(to)
    }

    /// `Σ s δ` and `Σ δ²` of a pose; `None` where the window is not whole in the picture.
    fn mismatch(&self, picture: &Gray<'_>, pose: &Pose) -> Option<([f64; 6], f64)> {
        let Pose { to, a } = *pose;
        let reach = f64::from(self.radius);
        for (axis, n) in [picture.width, picture.height].into_iter().enumerate() {
            let half = reach * (a[2 * axis].abs() + a[2 * axis + 1].abs());
            // Half a pixel more, for rounding.
            if !(to[axis] - half >= 0.5 && to[axis] + half <= f64::from(n) - 2.5) {
                return None;
            }
        }
        let [to, a] = [[to[0], to[1], 0.0, 0.0], a].map(|v| v.map(|c| c as f32));
        let (mut sums, mut squares) = ([0.0_f64; 6], 0.0_f64);
        let side = (2 * self.radius + 1) as usize;
        for (y, row) in (-self.radius..).zip(self.pixels.chunks_exact(side)) {
            let mut few = [0.0_f32; 5];
            for (x, &[value, gx, gy]) in (-self.radius..).zip(row) {
                let (fx, fy) = (x as f32, y as f32);
                let (px, py) = (to[0] + a[0] * fx + a[1] * fy, to[1] + a[2] * fx + a[3] * fy);
                let delta = between(picture, px, py) - value;
                let (ex, ey) = (gx * delta, gy * delta);
                few[0] += ex;
                few[1] += ey;
                few[2] += fx * ex;
                few[3] += fx * ey;
                few[4] += delta * delta;
            }
            let [ex, ey, xx, xy, square] = few.map(f64::from);
            let y = f64::from(y);
            for (sum, term) in sums.iter_mut().zip([ex, ey, xx, y * ex, xy, y * ey]) {
                *sum += term;
            }
            squares += square;
        }
        Some((sums, squares))
    }
}

/// Brightness between four pixels of the picture.
fn between(picture: &Gray<'_>, x: f32, y: f32) -> f32 {
    let (x0, y0) = (x as usize, y as usize);
    let (fx, fy) = (x - x0 as f32, y - y0 as f32);
    let i = y0 * picture.stride + x0;
    let pair = |i: usize| {
        let (left, right) = (f32::from(picture.data[i]), f32::from(picture.data[i + 1]));
        left + fx * (right - left)
    };
    let (top, bottom) = (pair(i), pair(i + picture.stride));
    top + fy * (bottom - top)
}

/// What a pixel's gradient tells of the six unknowns.
fn unknowns(x: i32, y: i32, gx: f32, gy: f32) -> [f32; 6] {
    let (x, y) = (x as f32, y as f32);
    [gx, gy, x * gx, y * gx, x * gy, y * gy]
}

/// Cholesky's factor of a symmetric matrix, of which the lower half is read; `None` where it is not well positive.
fn factored(matrix: &[[f64; 6]; 6]) -> Option<[[f64; 6]; 6]> {
    /// A pivot below this share of its diagonal entry is lost in the others.
    const SMALLEST_SHARE: f64 = 1e-4;
    let mut l = [[0.0; 6]; 6];
    for i in 0..6 {
        for k in 0..=i {
            let rest = matrix[i][k] - (0..k).map(|j| l[i][j] * l[k][j]).sum::<f64>();
            if i != k {
                l[i][k] = rest / l[k][k];
            } else if rest > SMALLEST_SHARE * matrix[i][i] && rest.is_finite() {
                l[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(l)
}

/// The solution of `L Lᵀ p = b`.
fn solved(l: &[[f64; 6]; 6], b: [f64; 6]) -> [f64; 6] {
    let mut p = b;
    for i in 0..6 {
        p[i] = (p[i] - (0..i).map(|j| l[i][j] * p[j]).sum::<f64>()) / l[i][i];
    }
    for i in (0..6).rev() {
        p[i] = (p[i] - (i + 1..6).map(|j| l[j][i] * p[j]).sum::<f64>()) / l[i][i];
    }
    p
}
