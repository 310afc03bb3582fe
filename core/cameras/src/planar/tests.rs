//! Poses that are known.

use nalgebra::Vector3;

use super::*;
use crate::Sighting;
use crate::staged::{LENS, Noise, board, poses as staged_poses, seen};

#[test]
fn exact_views_give_the_pose_back_through_any_lens() {
    for pose in staged_poses(12, [100.0, 62.5], 450.0, 60.0) {
        let sighting = seen(&LENS, &pose, &board(), &mut Noise::new(0, 0.0));
        let found = super::pose(&LENS, &board(), &sighting, Loss::Squares).unwrap();
        assert!((found.translation - pose.translation).norm() < 1e-6, "{found:?}");
        assert!((found.rotation.matrix() - pose.rotation.matrix()).norm() < 1e-8);
    }
}

#[test]
fn of_the_two_ways_a_far_plane_can_lean_the_better_is_taken() {
    let bars = Target::bars(&[1.5, 3.0, -2.0], &[-0.5, 0.5]).unwrap();
    let camera = Camera::pinhole(1500.0, Pixel::new(959.5, 539.5));
    for k in 0..24 {
        let angle = f64::from(k);
        let turn = Vector3::new(angle.cos() * 0.7, angle.sin() * 0.7, angle * 0.3);
        let pose = Pose::new(turn, Vector3::new(angle.cos(), angle.sin(), 14.0));
        let mut noise = Noise::new(k as u64, 0.2);
        let found = poses(&camera, &bars, &seen(&camera, &pose, &bars, &mut noise), Loss::Squares).unwrap();
        assert!(found[0].1 <= found[1].1);
        let off = found[0].0.rotation.angle_to(&pose.rotation);
        assert!(
            off < 0.15,
            "view {k} is off by {off} rad; the other by {}",
            found[1].0.rotation.angle_to(&pose.rotation)
        );
    }
}

#[test]
fn what_is_wrong_with_a_view_is_named() {
    let pose = staged_poses(1, [100.0, 62.5], 450.0, 60.0)[0];
    let right = seen(&LENS, &pose, &board(), &mut Noise::new(0, 0.0));
    let with = |change: &dyn Fn(&mut Sighting)| {
        let mut sighting = right.clone();
        change(&mut sighting);
        super::pose(&LENS, &board(), &sighting, Loss::Squares).unwrap_err()
    };
    assert_eq!(with(&|s| s.truncate(3)), CameraError::TooFewPoints { wanted: 4, came: 3 });
    assert_eq!(with(&|s| s.truncate(9)), CameraError::Collinear);
    assert_eq!(with(&|s| s[4].0 = 5), CameraError::SeenTwice { point: 5 });
    assert_eq!(with(&|s| s[4].0 = 54), CameraError::NoSuchPoint { point: 54, n_points: 54 });
    assert_eq!(with(&|s| s[4].1.x = f64::NAN), CameraError::NotFinite { point: 4 });
    let mirrored = |s: &mut Sighting| s.iter_mut().for_each(|(i, _)| *i = *i / 9 * 9 + (8 - *i % 9));
    assert_eq!(with(&mirrored), CameraError::Mirrored);
    let folding = Camera { k2: 0.0, ..LENS };
    let far = [right[0], right[8], right[45], (53, Pixel::new(1500.0, 300.0))];
    let error = super::pose(&folding, &board(), &far, Loss::Squares).unwrap_err();
    assert_eq!(error, CameraError::Reach { x: 1500.0, y: 300.0 });
}
