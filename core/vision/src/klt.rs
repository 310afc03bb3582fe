//! Pyramidal iterative Lucas-Kanade: where a small window of one picture went in the next.
//!
//! B. D. Lucas, T. Kanade, "An iterative image registration technique", IJCAI 1981; J.-Y. Bouguet, "Pyramidal
//! implementation of the Lucas Kanade feature tracker", Intel 2000; J. Diener's thesis, 2.4.3 and 2.5.1
//! (errata E1: the constraint is `I_x u + I_t = 0`; errata E4: level k starts from level k+1's solution).
//!
//! With the window `W` around the point, `g = ∇I` and the mismatch `δ(v) = J(x + v) - I(x)`, each step solves
//! `(Σ_W g gᵀ) dv = -Σ_W δ g` and moves by `dv`, until it is shorter than a hundredth of a pixel.
//!
//! Pixels, gradients and mismatches are 16-bit fixed-point numbers and their sums are exact integers, so the
//! plain kernel and the fast ones give the same bits (`klt/window.rs`).

pub mod affine;
#[cfg(test)]
mod tests;
mod window;

use crate::pyramid::{Level, Pyramid, border_px};
use crate::work::{shared, threads};
use crate::{Point, simd};
use window::{Sums, Window};

/// How to track; the defaults are OpenCV's for `calcOpticalFlowPyrLK` with four levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Radius of the window, pixels; its side is `2r + 1`.
    pub radius_px: u32,
    /// Levels of the pyramid to use, at least 1; a pyramid with fewer is used whole.
    pub levels: u32,
    /// Steps on each level, at most.
    pub max_iterations: u32,
    /// A step shorter than this ends the search on a level, pixels of that level.
    pub epsilon_px: f32,
    /// A window whose gradient matrix has a smaller eigenvalue is flat. OpenCV's measure: gradients are Scharr's
    /// (32 times gray levels per pixel), the matrix is divided by 2²⁰ and by the area of the window, so 1e-4 is
    /// a mean square gradient of 0.1 (gray levels per pixel)².
    pub min_eigenvalue: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self { radius_px: 10, levels: 4, max_iterations: 30, epsilon_px: 0.01, min_eigenvalue: 1e-4 }
    }
}

impl Params {
    /// How long one point takes on one thread, roughly, nanoseconds: windows are compared a few times on every level.
    #[must_use]
    pub fn cost_ns(&self) -> f64 {
        const PIXEL_NS: f64 = 0.2;
        /// Most searches end after fewer steps.
        const USUAL_STEPS: u32 = 10;
        let area = f64::from(2 * self.radius_px + 1).powi(2);
        let looks = 1 + self.max_iterations.min(USUAL_STEPS);
        PIXEL_NS * area * f64::from(looks) * f64::from(self.levels.max(1))
    }
}

/// Where a point went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Position in the next picture; the last good guess where it was not found. Always finite.
    pub to: Point,
    /// Whether it was found.
    pub state: State,
}

/// Whether a point was found in the next picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Found.
    Tracked,
    /// It is, or went, beyond the picture.
    Outside,
    /// Not found.
    Lost(Reason),
}

/// Why a point was not found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Its window has no texture, or only edges of one direction.
    Flat,
    /// The position, or the guess, that was handed in is not a finite number.
    NotFinite,
}

/// Follows points from one picture to the next, on up to `max_threads` threads.
///
/// `guesses` are positions in the next picture to start from; without them a point starts where it was. The
/// answer has one entry a point, in order, the same bits for any number of threads.
///
/// # Panics
/// When the pictures differ in size, a pyramid was made for a smaller radius, or there is not one guess a point.
#[must_use]
#[track_caller]
pub fn track(
    prev: &Pyramid,
    next: &Pyramid,
    from: &[Point],
    guesses: Option<&[Point]>,
    params: &Params,
    max_threads: usize,
) -> Vec<Flow> {
    track_at(simd::best(), prev, next, from, guesses, params, max_threads)
}

/// [`track`] with the kernels of a chosen level; the answer is the same, only the time differs.
///
/// # Panics
/// As [`track`].
#[must_use]
#[track_caller]
pub fn track_at(
    simd: simd::Level,
    prev: &Pyramid,
    next: &Pyramid,
    from: &[Point],
    guesses: Option<&[Point]>,
    params: &Params,
    max_threads: usize,
) -> Vec<Flow> {
    let guesses = guesses.unwrap_or(from);
    assert_eq!(from.len(), guesses.len(), "one guess a point");
    let pairs: Vec<_> = prev.levels().iter().zip(next.levels()).take(params.levels.max(1) as usize).collect();
    for (i, j) in &pairs {
        assert_eq!((i.width(), i.height()), (j.width(), j.height()), "size of the two pictures");
        let border = i.border_px().min(j.border_px());
        assert!(border >= border_px(params.radius_px), "pyramid made for a smaller radius");
    }

    let mut flows = vec![Flow { to: [0.0; 2], state: State::Lost(Reason::NotFinite) }; from.len()];
    let n_threads = threads(from.len(), params.cost_ns(), max_threads);
    shared([&mut flows], 1, n_threads, |first, [flows]| {
        let mut search = Search { params, window: Window::new(simd, params.radius_px) };
        for ((flow, &from), &guess) in flows.iter_mut().zip(&from[first..]).zip(&guesses[first..]) {
            *flow = search.follow(&pairs, from, guess);
        }
    });
    flows
}

