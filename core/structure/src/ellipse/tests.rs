//! Against the share of a normal distribution that lies inside, and against ellipses by hand.

use super::*;

/// Normal numbers from the sum of twelve even ones less six would have short tails: Box and Muller's have not.
fn normal(seed: &mut u64) -> [f64; 2] {
    let mut even = || {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*seed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let (u, v) = (even(), even() * std::f64::consts::TAU);
    let r = (-2.0 * u.ln()).sqrt();
    [r * v.cos(), r * v.sin()]
}

#[test]
fn nineteen_of_twenty_places_lie_inside() {
    let mut seed = 7;
    let (c, s) = (0.6_f64.cos(), 0.6_f64.sin());
    let places: Vec<[f64; 2]> = (0..40_000)
        .map(|_| {
            let [a, b] = normal(&mut seed);
            let (a, b) = (30.0 * a, 8.0 * b);
            [100.0 + c * a - s * b, 200.0 + s * a + c * b]
        })
        .collect();
    let ellipse = Ellipse::of(&places).unwrap();
    let outside = places.iter().filter(|place| ellipse.depth(**place) <= 0.0).count() as f64 / 40_000.0;
    assert!((outside - 0.05).abs() < 0.004, "{outside}");
    assert!((ellipse.reach[0] / (5.9915_f64.sqrt() * 30.0) - 1.0).abs() < 0.02, "{ellipse:?}");
    assert!((ellipse.reach[1] / (5.9915_f64.sqrt() * 8.0) - 1.0).abs() < 0.02, "{ellipse:?}");
    assert!((ellipse.axis[1].atan2(ellipse.axis[0]) - 0.6).abs() < 0.02, "{ellipse:?}");
}

/// Four places at (±3, 0) and (0, ±2): variances 18/3 and 8/3, with nobody between the axes.
#[test]
fn an_ellipse_by_hand() {
    let ellipse = Ellipse::of(&[[3.0, 0.0], [-3.0, 0.0], [0.0, 2.0], [0.0, -2.0]]).unwrap();
    let [long, short] = [6.0_f64, 8.0 / 3.0].map(|variance| (5.991_464_547 * variance).sqrt());
    assert!((ellipse.reach[0] - long).abs() < 1e-6 && (ellipse.reach[1] - short).abs() < 1e-6);
    assert!((ellipse.depth([0.0, 0.0]) - short).abs() < 1e-6, "the third axis is as long as the shorter one");
    let half = ellipse.depth([long / 2.0, 0.0]);
    assert!((half - short * 0.75_f64.sqrt()).abs() < 1e-6);
    assert!(ellipse.depth([long * 1.01, 0.0]).abs() < f64::MIN_POSITIVE);
}

#[test]
fn few_places_and_places_on_a_line_have_no_depth() {
    assert_eq!(Ellipse::of(&[]), None);
    let one = Ellipse::of(&[[4.0, 5.0]]).unwrap();
    assert_eq!((one.centre, one.reach, one.depth([4.0, 5.0])), ([4.0, 5.0], [0.0, 0.0], 0.0));
    let same = Ellipse::of(&[[4.0, 5.0]; 7]).unwrap();
    assert_eq!((same.reach, same.depth([4.0, 5.0])), ([0.0, 0.0], 0.0));
    let two = Ellipse::of(&[[0.0, 0.0], [4.0, 0.0]]).unwrap();
    assert!((two.reach[0] - REACH * 8.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!((two.reach[1], two.depth([2.0, 0.0])), (0.0, 0.0));
    let line: Vec<[f64; 2]> = (0..9).map(|k| [f64::from(k) * 0.1, f64::from(k) * 0.3]).collect();
    let line = Ellipse::of(&line).unwrap();
    assert!(line.depth(line.centre).abs() < f64::MIN_POSITIVE, "{line:?}");
}
