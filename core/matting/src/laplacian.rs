//! The matting Laplacian of a colour picture (Levin, Lischinski & Weiss, PAMI 30, 2008; Zeng's dissertation 2.2.1).
//!
//! In a window of 3 by 3 pixels opacity shall be linear in colour: the cost of equation 2.6, with its best coefficients, is
//! `αᵀ L α`. Equation 2.4 is right for gray pictures only; of colours (errata Z2) the entry of pixels i and j is the sum,
//! over the windows that hold both, of
//!
//! `δ_ij - (1 + (I_i - μ)ᵀ (Σ + ε/9 1)⁻¹ (I_j - μ)) / 9`
//!
//! with the mean μ of a window's colours and their 3 by 3 covariance Σ.

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) use tests::definition;

use crate::Picture;
use crate::grid::{Grid, Offset, Size, WITHIN_TWO};
use crate::work::made;

/// Pixels of a window.
const PIXELS: f64 = 9.0;

/// The matting Laplacian of a picture, colours from 0 to 1.
pub(crate) fn laplacian(picture: &Picture<'_>, epsilon: f64) -> Grid<1> {
    let size = Size { width: picture.width as usize, height: picture.height as usize };
    let inner = size.width - 2;
    let windows = made(inner * (size.height - 2), |window| {
        Window::new(picture, window / inner * size.width + window % inner, epsilon)
    });
    Grid::new(size, WITHIN_TWO, |pixel, offset| {
        let [x, y] = [pixel % size.width, pixel / size.width];
        let [columns, rows] = [shared(x, offset[0], size.width), shared(y, offset[1], size.height)];
        let colours = [picture.colour(pixel), picture.colour(ahead(pixel, offset, size))];
        let own = if offset == [0, 0] { 1.0 } else { 0.0 };
        let entry = rows.flat_map(|y| columns.clone().map(move |x| y * inner + x)).map(|window| {
            let [a, b] = colours.map(|colour| windows[window].whitened(colour));
            own - (1.0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / PIXELS
        });
        [[entry.sum()]]
    })
}

fn ahead(pixel: usize, [dx, dy]: Offset, size: Size) -> usize {
    pixel.wrapping_add_signed(dy * size.width as isize + dx)
}

/// Along one axis: the windows, by their first pixel, that hold a pixel and the one that lies so far from it.
fn shared(at: usize, offset: isize, n: usize) -> std::ops::Range<usize> {
    let other = at.wrapping_add_signed(offset);
    at.max(other).saturating_sub(2)..(at.min(other) + 1).min(n - 2)
}

/// The colours of a window: their mean, and what makes their covariance the unit matrix.
struct Window {
    mean: [f64; 3],
    /// The inverse of the Cholesky factor of the covariance, by rows of its lower half.
    whitening: [f64; 6],
}

impl Window {
    /// The window whose top left pixel this is.
    fn new(picture: &Picture<'_>, first: usize, epsilon: f64) -> Self {
        let width = picture.width as usize;
        let pixels = [0, 1, 2].into_iter().flat_map(|y| [0, 1, 2].map(|x| first + y * width + x));
        let mut mean = [0.0; 3];
        for pixel in pixels.clone() {
            mean.iter_mut().zip(picture.colour(pixel)).for_each(|(mean, value)| *mean += value / PIXELS);
        }
        let mut covariance = [0.0; 6];
        for pixel in pixels {
            let colour = picture.colour(pixel);
            let [r, g, b]: [f64; 3] = std::array::from_fn(|c| colour[c] - mean[c]);
            let products = [r * r, g * r, g * g, b * r, b * g, b * b];
            covariance.iter_mut().zip(products).for_each(|(sum, product)| *sum += product / PIXELS);
        }
        Self { mean, whitening: inverse_factor(covariance, epsilon / PIXELS) }
    }

    fn whitened(&self, colour: [f64; 3]) -> [f64; 3] {
        let [r, g, b]: [f64; 3] = std::array::from_fn(|c| colour[c] - self.mean[c]);
        let w = &self.whitening;
        [w[0] * r, w[1] * r + w[2] * g, w[3] * r + w[4] * g + w[5] * b]
    }
}

/// The inverse of the Cholesky factor of a 3 by 3 matrix that has this much more on its diagonal; both by rows of the lower
/// half. (Minors would lose all digits where a window's colours lie on a line.)
fn inverse_factor([rr, gr, gg, br, bg, bb]: [f64; 6], more: f64) -> [f64; 6] {
    // No pivot is less than what was added, but for rounding.
    let root = |pivot: f64| (pivot + more).max(more).sqrt();
    let r = root(rr);
    let (gr, br) = (gr / r, br / r);
    let g = root(gg - gr * gr);
    let bg = (bg - br * gr) / g;
    let b = root(bb - br * br - bg * bg);
    let (i, k, m) = (1.0 / r, 1.0 / g, 1.0 / b);
    let j = -gr * i * k;
    [i, j, k, -(br * i + bg * j) * m, -bg * k * m, m]
}
