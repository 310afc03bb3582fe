//! Cameras against OpenCV's numbers, differences and themselves.

use nalgebra::{Vector2, Vector3};

use super::*;
use crate::Pose;

const LENS: Camera = Camera {
    fx: 536.0,
    fy: 530.0,
    cx: 342.0,
    cy: 235.0,
    k1: -0.27,
    k2: 0.1,
    p1: 0.0015,
    p2: -0.0008,
    k3: 0.05,
};

#[test]
fn pixels_are_those_of_opencv() {
    // cv2.projectPoints of OpenCV 5.0.
    let camera_from_world = Pose::new(Vector3::new(0.2, -0.3, 0.15), Vector3::new(0.1, -0.05, 1.7));
    for (place, want) in [
        ([0.0, 0.0, 0.0], [373.485_046_045_003, 219.436_220_876_436]),
        ([0.3, 0.2, 0.0], [442.895_838_968_150, 286.282_844_342_484]),
        ([-0.5, 0.4, 0.1], [198.091_637_957_854, 313.005_206_747_024]),
        ([0.6, -0.45, 0.2], [519.202_078_527_868, 118.427_151_254_892]),
        ([0.7, 0.6, -0.1], [521.360_550_108_496, 400.029_065_637_863]),
    ] {
        let got = LENS.project(&camera_from_world.of(&Vector3::from(place))).unwrap();
        assert!((got - Vector2::from(want)).norm() < 1e-9, "{place:?}: {got}");
    }
    assert_eq!(LENS.project(&Vector3::new(0.1, 0.1, -1.0)), None);
    assert_eq!(LENS.project(&Vector3::new(0.1, 0.1, 0.0)), None);
}

#[test]
fn slopes_are_those_of_differences() {
    let place = Vector3::new(0.4, -0.7, 1.6);
    let slopes = LENS.project_with_slopes(&place).unwrap();
    assert_eq!(slopes.at, LENS.project(&place).unwrap());
    for axis in 0..3 {
        let mut step = Vector3::zeros();
        step[axis] = 1e-6;
        let difference =
            (LENS.project(&(place + step)).unwrap() - LENS.project(&(place - step)).unwrap()) / 2e-6;
        assert!((difference - slopes.by_place.column(axis)).norm() < 1e-6, "axis {axis}");
    }
    for number in 0..N_NUMBERS {
        let [forth, back] = [1e-6, -1e-6].map(|step| {
            let mut numbers = LENS.numbers();
            numbers[number] += step;
            Camera::of(numbers).project(&place).unwrap()
        });
        let difference = (forth - back) / 2e-6;
        assert!((difference - slopes.by_numbers.column(number)).norm() < 1e-6, "{}", NUMBERS[number]);
    }
}

#[test]
fn undistorting_undoes_what_the_lens_did() {
    let barrel = Camera { k1: -0.35, k2: 0.12, k3: 0.0, ..LENS };
    let pincushion = Camera { k1: 0.3, k2: 0.1, ..LENS };
    for camera in [LENS, barrel, pincushion, Camera::pinhole(800.0, Vector2::new(320.0, 240.0))] {
        for y in (0..480).step_by(40) {
            for x in (0..640).step_by(40) {
                let at = Vector2::new(f64::from(x), f64::from(y));
                let ray = camera.undistort(&at).unwrap();
                let back = camera.project(&Vector3::new(ray.x, ray.y, 1.0)).unwrap();
                assert!((back - at).norm() < 1e-9, "{at} by {camera:?}");
            }
        }
    }
}

#[test]
fn pixels_beyond_the_model_are_named() {
    // Of r (1 - 0.3 r²) the highest value is 0.7027, at r = 1.054: 351.4 px from the centre at f = 500.
    let camera = Camera { k1: -0.3, ..Camera::pinhole(500.0, Vector2::zeros()) };
    assert!(camera.undistort(&Vector2::new(351.0, 0.0)).is_ok());
    for far in [352.0, 400.0, 5000.0, 1e9] {
        let error = camera.undistort(&Vector2::new(0.0, far)).unwrap_err();
        assert_eq!(error, CameraError::Reach { x: 0.0, y: far });
    }
}
