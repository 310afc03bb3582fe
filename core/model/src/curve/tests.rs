//! The basis of errata E9, what the curve reproduces, and where it must pass.

use super::{Knot, basis, speed, through};

const TOLERANCE: f64 = 1e-12;

fn knots(times_s: &[f64], path: impl Fn(f64) -> [f64; 2]) -> Vec<Knot> {
    times_s.iter().map(|&t_s| Knot { t_s, at: path(t_s) }).collect()
}

fn near(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).abs() <= tolerance && (a[1] - b[1]).abs() <= tolerance
}

#[test]
fn basis_is_the_corrected_one() {
    let dt_s = 0.4;
    for (tau, want) in [
        (0.0, [1.0, 0.0, 0.0, 0.0]),
        (0.5, [0.5, 0.125 * dt_s, 0.5, -0.125 * dt_s]),
        (1.0, [0.0, 0.0, 1.0, 0.0]),
    ] {
        let got = basis(tau, dt_s);
        assert!(got.iter().zip(want).all(|(g, w)| (g - w).abs() < TOLERANCE), "{tau}: {got:?}");
    }
    for k in 0..=10 {
        let [h00, _, h01, _] = basis(f64::from(k) / 10.0, dt_s);
        assert!((h00 + h01 - 1.0).abs() < TOLERANCE, "positions are averaged");
    }
}

#[test]
fn basis_has_the_slopes_it_weighs() {
    let (dt_s, step) = (0.7, 1e-6);
    let slopes = |tau: f64| {
        let (a, b) = (basis(tau - step, dt_s), basis(tau + step, dt_s));
        [0, 1, 2, 3].map(|k| (b[k] - a[k]) / (2.0 * step * dt_s))
    };
    for (tau, want) in [(0.0, [0.0, 1.0, 0.0, 0.0]), (1.0, [0.0, 0.0, 0.0, 1.0])] {
        let got = slopes(tau);
        assert!(got.iter().zip(want).all(|(g, w)| (g - w).abs() < 1e-5), "{tau}: {got:?}");
    }
}

#[test]
fn quadratics_come_back_between_inner_knots() {
    let path = |t: f64| [3.0 - 2.0 * t + 5.0 * t * t, 1.0 + 7.0 * t - 0.5 * t * t];
    let segments = through(&knots(&[0.0, 0.1, 0.4, 1.0, 1.3], path));
    for segment in &segments[1..segments.len() - 1] {
        for k in 0..=8 {
            let t = segment.from.t_s + (segment.to.t_s - segment.from.t_s) * f64::from(k) / 8.0;
            assert!(near(segment.at(t), path(t), 1e-11), "at {t}");
        }
    }
}

#[test]
fn curve_passes_its_knots_and_lines_stay_lines() {
    let line = |t: f64| [10.0 + 4.0 * t, -3.0 * t];
    let segments = through(&knots(&[0.0, 0.5, 0.6, 2.0], line));
    assert_eq!(segments.len(), 3);
    for segment in &segments {
        assert!(near(segment.at(segment.from.t_s), segment.from.at, TOLERANCE));
        assert!(near(segment.at(segment.to.t_s), segment.to.at, TOLERANCE));
        let middle = f64::midpoint(segment.from.t_s, segment.to.t_s);
        assert!(near(segment.at(middle), line(middle), TOLERANCE), "also in the first and last segment");
    }
}

#[test]
fn nearer_neighbour_weighs_more() {
    // Diener 2009, figure 3.9: k1 - k = 2 (k - k0), so the earlier slope has weight 2/3.
    let k = |t_s, x| Knot { t_s, at: [x, 0.0] };
    let got = speed(Some(k(0.0, 0.0)), k(1.0, 3.0), Some(k(3.0, 3.0)));
    assert!(near(got, [2.0, 0.0], TOLERANCE), "{got:?}");
    assert!(near(speed(None, k(1.0, 3.0), Some(k(3.0, 7.0))), [2.0, 0.0], TOLERANCE));
    assert!(near(speed(Some(k(0.0, 2.0)), k(1.0, 3.0), None), [1.0, 0.0], TOLERANCE));
    assert!(near(speed(None, k(1.0, 3.0), None), [0.0, 0.0], TOLERANCE));
    assert!(through(&[k(0.0, 1.0)]).is_empty() && through(&[]).is_empty());
}
