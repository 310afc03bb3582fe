//! Against a system solved by hand, the equations of Euler and Lagrange, the limits of α, and known motion.

use super::*;
use crate::middlebury::{Pair, mean, moved};
use crate::texture;

fn field(pair: &Pair, params: &Params, n_threads: usize) -> Field {
    let [from, to] = pair.scales(params.levels, SMOOTHING_PX);
    measure(&from, &to, params, n_threads, &|_| true).unwrap()
}

fn plane(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Plane {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Plane { width, height, data: pixels.map(|(x, y)| value(x, y) as f32).collect() }
}

/// A constraint that looks drawn by chance.
fn asked(width: usize, height: usize) -> Constraint {
    let part = |seed: u64| plane(width, height, |x, y| 9.0 * texture::hash(seed, x as i64, y as i64));
    Constraint { gx: part(1), gy: part(2), rest: part(3) }
}

/// Pairs of neighbours.
fn edges(width: usize, height: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..width * height).flat_map(move |i| {
        let right = (i % width + 1 < width).then_some((i, i + 1));
        let below = (i / width + 1 < height).then_some((i, i + width));
        right.into_iter().chain(below)
    })
}

fn energy(Constraint { gx, gy, rest }: &Constraint, motion: &Motion, alpha: f64) -> f64 {
    let at = |plane: &Plane, i: usize| f64::from(plane.data[i]);
    let (u, v) = (&motion.u, &motion.v);
    let brightness: f64 =
        (0..u.data.len()).map(|i| (at(gx, i) * at(u, i) + at(gy, i) * at(v, i) + at(rest, i)).powi(2)).sum();
    let smoothness: f64 = edges(u.width, u.height)
        .map(|(i, k)| (at(u, i) - at(u, k)).powi(2) + (at(v, i) - at(v, k)).powi(2))
        .sum();
    brightness + alpha * alpha * smoothness
}

/// Largest derivative of the energy by any u or v: the discrete equations of Euler and Lagrange.
fn slope(Constraint { gx, gy, rest }: &Constraint, motion: &Motion, alpha: f64) -> f64 {
    let at = |plane: &Plane, i: usize| f64::from(plane.data[i]);
    let (u, v) = (&motion.u, &motion.v);
    let mut slopes: Vec<[f64; 2]> = (0..u.data.len())
        .map(|i| {
            let off = at(gx, i) * at(u, i) + at(gy, i) * at(v, i) + at(rest, i);
            [2.0 * at(gx, i) * off, 2.0 * at(gy, i) * off]
        })
        .collect();
    for (i, k) in edges(u.width, u.height) {
        for (axis, plane) in [u, v].into_iter().enumerate() {
            let pull = 2.0 * alpha * alpha * (at(plane, i) - at(plane, k));
            slopes[i][axis] += pull;
            slopes[k][axis] -= pull;
        }
    }
    slopes.iter().flatten().fold(0.0, |most, s| most.max(s.abs()))
}

fn solved(constraint: &Constraint, alpha: f32, sweeps: u32, n_threads: usize) -> Motion {
    let mut system = System::new(constraint, &Motion::blank(&constraint.gx), alpha);
    system.solve(sweeps, 0.0, n_threads, &|_| true).unwrap();
    system.motion()
}

#[test]
fn two_pixels_are_solved_as_by_hand() {
    // (u₁ - 1)² + (2 u₂)² + (u₁ - u₂)²: 2 u₁ - u₂ = 1 and 5 u₂ - u₁ = 0.
    let row = |values: [f32; 2]| Plane { width: 2, height: 1, data: values.into() };
    let constraint = Constraint { gx: row([1.0, 2.0]), gy: row([0.0; 2]), rest: row([-1.0, 0.0]) };
    let motion = solved(&constraint, 1.0, 400, 1);
    for (got, want) in motion.u.data.iter().zip([5.0 / 9.0, 1.0 / 9.0]) {
        assert!((got - want).abs() < 1e-5, "{:?}", motion.u.data);
    }
    assert_eq!(motion.v.data, [0.0; 2]);
}

#[test]
fn every_sweep_lowers_the_energy_and_the_solution_has_no_slope() {
    for (width, height) in [(17, 12), (12, 17), (8, 8), (1, 9), (9, 1), (2, 2)] {
        for (alpha, relaxation) in [(3.0, 1.0), (3.0, 1.9), (15.0, 1.9), (0.5, 1.5)] {
            let constraint = asked(width, height);
            let mut system = System::new(&constraint, &Motion::blank(&constraint.gx), alpha);
            let mut last = energy(&constraint, &system.motion(), f64::from(alpha));
            let first = slope(&constraint, &system.motion(), f64::from(alpha));
            for n in 0..600 {
                system.sweep(relaxation, 1);
                let now = energy(&constraint, &system.motion(), f64::from(alpha));
                assert!(now <= last * (1.0 + 1e-6), "{width}x{height} α {alpha}, sweep {n}: {last} to {now}");
                last = now;
            }
            let end = slope(&constraint, &system.motion(), f64::from(alpha));
            assert!(end < 1e-4 * first, "{width}x{height} α {alpha}: {first} to {end}");
        }
    }
}

