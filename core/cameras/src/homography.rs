//! How a plane is seen: homographies by the normalised direct linear transform.

use nalgebra::{DMatrix, Matrix3, Vector2};

use crate::CameraError;

/// Smallest of the eight singular values that must not vanish, of the largest: what is below is rounding, or noise.
const SMALLEST: f64 = 1e-4;

/// The matrix H with `to ∝ H (from, 1)` that fits best, of length 1, and so that places among `from` have positive
/// third coordinates.
///
/// R. Hartley, A. Zisserman, "Multiple View Geometry", algorithm 4.2: both sets are moved to their middle and scaled first.
///
/// # Errors
/// [`CameraError::TooFewPoints`] of fewer than 4, [`CameraError::Collinear`] where they do not span a plane (all on a line, or
/// all but one).
///
/// # Panics
/// When there are not as many of one as of the other.
#[track_caller]
pub fn homography(from: &[Vector2<f64>], to: &[Vector2<f64>]) -> Result<Matrix3<f64>, CameraError> {
    assert_eq!(from.len(), to.len(), "as many places as pixels");
    if from.len() < 4 {
        return Err(CameraError::TooFewPoints { wanted: 4, came: from.len() });
    }
    let (Some((from_even, of_from)), Some((to_even, of_to))) = (evened(from), evened(to)) else {
        return Err(CameraError::Collinear);
    };
    // Whether the places say enough is a question for the places alone: asked of their own picture, without noise.
    if !spans(&from_even) || !spans(&to_even) {
        return Err(CameraError::Collinear);
    }
    let (_, vector) = least(&equations(&from_even, &to_even));
    let even = Matrix3::from_row_slice(&vector);
    let to_from_even = of_to.try_inverse().ok_or(CameraError::Collinear)?;
    let h = to_from_even * even * of_from;
    let middle = from.iter().sum::<Vector2<f64>>() / from.len() as f64;
    let sign = (h * middle.push(1.0)).z.signum();
    Ok(h * (sign / h.norm()))
}

/// Where a homography takes a place.
#[cfg(test)]
fn moved(h: &Matrix3<f64>, place: &Vector2<f64>) -> Vector2<f64> {
    let seen = h * place.push(1.0);
    seen.xy() / seen.z
}

fn spans(points: &[Vector2<f64>]) -> bool {
    least(&equations(points, points)).0 > SMALLEST
}

/// Points about their middle, at √2 from it on average, and the matrix that took them there.
fn evened(points: &[Vector2<f64>]) -> Option<(Vec<Vector2<f64>>, Matrix3<f64>)> {
    let n = points.len() as f64;
    let middle = points.iter().sum::<Vector2<f64>>() / n;
    let far = points.iter().map(|p| (p - middle).norm()).sum::<f64>() / n;
    let scale = std::f64::consts::SQRT_2 / far;
    let matrix = Matrix3::new(scale, 0.0, -scale * middle.x, 0.0, scale, -scale * middle.y, 0.0, 0.0, 1.0);
    scale.is_finite().then(|| (points.iter().map(|p| (p - middle) * scale).collect(), matrix))
}

/// Two rows a pair: what each says of the nine numbers of H, row by row.
fn equations(from: &[Vector2<f64>], to: &[Vector2<f64>]) -> DMatrix<f64> {
    // Nine rows at least, so that there are nine singular vectors.
    let mut a = DMatrix::zeros((2 * from.len()).max(9), 9);
    for (i, (p, q)) in from.iter().zip(to).enumerate() {
        for (row, column, by) in [(2 * i, 0, q.x), (2 * i + 1, 3, q.y)] {
            for (k, value) in [p.x, p.y, 1.0].into_iter().enumerate() {
                a[(row, column + k)] = value;
                a[(row, 6 + k)] = -by * value;
            }
        }
    }
    a
}

/// The vector that a matrix of nine columns shortens most; with the second smallest singular value, of the largest.
fn least(a: &DMatrix<f64>) -> (f64, [f64; 9]) {
    let svd = a.clone().svd(false, true);
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&i, &j| svd.singular_values[i].total_cmp(&svd.singular_values[j]));
    let share = svd.singular_values[order[1]] / svd.singular_values[order[8]];
    // Asked for above, so it is there.
    let rows = svd.v_t.unwrap_or_else(|| DMatrix::zeros(9, 9));
    (share, std::array::from_fn(|k| rows[(order[0], k)]))
}

#[cfg(test)]
mod tests;
