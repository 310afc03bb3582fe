//! Normalised correlation of one window with a larger one, at all displacements together.
//!
//! With a template `T = w (A - Ā)`, weights `w` of sum 1 and the other picture's pixels `B`, one transform of `B + i B²`
//! gives all that is needed: times the conjugate transform of `T` it is that of `T⋆B + i T⋆B²`, of which the real part is
//! wanted, and times that of `w` it is the transform of `w⋆B + i w⋆B²`, hence `Var_w B = w⋆B² - (w⋆B)²`.

use std::sync::Arc;

use rustfft::num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

use super::Weighting;

/// A window whose brightness varies less (standard deviation, gray levels) has nothing to correlate.
const FLAT_GRAY: f32 = 0.3;

/// Transforms and weights for windows of one radius.
pub(super) struct Correlator {
    side: usize,
    /// Side of what is transformed: the window and all its displacements.
    size: usize,
    forth: Arc<dyn Fft<f32>>,
    back: Arc<dyn Fft<f32>>,
    /// `(side, side)`, of sum 1.
    weights: Vec<f32>,
    /// Conjugate of their transform, `(size, size)`, columns first.
    spectrum: Vec<Complex32>,
}

/// The highest place of a correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    /// Displacement, pixels.
    pub(super) at: [f32; 2],
    /// How many times as high it is as the next best; infinite where there is none.
    pub(super) ratio: f32,
}

impl Correlator {
    /// For windows of this radius, pixels, and displacements of half of it.
    pub(super) fn new(radius: u32, weighting: Weighting) -> Self {
        let side = 2 * radius as usize + 1;
        let size = smooth(side + 2 * (radius as usize / 2).max(2));
        let mut planner = FftPlanner::new();
        let (forth, back) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
        let weight = |i: usize| {
            let x = (i as f32 - radius as f32) / (0.5 * radius as f32);
            match weighting {
                Weighting::Uniform => 1.0,
                Weighting::Gaussian => (-0.5 * x * x).exp(),
            }
        };
        let mut weights: Vec<f32> =
            (0..side).flat_map(|y| (0..side).map(move |x| weight(x) * weight(y))).collect();
        let sum: f32 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        let mut correlator = Self { side, size, forth, back, weights, spectrum: Vec::new() };
        let Scratch { mut template, mut turned, mut lines, .. } = correlator.scratch();
        for (i, &w) in correlator.weights.iter().enumerate() {
            template[i / side * size + i % side] = Complex32::new(w, 0.0);
        }
        transform(&*correlator.forth, size, &mut template, &mut turned, &mut lines);
        correlator.spectrum = template.iter().map(Complex32::conj).collect();
        correlator
    }

    /// Farthest displacement, pixels.
    pub(super) fn reach(&self) -> usize {
        (self.size - self.side) / 2
    }

    /// Memory to work in.
    pub(super) fn scratch(&self) -> Scratch {
        let blank = vec![Complex32::ZERO; self.size * self.size];
        let lines = self.forth.get_inplace_scratch_len().max(self.back.get_inplace_scratch_len());
        Scratch {
            template: blank.clone(),
            picture: blank.clone(),
            sums: blank.clone(),
            turned: blank,
            lines: vec![Complex32::ZERO; lines],
            map: Vec::new(),
            forth: Vec::new(),
            power: 0.0,
        }
    }
}

/// One thread's memory.
pub(super) struct Scratch {
    template: Vec<Complex32>,
    picture: Vec<Complex32>,
    sums: Vec<Complex32>,
    turned: Vec<Complex32>,
    lines: Vec<Complex32>,
    /// Correlation at every displacement, row-major, `2 reach + 1` a row.
    map: Vec<f32>,
    /// The same of the way there, while that back is measured.
    forth: Vec<f32>,
    /// Weighted variance of the template.
    power: f32,
}

