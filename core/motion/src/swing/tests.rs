//! Swings that are known, against what they were made of and against bounds that can be worked out by hand.

use std::f64::consts::TAU;

use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use super::{Manner, NoSwing, Swing, swing};

/// Frequency, damping, how far it was pulled.
type Mode = (f64, f64, f64);

/// Held for a while, let go at rest, on a drift, in white noise.
struct Pull<'a> {
    modes: &'a [Mode],
    fps: f64,
    seconds: f64,
    held_s: f64,
    noise: f64,
}

impl Pull<'_> {
    fn series(&self, seed: u64) -> Vec<f64> {
        let mut chance = Pcg64Mcg::seed_from_u64(seed);
        let mut at = |k: usize| {
            let t = k as f64 / self.fps;
            let since = (t - self.held_s).max(0.0);
            let of_mode = |(hz, ratio, pulled): &Mode| {
                let omega = TAU * hz;
                let damped = omega * (1.0 - ratio * ratio).sqrt();
                let turned = (damped * since).cos() + ratio * omega / damped * (damped * since).sin();
                pulled * (-ratio * omega * since).exp() * turned
            };
            let drift = 3.0 + 0.001 * t;
            drift
                + self.modes.iter().map(of_mode).sum::<f64>()
                + self.noise * chance.sample::<f64, _>(StandardNormal)
        };
        (0..(self.seconds * self.fps) as usize).map(&mut at).collect()
    }

    fn swing(&self, seed: u64) -> Result<Swing, NoSwing> {
        let lowest = 3.0 / self.seconds;
        swing(&self.series(seed), self.fps, [lowest, self.fps / 2.0])
    }
}

fn one(mode: &Mode, fps: f64, seconds: f64, noise: f64) -> Pull<'_> {
    Pull { modes: std::slice::from_ref(mode), fps, seconds, held_s: 0.0, noise }
}

/// Driven by an even wind for long: small steps of an oscillator under white force, after it has forgotten its start.
fn driven(hz: f64, ratio: f64, fps: f64, n: usize, seed: u64) -> Vec<f64> {
    let (omega, dt) = (TAU * hz, 1.0 / fps / 20.0);
    let mut chance = Pcg64Mcg::seed_from_u64(seed);
    let (mut q, mut speed) = (0.0, 0.0);
    let mut sample = || {
        for _ in 0..20 {
            speed += dt * (chance.random_range(-1.0..1.0) - 2.0 * ratio * omega * speed - omega * omega * q);
            q += dt * speed;
        }
        q
    };
    let unseen = (10.0 * fps / (ratio * omega)) as usize;
    (0..unseen + n).map(|_| sample()).skip(unseen).collect()
}

fn root_mean_square(values: impl IntoIterator<Item = f64>) -> f64 {
    let (n, sum) = values.into_iter().fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
    f64::sqrt(sum / n)
}

#[test]
fn without_noise_frequency_and_damping_are_back_to_five_digits() {
    for (hz, ratio, fps, seconds) in [
        (0.2, 0.005, 4.0, 60.0),
        (0.2, 0.2, 4.0, 60.0),
        (0.29, 0.05, 4.0, 30.0),
        (1.49, 0.053, 25.0, 20.0),
        (1.9, 0.01, 4.0, 50.0),
        (5.0, 0.02, 100.0, 5.0),
        (5.0, 0.1, 12.0, 5.0),
    ] {
        let found = one(&(hz, ratio, 1.0), fps, seconds, 0.0).swing(0).unwrap();
        assert_eq!((found.manner, found.first), (Manner::LetGo, 0), "{hz} {ratio}: {found:?}");
        assert!((found.hz.value / hz - 1.0).abs() < 1e-5, "{hz} {ratio}: {found:?}");
        assert!((found.ratio.value / ratio - 1.0).abs() < 1e-5, "{hz} {ratio}: {found:?}");
    }
}

