//! The mode against finite differences, against covariances that are known, and against mean and median.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::*;

#[path = "../../examples/robust_bench/draws.rs"]
mod outliers;
mod region;

/// Draws with mean (3, -2) and covariance [[2, .5], [.5, 1]].
fn draws(n: usize, seed: u64) -> Vec<[f64; 2]> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let (xx, xy, yy) = (2.0_f64, 0.5, 1.0);
    let draw = |_| {
        let (a, b) = (normal(), normal());
        [3.0 + xx.sqrt() * a, -2.0 + xy / xx.sqrt() * a + (yy - xy * xy / xx).sqrt() * b]
    };
    (0..n).map(draw).collect()
}

#[track_caller]
fn assert_near(found: &[f64], wanted: &[f64], within: f64) {
    let near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= within);
    assert!(near && found.len() == wanted.len(), "{found:?}, not {wanted:?} within {within}");
}

/// Density of `samples` at `x` with the kernel of `covariance`, without its constant.
fn density(samples: &[[f64; 2]], covariance: Covariance, x: [f64; 2]) -> f64 {
    let metric = inverse(covariance).unwrap();
    let kernel = |s: &[f64; 2]| (-0.5 * mahalanobis2(metric, minus(*s, x))).exp();
    samples.iter().map(kernel).sum::<f64>() / samples.len() as f64
}

/// Errata E5: the step is `Σ ∇f / f`, with `∇f` from finite differences; and it climbs.
#[test]
fn a_step_goes_up_the_gradient_of_the_density() {
    const H: f64 = 1e-5;
    let samples = draws(40, 1);
    for (at, covariance) in
        [([1.0, -1.0], [2.0, 0.5, 1.0]), ([4.5, -3.0], [0.5, -0.2, 0.8]), ([3.0, 0.0], [0.3, 0.0, 0.3])]
    {
        let now = Mode { at, covariance, effective: 40.0, weights: Vec::new() };
        let next = step(&samples, &now, 0.0).unwrap();
        let f = |dx: f64, dy: f64| density(&samples, covariance, [at[0] + dx, at[1] + dy]);
        let gradient = [(f(H, 0.0) - f(-H, 0.0)) / (2.0 * H), (f(0.0, H) - f(0.0, -H)) / (2.0 * H)];
        let [xx, xy, yy] = covariance;
        let m = [xx * gradient[0] + xy * gradient[1], xy * gradient[0] + yy * gradient[1]];
        assert_near(&minus(next.at, at), &m.map(|m| m / f(0.0, 0.0)), 1e-7);
        let after = minus(next.at, at);
        assert!(f(after[0], after[1]) > f(0.0, 0.0), "the density falls from {at:?} to {:?}", next.at);
    }
}

/// Errata E6: over 20,000 trials of ten draws the centred, weighted covariance has the true one as its mean, also when
/// the weights differ.
#[test]
fn the_weighted_covariance_is_unbiased() {
    const N: usize = 10;
    let samples = draws(20_000 * N, 2);
    let raw: Vec<f64> = (0..N).map(|i| 1.0 + (i % 4) as f64).collect();
    let sum: f64 = raw.iter().sum();
    let uneven: Vec<f64> = raw.iter().map(|w| w / sum).collect();
    for weights in [vec![1.0 / N as f64; N], uneven] {
        let mut mean = [0.0; 3];
        for trial in samples.chunks(N) {
            let (_, covariance) = moments(trial, &weights, 0.0);
            (0..3).for_each(|k| mean[k] += covariance[k] / 20_000.0);
        }
        assert_near(&mean, &[2.0, 0.5, 1.0], 0.03);
    }
}

/// Errata E7: without a floor the spread falls as `1 / (k + 1)`, towards a single sample; with one it stops near the
/// geometric mean of noise and spread, and a smallest number of deciding samples stops it, too.
#[test]
fn the_floor_keeps_the_covariance_from_collapsing() {
    let samples = draws(20_000, 3);
    let area = |mode: &Mode| spread_px(mode.covariance).powi(2);
    let narrowing = |floor_px: f64, n: usize| {
        let first = start(&samples, floor_px).unwrap();
        let next = |now: &Mode| step(&samples, now, floor_px);
        std::iter::successors(Some(first), next).map(|mode| area(&mode)).take(n).collect::<Vec<f64>>()
    };
    let all = 1.75_f64.sqrt();
    let collapse = narrowing(0.0, 9);
    let ideal: Vec<f64> = (0..9).map(|k| all / f64::from(k + 1)).collect();
    assert_near(&collapse, &ideal, 0.03);
    assert_near(&collapse[1..9], &[0.62, 0.41, 0.31, 0.24, 0.19, 0.15, 0.12, 0.10], 0.06);

    // s = (Σ_data⁻¹ + s⁻¹)⁻¹ + floor², solved for the area of a round spread.
    let floor = 0.3_f64.powi(2);
    let end = (floor + (floor * floor + 4.0 * floor * all).sqrt()) / 2.0;
    let held = narrowing(0.3, 40);
    assert!((held[39] - held[29]).abs() < 1e-4, "still falling: {held:?}");
    assert!((held[39] / end - 1.0).abs() < 0.05, "{} instead of {end}", held[39]);

    let few = &samples[..30];
    let params =
        |floor_px, min_effective| Params { floor_px, min_effective, epsilon_px: 0.0, ..Params::default() };
    let ended = |params| mode(few, &params).unwrap().effective;
    assert!((2.0..4.0).contains(&ended(params(0.0, 2.0))), "{}", ended(params(0.0, 2.0)));
    assert!(ended(params(0.0, 8.0)) >= 8.0);
    assert!(ended(params(1.0, 2.0)) > 15.0);
}

