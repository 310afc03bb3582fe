//! Boards that are drawn as a camera would see them.

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

use crate::Gray;
use crate::board::Board;

/// A board before a camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub(super) board: Board,
    pub(super) size: [u32; 2],
    /// Side of a square where it is nearest to facing the camera, pixels.
    pub(super) square_px: f64,
    /// Turns about the picture's x, y and about the sight, degrees.
    pub(super) turns_deg: [f64; 3],
    /// Middle of the board, from that of the picture, pixels.
    pub(super) aside_px: [f64; 2],
    /// Of A. Fitzgibbon's division model, `undistorted = distorted / (1 + lens · r²)`, r in half widths: negative is a barrel.
    pub(super) lens: f64,
    /// Standard deviation of the blur and of the noise, pixels and grey levels.
    pub(super) blur_px: f64,
    pub(super) noise: f64,
    pub(super) dark: f64,
    pub(super) bright: f64,
    /// Something grey before the picture: left, top, right, bottom, pixels.
    pub(super) before: Option<[f64; 4]>,
}

impl Default for Drawn {
    fn default() -> Self {
        Self {
            board: Board { columns: 9, rows: 6 },
            size: [640, 480],
            square_px: 40.0,
            turns_deg: [10.0, -15.0, 5.0],
            aside_px: [0.0; 2],
            lens: 0.0,
            blur_px: 0.7,
            noise: 1.0,
            dark: 30.0,
            bright: 220.0,
            before: None,
        }
    }
}

type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn applied(a: &Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    let [u, v, w] = [0, 1, 2].map(|i| a[i][0] * x + a[i][1] * y + a[i][2]);
    [u / w, v / w]
}

/// Up to its size, which directions do not have.
fn inverse(a: &Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (r, s, c, d) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
        a[r][c] * a[s][d] - a[r][d] * a[s][c]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| minor(i, j)))
}

impl Drawn {
    /// From squares, `(0, 0)` the first corner, to pixels from the picture's middle, without the lens.
    fn pixels_from_squares(&self) -> Matrix {
        let [(sx, cx), (sy, cy), (sz, cz)] = self.turns_deg.map(|deg| deg.to_radians().sin_cos());
        let about_x = [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]];
        let about_y = [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]];
        let about_z = [[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]];
        let turn = times(&about_y, &times(&about_x, &about_z));
        let focal = f64::from(self.size[0]);
        let depth = focal / self.square_px;
        let middle = [self.board.columns, self.board.rows].map(|n| (n as f64 - 1.0) / 2.0);
        let row = |i: usize, beyond: f64| {
            [turn[i][0], turn[i][1], beyond - turn[i][0] * middle[0] - turn[i][1] * middle[1]]
        };
        let [right, down] = self.aside_px.map(|px| px / self.square_px);
        let [x, y, z] = [row(0, right), row(1, down), row(2, depth)];
        [x.map(|v| v * focal), y.map(|v| v * focal), z]
    }

    fn middle(&self) -> [f64; 2] {
        self.size.map(|n| (f64::from(n) - 1.0) / 2.0)
    }

    /// Where the corners are, row by row.
    pub(super) fn corners(&self) -> Vec<[f64; 2]> {
        let (matrix, middle, unit) =
            (self.pixels_from_squares(), self.middle(), f64::from(self.size[0]) / 2.0);
        let columns = self.board.columns;
        let corner = |i: usize| {
            let [x, y] = applied(&matrix, [(i % columns) as f64, (i / columns) as f64]);
            let r = x.hypot(y) / unit;
            // The root of r = d / (1 + lens d²) that is r where there is no lens.
            let d = 2.0 / (1.0 + (1.0 - 4.0 * self.lens * r * r).sqrt());
            [x * d + middle[0], y * d + middle[1]]
        };
        (0..columns * self.board.rows).map(corner).collect()
    }

    pub(super) fn picture(&self, seed: u64) -> Vec<u8> {
        // Spread so that no two samples of a pixel are in line with its sides, which edges may be.
        const FINE: i32 = 16;
        let squares = inverse(&self.pixels_from_squares());
        let (middle, unit) = (self.middle(), f64::from(self.size[0]) / 2.0);
        let light = |at: [f64; 2]| {
            let [x, y] = [at[0] - middle[0], at[1] - middle[1]];
            let bent = 1.0 + self.lens * (x * x + y * y) / (unit * unit);
            let [column, row] = applied(&squares, [x / bent, y / bent]);
            self.light(at, column, row)
        };
        let [width, height] = self.size;
        let mut picture = Vec::with_capacity((width * height) as usize);
        for y in 0..height {
            for x in 0..width {
                let mut sum = 0.0;
                for k in 0..FINE {
                    let off = |k: i32| (f64::from(k) + 0.5) / f64::from(FINE) - 0.5;
                    sum += light([f64::from(x) + off(k), f64::from(y) + off(k * 7 % FINE)]);
                }
                picture.push(sum / f64::from(FINE));
            }
        }
        let blurred = blurred(&picture, width as usize, self.blur_px);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let noise = Normal::new(0.0, self.noise).unwrap();
        blurred.iter().map(|v| (v + noise.sample(&mut random)).round().clamp(0.0, 255.0) as u8).collect()
    }

    fn light(&self, [x, y]: [f64; 2], column: f64, row: f64) -> f64 {
        if self
            .before
            .is_some_and(|[left, top, right, bottom]| x > left && x < right && y > top && y < bottom)
        {
            return 120.0;
        }
        let [columns, rows] = [self.board.columns, self.board.rows].map(|n| n as f64);
        let inside =
            |rim: f64| column > -1.0 - rim && row > -1.0 - rim && column < columns + rim && row < rows + rim;
        // The outermost square at the first corner is dark.
        let is_dark = (column.floor() + row.floor()).rem_euclid(2.0) < 0.5;
        if inside(0.0) && is_dark {
            self.dark
        } else if inside(0.7) {
            self.bright
        } else {
            // What is behind the board: waves of light.
            110.0 + 40.0 * (x * 0.05).sin() * (y * 0.07).cos()
        }
    }
}