/// What is seen until it is gone has decay and turn known to 16 s^2 a^3 / (A^2 fps) each, squared, and no better
/// (Cramer and Rao): the sums of Fisher's information are integrals of e^(-2at), t e^(-2at), t^2 e^(-2at).
#[test]
fn decays_are_as_exact_as_noise_lets_anything_be_and_say_so() {
    for (hz, ratio, fps, seconds, noise) in [
        (0.2, 0.05, 4.0, 120.0, 0.05),
        (0.29, 0.02, 4.0, 200.0, 0.1),
        (1.0, 0.1, 25.0, 12.0, 0.05),
        (1.0, 0.2, 50.0, 8.0, 0.05),
        (5.0, 0.03, 100.0, 8.0, 0.1),
        (2.0, 0.01, 20.0, 60.0, 0.2),
    ] {
        let mode = (hz, ratio, 1.0);
        let alpha: f64 = ratio * TAU * hz;
        let bound = (16.0 * noise * noise * alpha.powi(3) / fps).sqrt();
        let found: Vec<Swing> =
            (0..60).map(|seed| one(&mode, fps, seconds, noise).swing(seed).unwrap()).collect();
        let damped = hz * (1.0 - ratio * ratio).sqrt();
        let of_alpha = root_mean_square(found.iter().map(|s| TAU * s.hz.value * s.ratio.value - alpha));
        let of_omega = root_mean_square(found.iter().map(|s| TAU * (s.damped_hz() - damped)));
        for (what, spread) in [("decay", of_alpha), ("turn", of_omega)] {
            assert!((0.75..1.35).contains(&(spread / bound)), "{what} of {mode:?}: {}", spread / bound);
        }
        for (what, told) in [
            ("frequency", root_mean_square(found.iter().map(|s| (s.hz.value - hz) / s.hz.error))),
            ("damping", root_mean_square(found.iter().map(|s| (s.ratio.value - ratio) / s.ratio.error))),
        ] {
            assert!(
                (0.7..1.4).contains(&told),
                "{what} of {mode:?}: errors over those that were told: {told}"
            );
        }
    }
}

/// 24 s^2 / (A^2 n^3), radians a sample, squared, both for the turn and for the decay (Rife and Boorstyn, IEEE Trans.
/// Inf. Theory 20, 1974, for a real sine).
#[test]
fn a_steady_sine_has_a_frequency_and_no_damping() {
    let (hz, fps, seconds, noise) = (0.7, 10.0, 40.0, 0.2);
    let found: Vec<Swing> =
        (0..60).map(|seed| one(&(hz, 0.0, 1.0), fps, seconds, noise).swing(seed).unwrap()).collect();
    assert!(found.iter().filter(|s| s.manner == Manner::Steady).count() >= 58, "{found:?}");
    let bound = fps * (24.0 * noise * noise / (seconds * fps).powi(3)).sqrt();
    let of_omega = root_mean_square(found.iter().map(|s| TAU * (s.hz.value - hz)));
    let of_alpha = root_mean_square(found.iter().map(|s| TAU * s.hz.value * s.ratio.value));
    for spread in [of_omega, of_alpha] {
        assert!((0.75..1.35).contains(&(spread / bound)), "{}", spread / bound);
    }
    let clean = one(&(hz, 0.0, 1.0), fps, seconds, 0.0).swing(0).unwrap();
    assert_eq!(clean.manner, Manner::Steady);
    assert!((clean.hz.value - hz).abs() < 1e-6 && clean.ratio.value.abs() < 1e-6, "{clean:?}");
}

#[test]
fn what_swings_farther_and_farther_grows() {
    for (ratio, noise) in [(-0.005, 0.05), (-0.02, 0.3), (-0.05, 0.0)] {
        let found = one(&(0.7, ratio, 1.0), 10.0, 40.0, noise).swing(1).unwrap();
        assert_eq!(found.manner, Manner::Growing, "{ratio}: {found:?}");
        assert!((found.ratio.value - ratio).abs() < 4.0 * found.ratio.error + 1e-6, "{ratio}: {found:?}");
        assert!(found.log_decrement().value < 0.0);
    }
}

#[test]
fn what_is_held_before_it_is_let_go_swings_from_the_release() {
    for (held_s, noise) in [(2.0, 0.0), (2.0, 0.02), (10.0, 0.02), (30.0, 0.05)] {
        for seed in 0..8 {
            let mode = (0.29, 0.05, 1.0);
            let pull = Pull { held_s, seconds: 75.0, ..one(&mode, 4.0, 0.0, noise) };
            let found = pull.swing(seed).unwrap();
            let late = found.first as f64 / 4.0 - held_s;
            assert!((-0.3..0.8).contains(&late), "{held_s} s, {noise}: {late} s late, {found:?}");
            assert_eq!(found.manner, Manner::LetGo);
            let off = (found.ratio.value - 0.05).abs();
            assert!(off < 4.0 * found.ratio.error + 1e-6, "{held_s} s, {noise}: {found:?}");
        }
    }
}

#[test]
fn of_two_close_modes_each_keeps_its_own() {
    for apart in [0.3, 0.1, 0.05] {
        let modes = [(1.0, 0.03, 1.0), (1.0 + apart, 0.02, 0.6)];
        let pull = Pull { modes: &modes, fps: 20.0, seconds: 40.0, held_s: 0.0, noise: 0.02 };
        for seed in 0..8 {
            let found = pull.swing(seed).unwrap();
            let which = if (found.hz.value - 1.0).abs() < apart / 2.0 { modes[0] } else { modes[1] };
            assert!((found.hz.value - which.0).abs() < 4.5 * found.hz.error, "{apart}: {found:?}");
            assert!((found.ratio.value - which.1).abs() < 4.5 * found.ratio.error, "{apart}: {found:?}");
            assert!(found.hz.error < 0.005, "{apart}: {found:?}");
        }
    }
}

