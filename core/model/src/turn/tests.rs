//! Turns do what closed forms say, as matrices and as quaternions.

use proptest::prelude::*;

use super::*;

/// What a quaternion of length 1 does to a vector: v + 2 u × (u × v + w v).
fn turned([x, y, z, w]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let (u, once) = ([x, y, z], cross([x, y, z], v));
    let twice = cross(u, std::array::from_fn(|k| once[k] + w * v[k]));
    std::array::from_fn(|k| v[k] + 2.0 * twice[k])
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(std::array::from_fn(|k| a[k] - b[k]))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    v.map(|x| x / norm(v))
}

#[test]
fn quaternions_are_half_the_angle_about_the_axis() {
    for (axis, degrees) in [
        ([0.0, 0.0, 1.0], 90.0),
        ([1.0, 0.0, 0.0], 180.0),
        ([0.0, 1.0, 0.0], 179.999_999),
        ([0.6, 0.0, 0.8], 1e-9),
        ([0.0, -0.6, 0.8], 120.0),
        ([0.0, 1.0, 0.0], 0.0),
    ] {
        let (sin, cos) = (f64::to_radians(degrees) / 2.0).sin_cos();
        let found = Turn::about(axis, f64::to_radians(degrees)).quaternion();
        let wanted = [sin * axis[0], sin * axis[1], sin * axis[2], cos];
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-15, "{axis:?} {degrees}: {found} {wanted}");
        }
    }
}

#[test]
fn half_a_turn_goes_about_the_line_of_sight() {
    let up = [0.0, 0.0, 1.0];
    let turn = Turn::between(up, [0.0, 0.0, -1.0]);
    assert!(apart(turn.apply([0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]) < 1e-15);
    assert!(apart(turn.apply(up), [0.0, 0.0, -1.0]) < 1e-15);
    let away = Turn::between([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
    assert!(apart(away.apply([0.0, 1.0, 0.0]), [0.0, -1.0, 0.0]) < 1e-15);
    assert_eq!(Turn::between(up, up), Turn::NONE);
}

proptest! {
    #[test]
    fn any_turn_leads_there_and_back_either_way(
        from in prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |v| norm(*v) > 0.1),
        to in prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |v| norm(*v) > 0.1),
        other in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let (from, to) = (unit(from), unit(to));
        let turn = Turn::between(from, to);
        prop_assert!(apart(turn.apply(from), to) < 1e-12);
        let line = axis(from, to);
        prop_assert!(apart(turn.apply(line), line) < 1e-12, "what is turned about stays");
        prop_assert!(apart(turned(turn.quaternion(), other), turn.apply(other)) < 1e-12);
        prop_assert!(apart(turn.back().after(&turn).apply(other), other) < 1e-12);
    }
}
