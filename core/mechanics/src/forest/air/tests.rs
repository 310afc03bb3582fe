//! Damping by the air against closed forms, against a fine reference, and at its limits.

use super::fade;
use crate::forest::tests::{PACE, blowing, forest, go, plant, threads};
use crate::forest::{Forest, Pace, Stand};
use crate::wind::{Noise, Wind};
use crate::{Damping, Form, Integrator, Stirring};
use nalgebra::Vector3;

/// Little by the wood, so that the most of it is the air's.
const DAMPING: Damping = Damping { alpha: 0.1, beta: 5e-4, mass: 1.0, air: 1.0 };

/// Of a mode of a copy that is so large and heavy, in a wind: omega, gamma and what it comes to rest at.
fn swing(plant: &Stirring, mode: usize, stand: &Stand, damping: &Damping, v: &Vector3<f64>) -> [f64; 3] {
    let (scale, mass) = (f64::from(stand.scale), f64::from(stand.mass) * damping.mass);
    let omega = plant.omegas[mode] / scale / mass.sqrt();
    let of_air = damping.air * plant.basis.damping(mode, v) / (mass * scale);
    let rest = plant.basis.force(mode, v) / (mass * scale.powi(2)) / omega.powi(2);
    [omega, damping.alpha + damping.beta * omega.powi(2) + of_air, rest]
}

#[test]
fn what_fades_is_an_exponential_and_never_grows() {
    for k in 0..=4000 {
        let x = k as f32 / 1000.0;
        let off = f64::from(fade(x)) / f64::from(-x).exp() - 1.0;
        assert!(off.abs() < if x <= 1.0 { 1e-6 } else { 4e-3 }, "{x}: {off}");
    }
    let far: Vec<f32> = (0..40).map(|k| fade(1.7_f32.powi(k))).collect();
    assert!(far.is_sorted_by(|a, b| a >= b) && far.iter().all(|v| (0.0..=1.0).contains(v)), "{far:?}");
    for (x, wanted) in [(0.0, 1.0), (-1e-9, 1.0), (f32::MAX, 0.0), (f32::INFINITY, 0.0)] {
        assert_eq!(fade(x).to_bits(), f32::to_bits(wanted), "{x}");
    }
}

/// Not by a bit.
#[test]
fn still_air_takes_nothing() {
    let plant = plant(40, 5, Form::Linear);
    let end = |air: f64, wind: f64| {
        let pace = Pace { damping: Damping { air, ..PACE.damping }, ..PACE };
        let mut forest = forest(&plant, &[Stand { turn: 0.4, ..Stand::default() }], &pace);
        forest.pull(0, &plant.pulled(0.3).unwrap());
        go(&mut forest, 50, &blowing(Vector3::new(wind, 0.0, 0.0)), &threads(1));
        forest.save()
    };
    assert!(end(0.0, 0.0) == end(1.0, 0.0) && end(1.0, 0.0) == end(700.0, 0.0));
    assert!(end(0.0, 3.0) != end(1.0, 3.0));
}

