//! Motion by the spectrum against closed forms, and against steps that go on until it goes round.

use super::super::tests::{forest, plant, threads};
use super::{Forest, Round, Waves};
use crate::oscillator::State;
use crate::wind::{Constant, Power, Sine, Sum, Wind, series};
use crate::{Damping, ForestError, Form, Integrator, Oscillator, Pace, Stand};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rustfft::num_complex::Complex;
use std::f64::consts::{PI, TAU};

const PACE: Pace = Pace {
    step: 0.002,
    integrator: Integrator::Exact,
    damping: Damping { alpha: 2.0, beta: 0.008, mass: 1.2, air: 0.0 },
};
/// After so many seconds the wind of these tests begins again.
const PERIOD_S: f64 = 4.0;

/// What a mode does under a force, again and again.
fn answer(oscillator: &Oscillator, force: &[f64], step: f64) -> Vec<Complex<f64>> {
    let waves = Waves::new(force.len(), step);
    let pressed = waves.of(force.iter().copied());
    waves.back(|k, hz| pressed[k] * oscillator.response(hz))
}

/// A mean of so many metres per second with waves upon it.
fn gusty(swing: f64) -> Sum {
    let mean = Vector3::new(6.0, -2.0, 0.5);
    let wave = |hz: f64, phase: f64, amplitude: [f64; 3]| Sine {
        amplitude: swing * Vector3::from(amplitude),
        hz,
        waves: Vector3::new(0.02, 0.01, 0.0),
        phase,
    };
    let waves =
        [wave(0.25, 0.3, [1.0, 0.4, 0.1]), wave(0.5, 1.7, [-0.5, 0.8, 0.2]), wave(1.0, 4.0, [0.4, 0.1, 0.0])];
    let mut all: Vec<Box<dyn Wind>> = vec![Box::new(Constant(mean))];
    all.extend(waves.map(|wave| Box::new(wave) as Box<dyn Wind>));
    Sum(all)
}

fn stands() -> [Stand; 3] {
    let stand = |turn, scale, mass| Stand { turn, scale, mass };
    [stand(0.0, 1.0, 1.0), stand(0.8, 1.4, 0.7), stand(-2.0, 0.8, 2.0)]
}

/// Copies stand 10 m apart.
fn blowing(wind: &dyn Wind) -> impl Fn(usize, f64) -> Vector3<f64> + Sync + use<'_> {
    |copy, time| wind.sample(&Vector3::new(copy as f64 * 10.0, 0.0, 0.0), time)
}

/// All of a motion, `(n_frames, n_copies, n_modes)`: amplitudes and speeds.
fn played(forest: &mut Forest, round: &Round) -> Vec<(Vec<f32>, Vec<f32>)> {
    let frame = |frame| {
        forest.put(round, frame);
        (forest.amplitudes.clone(), forest.speeds.clone())
    };
    (0..round.n_frames).map(frame).collect()
}

/// Errata E34: the static limit is +1 / k. At its own frequency a mode lags by a quarter turn, above it by half of one.
#[test]
fn a_mode_answers_slow_waves_as_it_rests_and_its_own_a_quarter_turn_late() {
    for zeta in [0.01, 0.4, 1.0, 3.0] {
        let mode = Oscillator { omega: 7.0, gamma: 14.0 * zeta, mass: 2.5 };
        let near = |got: Complex<f64>, wanted: Complex<f64>| (got - wanted).norm() < 1e-14 * wanted.norm();
        assert!(near(mode.response(0.0), mode.rest(1.0).into()), "{zeta}");
        let own = Complex::new(0.0, -1.0 / (mode.mass * mode.omega * mode.gamma));
        assert!((mode.response(mode.omega / TAU) - own).norm() < 1e-12 * own.norm(), "{zeta}");
        let (fast, free) = (mode.response(1e6), -1.0 / (mode.mass * (TAU * 1e6).powi(2)));
        assert!(
            (fast.re / free - 1.0).abs() < 1e-9 && fast.im.abs() < 1e-4 * fast.re.abs(),
            "{zeta}: {fast}"
        );
    }
}

/// Steps are the means of a wave, which are sin(x) / x as large, x = pi f dt; what else a staircase has is beyond hearing.
#[test]
fn a_mode_answers_a_wave_as_exact_steps_do_once_they_have_settled() {
    let step = 0.01;
    for (omega, zeta) in [(7.0, 0.05), (7.0, 0.9), (7.0, 3.0), (30.0, 0.3)] {
        let mode = Oscillator { omega, gamma: 2.0 * zeta * omega, mass: 1.5 };
        for hz in [0.25, 1.0, 2.0] {
            let (one, mut state, mut sum) = (mode.step(step), State::default(), Complex::new(0.0, 0.0));
            let n = (100.0 / (hz * step)).round() as usize;
            for k in 0..2 * n {
                let turn = Complex::from_polar(1.0, -TAU * hz * k as f64 * step);
                if k >= n {
                    sum += turn * (state.q * 2.0 / n as f64);
                }
                state = one.next(state, (TAU * hz * (k as f64 + 0.5) * step).cos());
            }
            let x = PI * hz * step;
            let wanted = mode.response(hz) * x.sin() / x;
            assert!((sum - wanted).norm() < 2e-4 * wanted.norm(), "{omega} {zeta} {hz}: {sum} {wanted}");
        }
    }
}

