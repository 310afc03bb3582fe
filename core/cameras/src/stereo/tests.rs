//! Pairs that are known: boards, and the thesis's bars round a tree.

use super::*;
use crate::staged::{LENS, Noise, SIZE, board, poses, seen};
use crate::{Camera, Options};

fn pair() -> Pair {
    let right = Camera { fx: 560.0, fy: 558.0, cx: 310.0, k1: -0.2, ..LENS };
    Pair {
        cameras: [LENS, right],
        right_from_left: Pose::new(Vector3::new(0.01, -0.12, 0.02), Vector3::new(-83.0, 3.0, 6.0)),
    }
}

fn views(pair: &Pair, target: &Target, stands: &[Pose], noise: &mut Noise) -> Vec<[Sighting; 2]> {
    let both = |pose: &Pose| {
        let right = pair.right_from_left.after(pose);
        [seen(&pair.cameras[0], pose, target, noise), seen(&pair.cameras[1], &right, target, noise)]
    };
    stands.iter().map(both).collect()
}

fn board_views(n: usize, noise: &mut Noise) -> Vec<[Sighting; 2]> {
    views(&pair(), &board(), &poses(n, [100.0, 62.5], 450.0, 60.0), noise)
}

#[test]
fn exact_views_give_the_pair_back_even_where_one_camera_missed_some() {
    let mut views = board_views(9, &mut Noise::new(0, 0.0));
    views[3][0].clear();
    views[5][1].clear();
    views[6][1].truncate(30);
    let found = stereo(&board(), &views, [SIZE; 2], &Options::BOARD).unwrap();
    let stand = pair().right_from_left;
    assert!((found.pair.right_from_left.translation - stand.translation).norm() < 1e-4, "{found:?}");
    assert!((found.pair.right_from_left.rotation.matrix() - stand.rotation.matrix()).norm() < 1e-6);
    assert!((found.baseline - stand.translation.norm()).abs() < 1e-4);
    assert!(found.rms_px < 1e-6 && found.epipolar_px < 1e-6, "{} {}", found.rms_px, found.epipolar_px);
}

#[test]
fn standard_errors_are_those_of_many_trials() {
    let n = 30;
    let truth = pair().right_from_left;
    let (mut squares, mut told, mut lines) = ([0.0; 3], [0.0; 3], 0.0);
    for seed in 0..n {
        let views = board_views(5, &mut Noise::new(seed, 0.3));
        let found = stereo(&board(), &views, [SIZE; 2], &Options::BOARD).unwrap();
        let off = found.pair.right_from_left.translation - truth.translation;
        for k in 0..3 {
            squares[k] += off[k].powi(2);
            told[k] += found.shift_errors()[k].powi(2);
        }
        lines += found.epipolar_px.powi(2) / n as f64;
    }
    for k in 0..3 {
        let ratio = (squares[k] / told[k]).sqrt();
        assert!((0.65..1.4).contains(&ratio), "axis {k}: {ratio}");
    }
    // Across the line, noise of 0.3 px in either picture adds up.
    assert!((lines.sqrt() / (0.3 * 2.0_f64.sqrt()) - 1.0).abs() < 0.1, "{}", lines.sqrt());
}

#[test]
fn known_cameras_keep_their_numbers() {
    let found =
        stand(&board(), &board_views(4, &mut Noise::new(1, 0.1)), pair().cameras, Loss::Squares).unwrap();
    assert_eq!(found.pair.cameras, pair().cameras);
    assert_eq!(found.errors, [[0.0; N_NUMBERS]; 2]);
    let off = (found.baseline - pair().right_from_left.translation.norm()).abs();
    assert!(
        off < 4.0 * found.baseline_error && found.baseline_error < 0.1,
        "{off} of {}",
        found.baseline_error
    );
}