/// All modes of copies that are turned, large and heavy, in short steps: gamma is that of the wood and that of the basis.
#[test]
fn in_a_steady_wind_swings_die_as_the_closed_form_says() {
    let plant = plant(40, 4, Form::Linear);
    let (damping, step) = (DAMPING, 5e-3);
    let v = Vector3::new(3.0, -1.3, 0.3);
    for (turn, scale, mass) in [(0.0, 1.0, 1.0), (0.0, 2.0, 0.5), (1.1, 0.7, 1.5)] {
        let stand = Stand { turn, scale, mass };
        let mut forest = forest(&plant, &[stand], &Pace { step, damping, ..PACE });
        let (sin, cos) = f64::from(turn).sin_cos();
        let turned = Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        let begun = plant.pulled(0.5).unwrap()[0];
        forest.pull(0, &[begun; 4]);
        go(&mut forest, 300, &blowing(turned), &threads(1));
        for (mode, q) in forest.amplitudes(0).iter().enumerate() {
            let [omega, gamma, rest] = swing(&plant, mode, &stand, &damping, &v);
            let bare = swing(&plant, mode, &stand, &Damping { air: 0.0, ..damping }, &v)[1];
            assert!(
                gamma > 1.3 * bare && gamma < 1.5 * omega,
                "there is something to see: {gamma} {bare} {omega}"
            );
            let (t, half) = (1.5, gamma / 2.0);
            let damped = (omega.powi(2) - half.powi(2)).sqrt();
            let swing = (damped * t).cos() + half / damped * (damped * t).sin();
            let wanted = rest + (f64::from(begun) - rest) * (-half * t).exp() * swing;
            let most = (f64::from(begun) - rest).abs();
            assert!((f64::from(*q) - wanted).abs() < 2e-4 * most, "{stand:?} {mode}: {q} {wanted}");
        }
    }
}

/// From one to the next, q(n) q(n + 2) - q(n + 1)^2 of a swing about its rest is multiplied by the determinant of a step.
#[test]
fn in_long_steps_too_a_swing_dies_as_fast_as_it_should_and_rests_where_it_should() {
    let plant = plant(40, 3, Form::Linear);
    let (damping, v) = (DAMPING, Vector3::new(11.0, 3.0, 0.0));
    for step in [0.02, 0.1, 0.25] {
        let mut pair = forest(&plant, &[Stand::default(); 2], &Pace { step, damping, ..PACE });
        pair.pull(0, &[plant.pulled(2.0).unwrap()[0]; 3]);
        let mut apart = Vec::new();
        for _ in 0..8 {
            let [a, b] = [0, 1].map(|copy| pair.amplitudes(copy).to_vec());
            apart.push(a.iter().zip(&b).map(|(a, b)| f64::from(*a) - f64::from(*b)).collect::<Vec<_>>());
            go(&mut pair, 1, &blowing(v), &threads(1));
        }
        let area = |mode: usize, n: usize| apart[n][mode] * apart[n + 2][mode] - apart[n + 1][mode].powi(2);
        for mode in 0..plant.n_modes() {
            let gamma = swing(&plant, mode, &Stand::default(), &damping, &v)[1];
            let (got, wanted) = (area(mode, 5) / area(mode, 0), (-5.0 * gamma * step).exp());
            assert!((got / wanted - 1.0).abs() < 2e-3, "{step} {mode}: {got} {wanted}");
        }
        go(&mut pair, (400.0 / step) as usize, &blowing(v), &threads(1));
        for (mode, q) in pair.amplitudes(1).iter().enumerate() {
            let rest = swing(&plant, mode, &Stand::default(), &damping, &v)[2];
            assert!((f64::from(*q) / rest - 1.0).abs() < 1e-4, "{step} {mode}: {q} {rest}");
        }
    }
}

