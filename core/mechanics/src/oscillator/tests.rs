//! Integrators against closed forms.

use super::{Damping, Oscillator, State, symplectic_limit};

/// q(t) of a damped oscillator from rest under a force of 1, by the textbook.
fn risen(oscillator: &Oscillator, t: f64) -> f64 {
    let (omega, zeta) = (oscillator.omega, oscillator.gamma / (2.0 * oscillator.omega));
    let damped = omega * (1.0 - zeta.powi(2)).sqrt();
    let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
    (1.0 - (-zeta * omega * t).exp() * swing) / (oscillator.mass * omega.powi(2))
}

#[test]
fn a_constant_force_is_answered_exactly_in_steps_of_any_length() {
    for (omega, zeta) in [(9.4, 0.0), (9.4, 0.05), (3.0, 0.7), (0.5, 0.99)] {
        let oscillator = Oscillator { omega, gamma: 2.0 * zeta * omega, mass: 2.5 };
        for dt in [1e-3, 0.04, 0.5, 7.0] {
            let (step, mut state) = (oscillator.step(dt), State::default());
            for k in 1..=50 {
                state = step.next(state, 1.0);
                let wanted = risen(&oscillator, f64::from(k) * dt);
                assert!(
                    (state.q - wanted).abs() < 1e-12 * oscillator.rest(1.0).max(1e-3),
                    "{omega} {zeta} {dt} {k}"
                );
            }
        }
    }
}

#[test]
fn a_step_is_two_half_steps_also_at_and_beyond_critical_damping() {
    for zeta in [0.0, 0.3, 1.0 - 1e-13, 1.0, 1.0 + 1e-9, 3.0, 50.0] {
        let oscillator = Oscillator { omega: 5.0, gamma: 10.0 * zeta, mass: 1.0 };
        let begun = State { q: 0.3, speed: -1.1 };
        let whole = oscillator.step(0.2).next(begun, 0.7);
        let half = oscillator.step(0.1);
        let halves = half.next(half.next(begun, 0.7), 0.7);
        assert!((whole.q - halves.q).abs() < 1e-12 && (whole.speed - halves.speed).abs() < 1e-11, "{zeta}");
        assert!(whole.q.is_finite() && whole.speed.is_finite());
    }
}

/// Errata E41, with the numbers found there.
#[test]
fn symplectic_euler_is_bounded_up_to_its_limit_and_no_further() {
    for (zeta, wanted) in [(0.0, 2.0), (0.05, 1.9025), (0.2, 1.6396), (0.5, 1.2361), (1.0, 0.8284)] {
        let oscillator = Oscillator { omega: 3.0, gamma: 6.0 * zeta, mass: 1.0 };
        let limit = symplectic_limit(&oscillator);
        assert!((limit * 3.0 - wanted).abs() < 5e-5, "{zeta}: {}", limit * 3.0);
        let after = |dt: f64| {
            let begun = State { q: 1.0, speed: 0.0 };
            (0..20_000).fold(begun, |state, _| oscillator.symplectic(state, 0.0, dt)).q.abs()
        };
        assert!(after(limit * 0.999) < 100.0, "{zeta}: bounded below the limit");
        assert!(
            after(limit * 1.001).partial_cmp(&100.0) != Some(std::cmp::Ordering::Less),
            "{zeta}: not above it"
        );
    }
}

/// Its frequency is too high by (2 / x) asin(x / 2), x = omega dt (errata E41).
#[test]
fn symplectic_euler_swings_too_fast_by_what_is_known() {
    let (oscillator, dt) = (Oscillator { omega: 2.0, gamma: 0.0, mass: 1.0 }, 0.25);
    let mut state = State { q: 1.0, speed: 0.0 };
    let (mut crossings, mut last) = (0, 0.0);
    let n = 200_000;
    for k in 0..n {
        let next = oscillator.symplectic(state, 0.0, dt);
        if state.q < 0.0 && next.q >= 0.0 {
            crossings += 1;
            last = f64::from(k) + state.q / (state.q - next.q);
        }
        state = next;
    }
    let x = 2.0 * dt;
    let wanted = 2.0 / x * (x / 2.0).asin();
    let first = 0.75 * std::f64::consts::TAU / (oscillator.omega * wanted);
    let got = f64::from(crossings - 1) * std::f64::consts::TAU / (last * dt - first) / oscillator.omega;
    assert!((got / wanted - 1.0).abs() < 1e-4, "{got} {wanted}");
}

/// A force that changes linearly is answered to the second order.
#[test]
fn newmark_converges_to_the_exact_answer_with_the_square_of_the_step() {
    let oscillator = Oscillator { omega: 4.0, gamma: 0.4, mass: 1.5 };
    let error = |n: u32| {
        let dt = 3.0 / f64::from(n);
        let state = (0..n).fold(State::default(), |state, _| oscillator.newmark(state, 1.0, 1.0, dt));
        (state.q - risen(&oscillator, 3.0)).abs()
    };
    let ratio = error(300) / error(600);
    assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
}

/// Errata E42.
#[test]
fn a_heavier_plant_swings_more_slowly_and_is_damped_by_its_new_frequency() {
    let heavy = Oscillator::new(10.0, &Damping { alpha: 0.2, beta: 0.01, mass: 4.0, air: 1.0 });
    assert_eq!(heavy, Oscillator { omega: 5.0, gamma: 0.2 + 0.01 * 25.0, mass: 4.0 });
    // Under the same force it stays where it did: it is heavier, not stiffer.
    let light = Oscillator::new(10.0, &Damping { mass: 1.0, ..Damping::default() });
    assert!((heavy.rest(3.0) - light.rest(3.0)).abs() < 1e-15);
}
