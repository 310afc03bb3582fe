//! Colours against a table worked out by hand and Python's `colorsys`; the circle against its wrap.

use super::*;
use honami_model::track::{Quality, Sample, Source, Status};
use proptest::prelude::*;

fn mapping(gain_s_px: f64) -> Mapping {
    Mapping { gain_s_px, dial: Dial::ALL }
}

#[test]
fn colours_by_hand() {
    // Velocity in px/s at c = 0.01 s/px: colour, opacity. Down is a quarter turn: yellow-green.
    for (velocity, rgb, alpha) in [
        ([100.0, 0.0], [255, 0, 0], 1.0),
        ([900.0, 0.0], [255, 0, 0], 1.0),
        ([0.0, 100.0], [128, 255, 0], 1.0),
        ([-100.0, 0.0], [0, 255, 255], 1.0),
        ([0.0, -100.0], [128, 0, 255], 1.0),
        ([50.0, 0.0], [255, 0, 0], 0.5),
        ([-20.0, 0.0], [0, 255, 255], 0.2),
        ([-30.0, 40.0], [0, 255, 29], 0.5),
    ] {
        let tint = mapping(0.01).tint(velocity).unwrap();
        assert_eq!((tint.rgb, tint.alpha), (rgb, alpha), "{velocity:?}");
    }
    for velocity in [[0.0, 0.0], [f64::NAN, 1.0]] {
        assert_eq!(mapping(0.01).tint(velocity), None, "{velocity:?}");
    }
}

/// On black the tint is the cone of the thesis: HSV with `V = min(c ρ, 1)`. On white nothing becomes darker than the
/// colour itself: slow motion is no shadow.
#[test]
fn over_black_it_is_the_cone_and_over_white_no_shadow() {
    for (velocity, on_black, on_white) in [
        ([50.0, 0.0], [128, 0, 0], [255, 128, 128]),
        ([-20.0, 0.0], [0, 51, 51], [204, 255, 255]),
        ([0.0, 100.0], [128, 255, 0], [128, 255, 0]),
    ] {
        let tint = mapping(0.01).tint(velocity).unwrap();
        assert_eq!((over([0; 3], tint), over([255; 3], tint)), (on_black, on_white), "{velocity:?}");
    }
}

/// `[colorsys.hsv_to_rgb(d / 360, 1, 1) for d in …]`
#[test]
fn hues_are_those_of_colorsys() {
    for (degrees, rgb) in [
        (0.0, [1.0, 0.0, 0.0]),
        (15.0, [1.0, 0.25, 0.0]),
        (60.0, [1.0, 1.0, 0.0]),
        (100.0, [1.0 / 3.0, 1.0, 0.0]),
        (120.0, [0.0, 1.0, 0.0]),
        (165.0, [0.0, 1.0, 0.75]),
        (210.0, [0.0, 0.5, 1.0]),
        (240.0, [0.0, 0.0, 1.0]),
        (285.0, [0.75, 0.0, 1.0]),
        (300.0, [1.0, 0.0, 1.0]),
        (351.0, [1.0, 0.0, 0.15]),
        (-60.0, [1.0, 0.0, 1.0]),
    ] {
        let ours = hue(f64::to_radians(degrees));
        assert!(ours.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 1e-12), "{degrees}: {ours:?}");
    }
}

#[test]
fn a_dial_wraps_round() {
    for (centre, width, direction, shows) in [
        (0.0, 30.0, 30.0, true),
        (0.0, 30.0, -30.0, true),
        (0.0, 30.0, 330.0, true),
        (0.0, 30.0, 31.0, false),
        (170.0, 20.0, -170.0, true),
        (170.0, 20.0, -169.0, false),
        (-350.0, 15.0, 25.0, true),
        (90.0, 180.0, 270.0, true),
        (90.0, 0.0, 90.0, true),
        (90.0, 0.0, 90.5, false),
    ] {
        let dial = Dial { centre_rad: f64::to_radians(centre), half_width_rad: f64::to_radians(width) };
        assert_eq!(dial.shows(f64::to_radians(direction)), shows, "{direction} by {centre} ± {width}");
        let moving = f64::to_radians(direction).sin_cos();
        let tint = Mapping { gain_s_px: 1.0, dial }.tint([moving.1, moving.0]);
        assert_eq!(tint.is_some(), shows, "{direction} by {centre} ± {width}");
    }
}

