//! Swings that are known.

use super::swing;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// Pulled and let go: e^(-zeta omega t) cos(omega_d t), on a drift.
fn let_go(hz: f64, ratio: f64, fps: f64, n: usize) -> Vec<f64> {
    let damped = TAU * hz * (1.0 - ratio * ratio).sqrt();
    let at = |k: usize| {
        let t = k as f64 / fps;
        (-ratio * TAU * hz * t).exp() * (damped * t).cos() + 0.01 * t + 3.0
    };
    (0..n).map(at).collect()
}

/// Driven by an even wind for long: the exact recursion of an oscillator under white force.
fn driven(hz: f64, ratio: f64, fps: f64, n: usize, seed: u64) -> Vec<f64> {
    let (omega, dt) = (TAU * hz, 1.0 / fps / 20.0);
    let mut chance = Pcg64Mcg::seed_from_u64(seed);
    let (mut q, mut speed) = (0.0, 0.0);
    (0..n)
        .map(|_| {
            for _ in 0..20 {
                speed +=
                    dt * (chance.random_range(-1.0..1.0) - 2.0 * ratio * omega * speed - omega * omega * q);
                q += dt * speed;
            }
            q
        })
        .collect()
}

#[test]
fn what_is_pulled_and_let_go_has_its_frequency_and_damping_back() {
    for (hz, ratio, fps, n) in
        [(0.29, 0.05, 4.0, 512), (1.49, 0.053, 25.0, 500), (1.49, 0.02, 25.0, 1000), (3.0, 0.1, 50.0, 800)]
    {
        let found = swing(&let_go(hz, ratio, fps, n), fps, [hz / 3.0, fps / 2.0]).unwrap();
        assert!((found.hz / hz - 1.0).abs() < 0.001, "{hz} {ratio}: {found:?}");
        assert!((found.ratio / ratio - 1.0).abs() < 0.02, "{hz} {ratio}: {found:?}");
    }
}

#[test]
fn what_the_wind_drives_has_its_frequency_and_damping_back_within_chance() {
    for seed in 1..6 {
        let found = swing(&driven(0.8, 0.06, 10.0, 24_000, seed), 10.0, [0.2, 5.0]).unwrap();
        assert!((found.hz / 0.8 - 1.0).abs() < 0.02, "{seed}: {found:?}");
        assert!((found.ratio / 0.06 - 1.0).abs() < 0.25, "{seed}: {found:?}");
    }
}

/// A force whose power falls with the square of frequency pulls a peak down where nobody asks how steep it is.
#[test]
fn gusts_that_are_stronger_the_slower_they_are_do_not_pull_the_frequency_down() {
    let (hz, ratio, fps, n_steps) = (0.8, 0.06, 10.0, 20);
    let (omega, dt) = (TAU * hz, 1.0 / fps / f64::from(n_steps));
    let found: Vec<_> = (1..6)
        .map(|seed| {
            let mut chance = Pcg64Mcg::seed_from_u64(seed);
            let (mut force, mut q, mut speed) = (0.0, 0.0, 0.0);
            let mut sample = || {
                for _ in 0..n_steps {
                    force += dt * (chance.random_range(-1.0..1.0) - TAU * 0.02 * force);
                    speed += dt * (force - 2.0 * ratio * omega * speed - omega * omega * q);
                    q += dt * speed;
                }
                q
            };
            let series: Vec<f64> = (0..12_000).map(|_| sample()).collect();
            swing(&series, fps, [0.4, 5.0]).unwrap()
        })
        .collect();
    let mean = |of: fn(&super::Swing) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
    assert!((mean(|swing| swing.hz) / hz - 1.0).abs() < 0.01, "{found:?}");
    assert!((mean(|swing| swing.ratio) / ratio - 1.0).abs() < 0.15, "{found:?}");
}

#[test]
fn what_does_not_swing_has_none() {
    assert_eq!(swing(&[], 25.0, [0.1, 10.0]), None);
    assert_eq!(swing(&[1.0; 400], 25.0, [0.1, 10.0]), None);
    assert_eq!(swing(&[f64::NAN; 400], 25.0, [0.1, 10.0]), None);
    assert_eq!(swing(&let_go(1.0, 0.05, 25.0, 20), 25.0, [0.1, 2.0]), None);
}

#[test]
fn a_swing_falls_by_its_logarithmic_decrement() {
    let swing = super::Swing { hz: 1.0, ratio: 0.1 };
    // From crest to crest of the damped swing.
    let fall = (-0.1 * TAU / (1.0_f64 - 0.01).sqrt()).exp();
    assert!((swing.log_decrement() + fall.ln()).abs() < 1e-12);
}
