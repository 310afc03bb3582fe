//! Corners to a fraction of a pixel: where every edge around them points to.

use honami_model::picture::Gray;

use crate::meeting::{self, Lines, meeting};

/// How much of the picture around a corner is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// What belongs to the corner: not quite half a square each way, as the board lies in the picture.
    Squares,
    /// A square of this radius, pixels, wherever it reaches: what OpenCV's `cornerSubPix` does. Where squares are seen smaller than
    /// that, edges of other corners draw this one off.
    Radius(u32),
}

/// At rest, pixels.
const AT_REST_PX: f64 = 1e-4;
/// How far a window reaches, of the distance to the next corner.
const REACH: f64 = 0.45;
/// Standard deviation of its weights.
const SPREAD: f64 = 0.2;
/// More pixels than these add little, and a lens bends edges.
const MOST_PX: f64 = 12.0;

/// The corners of a grid of so many columns, each at its place; one that finds none near it stays where it was.
#[must_use]
pub fn refined(picture: &Gray<'_>, corners: &[[f64; 2]], columns: usize, window: Window) -> Vec<[f64; 2]> {
    (0..corners.len())
        .map(|i| {
            let cell = cell(corners, columns, i);
            let weights = Weights::new(cell, window);
            let window = meeting::Window {
                weight: |off| weights.of(off),
                radius_px: weights.radius_px,
                at_rest_px: weights.at_rest_px,
            };
            meeting(picture, corners[i], Lines::Edges, &window).unwrap_or(corners[i])
        })
        .collect()
}

/// Steps to the next corner along a row and down a column.
fn cell(corners: &[[f64; 2]], columns: usize, i: usize) -> [[f64; 2]; 2] {
    let (column, row, rows) = (i % columns, i / columns, corners.len() / columns);
    let step = |before: usize, after: usize, n: usize| {
        let n = n as f64;
        [0, 1].map(|axis| (corners[after][axis] - corners[before][axis]) / n)
    };
    let (left, right) = (column.saturating_sub(1), (column + 1).min(columns - 1));
    let (above, below) = (row.saturating_sub(1), (row + 1).min(rows - 1));
    let of_row = |column: usize| row * columns + column;
    [
        step(of_row(left), of_row(right), right - left),
        step(above * columns + column, below * columns + column, below - above),
    ]
}

/// What a pixel counts, by where it lies from the corner.
struct Weights {
    /// From pixels to steps of the grid, or to radii of the window.
    inverse: [[f64; 2]; 2],
    reach: f64,
    spread: f64,
    radius_px: i32,
    at_rest_px: f64,
}

impl Weights {
    fn new([along, down]: [[f64; 2]; 2], window: Window) -> Self {
        if let Window::Radius(radius) = window {
            // OpenCV's weights: exp(-(x / r)²) each way.
            let (per_px, spread) = (1.0 / f64::from(radius.max(1)), std::f64::consts::FRAC_1_SQRT_2);
            let inverse = [[per_px, 0.0], [0.0, per_px]];
            return Self { inverse, reach: 1.0, spread, radius_px: radius.max(1) as i32, at_rest_px: 0.01 };
        }
        let determinant = along[0] * down[1] - along[1] * down[0];
        let inverse = [
            [down[1] / determinant, -down[0] / determinant],
            [-along[1] / determinant, along[0] / determinant],
        ];
        let longest = [0, 1].map(|axis| along[axis].abs() + down[axis].abs());
        let radius_px = (REACH * longest[0].max(longest[1])).clamp(2.0, MOST_PX).ceil() as i32;
        Self { inverse, reach: REACH, spread: SPREAD, radius_px, at_rest_px: AT_REST_PX }
    }

    fn of(&self, [x, y]: [f64; 2]) -> f64 {
        let [a, b] = self.inverse.map(|row| row[0] * x + row[1] * y);
        if a.abs().max(b.abs()) > self.reach {
            return 0.0;
        }
        (-(a * a + b * b) / (2.0 * self.spread * self.spread)).exp()
    }
}