impl Scratch {
    /// Takes the window to look for, `pixel(x, y)` from its first one on; `None` where it is flat.
    pub(super) fn take(
        &mut self,
        correlator: &Correlator,
        pixel: impl Fn(usize, usize) -> f32,
    ) -> Option<()> {
        let Correlator { side, size, weights, .. } = correlator;
        let pixels: Vec<f32> =
            (0..*side).flat_map(|y| (0..*side).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        let mean: f32 = pixels.iter().zip(weights).map(|(p, w)| p * w).sum();
        self.template.fill(Complex32::ZERO);
        self.power = 0.0;
        for (i, (p, w)) in pixels.iter().zip(weights).enumerate() {
            let weighted = w * (p - mean);
            self.power += weighted * (p - mean);
            self.template[i / side * size + i % side] = Complex32::new(weighted, 0.0);
        }
        if self.power < FLAT_GRAY * FLAT_GRAY {
            return None;
        }
        transform(&*correlator.forth, *size, &mut self.template, &mut self.turned, &mut self.lines);
        Some(())
    }

    /// Correlates it with the other picture, `pixel(x, y)` from one reach before the window's first on, at every
    /// displacement within reach.
    pub(super) fn correlate(&mut self, correlator: &Correlator, pixel: impl Fn(usize, usize) -> f32) {
        let Correlator { size, .. } = *correlator;
        for (i, value) in self.picture.iter_mut().enumerate() {
            value.re = pixel(i % size, i / size);
        }
        // Small numbers keep their digits in the squares.
        let mean = self.picture.iter().map(|p| p.re).sum::<f32>() / (size * size) as f32;
        for value in &mut self.picture {
            let gray = value.re - mean;
            *value = Complex32::new(gray, gray * gray);
        }
        transform(&*correlator.forth, size, &mut self.picture, &mut self.turned, &mut self.lines);
        for ((sum, picture), weight) in self.sums.iter_mut().zip(&self.picture).zip(&correlator.spectrum) {
            *sum = picture * weight;
        }
        for (picture, template) in self.picture.iter_mut().zip(&self.template) {
            *picture *= template.conj();
        }
        transform(&*correlator.back, size, &mut self.sums, &mut self.turned, &mut self.lines);
        transform(&*correlator.back, size, &mut self.picture, &mut self.turned, &mut self.lines);

        let scale = 1.0 / (size * size) as f32;
        let n = 2 * correlator.reach() + 1;
        self.map.clear();
        for i in (0..n).flat_map(|y| (0..n).map(move |x| y * size + x)) {
            let (mean, square) = (self.sums[i].re * scale, self.sums[i].im * scale);
            let power = square - mean * mean;
            let together = self.picture[i].re * scale;
            let flat = power < FLAT_GRAY * FLAT_GRAY;
            self.map.push(if flat { 0.0 } else { (together / (power * self.power).sqrt()).clamp(-1.0, 1.0) });
        }
    }

    /// Puts the correlations so far aside, to be met by those of the way back.
    pub(super) fn turn(&mut self) {
        std::mem::swap(&mut self.map, &mut self.forth);
    }

    /// The mean of the correlations put aside and those of the way back since, whose displacements are opposite.
    ///
    /// A window's weights favour the side on which there is more to be seen; there and back they favour neither.
    pub(super) fn meet(&mut self) {
        for (back, forth) in self.map.iter_mut().rev().zip(&self.forth) {
            *back = 0.5 * (*back + forth);
        }
        self.map.reverse();
    }

    /// The best displacement; `None` where no place within reach is better than all around it.
    pub(super) fn peak(&self, correlator: &Correlator) -> Option<Peak> {
        peak(&self.map, 2 * correlator.reach() + 1)
    }
}

#[cfg(test)]
impl Scratch {
    pub(super) fn map(&self) -> &[f32] {
        &self.map
    }
}

/// Transforms rows, then columns. The result has columns first; two transforms restore the order.
fn transform(
    fft: &dyn Fft<f32>,
    size: usize,
    data: &mut Vec<Complex32>,
    turned: &mut Vec<Complex32>,
    lines: &mut [Complex32],
) {
    fft.process_with_scratch(data, lines);
    for (y, row) in data.chunks_exact(size).enumerate() {
        for (x, value) in row.iter().enumerate() {
            turned[x * size + y] = *value;
        }
    }
    fft.process_with_scratch(turned, lines);
    std::mem::swap(data, turned);
}

/// The least number from `n` on that has no other prime factors than 2, 3 and 5: those transform fast.
fn smooth(n: usize) -> usize {
    let is_smooth = |n: &usize| {
        let mut rest = *n;
        for prime in [2, 3, 5] {
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
        }
        rest == 1
    };
    (n..).find(is_smooth).unwrap_or(n)
}

/// The highest value that is not on the edge of a square map, to a fraction of a pixel from its middle.
pub(super) fn peak(map: &[f32], n: usize) -> Option<Peak> {
    let inner = (1..n - 1).flat_map(|y| (1..n - 1).map(move |x| y * n + x));
    let is_top = |&i: &usize| {
        let around = [i - n - 1, i - n, i - n + 1, i - 1, i + 1, i + n - 1, i + n, i + n + 1];
        map[i] > 0.0 && around.iter().all(|&j| map[j] <= map[i])
    };
    let mut tops: Vec<usize> = inner.filter(is_top).collect();
    tops.sort_by(|&a, &b| map[b].total_cmp(&map[a]).then(a.cmp(&b)));
    let &best = tops.first()?;
    // What lies on the edge may be the flank of a better one out of reach.
    let rim = (0..n * n).filter(|i| i % n == 0 || i % n == n - 1 || i / n == 0 || i / n == n - 1);
    if rim.into_iter().any(|i| map[i] > map[best]) {
        return None;
    }
    let apart = |&&i: &&usize| (i % n).abs_diff(best % n).max((i / n).abs_diff(best / n)) > 1;
    let ratio = tops.iter().find(apart).map_or(f32::INFINITY, |&next| map[best] / map[next]);
    let middle = (n / 2) as f32;
    let x = (best % n) as f32 - middle + fraction([map[best - 1], map[best], map[best + 1]]);
    let y = (best / n) as f32 - middle + fraction([map[best - n], map[best], map[best + n]]);
    Some(Peak { at: [x, y], ratio })
}

/// Top of the Gaussian through three values, of which the middle one is the highest; of the parabola where one of them
/// has no logarithm. -0.5..=0.5.
fn fraction(values: [f32; 3]) -> f32 {
    let [a, b, c] = if values.iter().all(|&v| v > 0.0) { values.map(f32::ln) } else { values };
    let bend = a - 2.0 * b + c;
    if bend < 0.0 { ((a - c) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
}
