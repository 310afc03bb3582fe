//! Against a system solved by hand, motion that is known exactly, and pairs whose motion was measured.

use super::*;
use crate::middlebury::{Pair, mean, moved};

fn field(pair: &Pair, params: &Params, n_threads: usize) -> Field {
    let [from, to] = pair.scales(params.levels, SMOOTHING_PX);
    measure(&from, &to, params, n_threads, &|_| true).unwrap()
}

#[test]
fn one_step_on_a_saddle_is_what_the_sums_give_by_hand() {
    // I = x y has the gradient (y, x). Where J = I + c, a window about (x, y) whose weights have the variance s² has the
    // matrix [y² + s², x y; x y, x² + s²] and the right side -c (y, x): its motion is -c (y, x) / (x² + y² + s²).
    let (width, height, c) = (40, 36, 0.75);
    let saddle = |lift: f32| {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32 - 20.0, y as f32 - 18.0)));
        Plane { width, height, data: pixels.map(|(x, y)| x * y + lift).collect() }
    };
    let (i, j) = (saddle(0.0), saddle(c));
    let params = Params { radius_px: 4, min_eigenvalue: 0.0, ..Params::default() };
    let windows = Windows::new(&i, &params, 1);
    let mut motion = Motion::blank(&i);
    windows.refine(&mut motion, &i, &j, 1);
    let variance: f32 = (1..=4).map(|k| 2.0 * windows.weights[k] * (k * k) as f32).sum();
    for (column, row) in [(20, 18), (25, 18), (14, 23), (28, 11)] {
        let (x, y) = (column as f32 - 20.0, row as f32 - 18.0);
        let scale = -c / (x * x + y * y + variance);
        let got = [motion.u.row(row)[column], motion.v.row(row)[column]];
        let apart = (got[0] - scale * y).hypot(got[1] - scale * x);
        assert!(apart < 1e-4, "({x}, {y}): {got:?} for {}, {}", scale * y, scale * x);
    }
}

#[test]
fn without_a_limit_what_cannot_be_solved_stays_finite_and_near() {
    let (width, height) = (48, 40);
    let picture = |value: &dyn Fn(f32, f32) -> f32| {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32, y as f32)));
        Plane { width, height, data: pixels.map(|(x, y)| value(x, y)).collect() }
    };
    type Brightness = fn(f32, f32) -> f32;
    let flat: Brightness = |_, _| 90.0;
    let edge: Brightness = |x, y| if x + y < 40.0 { 0.0 } else { 255.0 };
    let moved: Brightness = |x, y| if x + y < 43.0 { 0.0 } else { 255.0 };
    let dot: Brightness = |x, y| if (x, y) == (20.0, 20.0) { 255.0 } else { 0.0 };
    let faint: Brightness = |x, _| 90.0 + 1e-6 * x;
    for (i, (before, after)) in
        [(flat, edge), (edge, flat), (edge, moved), (dot, edge), (faint, edge), (edge, dot)]
            .iter()
            .enumerate()
    {
        for radius_px in [1, 7] {
            let (before, after) = (picture(before), picture(after));
            let params = Params { radius_px, min_eigenvalue: 0.0, ..Params::default() };
            let windows = Windows::new(&before, &params, 1);
            let mut motion = Motion::blank(&before);
            for _ in 0..100 {
                windows.refine(&mut motion, &before, &after, 1);
            }
            let farthest = motion
                .u
                .data
                .iter()
                .chain(&motion.v.data)
                .fold(0.0, |most: f32, c| if c.is_finite() { most.max(c.abs()) } else { f32::INFINITY });
            assert!(farthest <= 88.0, "pair {i}, radius {radius_px}: {farthest} px");
        }
    }
}

#[test]
fn known_motion_is_found() {
    let limits = [0.001, 0.03, 0.03, 0.05, 0.07, 0.07];
    for (pair, limit) in moved().iter().zip(limits) {
        let (errors, known) = pair.errors(&field(pair, &Params::default(), 1), 12);
        let (mean, high) = (mean(&errors), errors[errors.len() * 99 / 100]);
        assert!(mean < limit && known > 0.99, "{}: mean {mean}, 99 % below {high}, known {known}", pair.name);
    }
}

#[test]
fn what_has_no_texture_or_one_edge_is_not_known_and_the_rest_is() {
    let [mut before, mut after] = Pair::affine("", (120, 80), [1.0, 0.0, 0.0, 1.0], [-1.5, 0.5]).pictures;
    for picture in [&mut before, &mut after] {
        for (i, value) in picture.iter_mut().enumerate() {
            match i % 120 {
                0..30 => *value = 90,
                30..45 => *value = 200,
                _ => {}
            }
        }
    }
    let pair =
        Pair { name: String::new(), width: 120, height: 80, pictures: [before, after], truth: Vec::new() };
    let field = field(&pair, &Params { step_px: 1, ..Params::default() }, 1);
    for y in 20..60_usize {
        assert!((0..34).all(|x| !field.known[y * 120 + x]), "row {y}");
        assert!((60..100).all(|x| field.known[y * 120 + x]), "row {y}");
    }
}

#[test]
fn threads_do_not_change_a_bit_and_a_no_ends_it() {
    let pair = Pair::affine("", (480, 300), [1.01, 0.02, -0.01, 1.0], [1.3, 0.4]);
    let bits = |field: &Field| field.u.iter().chain(&field.v).map(|v| v.to_bits()).collect::<Vec<_>>();
    let once = field(&pair, &Params::default(), 1);
    for n_threads in [2, 3, 8] {
        let again = field(&pair, &Params::default(), n_threads);
        assert_eq!((bits(&again), &again.known), (bits(&once), &once.known), "{n_threads} threads");
    }
    let [from, to] = pair.scales(3, 0.0);
    let shares = std::cell::RefCell::new(Vec::new());
    let until = |limit: f64| {
        measure(&from, &to, &Params::default(), 1, &|done| {
            shares.borrow_mut().push(done);
            done < limit
        })
    };
    assert!(until(0.5).is_none() && until(2.0).is_some());
    let shares = shares.into_inner();
    assert!(shares.iter().all(|s| (0.0..1.0).contains(s)));
}

#[test]
fn tiny_pictures_are_measured_without_harm() {
    for (width, height) in [(1, 1), (2, 1), (1, 9), (7, 5), (33, 2)] {
        for radius_px in [0, 1, 7, 40] {
            let pair = Pair::affine("", (width, height), [1.0, 0.0, 0.0, 1.0], [0.4, 0.2]);
            let params = Params { radius_px, min_eigenvalue: 0.0, ..Params::default() };
            let field = field(&pair, &params, 2);
            assert!(field.u.iter().chain(&field.v).all(|v| v.is_finite()), "{width}x{height} r{radius_px}");
        }
    }
}

#[test]
fn pairs_with_measured_motion_are_met_as_well_as_the_readme_says() {
    for (name, limit) in [("RubberWhale", 0.285), ("Hydrangea", 0.4), ("Grove2", 0.295)] {
        let Some(pair) = Pair::middlebury(name) else { return };
        let (errors, known) = pair.errors(&field(&pair, &Params::default(), 2), 0);
        let (mean, median) = (mean(&errors), errors[errors.len() / 2]);
        println!("{name}: mean {mean:.3} px, median {median:.3} px, known {known:.3}");
        assert!(mean < limit, "{name}: {mean}");
    }
}
