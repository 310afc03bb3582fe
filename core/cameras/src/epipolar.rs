//! What one camera's pixel says of another's picture: the epipolar line, on which both see the same place.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::{Camera, CameraError, Pixel, Pose};

/// Two cameras that stand still.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pair {
    /// Both cameras; the first is the left one.
    pub cameras: [Camera; 2],
    /// How they stand.
    pub right_from_left: Pose,
}

impl Pair {
    /// The essential matrix E of directions, `rightᵀ E left = 0`: `[t]× R`.
    #[must_use]
    pub fn essential(&self) -> Matrix3<f64> {
        self.right_from_left.translation.cross_matrix() * self.right_from_left.rotation
    }

    /// Directions in which both see something.
    ///
    /// # Errors
    /// [`CameraError::Reach`] of pixels beyond a camera's distortion.
    pub fn rays(&self, seen: &[Pixel; 2]) -> Result<[Vector2<f64>; 2], CameraError> {
        Ok([self.cameras[0].undistort(&seen[0])?, self.cameras[1].undistort(&seen[1])?])
    }

    /// How far what both see is from being one place: root mean square of its distances from the epipolar lines of each other, pixels (of
    /// pictures without distortion). What lies as far away as the other camera, at the epipole, has none.
    ///
    /// # Errors
    /// [`CameraError::Reach`] of pixels beyond a camera's distortion.
    pub fn epipolar_px(&self, seen: &[Pixel; 2]) -> Result<f64, CameraError> {
        Ok(self.epipolar_px_of(&self.essential(), &self.rays(seen)?))
    }

    /// The same of directions, with the essential matrix at hand.
    pub(crate) fn epipolar_px_of(&self, e: &Matrix3<f64>, rays: &[Vector2<f64>; 2]) -> f64 {
        let [left, right] = rays.map(|ray| ray.push(1.0));
        let off = right.dot(&(e * left));
        let far = |line: Vector3<f64>, camera: &Camera| {
            // The line a x + b y + c = 0 of directions is (a / fx, b / fy, …) of pixels.
            let slope = (line.x / camera.fx).hypot(line.y / camera.fy);
            if slope > 0.0 { off / slope } else { 0.0 }
        };
        let [in_left, in_right] =
            [far(e.transpose() * right, &self.cameras[0]), far(e * left, &self.cameras[1])];
        (in_left.powi(2) / 2.0 + in_right.powi(2) / 2.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;
    use crate::staged::LENS;

    fn pair() -> Pair {
        let right_from_left = Pose::new(Vector3::new(0.02, -0.3, 0.05), Vector3::new(-0.8, 0.05, 0.1));
        Pair { cameras: [LENS, Camera { fx: 600.0, fy: 610.0, k1: 0.05, ..LENS }], right_from_left }
    }

    fn seen(pair: &Pair, place: Place) -> [Pixel; 2] {
        let [left, right] = pair.cameras;
        [left.project(&place).unwrap(), right.project(&pair.right_from_left.of(&place)).unwrap()]
    }

    #[test]
    fn what_is_one_place_lies_on_the_line_and_what_is_not_as_far_off_as_it_was_moved() {
        // Without distortion and turns, lines are rows: 2 px down in one picture are 2 px from either line.
        let level = Pair {
            cameras: [Camera::pinhole(500.0, Pixel::new(320.0, 240.0)); 2],
            right_from_left: Pose::new(Vector3::zeros(), Vector3::new(-1.0, 0.0, 0.0)),
        };
        for place in [[0.3, -0.2, 3.0], [-0.5, 0.4, 2.0], [0.0, 0.0, 5.0]].map(Place::from) {
            let at = seen(&pair(), place);
            assert!(pair().epipolar_px(&at).unwrap() < 1e-9);
            let [left, right] = seen(&level, place);
            let off = level.epipolar_px(&[left, right + Pixel::new(7.0, 2.0)]).unwrap();
            assert!((off - 2.0).abs() < 1e-9, "{off}");
        }
    }

    #[test]
    fn the_matrix_has_two_equal_singular_values_and_a_third_of_nothing() {
        let pair = pair();
        let e = pair.essential();
        let place = Place::new(0.3, -0.2, 3.0);
        let [left, right] = [place, pair.right_from_left.of(&place)].map(|place| place / place.z);
        assert!((right.transpose() * e * left).norm() < 1e-12);
        let singular = e.singular_values();
        assert!((singular[0] - singular[1]).abs() < 1e-12 && singular[2] < 1e-12, "{singular}");
    }
}