/// In gusts that change every 0.08 s, by Runge and Kutta's fourth order in steps of 0.0005 s: in frames of 1/25 s within
/// 1 % of how far it goes, and a quarter of that in steps half as long.
#[test]
fn gusts_are_answered_as_by_a_fine_reference() {
    const PIECE: f64 = 0.08;
    let plant = plant(40, 1, Form::Linear);
    let (damping, stand) = (DAMPING, Stand::default());
    let noise = Noise { speed: 14.0, cell: 50.0, second: 0.5, seed: 2, n_cells: None };
    let gust = |piece: usize| {
        Vector3::new(7.0, 0.0, 0.0) + noise.sample(&Vector3::new(3.3, 1.7, 0.2), PIECE * piece as f64)
    };
    let fine = |n_pieces: usize| {
        let (mut q, mut speed, h) = (0.0, 0.0, PIECE / 160.0);
        let mut path = vec![0.0];
        for piece in 0..n_pieces {
            let [omega, gamma, rest] = swing(&plant, 0, &stand, &damping, &gust(piece));
            let gain = |q: f64, speed: f64| omega.powi(2) * (rest - q) - gamma * speed;
            for _ in 0..160 {
                let (q1, v1) = (speed, gain(q, speed));
                let (q2, v2) = (speed + h / 2.0 * v1, gain(q + h / 2.0 * q1, speed + h / 2.0 * v1));
                let (q3, v3) = (speed + h / 2.0 * v2, gain(q + h / 2.0 * q2, speed + h / 2.0 * v2));
                let (q4, v4) = (speed + h * v3, gain(q + h * q3, speed + h * v3));
                q += h / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4);
                speed += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            }
            path.push(q);
        }
        path
    };
    let wanted = fine(250);
    let most = wanted.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let off = |n: usize| {
        let mut forest = forest(&plant, &[stand], &Pace { step: PIECE / n as f64, damping, ..PACE });
        let ends = (0..250).map(|piece| {
            go(&mut forest, n, &blowing(gust(piece)), &threads(1));
            (f64::from(forest.amplitudes(0)[0]) - wanted[piece + 1]).abs()
        });
        ends.fold(0.0, f64::max) / most
    };
    let (frames, halves) = (off(2), off(4));
    assert!(frames < 1e-2, "{frames}");
    assert!((3.0..5.0).contains(&(frames / halves)), "{frames} {halves}");
}

#[test]
fn no_wind_and_no_step_makes_it_grow() {
    let plant = plant(30, 4, Form::Linear);
    for integrator in [Integrator::Exact, Integrator::Newmark] {
        for (speed, step) in [(1e4, 10.0), (30.0, 0.7), (1e4, 1e-3), (1e6, 1e3)] {
            let pace = Pace { step, damping: DAMPING, integrator };
            let mut forest = forest(&plant, &[Stand::default()], &pace);
            let v = Vector3::new(speed, 0.0, 0.0);
            let rest: Vec<f64> =
                (0..4).map(|mode| swing(&plant, mode, &Stand::default(), &DAMPING, &v)[2]).collect();
            let most = rest.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
            for _ in 0..300 {
                go(&mut forest, 1, &blowing(v), &threads(1));
                let far = |q: &f32| f64::from(q.abs()) <= 2.01 * most;
                assert!(forest.amplitudes(0).iter().all(far), "{integrator:?} {speed} {step}");
            }
        }
    }
}

/// Symplectic Euler bears sqrt(2) / omega where a storm takes all speed; a little more and it grows.
#[test]
fn the_thesiss_method_has_another_limit_in_the_air() {
    let plant = plant(20, 1, Form::Linear);
    let damping = Damping { alpha: 0.0, beta: 0.0, mass: 1.0, air: 1000.0 };
    let limit = std::f64::consts::SQRT_2 / plant.omegas[0];
    let of = |share: f64, air: f64| {
        let damping = Damping { air, ..damping };
        let pace = Pace { step: share * limit, integrator: Integrator::Symplectic, damping };
        Forest::new(&plant, &[0], &[Stand::default()], &pace)
    };
    assert!(of(1.01, 0.0).is_ok());
    let error = of(1.01, 1000.0).unwrap_err().to_string();
    assert!(error.contains(&format!("less than {limit:.6} s is wanted")), "{error}");
    let mut storm = of(0.99, 1000.0).unwrap();
    storm.pull(0, &plant.pulled(0.1).unwrap());
    go(&mut storm, 2000, &blowing(Vector3::new(1e3, 0.0, 0.0)), &threads(1));
    let rest = plant.basis.force(0, &Vector3::new(1e3, 0.0, 0.0)) / plant.omegas[0].powi(2);
    let q = f64::from(storm.amplitudes(0)[0]);
    assert!((q / rest - 1.0).abs() < 1e-3, "{q} {rest}");
}
