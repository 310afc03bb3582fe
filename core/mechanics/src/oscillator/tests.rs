//! Integrators against closed forms.

use super::{Damping, Integrator, Oscillator, State};
use std::f64::consts::TAU;

impl Oscillator {
    /// Where it stays under a constant force.
    pub(crate) fn rest(&self, force: f64) -> f64 {
        force / (self.mass * self.omega.powi(2))
    }
}

/// q(t) of a damped oscillator from rest under a force of 1, by the textbook: it swings, or creeps as the sum of two decays.
fn risen(oscillator: &Oscillator, t: f64) -> f64 {
    let (omega, zeta) = (oscillator.omega, oscillator.gamma / (2.0 * oscillator.omega));
    let left = if zeta < 1.0 {
        let damped = omega * (1.0 - zeta.powi(2)).sqrt();
        let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
        (-zeta * omega * t).exp() * swing
    } else if zeta > 1.0 {
        let [slow, fast] = [-1.0, 1.0].map(|sign| omega * (zeta + sign * (zeta.powi(2) - 1.0).sqrt()));
        (fast * (-slow * t).exp() - slow * (-fast * t).exp()) / (fast - slow)
    } else {
        (1.0 + omega * t) * (-omega * t).exp()
    };
    (1.0 - left) / (oscillator.mass * omega.powi(2))
}

#[test]
fn a_constant_force_is_answered_exactly_in_steps_of_any_length() {
    let cases = [(9.4, 0.0), (9.4, 0.05), (3.0, 0.7), (0.5, 0.99), (4.0, 1.0), (4.0, 1.3), (9.4, 8.0)];
    for (omega, zeta) in cases {
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

/// Errata E41, with the numbers found there, and 2 / (2 zeta) nearly where damping is most of it.
#[test]
fn symplectic_euler_is_bounded_up_to_its_limit_and_no_further() {
    let cases = [
        (0.0, 2.0),
        (0.05, 1.9025),
        (0.2, 1.6396),
        (0.5, 1.2361),
        (1.0, 0.8284),
        (3.0, 0.3246),
        (50.0, 0.02),
    ];
    for (zeta, wanted) in cases {
        let oscillator = Oscillator { omega: 3.0, gamma: 6.0 * zeta, mass: 1.0 };
        let limit = oscillator.symplectic_limit();
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
        assert!(oscillator.step_by(Integrator::Symplectic, limit * 0.999).is_ok());
        assert!(oscillator.step_by(Integrator::Symplectic, limit * 1.001).is_err());
    }
}

/// Periods without damping in closed form; with it, by where 60 swings cross 0 upwards, between two steps on a line.
#[test]
fn methods_swing_too_fast_or_too_slowly_by_what_is_told() {
    let methods = [Integrator::Exact, Integrator::Symplectic, Integrator::Newmark];
    for dt in [0.01, 0.1, 0.25, 0.6] {
        let mode = Oscillator { omega: 2.0, gamma: 0.0, mass: 1.7 };
        let x = mode.omega * dt;
        let wanted = [1.0, 2.0 / x * (x / 2.0).asin(), 2.0 / x * (x / 2.0).atan()];
        for (method, wanted) in methods.into_iter().zip(wanted) {
            let share = mode.swings(method, dt).unwrap();
            assert!((share - wanted).abs() < 1e-12, "{method:?} {dt}: {share} {wanted}");
        }
        for (method, zeta) in
            methods.into_iter().flat_map(|method| [0.0, 0.03, 0.2].map(|zeta| (method, zeta)))
        {
            let mode = Oscillator { gamma: 4.0 * zeta, ..mode };
            let step = mode.step_by(method, dt).unwrap();
            let (mut state, mut crossings) = (State { q: 1.0, speed: 0.0 }, Vec::new());
            for k in 0.. {
                let next = step.next(state, 0.0);
                if state.q < 0.0 && next.q >= 0.0 {
                    crossings.push((f64::from(k) + state.q / (state.q - next.q)) * dt);
                }
                if crossings.len() > 60 {
                    break;
                }
                state = next;
            }
            let period = (crossings[60] - crossings[0]) / 60.0;
            let got = TAU / period / (mode.omega * f64::sqrt(1.0 - zeta * zeta));
            let share = mode.swings(method, dt).unwrap();
            // A line for a curve is off by x^2 / 8 of a step at most, of which there are 60 swings.
            assert!((got / share - 1.0).abs() < 2e-3 * x * x, "{method:?} {dt} {zeta}: {got} {share}");
        }
    }
    let creeps = Oscillator { omega: 2.0, gamma: 4.0, mass: 1.0 };
    assert_eq!(creeps.swings(Integrator::Newmark, 0.1), None);
    assert_eq!(Oscillator { gamma: 0.0, ..creeps }.swings(Integrator::Symplectic, 1.1), None);
}

/// Newmark's answers to the second order, symplectic Euler to the first, also what creeps.
#[test]
fn methods_converge_to_the_exact_answer_in_their_order() {
    for (method, order) in [(Integrator::Newmark, 2.0), (Integrator::Symplectic, 1.0)] {
        for zeta in [0.05, 1.0, 3.0] {
            let oscillator = Oscillator { omega: 4.0, gamma: 8.0 * zeta, mass: 1.5 };
            let error = |n: u32| {
                let step = oscillator.step_by(method, 1.1 / f64::from(n)).unwrap();
                let state = (0..n).fold(State::default(), |state, _| step.next(state, 1.0));
                (state.q - risen(&oscillator, 1.1)).abs()
            };
            let got = (error(1000) / error(2000)).log2();
            assert!((got - order).abs() < 0.03, "{method:?} {zeta}: {got}");
        }
    }
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