/// Of a force of G0 a hertz, one-sided, a mode has the variance G0 / (4 m^2 gamma omega^2): what is left out below the first
/// wave is 2 gamma / (omega^2 T) of it.
#[test]
fn a_white_force_gives_the_variance_of_the_closed_form_as_do_exact_steps() {
    let mode = Oscillator { omega: 5.0, gamma: 1.0, mass: 1.7 };
    let wanted = |density: f64| density / (4.0 * (mode.mass * mode.omega).powi(2) * mode.gamma);
    let (n, step) = (1 << 15, 0.01);
    let force = series(&Power { at_1_hz: 0.3, beta: 0.0 }, n, step, 4);
    let variance = answer(&mode, &force, step).iter().map(|state| state.re.powi(2)).sum::<f64>() / n as f64;
    assert!((variance / wanted(0.3) - 1.0).abs() < 3e-4, "{variance} {}", wanted(0.3));

    // Forces by chance, evenly from -1 to 1 for a step each, have 2 dt / 3 a hertz. A variance over T is off by
    // sqrt(2 / (gamma T)) of itself: 1 % here, and three times that is hardly ever met.
    let (n, step) = (1_000_000, 0.02);
    let mut chance = rand_pcg::Pcg64::seed_from_u64(7);
    let (one, mut state, mut squares) = (mode.step(step), State::default(), 0.0);
    for _ in 0..n {
        state = one.next(state, chance.random_range(-1.0..1.0));
        squares += state.q.powi(2);
    }
    let ratio = squares / f64::from(n) / wanted(2.0 * step / 3.0);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

/// Copies of several sizes and masses, turned, that have gone on by exact steps until they do the same again. A step answers
/// what blew half a step before its end: 2 pi f dt / 2 of a wave is 0.6 % of the fastest.
#[test]
fn a_forest_that_has_gone_on_for_long_goes_round_by_the_spectrum() {
    let plant = plant(60, 6, Form::Linear);
    let (wind, one) = (gusty(1.5), threads(1));
    let mut stepped = forest(&plant, &stands(), &PACE);
    let round = stepped.round(100, 20, &blowing(&wind), &one).unwrap();
    let wanted = played(&mut stepped, &round);
    stepped.reset();
    let blows = blowing(&wind);
    let go_on = |forest: &mut Forest, n: usize| {
        for _ in 0..n {
            let middle = forest.time() + PACE.step / 2.0;
            forest.step(&|copy| blows(copy, middle), None, &one).unwrap();
        }
    };
    go_on(&mut stepped, 5 * 2000);
    let n = wanted[0].0.len();
    let most = |of: &dyn Fn(usize) -> f32| (0..100).map(of).fold(0.0, f32::max);
    let mean = |k: usize| wanted.iter().map(|(q, _)| q[k]).sum::<f32>() / 100.0;
    let swings: Vec<[f32; 2]> = (0..n)
        .map(|k| {
            [most(&|frame| (wanted[frame].0[k] - mean(k)).abs()), most(&|frame| wanted[frame].1[k].abs())]
        })
        .collect();
    for (frame, (q, speed)) in wanted.iter().enumerate() {
        for k in 0..n {
            let off = [stepped.amplitudes[k] - q[k], stepped.speeds[k] - speed[k]];
            for (off, swing) in off.into_iter().zip(swings[k]) {
                assert!(off.abs() < 0.01 * swing, "{frame} {k}: {off} of {swing}");
            }
        }
        go_on(&mut stepped, 20);
    }
}

/// A wind that comes later moves it later, round and round: no frame is the first.
#[test]
fn what_goes_round_has_no_seam() {
    let plant = plant(40, 5, Form::Linear);
    let (wind, one) = (gusty(2.0), threads(1));
    let pace = Pace { step: 0.04, damping: Damping { air: 1.0, ..PACE.damping }, ..PACE };
    for n in [100, 25] {
        let step = PERIOD_S / n as f64;
        let mut forest = forest(&plant, &stands(), &Pace { step, ..pace });
        let blows = blowing(&wind);
        let round = |by: usize| forest.round(n, 1, &|copy, time| blows(copy, time + by as f64 * step), &one);
        let (first, later) = (round(0).unwrap(), round(7).unwrap());
        let [first, later] = [first, later].map(|round| played(&mut forest, &round));
        let all = first.iter().flat_map(|(q, speed)| q.iter().chain(speed));
        let most = all.fold(0.0_f32, |most, v| v.abs().max(most));
        for frame in 0..n {
            let (now, then) = (&first[(frame + 7) % n], &later[frame]);
            let pairs = now.0.iter().zip(&then.0).chain(now.1.iter().zip(&then.1));
            pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-6 * most, "{n} {frame}: {a} {b}"));
        }
    }
}