fn blurred(picture: &[f64], width: usize, sigma: f64) -> Vec<f64> {
    let radius = (3.0 * sigma).ceil() as i64;
    let weights: Vec<f64> =
        (-radius..=radius).map(|k| (-((k * k) as f64) / (2.0 * sigma * sigma).max(1e-9)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let height = picture.len() / width;
    let along = |from: &[f64], step: usize, n: usize, at: usize, place: usize| -> f64 {
        let start = at - place * step;
        let there =
            |k: usize| start + (place as i64 + k as i64 - radius).clamp(0, n as i64 - 1) as usize * step;
        weights.iter().enumerate().map(|(k, weight)| weight * from[there(k)]).sum::<f64>() / total
    };
    let rows: Vec<f64> = (0..picture.len()).map(|at| along(picture, 1, width, at, at % width)).collect();
    (0..picture.len()).map(|at| along(&rows, width, height, at, at / width)).collect()
}

/// Leaves that lie over one another, 640 by 480.
pub(super) fn leaves() -> Vec<u8> {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut picture = vec![60; 640 * 480];
    for _ in 0..1500 {
        let [x, y]: [i32; 2] = [random.random_range(0..640), random.random_range(0..480)];
        let [wide, high]: [i32; 2] = [(); 2].map(|()| random.random_range(4..25));
        let light = random.random_range(20..=250);
        for v in (y - high).max(0)..(y + high).min(480) {
            for u in (x - wide).max(0)..(x + wide).min(640) {
                let [a, b] = [f64::from(u - x) / f64::from(wide), f64::from(v - y) / f64::from(high)];
                if a * a + b * b < 1.0 {
                    picture[(v * 640 + u) as usize] = light;
                }
            }
        }
    }
    picture
}

/// A drawn board, found in its picture.
pub(super) fn found(drawn: &Drawn, seed: u64) -> Result<Vec<[f64; 2]>, super::BoardError> {
    let picture = drawn.picture(seed);
    super::find(&Gray::packed(&picture, drawn.size[0], drawn.size[1]), drawn.board, super::Window::Squares)
}
