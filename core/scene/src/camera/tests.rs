//! Where cameras are and what they see, by hand.

use super::{Camera, Orbit};
use std::f32::consts::FRAC_PI_2;

fn near(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
}

#[test]
fn an_orbit_goes_round_counterclockwise_from_the_front() {
    let at = |azimuth, elevation| {
        Orbit { target: [1.0, 2.0, 3.0], distance: 2.0, azimuth, elevation, angle: 1.0 }.camera().eye
    };
    assert!(near(&at(0.0, 0.0), &[1.0, 0.0, 3.0]));
    assert!(near(&at(FRAC_PI_2, 0.0), &[3.0, 2.0, 3.0]));
    assert!(near(&at(0.0, FRAC_PI_2)[2..], &[5.0 - 0.0001]));
}

/// Each: where it would be, and from how high it is then seen.
#[test]
fn an_eye_stays_above_the_ground() {
    for (height, distance, elevation, wanted) in [
        (3.0, 10.0, 0.2, 3.0 + 10.0 * 0.2_f32.sin()),
        // Up into a crown from the ground, and as far down as that.
        (3.0, 10.0, -0.2, 3.0 - 10.0 * 0.2_f32.sin()),
        (3.0, 10.0, -1.5, 0.1),
        (3.0, 2.0, -1.5, 3.0 - 2.0 * 1.5_f32.sin()),
        (0.0, 10.0, -0.3, 0.1),
        (-4.0, 10.0, -0.3, 0.1),
        (-4.0, 10.0, 0.3, 10.0 * 0.3_f32.sin()),
    ] {
        let target = [1.0, 2.0, height];
        let mut orbit = Orbit { target, distance, azimuth: 0.7, elevation, angle: 1.0 };
        orbit.stay_above();
        let eye = orbit.camera().eye;
        assert!((eye[2] - wanted).abs() < 1e-4, "{height} {distance} {elevation}: {eye:?}");
    }
}

#[test]
fn what_is_right_of_and_above_the_target_is_seen_so() {
    // A quarter turn between the edges: at distance 2 half of the picture is 2 long.
    let camera = Camera { eye: [0.0, -2.0, 1.0], target: [0.0, 0.0, 1.0], angle: FRAC_PI_2 };
    let seen = |place| {
        let ([right, up], depth) = camera.seen(place);
        [right, up, depth]
    };
    let table = [
        ([0.0, 0.0, 1.0], [0.0, 0.0, 2.0]),
        ([1.0, 0.0, 1.0], [0.5, 0.0, 2.0]),
        ([0.0, 0.0, 3.0], [0.0, 1.0, 2.0]),
        ([2.0, 2.0, 0.0], [0.5, -0.25, 4.0]),
    ];
    for (place, wanted) in table {
        assert!(near(&seen(place), &wanted), "{place:?}: {:?}", seen(place));
    }
}