/// What blows at a copy all the time holds it where it would come to rest, whatever the air takes.
#[test]
fn in_a_steady_wind_it_stays_where_it_rests() {
    let plant = plant(40, 5, Form::Linear);
    let wind = Vector3::new(4.0, 3.0, 0.2);
    let pace = Pace { step: 0.1, damping: Damping { air: 1.0, ..PACE.damping }, ..PACE };
    let mut forest = forest(&plant, &[Stand::default()], &pace);
    let round = forest.round(7, 3, &|_, _| wind, &threads(1)).unwrap();
    for (q, speed) in played(&mut forest, &round) {
        for (mode, (q, speed)) in q.into_iter().zip(speed).enumerate() {
            let wanted = plant.basis.force(mode, &wind) / plant.omegas[mode].powi(2);
            assert!((f64::from(q) - wanted).abs() < 1e-6 * wanted.abs(), "{mode}: {q} {wanted}");
            assert!(f64::from(speed).abs() < 1e-9 * wanted.abs(), "{mode}: {speed}");
        }
    }
    assert!((forest.time() - 6.0 * 0.3).abs() < 1e-12);
}

#[test]
fn a_motion_that_goes_round_has_the_same_bits_on_any_number_of_threads() {
    let plant = plant(40, 5, Form::Linear);
    let wind = gusty(2.0);
    let forest = forest(&plant, &[stands(), stands()].concat(), &Pace { step: 0.04, ..PACE });
    let [one, two] = [1, 2].map(|n| forest.round(50, 2, &blowing(&wind), &threads(n)).unwrap());
    assert_eq!(one, two);
}

#[test]
fn what_has_no_motion_that_goes_round_is_refused() {
    let plant = plant(40, 3, Form::Linear);
    let damping = Damping { alpha: 0.0, beta: 0.0, mass: 1.0, air: 1.0 };
    let free = forest(&plant, &stands(), &Pace { step: 0.1, damping, ..PACE });
    let blows = |wind: Vector3<f64>| free.round(10, 1, &|_, _| wind, &threads(2));
    assert!(blows(Vector3::x()).is_ok(), "the air damps");
    let hz = plant.omegas[0] / TAU;
    assert_eq!(blows(Vector3::zeros()), Err(ForestError::Undamped { hz }));
    let wild = |copy: usize, time: f64| Vector3::x() * if copy > 0 && time > 0.45 { f64::NAN } else { 1.0 };
    let Err(ForestError::Wind { copy: 1, time }) = free.round(10, 1, &wild, &threads(2)) else {
        panic!("wild")
    };
    assert!((time - 0.5).abs() < 1e-12);
    let bytes = free.round_bytes(usize::MAX, 1, 1);
    assert_eq!(free.round_bytes(10, 2, 1), 9 * 10 * 8 + 20 * 88);
    assert_eq!(bytes, usize::MAX);
}

/// Where the air's damping changes with gusts of a fifth of the mean, its mean lets modes swing as far within a tenth; without
/// it they swing farther, the slowest 2.8 times as far.
#[test]
fn the_mean_of_the_airs_damping_is_near_what_gusts_make_of_it() {
    let plant = plant(60, 6, Form::Linear);
    let (wind, one) = (gusty(1.5), threads(1));
    let pace =
        Pace { step: 0.02, damping: Damping { alpha: 0.3, mass: 1.0, air: 1.0, ..PACE.damping }, ..PACE };
    let n = (PERIOD_S / pace.step) as usize;
    let mut stepped = forest(&plant, &stands(), &pace);
    let round = stepped.round(n, 1, &blowing(&wind), &one).unwrap();
    let wanted = played(&mut stepped, &round);
    stepped.retune(&Pace { damping: Damping { air: 0.0, ..pace.damping }, ..pace }).unwrap();
    let airless = stepped.round(n, 1, &blowing(&wind), &one).unwrap();
    let airless = played(&mut stepped, &airless);
    stepped.retune(&pace).unwrap();
    stepped.reset();
    let blows = blowing(&wind);
    let mut gone = Vec::new();
    for k in 0..20 * n {
        if k >= 19 * n {
            gone.push((stepped.amplitudes.clone(), stepped.speeds.clone()));
        }
        let middle = stepped.time() + pace.step / 2.0;
        stepped.step(&|copy| blows(copy, middle), None, &one).unwrap();
    }
    let deviation = |rows: &[(Vec<f32>, Vec<f32>)], k: usize| {
        let mean = rows.iter().map(|(q, _)| f64::from(q[k])).sum::<f64>() / n as f64;
        rows.iter().map(|(q, _)| (f64::from(q[k]) - mean).powi(2)).sum::<f64>().sqrt()
    };
    for k in 0..wanted[0].0.len() {
        let [by_mean, without] = [&wanted, &airless].map(|rows| deviation(rows, k) / deviation(&gone, k));
        assert!((0.9..1.1).contains(&by_mean) && without > by_mean + 0.05, "{k}: {by_mean} {without}");
        assert!(k > 0 || without > 2.0, "{without}");
    }
}
