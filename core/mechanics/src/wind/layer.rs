//! A level layer of air that flows by itself over trees: stable fluids (Stam, SIGGRAPH 1999, with his Fourier transform of
//! 2001), held back by what stands in its cells as Akagi and Kitajima (2006) have it, f = -k m u (thesis 5.2.4, 5.1).
//!
//! Errata E23: the viscosity of 5.1 is kinematic, square metres per second, and what it changes is the velocity at a place.

#[cfg(test)]
mod tests;

use nalgebra::Vector2;
use realfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A square of so many cells a side that comes round at its sides; velocities are at the corners of its cells, the first
/// of them at 0.
#[derive(Clone)]
pub struct Layer {
    n: usize,
    cell: f64,
    viscosity: f64,
    /// Of each place, along x and then along y, by what its air is held back, per second.
    held: Vec<f64>,
    /// Velocities, x + i y.
    air: Vec<Complex<f64>>,
    spare: Vec<Complex<f64>>,
    there: Arc<dyn Fft<f64>>,
    back: Arc<dyn Fft<f64>>,
}

impl Layer {
    /// Still air: so many cells a side, at least 4 and even; metres of a cell, and viscosity in square metres per second.
    ///
    /// # Panics
    /// Where there are not so many cells.
    #[must_use]
    pub fn new(n: usize, cell: f64, viscosity: f64) -> Self {
        assert!(n >= 4 && n.is_multiple_of(2), "four cells or more, and an even number");
        let mut plans = FftPlanner::new();
        let (there, back) = (plans.plan_fft_forward(n), plans.plan_fft_inverse(n));
        let still = vec![Complex::default(); n * n];
        Self { n, cell, viscosity, held: vec![0.0; n * n], air: still.clone(), spare: still, there, back }
    }

    /// Velocities, metres per second, row by row.
    pub fn velocities(&self) -> impl Iterator<Item = [f64; 2]> {
        self.air.iter().map(|v| [v.re, v.im])
    }

    /// Holds air back by so much per second and square metre of the ground, shared by the four nearest places.
    pub fn hold(&mut self, place: &Vector2<f64>, rate: f64) {
        let at = place / self.cell;
        let (first, share) = (at.map(f64::floor), at.map(|v| v - v.floor()));
        for (dx, wx) in [(0.0, 1.0 - share.x), (1.0, share.x)] {
            for (dy, wy) in [(0.0, 1.0 - share.y), (1.0, share.y)] {
                let row = self.row(first.x + dx, first.y + dy);
                self.held[row] += wx * wy * rate / self.cell.powi(2);
            }
        }
    }

    /// What blows at every place becomes what it is told, by the place in metres and by what blew there.
    pub fn blow(&mut self, of: impl Fn(Vector2<f64>, Vector2<f64>) -> Vector2<f64>) {
        for (row, air) in self.air.iter_mut().enumerate() {
            let place = Vector2::new((row % self.n) as f64, (row / self.n) as f64) * self.cell;
            let now = of(place, Vector2::new(air.re, air.im));
            *air = Complex::new(now.x, now.y);
        }
    }

    /// Holds back, carries, and then spreads by viscosity and takes out what would spring or sink.
    pub fn step(&mut self, dt: f64) {
        for (air, held) in self.air.iter_mut().zip(&self.held) {
            *air *= (-held * dt).exp();
        }
        self.carry(dt);
        self.settle(dt);
    }

    /// What is here now was a step ago where the air has come from (by the middle of its way), between places by cubics.
    fn carry(&mut self, dt: f64) {
        let cells = dt / self.cell;
        let mut carried = std::mem::take(&mut self.spare);
        for (row, air) in carried.iter_mut().enumerate() {
            let (x, y) = ((row % self.n) as f64, (row / self.n) as f64);
            let here = self.air[row] * (cells / 2.0);
            let middle = self.between(x - here.re, y - here.im) * cells;
            *air = self.between(x - middle.re, y - middle.im);
        }
        self.spare = std::mem::replace(&mut self.air, carried);
    }

    /// The part without divergence, of which viscosity leaves exp(-nu k^2 t): each wave for itself.
    pub fn settle(&mut self, dt: f64) {
        let n = self.n;
        self.transform(&Arc::clone(&self.there));
        let wave = |k: usize| {
            let k = if k > n / 2 { k as f64 - n as f64 } else { k as f64 };
            TAU * k / (n as f64 * self.cell)
        };
        let part = 1.0 / (n * n) as f64;
        // Rows and columns have changed places.
        for (row, settled) in self.spare.iter_mut().enumerate() {
            let (a, b) = (row / n, row % n);
            let (own, other) = (self.air[row], self.air[(n - a) % n * n + (n - b) % n].conj());
            // Both velocities are real: their waves are in the sum and the difference.
            let u = (own + other) / 2.0;
            let v = (own - other) / Complex::new(0.0, 2.0);
            let (kx, ky) = (wave(a), wave(b));
            let square = kx * kx + ky * ky;
            *settled = if a == n / 2 || b == n / 2 {
                // The shortest waves point nowhere.
                Complex::default()
            } else if square > 0.0 {
                let along = (u * kx + v * ky) / square;
                let left = (-self.viscosity * square * dt).exp() * part;
                ((u - along * kx) + (v - along * ky) * Complex::i()) * left
            } else {
                own * part
            };
        }
        std::mem::swap(&mut self.air, &mut self.spare);
        self.transform(&Arc::clone(&self.back));
    }

    /// Along both sides; rows and columns change places.
    fn transform(&mut self, plan: &Arc<dyn Fft<f64>>) {
        plan.process(&mut self.air);
        self.turn();
        plan.process(&mut self.air);
    }

    fn turn(&mut self) {
        for row in 0..self.n {
            for column in row + 1..self.n {
                self.air.swap(row * self.n + column, column * self.n + row);
            }
        }
    }

    /// At a place in cells.
    fn between(&self, x: f64, y: f64) -> Complex<f64> {
        let (first, along) = (x.floor(), cubic(x - x.floor()));
        let (row, across) = (y.floor(), cubic(y - y.floor()));
        let mut sum = Complex::default();
        for (j, wy) in across.into_iter().enumerate() {
            for (i, wx) in along.into_iter().enumerate() {
                sum += self.air[self.row(first + i as f64 - 1.0, row + j as f64 - 1.0)] * (wx * wy);
            }
        }
        sum
    }

    /// Of a place by whole numbers, which come round.
    fn row(&self, x: f64, y: f64) -> usize {
        let n = self.n as i64;
        ((y as i64).rem_euclid(n) * n + (x as i64).rem_euclid(n)) as usize
    }
}

/// Lagrange's weights of four places, -1 to 2, between the two in the middle.
fn cubic(t: f64) -> [f64; 4] {
    let (a, b, c) = (t + 1.0, t - 1.0, t - 2.0);
    [-t * b * c / 6.0, a * b * c / 2.0, -a * t * c / 2.0, a * t * b / 6.0]
}
