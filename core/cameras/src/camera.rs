//! A pinhole camera with a lens: eq. 2.1 of the thesis without skew, and the distortion that OpenCV has.

use nalgebra::{Matrix2, Matrix2x3, SMatrix, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::{CameraError, Pixel, Place};

/// Names of a camera's numbers, in the order of [`Camera::numbers`].
pub const NUMBERS: [&str; N_NUMBERS] = ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"];
/// How many they are.
pub const N_NUMBERS: usize = 9;

/// Steps of Newton's method that undistorting may take; it needs 4 to 6.
const MOST_STEPS: usize = 30;
/// Places between the axis and a ray where the lens must not fold the picture over.
const PROBES: usize = 16;

/// What a camera makes of places in front of it.
///
/// A place (X, Y, Z) in the camera's own axes (x right, y down, z forward) is seen in the direction `x = X / Z, y = Y / Z`. The
/// lens moves it, with `r² = x² + y²` and `a = 1 + k1 r² + k2 r⁴ + k3 r⁶`, to
/// `x' = a x + 2 p1 x y + p2 (r² + 2 x²)`, `y' = a y + p1 (r² + 2 y²) + 2 p2 x y`, and the pixel is `(fx x' + cx, fy y' + cy)`:
/// numbers and centre, `(0, 0)` in the middle of the top-left pixel, are those of OpenCV. Where it is read from a file the distortion
/// may be left out: there is none then.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Focal length along x, pixels.
    pub fx: f64,
    /// Focal length along y, pixels.
    pub fy: f64,
    /// Where the axis meets the picture, x, pixels.
    pub cx: f64,
    /// Where the axis meets the picture, y, pixels.
    pub cy: f64,
    /// Radial distortion, of r².
    #[serde(default)]
    pub k1: f64,
    /// Radial distortion, of r⁴.
    #[serde(default)]
    pub k2: f64,
    /// Distortion of a lens that stands askew.
    #[serde(default)]
    pub p1: f64,
    /// The same, across.
    #[serde(default)]
    pub p2: f64,
    /// Radial distortion, of r⁶.
    #[serde(default)]
    pub k3: f64,
}

/// The middle of a picture of this size, pixels.
#[must_use]
pub fn middle([width, height]: [u32; 2]) -> Pixel {
    Pixel::new((f64::from(width) - 1.0) / 2.0, (f64::from(height) - 1.0) / 2.0)
}

/// A pixel, and how it changes with the place, in the camera's axes, and with the camera's numbers.
pub(crate) struct Projected {
    pub(crate) at: Pixel,
    pub(crate) by_place: Matrix2x3<f64>,
    pub(crate) by_numbers: SMatrix<f64, 2, N_NUMBERS>,
}