#[test]
fn what_the_wind_drives_has_its_frequency_and_damping_back_within_what_is_told() {
    for (ratio, seconds) in [(0.06, 120.0), (0.02, 300.0)] {
        let found: Vec<Swing> = (0..24)
            .map(|seed| {
                swing(&driven(0.8, ratio, 10.0, (seconds * 10.0) as usize, seed), 10.0, [0.2, 5.0]).unwrap()
            })
            .collect();
        assert!(found.iter().all(|s| s.manner == Manner::Driven), "{found:?}");
        for (what, told) in [
            ("frequency", root_mean_square(found.iter().map(|s| (s.hz.value - 0.8) / s.hz.error))),
            ("damping", root_mean_square(found.iter().map(|s| (s.ratio.value - ratio) / s.ratio.error))),
        ] {
            assert!(
                (0.6..1.5).contains(&told),
                "{what} at {ratio}: errors over those that were told: {told}"
            );
        }
    }
    // Minutes of it are as exact as a half-power width of 2 zeta f lets them be: zeta^2 within zeta / (2 pi f T).
    let found: Vec<Swing> =
        (0..4).map(|seed| swing(&driven(0.8, 0.06, 10.0, 12_000, seed), 10.0, [0.2, 5.0]).unwrap()).collect();
    let bound = (0.06 / (TAU * 0.8 * 1200.0)).sqrt();
    for found in found {
        assert!((found.ratio.value - 0.06).abs() < 5.0 * bound, "{found:?}");
        assert!((0.7 * bound..2.5 * bound).contains(&found.ratio.error), "{found:?}");
    }
}

/// A force whose power falls with the square of frequency pulls a peak down where nobody asks how steep it is.
#[test]
fn gusts_that_are_stronger_the_slower_they_are_do_not_pull_the_frequency_down() {
    let (hz, ratio, fps, n_steps) = (0.8, 0.06, 10.0, 20);
    let (omega, dt) = (TAU * hz, 1.0 / fps / f64::from(n_steps));
    let found: Vec<Swing> = (1..6)
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
    let mean = |of: fn(&Swing) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
    assert!((mean(|swing| swing.hz.value) / hz - 1.0).abs() < 0.01, "{found:?}");
    assert!((mean(|swing| swing.ratio.value) / ratio - 1.0).abs() < 0.15, "{found:?}");
}

#[test]
fn what_does_not_swing_says_why() {
    let noise = one(&(1.0, 0.05, 0.0), 10.0, 40.0, 1.0);
    for (series, band, why) in [
        (vec![], [0.1, 10.0], NoSwing::Short { came: 0 }),
        (vec![1.0; 11], [0.1, 10.0], NoSwing::Short { came: 11 }),
        (vec![1.0; 400], [0.1, 10.0], NoSwing::Still),
        ((0..400).map(|k| 1e6 + 0.1 * f64::from(k)).collect(), [0.1, 10.0], NoSwing::Still),
        (vec![1.0, 2.0, f64::NAN, 1.0], [0.1, 10.0], NoSwing::NoNumber { sample: 2 }),
        (one(&(1.0, 0.05, 1.0), 25.0, 4.0, 0.0).series(0), [0.1, 0.2], NoSwing::Band { step_hz: 0.25 }),
        (noise.series(3), [0.1, 5.0], NoSwing::Noise),
    ] {
        assert_eq!(swing(&series, 25.0, band), Err(why.clone()), "{why}");
    }
}

/// From crest to crest, in the series itself.
#[test]
fn a_swing_falls_by_its_logarithmic_decrement() {
    let mode: Mode = (0.5, 0.1, 1.0);
    let told = one(&mode, 50.0, 30.0, 0.0).swing(0).unwrap();
    let at = |t: f64| {
        let (alpha, damped) = (0.1 * TAU * 0.5, TAU * 0.5 * 0.99_f64.sqrt());
        (-alpha * t).exp() * (damped * t).cos()
    };
    let period = 1.0 / told.damped_hz();
    for t in [0.0, 1.7, 4.1] {
        assert!((told.log_decrement().value - (at(t) / at(t + period)).ln()).abs() < 1e-4, "{told:?}");
    }
    assert!((told.hz.value - 0.5).abs() < 1e-6 && (told.damped_hz() - 0.5 * 0.99_f64.sqrt()).abs() < 1e-6);
}
