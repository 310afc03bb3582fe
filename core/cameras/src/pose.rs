//! How one frame of axes stands in another.

use nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use serde::{Deserialize, Serialize};

use crate::Place;

/// A turn and then a shift: `b_from_a.of(&place_in_a)` is the place in b. `b_from_a` is how it is named.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// The turn.
    pub rotation: Rotation3<f64>,
    /// The shift, in the unit of the target: where the origin of a is in b.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// Both frames are one.
    #[must_use]
    pub fn identity() -> Self {
        Self { rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

    /// Turned about this axis by its length, radians, then shifted.
    #[must_use]
    pub fn new(turn_rad: Vector3<f64>, translation: Vector3<f64>) -> Self {
        Self { rotation: Rotation3::new(turn_rad), translation }
    }

    /// A place of a, in b.
    #[must_use]
    pub fn of(&self, place: &Place) -> Place {
        self.rotation * place + self.translation
    }

    /// `a_from_b`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// `c_from_b.after(&b_from_a)` is `c_from_a`.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self { rotation: self.rotation * first.rotation, translation: self.of(&first.translation) }
    }

    /// Where the origin of b is in a: of `camera_from_world`, where the camera stands.
    #[must_use]
    pub fn centre(&self) -> Place {
        self.inverse().translation
    }

    /// Turned further by the first three, radians, and shifted further by the last three.
    pub(crate) fn stepped(&self, step: &Vector6<f64>) -> Self {
        let mut rotation = Rotation3::new(step.fixed_rows::<3>(0).into_owned()) * self.rotation;
        rotation.renormalize();
        Self { rotation, translation: self.translation + step.fixed_rows::<3>(3) }
    }

    /// How the turned place changes with a turn further.
    pub(crate) fn by_turn(&self, place: &Place) -> Matrix3<f64> {
        -(self.rotation * place).cross_matrix()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_follow_one_another_and_turn_back() {
        let b_from_a = Pose::new(Vector3::new(0.3, -0.2, 1.1), Vector3::new(1.0, 2.0, -3.0));
        let c_from_b = Pose::new(Vector3::new(-1.3, 0.4, 0.2), Vector3::new(0.5, 0.0, 7.0));
        let place = Vector3::new(0.2, -4.0, 1.5);
        let c_from_a = c_from_b.after(&b_from_a);
        assert!((c_from_a.of(&place) - c_from_b.of(&b_from_a.of(&place))).norm() < 1e-12);
        assert!((c_from_a.inverse().of(&c_from_a.of(&place)) - place).norm() < 1e-12);
        assert!(b_from_a.of(&b_from_a.centre()).norm() < 1e-12);
        // A quarter turn about z takes x to y.
        let quarter = Pose::new(Vector3::z() * std::f64::consts::FRAC_PI_2, Vector3::zeros());
        assert!((quarter.of(&Vector3::x()) - Vector3::y()).norm() < 1e-12);
    }

    #[test]
    fn slopes_by_turning_are_those_of_differences() {
        let pose = Pose::new(Vector3::new(0.3, -0.2, 1.1), Vector3::new(1.0, 2.0, -3.0));
        let place = Vector3::new(0.2, -4.0, 1.5);
        let slopes = pose.by_turn(&place);
        for axis in 0..3 {
            let mut step = Vector6::zeros();
            step[axis] = 1e-6;
            let difference = (pose.stepped(&step).of(&place) - pose.stepped(&-step).of(&place)) / 2e-6;
            assert!((difference - slopes.column(axis)).norm() < 1e-8);
        }
    }
}