#[test]
fn horn_and_schuncks_own_iteration_ends_at_the_same_motion() {
    let (width, height, alpha) = (13, 9, 4.0_f64);
    let constraint = asked(width, height);
    let neighbours: Vec<Vec<usize>> = (0..width * height)
        .map(|i| {
            edges(width, height)
                .filter_map(|(a, b)| (a == i).then_some(b).or((b == i).then_some(a)))
                .collect()
        })
        .collect();
    let mut motion = vec![[0.0_f64; 2]; width * height];
    for _ in 0..20_000 {
        let next = (0..motion.len()).map(|i| {
            let n = neighbours[i].len() as f64;
            let mean = [0, 1].map(|axis| neighbours[i].iter().map(|&k| motion[k][axis]).sum::<f64>() / n);
            let [gx, gy, rest] =
                [&constraint.gx, &constraint.gy, &constraint.rest].map(|p| f64::from(p.data[i]));
            let off = (gx * mean[0] + gy * mean[1] + rest) / (n * alpha * alpha + gx * gx + gy * gy);
            [mean[0] - gx * off, mean[1] - gy * off]
        });
        motion = next.collect();
    }
    let got = solved(&constraint, alpha as f32, 2000, 1);
    for (i, want) in motion.iter().enumerate() {
        let apart = (f64::from(got.u.data[i]) - want[0]).hypot(f64::from(got.v.data[i]) - want[1]);
        assert!(apart < 1e-4, "pixel {i}: {apart}");
    }
}

#[test]
fn a_large_alpha_moves_all_as_one_and_a_small_one_keeps_every_brightness() {
    let constraint = asked(9, 7);
    let stiff = solved(&constraint, 300.0, 20_000, 1);
    // The one motion that fits all constraints best.
    let sum = |a: &Plane, b: &Plane| a.data.iter().zip(&b.data).map(|(a, b)| f64::from(a * b)).sum::<f64>();
    let Constraint { gx, gy, rest } = &constraint;
    let (xx, xy, yy) = (sum(gx, gx), sum(gx, gy), sum(gy, gy));
    let (bx, by) = (-sum(gx, rest), -sum(gy, rest));
    let determinant = xx * yy - xy * xy;
    let want = [(yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant];
    for (u, v) in stiff.u.data.iter().zip(&stiff.v.data) {
        assert!((f64::from(*u) - want[0]).hypot(f64::from(*v) - want[1]) < 5e-3, "{u} {v} for {want:?}");
    }
    let loose = solved(&constraint, 1e-3, 4000, 1);
    for i in 0..loose.u.data.len() {
        let off = gx.data[i] * loose.u.data[i] + gy.data[i] * loose.v.data[i] + rest.data[i];
        assert!(off.abs() < 0.05, "pixel {i}: {off}");
    }
}

#[test]
fn known_motion_is_found() {
    let limits = [0.001, 0.05, 0.05, 0.06, 0.06, 0.06];
    for (pair, limit) in moved().iter().zip(limits) {
        let (errors, known) = pair.errors(&field(pair, &Params::default(), 1), 12);
        let (mean, high) = (mean(&errors), errors[errors.len() * 99 / 100]);
        assert!(
            mean < limit && known > 0.999,
            "{}: mean {mean}, 99 % below {high}, known {known}",
            pair.name
        );
    }
}

#[test]
fn what_has_no_texture_moves_with_what_is_around_it() {
    let mut pair = Pair::affine("", (120, 90), [1.0, 0.0, 0.0, 1.0], [-1.5, 0.5]);
    for picture in &mut pair.pictures {
        for y in 35..55 {
            picture[y * 120 + 50..y * 120 + 70].fill(128);
        }
    }
    let hole = field(&pair, &Params::default(), 1);
    let [u, v] = hole.at([60.0, 45.0]).unwrap();
    assert!((u - 1.5).abs() < 0.8 && (v + 0.5).abs() < 0.5, "{u} {v}");
    let gray = Pair { pictures: [vec![128; 120 * 90], vec![128; 120 * 90]], ..pair };
    let still = field(&gray, &Params::default(), 1);
    assert!(still.u.iter().chain(&still.v).all(|c| *c == 0.0));
}

#[test]
fn threads_do_not_change_a_bit_and_a_no_ends_it() {
    let pair = Pair::affine("", (480, 300), [1.01, 0.02, -0.01, 1.0], [1.3, 0.4]);
    let bits = |field: &Field| field.u.iter().chain(&field.v).map(|v| v.to_bits()).collect::<Vec<_>>();
    for params in [Params::default(), Params { median: false, robust_gray: 0.0, ..Params::default() }] {
        let once = field(&pair, &params, 1);
        for n_threads in [2, 3, 8] {
            assert_eq!(bits(&field(&pair, &params, n_threads)), bits(&once), "{n_threads} threads");
        }
    }
    let [from, to] = pair.scales(3, 0.0);
    let until = |limit: f64| measure(&from, &to, &Params::default(), 1, &|done| done < limit);
    assert!(until(0.5).is_none() && until(1.0).is_some());
}

#[test]
fn tiny_pictures_are_measured_without_harm() {
    for (width, height) in [(1, 1), (2, 1), (1, 9), (7, 5), (33, 2)] {
        let pair = Pair::affine("", (width, height), [1.0, 0.0, 0.0, 1.0], [0.4, 0.2]);
        let field = field(&pair, &Params::default(), 2);
        assert!(field.u.iter().chain(&field.v).all(|v| v.is_finite()), "{width}x{height}");
    }
}

#[test]
fn pairs_with_measured_motion_are_met_as_well_as_the_readme_says() {
    for (name, limit) in [("RubberWhale", 0.26), ("Hydrangea", 0.33), ("Grove2", 0.225)] {
        let Some(pair) = Pair::middlebury(name) else { return };
        let (errors, _) = pair.errors(&field(&pair, &Params::default(), 2), 0);
        let (mean, median) = (mean(&errors), errors[errors.len() / 2]);
        println!("{name}: mean {mean:.3} px, median {median:.3} px");
        assert!(mean < limit, "{name}: {mean}");
    }
}