/// A track that goes 2 px right a frame, with the frames in which it is not seen.
fn span(first_frame: u32, n: u32, lost: &[u32]) -> Span {
    let sample = |frame: u32| Sample {
        x: 2.0 * frame as f32,
        y: 5.0,
        status: if lost.contains(&frame) { Status::Lost } else { Status::Tracked },
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame, samples: (first_frame..first_frame + n).map(sample).collect() }
}

#[test]
fn velocities_are_by_the_clock() {
    let times = FrameTimes::new(vec![0.0, 0.1, 0.2, 0.6, 0.7, 0.8, 0.9]).unwrap();
    let span = span(1, 6, &[4]);
    for (frame, speed) in [
        (0, None),
        (1, Some(20.0)),
        (2, Some(8.0)),
        (3, Some(5.0)),
        (4, None),
        (5, Some(20.0)),
        (6, Some(20.0)),
        (7, None),
    ] {
        let [u, v] = velocity(&span, &times, frame).unwrap_or([-1.0, 0.0]);
        assert!((u - speed.unwrap_or(-1.0)).abs() < 1e-9 && v == 0.0, "frame {frame}: {u}");
    }
    assert_eq!(velocity(&self::span(2, 1, &[]), &times, 2), None, "alone");
    assert!((usual_speed(&[&span], &times).unwrap() - 20.0).abs() < 1e-9);
    assert_eq!(usual_speed(&[], &times), None);
}

#[test]
fn discs_are_strongest_in_the_middle_and_gone_at_their_edge() {
    let tint = Tint { rgb: [200, 0, 0], alpha: 0.5 };
    let mut pixels = vec![[0, 0, 100]; 7 * 5];
    paint_discs(&mut pixels, 7, &[Disc { at: [3.0, 2.0], tint }], [2.0, 2.0]);
    assert_eq!(pixels[2 * 7 + 3], [100, 0, 50]);
    assert_eq!(pixels[2 * 7 + 4], [75, 0, 63], "(1 - 1/4) / 2 of it");
    assert_eq!(pixels[2 * 7 + 5], [0, 0, 100]);
    assert_eq!(pixels[0], [0, 0, 100]);
}

proptest! {
    #[test]
    fn distances_are_on_the_circle(a in -20.0..20.0_f64, b in -20.0..20.0_f64, turns in -3..3) {
        let d = angular_distance(a, b);
        prop_assert!((0.0..=PI).contains(&d));
        prop_assert!((d - angular_distance(b, a)).abs() < 1e-9);
        prop_assert!((d - angular_distance(a + TAU * f64::from(turns), b)).abs() < 1e-9);
        prop_assert!((d - (a - b).cos().clamp(-1.0, 1.0).acos()).abs() < 1e-6);
    }

    #[test]
    fn the_order_of_discs_does_not_matter(
        discs in prop::collection::vec((-3.0..12.0_f64, -3.0..9.0_f64, 0..256_u32, 0.01..1.0_f64), 0..6),
    ) {
        let disc = |&(x, y, red, alpha): &(f64, f64, u32, f64)| {
            Disc { at: [x, y], tint: Tint { rgb: [red as u8, 90, 0], alpha } }
        };
        let mut discs: Vec<Disc> = discs.iter().map(disc).collect();
        let painted = |discs: &[Disc]| {
            let mut pixels = vec![[40, 50, 60]; 9 * 6];
            paint_discs(&mut pixels, 9, discs, [2.5, 1.5]);
            pixels
        };
        let one = painted(&discs);
        discs.reverse();
        for (a, b) in one.iter().zip(painted(&discs)) {
            prop_assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1));
        }
    }

    #[test]
    fn opacity_grows_with_speed(u in -500.0..500.0_f64, v in -500.0..500.0_f64, gain in 0.0001..1.0_f64) {
        let alpha = |k: f64| mapping(gain).tint([k * u, k * v]).map_or(0.0, |tint| tint.alpha);
        prop_assert!((alpha(1.0) - (gain * u.hypot(v)).min(1.0)).abs() < 1e-12);
        prop_assert!(alpha(2.0) >= alpha(1.0) && alpha(100.0) <= 1.0);
    }
}
