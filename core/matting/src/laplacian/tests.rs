//! The entries against the cost they come from, and what must be true of any matting Laplacian.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::tests::kinds;

/// The cost of equation 2.6 as it is defined: the sum, over the windows, of what is left of the opacities (and of nought for
/// each coefficient, weighed by √ε) beside the best coefficients and constant; those by an orthogonal basis of the columns.
pub(crate) fn definition(picture: &Picture<'_>, epsilon: f64) -> DMatrix<f64> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let mut cost = DMatrix::zeros(width * height, width * height);
    for y in 1..height - 1 {
        for x in 1..width - 1 {
            let pixels: Vec<usize> = (0..9).map(|k| (y + k / 3 - 1) * width + x + k % 3 - 1).collect();
            let columns = DMatrix::from_fn(12, 4, |row, column| match (row, column) {
                (0..9, 3) => 1.0,
                (0..9, c) => picture.colour(pixels[row])[c],
                (_, c) => {
                    if row - 9 == c {
                        epsilon.sqrt()
                    } else {
                        0.0
                    }
                }
            });
            let basis = columns.qr().q();
            let left = DMatrix::identity(12, 12) - &basis * basis.transpose();
            for (i, &a) in pixels.iter().enumerate() {
                for (j, &b) in pixels.iter().enumerate() {
                    cost[(a, b)] += left[(i, j)];
                }
            }
        }
    }
    cost
}

#[test]
fn entries_are_those_of_the_cost() {
    for (width, height) in [(3, 3), (5, 4), (12, 10)] {
        for (name, rgb) in kinds(width, height) {
            let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
            for epsilon in [1e-7, 1e-3] {
                let off = (laplacian(&picture, epsilon).dense() - definition(&picture, epsilon)).amax();
                assert!(off < 1e-8, "{name} {width}x{height}, {epsilon:e}: off by {off:e}");
            }
        }
    }
}

#[test]
fn a_laplacian_loses_the_constant_and_all_but_loses_colours_and_feels_nothing_less_than_nought() {
    let (width, height) = (11, 9);
    for (name, rgb) in kinds(width, height) {
        let picture = Picture::new(width as u32, height as u32, &rgb).unwrap();
        let dense = laplacian(&picture, 1e-7).dense();
        assert_eq!(dense, dense.transpose(), "{name}");
        let n = width * height;
        let constant = &dense * DVector::repeat(n, 1.0);
        assert!(constant.amax() < 1e-12, "{name}: {:e}", constant.amax());
        for channel in 0..3 {
            let colour = DVector::from_fn(n, |pixel, _| picture.colour(pixel)[channel]);
            // A window pays ε for a coefficient of 1, and no more.
            let most = 1e-7 * ((width - 2) * (height - 2)) as f64;
            let cost = colour.dot(&(&dense * &colour));
            assert!((-1e-12..most * 1.01).contains(&cost), "{name}, channel {channel}: {cost:e}");
        }
        let least = dense.symmetric_eigenvalues().min();
        assert!(least > -1e-12, "{name}: {least:e}");
    }
}