impl Camera {
    /// A camera without distortion whose pixels are square, with its axis through `centre`; lengths in pixels.
    #[must_use]
    pub fn pinhole(focal_px: f64, centre: Pixel) -> Self {
        Self::of([focal_px, focal_px, centre.x, centre.y, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// fx, fy, cx, cy, k1, k2, p1, p2, k3.
    #[must_use]
    pub fn numbers(&self) -> [f64; N_NUMBERS] {
        [self.fx, self.fy, self.cx, self.cy, self.k1, self.k2, self.p1, self.p2, self.k3]
    }

    /// The camera of these [`numbers`](Self::numbers).
    #[must_use]
    pub fn of([fx, fy, cx, cy, k1, k2, p1, p2, k3]: [f64; N_NUMBERS]) -> Self {
        Self { fx, fy, cx, cy, k1, k2, p1, p2, k3 }
    }

    /// Whether all numbers are finite and both focal lengths positive.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.numbers().iter().all(|number| number.is_finite()) && self.fx > 0.0 && self.fy > 0.0
    }

    /// The pixel in which a place, in the camera's axes, is seen; `None` of places that are not in front of the camera.
    #[must_use]
    pub fn project(&self, place: &Place) -> Option<Pixel> {
        (place.z > 0.0).then(|| self.pixel(&self.distort(&(place.xy() / place.z))))
    }

    /// The direction (X / Z, Y / Z) from which light falls on a pixel.
    ///
    /// # Errors
    /// [`CameraError::Reach`] where the polynomial of the distortion has turned back before it came to this pixel.
    pub fn undistort(&self, at: &Pixel) -> Result<Vector2<f64>, CameraError> {
        let beyond = || CameraError::Reach { x: at.x, y: at.y };
        let wanted = Vector2::new((at.x - self.cx) / self.fx, (at.y - self.cy) / self.fy);
        let mut ray = wanted;
        let tolerance = 1e-13 * (1.0 + wanted.norm());
        for _ in 0..MOST_STEPS {
            let off = self.distort(&ray) - wanted;
            if off.norm() <= tolerance {
                break;
            }
            ray -= self.stretch(&ray).try_inverse().ok_or_else(beyond)? * off;
        }
        // A fold between the axis and the ray: the same pixel was met before.
        let unfolded =
            (1..=PROBES).all(|k| self.stretch(&(ray * (k as f64 / PROBES as f64))).determinant() > 0.0);
        let arrived = (self.distort(&ray) - wanted).norm() <= 1e-9 * (1.0 + wanted.norm());
        if arrived && unfolded { Ok(ray) } else { Err(beyond()) }
    }

    fn pixel(&self, distorted: &Vector2<f64>) -> Pixel {
        Vector2::new(self.fx * distorted.x + self.cx, self.fy * distorted.y + self.cy)
    }

    fn distort(&self, ray: &Vector2<f64>) -> Vector2<f64> {
        let (x, y, r2) = (ray.x, ray.y, ray.norm_squared());
        let along = self.along(r2);
        Vector2::new(
            along * x + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
            along * y + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        )
    }

    fn along(&self, r2: f64) -> f64 {
        1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
    }

    /// How a distorted direction changes with the direction.
    fn stretch(&self, ray: &Vector2<f64>) -> Matrix2<f64> {
        let (x, y, r2) = (ray.x, ray.y, ray.norm_squared());
        let along = self.along(r2);
        // By r²; that of r² by x is 2 x.
        let slope = self.k1 + r2 * (2.0 * self.k2 + r2 * 3.0 * self.k3);
        let across = 2.0 * (slope * x * y + self.p1 * x + self.p2 * y);
        Matrix2::new(
            along + 2.0 * slope * x * x + 2.0 * self.p1 * y + 6.0 * self.p2 * x,
            across,
            across,
            along + 2.0 * slope * y * y + 6.0 * self.p1 * y + 2.0 * self.p2 * x,
        )
    }

    pub(crate) fn project_with_slopes(&self, place: &Vector3<f64>) -> Option<Projected> {
        if place.z <= 0.0 {
            return None;
        }
        let ray = place.xy() / place.z;
        let (x, y, r2) = (ray.x, ray.y, ray.norm_squared());
        let distorted = self.distort(&ray);
        let focal = Matrix2::new(self.fx, 0.0, 0.0, self.fy);
        let by_depth = 1.0 / place.z;
        let ray_by_place = Matrix2x3::new(by_depth, 0.0, -x * by_depth, 0.0, by_depth, -y * by_depth);
        let (r4, r6, xy) = (r2 * r2, r2 * r2 * r2, 2.0 * x * y);
        let (fx, fy) = (self.fx, self.fy);
        #[rustfmt::skip]
        let by_numbers = SMatrix::<f64, 2, N_NUMBERS>::from_row_slice(&[
            distorted.x, 0.0, 1.0, 0.0, fx * x * r2, fx * x * r4, fx * xy, fx * (r2 + 2.0 * x * x), fx * x * r6,
            0.0, distorted.y, 0.0, 1.0, fy * y * r2, fy * y * r4, fy * (r2 + 2.0 * y * y), fy * xy, fy * y * r6,
        ]);
        let by_place = focal * self.stretch(&ray) * ray_by_place;
        Some(Projected { at: self.pixel(&distorted), by_place, by_numbers })
    }
}

#[cfg(test)]
mod tests;