#[test]
fn cameras_that_never_saw_it_together_are_named() {
    let mut views = board_views(8, &mut Noise::new(0, 0.0));
    for (i, view) in views.iter_mut().enumerate() {
        view[i % 2].clear();
    }
    assert_eq!(stereo(&board(), &views, [SIZE; 2], &Options::BOARD).unwrap_err(), CameraError::NeverTogether);
    let mut views = board_views(3, &mut Noise::new(0, 0.0));
    views[1][1].truncate(8);
    let error = stereo(&board(), &views, [SIZE; 2], &Options::BOARD).unwrap_err().to_string();
    assert!(error.starts_with("the right camera: view 1: all points"), "{error}");
}

/// The thesis's rig (2.3.2): three targets along five metres, two along one metre across, one where they meet; two cameras that look at a
/// tree of six metres from 14 m.
fn bars() -> (Target, Pair) {
    let camera = |focal| Camera::pinhole(focal, Pixel::new(959.5, 539.5));
    let right_from_left = Pose::new(Vector3::new(0.02, 0.6, -0.01), Vector3::new(-8.0, 0.3, 2.5));
    (
        Target::bars(&[1.2, 2.5, -2.5], &[-0.5, 0.5]).unwrap(),
        Pair { cameras: [camera(1900.0), camera(2000.0)], right_from_left },
    )
}

/// The bars moved round the tree and turned every way, facing either camera or neither.
fn round_the_tree(n: usize) -> Vec<Pose> {
    (0..n)
        .map(|i| {
            let a = i as f64;
            let turn =
                Vector3::new((a * 2.4).cos(), (a * 2.4).sin(), 0.0) * (0.5 + 0.5 * (a * 0.618).fract());
            let turned = Pose::new(turn, Vector3::zeros()).rotation
                * Pose::new(Vector3::z() * a * 1.3, Vector3::zeros()).rotation;
            Pose {
                rotation: turned,
                translation: Vector3::new(
                    2.0 * (a * 0.9).cos(),
                    (a * 1.7).sin(),
                    14.0 + 2.0 * (a * 0.9).sin(),
                ),
            }
        })
        .collect()
}

#[test]
fn bars_round_a_tree_give_cameras_and_their_distance_to_a_percent() {
    let (target, pair) = bars();
    let mut views = views(&pair, &target, &round_the_tree(16), &mut Noise::new(3, 0.5));
    // One target was clicked in the wrong place.
    views[4][1][2].1.x += 40.0;
    let sizes = [[1920, 1080]; 2];
    let found = stereo(&target, &views, sizes, &Options::BARS).unwrap();
    for (camera, truth) in found.pair.cameras.iter().zip(pair.cameras) {
        assert!((camera.fx / truth.fx - 1.0).abs() < 0.01, "{} for {}", camera.fx, truth.fx);
    }
    let truth = pair.right_from_left.translation.norm();
    assert!(
        (found.baseline / truth - 1.0).abs() < 0.01,
        "{} ± {} for {truth}",
        found.baseline,
        found.baseline_error
    );
    assert!(
        (found.baseline - truth).abs() < 4.0 * found.baseline_error && found.baseline_error < 0.1 * truth
    );
}

#[test]
fn bars_that_lie_alike_in_every_view_tell_nothing() {
    let (target, pair) = bars();
    let facing: Vec<Pose> = (0..6)
        .map(|i| Pose::new(Vector3::z() * f64::from(i), Vector3::new(0.3 * f64::from(i), 0.0, 14.0)))
        .collect();
    let error = stereo(
        &target,
        &views(&pair, &target, &facing, &mut Noise::new(3, 0.5)),
        [[1920, 1080]; 2],
        &Options::BARS,
    );
    let named = |error: &CameraError| matches!(error, CameraError::One { source, .. } if matches!(**source, CameraError::Alike { .. }));
    assert!(error.as_ref().is_err_and(named), "{error:?}");
    assert_eq!(Target::bars(&[1.0, 2.0, 3.0], &[]), Err(CameraError::Collinear));
    assert_eq!(Target::bars(&[1.0, 2.0, 3.0], &[0.5]), Err(CameraError::Collinear));
}
