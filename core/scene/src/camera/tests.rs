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