#[test]
fn samples_without_a_metric_are_named() {
    let line: Vec<[f64; 2]> = (0..9).map(|i| [2.0 + 0.3 * f64::from(i), 5.0 - 0.7 * f64::from(i)]).collect();
    let same = vec![[0.1, 0.2]; 5];
    let bare = Params { floor_px: 0.0, ..Params::default() };
    for (samples, fault) in [
        (&[] as &[[f64; 2]], Degenerate::Empty),
        (&[[1.0, 2.0]], Degenerate::Few),
        (&same, Degenerate::Equal),
        (&line, Degenerate::Collinear),
        (&[[1.0, 2.0], [3.0, 4.0]], Degenerate::Collinear),
        (&[[1.0, 2.0], [f64::NAN, 4.0], [0.0, 1.0]], Degenerate::NotFinite),
        (&[[1.0, 2.0], [f64::INFINITY, 4.0], [0.0, 1.0]], Degenerate::NotFinite),
        (&[[1e200, 2.0], [3.0, 1e200], [0.0, 1.0]], Degenerate::NotFinite),
    ] {
        assert_eq!(mode(samples, &bare), Err(fault), "{samples:?}");
    }
    // Of two that differ each is as right as the other: their mean is nobody's motion.
    for (n, fault) in [(1, Degenerate::Few), (2, Degenerate::Few), (7, Degenerate::Few)] {
        let params = Params { min_effective: 7.5, ..Params::default() };
        assert_eq!(mode(&draws(n, 5), &params), Err(fault), "{n} samples");
    }
    assert_eq!(mode(&draws(2, 5), &Params::default()), Err(Degenerate::Few));
    assert!(mode(&draws(8, 5), &Params { min_effective: 7.5, ..Params::default() }).is_ok());
    // With a floor a point and a line have one.
    let floored = Params::default();
    assert_near(&mode(&same, &floored).unwrap().at, &[0.1, 0.2], 1e-12);
    assert_near(&mode(&line, &floored).unwrap().at, &[3.2, 2.2], 1e-6);
    assert_near(&[mode(&same, &floored).unwrap().effective], &[5.0], 1e-9);
}

#[test]
fn the_mode_moves_with_its_samples_and_does_not_mind_their_order() {
    let samples = draws(50, 4);
    let params = Params::default();
    let one = mode(&samples, &params).unwrap();
    let moved: Vec<[f64; 2]> = samples.iter().map(|x| [x[0] + 7.5, x[1] - 20.25]).collect();
    assert_near(&mode(&moved, &params).unwrap().at, &[one.at[0] + 7.5, one.at[1] - 20.25], 1e-9);
    let reversed: Vec<[f64; 2]> = samples.iter().rev().copied().collect();
    assert_near(&mode(&reversed, &params).unwrap().at, &one.at, 1e-9);
    assert!((one.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

/// The claim of 2.5.2: outliers of one direction pull the mean, and the median too, but not the mode.
#[test]
fn thirty_percent_that_move_another_way_do_not_move_the_mode() {
    let params = Params::default();
    let at = |samples: &[[f64; 2]]| mode(samples, &params).unwrap().at;
    for (away_px, of_median, of_mean) in
        [(1.0, 1.0, 0.6), (2.0, 0.6, 0.3), (4.0, 0.6, 0.1), (16.0, 0.6, 0.03)]
    {
        let [mean, median, mode] = outliers::errors(0.3, away_px, &at);
        let is_better = mode < of_median * median && mode < of_mean * mean;
        assert!(is_better, "{away_px} px: mean {mean}, median {median}, mode {mode}");
    }
    // Where nothing is wrong it costs little.
    let [mean, median, mode] = outliers::errors(0.0, 0.0, &at);
    assert!(mode < 1.3 * mean && mode < 1.1 * median, "{mean} {median} {mode}");
}
