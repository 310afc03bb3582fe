//! A camera from views of a plane, in closed form.
//!
//! Z. Zhang, "A flexible new technique for camera calibration", PAMI 22 (2000), 1330-1334: each view's homography `H = (h1 h2 h3)` gives
//! two equations, `h1ᵀ B h2 = 0` and `h1ᵀ B h1 = h2ᵀ B h2`, for `B = A⁻ᵀ A⁻¹`. Skew is nought here, as in all that follows: pixels
//! are rows and columns.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::camera::middle;
use crate::{Camera, Pixel};

/// Smallest singular value that counts, of the largest.
const SMALLEST: f64 = 1e-6;

/// Focal lengths and centre from three views or more; `None` where the views do not tell, or tell nonsense. The centre of
/// the coordinates should be near that of the picture, and a unit some hundred pixels.
fn free(homographies: &[Matrix3<f64>]) -> Option<Camera> {
    // Of B, up to its size: B11, B22, B13, B23, B33.
    let row = |a: &Vector3<f64>, b: &Vector3<f64>| {
        [a.x * b.x, a.y * b.y, a.x * b.z + a.z * b.x, a.y * b.z + a.z * b.y, a.z * b.z]
    };
    let mut equations = DMatrix::zeros((2 * homographies.len()).max(5), 5);
    for (i, pair) in homographies.iter().map(columns).enumerate() {
        let [h1, h2] = pair?;
        let (across, along, other) = (row(&h1, &h2), row(&h1, &h1), row(&h2, &h2));
        for k in 0..5 {
            equations[(2 * i, k)] = across[k];
            equations[(2 * i + 1, k)] = along[k] - other[k];
        }
    }
    let svd = equations.svd(false, true);
    let mut order: Vec<usize> = (0..5).collect();
    order.sort_by(|&i, &j| svd.singular_values[i].total_cmp(&svd.singular_values[j]));
    if svd.singular_values[order[1]] < SMALLEST * svd.singular_values[order[4]] {
        return None;
    }
    let rows = svd.v_t?;
    let b = rows.row(order[0]);
    let (b11, b22, b13, b23, b33) = (b[0], b[1], b[2], b[3], b[4]);
    let (cx, cy) = (-b13 / b11, -b23 / b22);
    let size = b33 - b13 * b13 / b11 - b23 * b23 / b22;
    let camera = Camera {
        fx: (size / b11).sqrt(),
        fy: (size / b22).sqrt(),
        ..Camera::pinhole(1.0, Pixel::new(cx, cy))
    };
    camera.is_sound().then_some(camera)
}

/// Focal lengths, where the axis goes through the origin; one for both where `square`.
fn centred(homographies: &[Matrix3<f64>], square: bool) -> Option<Camera> {
    let n_unknown = if square { 1 } else { 2 };
    let mut equations = DMatrix::zeros(2 * homographies.len(), n_unknown);
    let mut right = DVector::zeros(2 * homographies.len());
    for (i, pair) in homographies.iter().map(columns).enumerate() {
        let [h1, h2] = pair?;
        let terms = [
            [h1.x * h2.x, h1.y * h2.y, h1.z * h2.z],
            [h1.x * h1.x - h2.x * h2.x, h1.y * h1.y - h2.y * h2.y, h1.z * h1.z - h2.z * h2.z],
        ];
        for (row, [x, y, z]) in terms.into_iter().enumerate() {
            if square {
                equations[(2 * i + row, 0)] = x + y;
            } else {
                equations[(2 * i + row, 0)] = x;
                equations[(2 * i + row, 1)] = y;
            }
            right[2 * i + row] = -z;
        }
    }
    let inverse_squares = equations.svd(true, true).solve(&right, 1e-12).ok()?;
    let focal = |k: usize| 1.0 / inverse_squares[k].sqrt();
    let camera = Camera { fx: focal(0), fy: focal(n_unknown - 1), ..Camera::pinhole(1.0, Pixel::zeros()) };
    camera.is_sound().then_some(camera)
}

/// The first two columns of a homography, of length 1 together: no view counts more for being near.
fn columns(h: &Matrix3<f64>) -> Option<[Vector3<f64>; 2]> {
    let [h1, h2] = [h.column(0).into_owned(), h.column(1).into_owned()];
    let length = h1.norm().hypot(h2.norm());
    (length.is_finite() && length > 0.0).then(|| [h1 / length, h2 / length])
}

/// Cameras to start a search from, of pictures of this size, pixels: with a free centre, and with one in the middle.
pub(crate) fn starts(homographies: &[Matrix3<f64>], size: [u32; 2]) -> Vec<Camera> {
    let (middle, unit) = (middle(size), f64::from(size[0] + size[1]) / 4.0);
    let even = Matrix3::new(unit, 0.0, middle.x, 0.0, unit, middle.y, 0.0, 0.0, 1.0);
    let Some(to_even) = even.try_inverse() else { return Vec::new() };
    let homographies: Vec<_> = homographies.iter().map(|h| to_even * h).collect();
    let found = [free(&homographies), centred(&homographies, false), centred(&homographies, true)];
    let pixels = |c: Camera| Camera {
        fx: c.fx * unit,
        fy: c.fy * unit,
        cx: c.cx * unit + middle.x,
        cy: c.cy * unit + middle.y,
        ..c
    };
    found.into_iter().flatten().map(pixels).collect()
}

#[cfg(test)]
mod tests;