/// One thread's search: parameters and scratch memory.
struct Search<'a> {
    params: &'a Params,
    window: Window,
}

impl Search<'_> {
    /// Follows one point from the coarsest level to the finest.
    fn follow(&mut self, pairs: &[(&Level, &Level)], from: Point, guess: Point) -> Flow {
        if !from.iter().chain(&guess).all(|c| c.is_finite()) {
            return Flow { to: [0.0; 2], state: State::Lost(Reason::NotFinite) };
        }
        let top = (1_u32 << (pairs.len() - 1)) as f32;
        let mut flow = Flow { to: [guess[0] / top, guess[1] / top], state: State::Tracked };
        for (k, &(prev, next)) in pairs.iter().enumerate().rev() {
            // Only the answer of the finest level counts; a coarse one that fails leaves its guess to the next.
            let scale = (1_u32 << k) as f32;
            flow = self.refine(prev, next, [from[0] / scale, from[1] / scale], flow.to);
            if k > 0 {
                flow.to = flow.to.map(|c| c * 2.0);
            }
        }
        if flow.state == State::Tracked && !pairs[0].1.picture().holds(flow.to) {
            flow.state = State::Outside;
        }
        flow
    }

    /// Searches on one level, from a guess.
    fn refine(&mut self, prev: &Level, next: &Level, from: Point, mut to: Point) -> Flow {
        let Params { radius_px, max_iterations, epsilon_px, min_eigenvalue, .. } = *self.params;
        let Some(corner) = Corner::of(prev, from, radius_px) else {
            return Flow { to, state: State::Outside };
        };
        let sums = self.window.cut(prev, corner);
        let area = f64::from((2 * radius_px + 1).pow(2));
        let Some(solver) = Solver::new(&sums, area, f64::from(min_eigenvalue)) else {
            return Flow { to, state: State::Lost(Reason::Flat) };
        };

        let mut before = [0.0_f32; 2];
        for i in 0..max_iterations {
            let Some(corner) = Corner::of(next, to, radius_px) else {
                return Flow { to, state: State::Outside };
            };
            let step = solver.step(self.window.mismatch(next, corner));
            to = [to[0] + step[0], to[1] + step[1]];
            if step[0] * step[0] + step[1] * step[1] <= epsilon_px * epsilon_px {
                break;
            }
            // It swings between two places: settle half-way, as OpenCV does.
            if i > 0 && (step[0] + before[0]).abs() < SWING_PX && (step[1] + before[1]).abs() < SWING_PX {
                to = [to[0] - step[0] / 2.0, to[1] - step[1] / 2.0];
                break;
            }
            before = step;
        }
        Flow { to, state: State::Tracked }
    }
}

/// Two opposite steps that differ by less than this are a swing, pixels (OpenCV's number).
const SWING_PX: f32 = 0.01;

/// First pixel of a window, and how far the window lies beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    x: i32,
    y: i32,
    /// Right and down, in 2¹⁵ths of a pixel, 0..=32767.
    fraction: [i16; 2],
}

impl Corner {
    /// `None` where the window shares no pixel with the picture, or `centre` is not finite.
    fn of(level: &Level, centre: Point, radius_px: u32) -> Option<Self> {
        let split = |centre: f32, n: u32| {
            let start = centre - radius_px as f32;
            let whole = start.floor();
            let fraction = ((start - whole) * 32768.0).round().min(32767.0) as i16;
            let first = -(2.0 * radius_px as f32 + 1.0);
            (whole >= first && whole < n as f32).then_some((whole as i32, fraction))
        };
        let (x, fx) = split(centre[0], level.width())?;
        let (y, fy) = split(centre[1], level.height())?;
        Some(Self { x, y, fraction: [fx, fy] })
    }
}

/// The 2x2 system of a window.
struct Solver {
    a: [f64; 3],
    determinant: f64,
}

impl Solver {
    /// `None` when the window is flat.
    fn new(&Sums { xx, xy, yy }: &Sums, area: f64, min_eigenvalue: f64) -> Option<Self> {
        /// Scale of the eigenvalue (see [`Params::min_eigenvalue`]).
        const UNIT: f64 = (1_u32 << 20) as f64;
        let [xx, xy, yy] = [xx, xy, yy].map(|sum| sum as f64);
        let smaller = (xx + yy - ((xx - yy).powi(2) + 4.0 * xy * xy).sqrt()) / 2.0;
        let determinant = xx * yy - xy * xy;
        let solvable = smaller / (UNIT * area) >= min_eigenvalue && determinant >= f64::EPSILON * xx * yy;
        (solvable && determinant > 0.0).then_some(Self { a: [xx, xy, yy], determinant })
    }

    /// The step that the sums of mismatch times gradient ask for, pixels.
    fn step(&self, mismatch: [i64; 2]) -> Point {
        let [bx, by] = mismatch.map(|sum| sum as f64);
        let [xx, xy, yy] = self.a;
        [((xy * by - yy * bx) / self.determinant) as f32, ((xy * bx - xx * by) / self.determinant) as f32]
    }
}
