//! Damping by honami and by what is in use, of swings that are known: how far off on average, and how far apart.
//!
//! `cargo run --release -p honami-motion --example swing_bench`
#![expect(clippy::print_stdout, reason = "a program that prints its measurements")]

use std::f64::consts::TAU;

use honami_motion::swing::swing;
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use realfft::RealFftPlanner;

/// Natural frequency of all of them, hertz, and samples a second.
const HZ: f64 = 0.8;
const FPS: f64 = 10.0;
const RECORDS: u64 = 100;
/// Welch's pieces, seconds, half over one another.
const PIECE_S: f64 = 30.0;
/// Swings of a random decrement.
const SWINGS: f64 = 8.0;

type Method = (&'static str, fn(&[f64]) -> Option<f64>);

fn main() {
    let of_wind: [Method; 3] =
        [("honami", by_honami), ("half-power width", by_width), ("random decrement", by_random_decrement)];
    let of_pull: [Method; 3] = [("honami", by_honami), ("crests", by_crests), ("half-power width", by_width)];
    println!("| record | method | damping off, % | spread, % | of {RECORDS} |\n|---|---|---|---|---|");
    for (ratio, seconds) in [(0.02, 120.0), (0.02, 600.0), (0.06, 120.0), (0.06, 600.0)] {
        let name = format!("wind, {:.0} %, {seconds} s", 100.0 * ratio);
        row(&name, ratio, &of_wind, |seed| driven(ratio, seconds, seed));
    }
    for (ratio, noise) in [(0.02, 0.02), (0.05, 0.02), (0.05, 0.1), (0.15, 0.02)] {
        let name = format!("let go, {:.0} %, 40 s, noise {:.0} %", 100.0 * ratio, 100.0 * noise);
        row(&name, ratio, &of_pull, |seed| let_go(ratio, noise, seed));
    }
}

fn row(name: &str, ratio: f64, methods: &[Method], record: impl Fn(u64) -> Vec<f64>) {
    for (method, of) in methods {
        let found: Vec<f64> =
            (0..RECORDS).filter_map(|seed| of(&record(seed))).map(|z| z / ratio - 1.0).collect();
        let n = found.len().max(1) as f64;
        let mean = found.iter().sum::<f64>() / n;
        let spread = (found.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / n).sqrt();
        println!("| {name} | {method} | {:+.1} | {:.1} | {} |", 100.0 * mean, 100.0 * spread, found.len());
    }
}

fn driven(ratio: f64, seconds: f64, seed: u64) -> Vec<f64> {
    let (omega, steps) = (TAU * HZ, 20);
    let dt = 1.0 / FPS / f64::from(steps);
    let mut chance = Pcg64Mcg::seed_from_u64(seed);
    let (mut q, mut speed) = (0.0, 0.0);
    let mut sample = || {
        for _ in 0..steps {
            speed += dt * (chance.random_range(-1.0..1.0) - 2.0 * ratio * omega * speed - omega * omega * q);
            q += dt * speed;
        }
        q
    };
    let unseen = (8.0 * FPS / (ratio * omega)) as usize;
    (0..unseen + (seconds * FPS) as usize).map(|_| sample()).skip(unseen).collect()
}

fn let_go(ratio: f64, noise: f64, seed: u64) -> Vec<f64> {
    let (omega, mut chance) = (TAU * HZ, Pcg64Mcg::seed_from_u64(seed));
    let damped = omega * (1.0 - ratio * ratio).sqrt();
    let mut at = |k: u32| {
        let t = f64::from(k) / FPS;
        (-ratio * omega * t).exp() * (damped * t).cos() + noise * chance.sample::<f64, _>(StandardNormal)
    };
    (0..400).map(&mut at).collect()
}

fn by_honami(series: &[f64]) -> Option<f64> {
    Some(swing(series, FPS, [0.25 * HZ, FPS / 2.0]).ok()?.ratio.value)
}

/// Half the width of the peak at half its power, over its frequency; Welch's spectrum through Hann's window.
fn by_width(series: &[f64]) -> Option<f64> {
    let piece = ((PIECE_S * FPS) as usize).min(series.len());
    // Padded, so that the width does not depend on where the frequencies lie.
    let n = 8 * piece;
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let (mut power, mut output) = (vec![0.0; n / 2 + 1], forward.make_output_vec());
    for start in (0..=series.len() - piece).step_by(piece / 2) {
        let part = &series[start..start + piece];
        let mean = part.iter().sum::<f64>() / piece as f64;
        let hann = |k: usize| 0.5 - 0.5 * (TAU * k as f64 / piece as f64).cos();
        let mut input: Vec<f64> = part.iter().enumerate().map(|(k, v)| (v - mean) * hann(k)).collect();
        input.resize(n, 0.0);
        forward.process(&mut input, &mut output).ok()?;
        power.iter_mut().zip(&output).for_each(|(power, v)| *power += v.norm_sqr());
    }
    let hz = |k: f64| k * FPS / n as f64;
    let first = (0.5 * HZ * n as f64 / FPS) as usize;
    let top = (first..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    let half = 0.5 * power[top];
    let between = |above: usize, below: usize| {
        let share = (power[above] - half) / (power[above] - power[below]);
        above as f64 + share * (below as f64 - above as f64)
    };
    let low = (1..top).rev().find(|k| power[*k] < half)?;
    let high = (top..power.len()).find(|k| power[*k] < half)?;
    Some((hz(between(high - 1, high)) - hz(between(low + 1, low))) / (2.0 * hz(top as f64)))
}

/// The mean of what follows each rise through the root mean square times the root of two, whose crests fall as a swing
/// that is let go (Cole, AIAA 68-288, 1968).
fn by_random_decrement(series: &[f64]) -> Option<f64> {
    let level = (2.0 * series.iter().map(|v| v * v).sum::<f64>() / series.len() as f64).sqrt();
    let long = (SWINGS * FPS / HZ) as usize;
    let mut mean = vec![0.0; long];
    for start in
        (1..series.len().saturating_sub(long)).filter(|k| series[k - 1] < level && series[*k] >= level)
    {
        mean.iter_mut().zip(&series[start..]).for_each(|(mean, v)| *mean += v);
    }
    by_crests(&mean)
}

/// The slope of the logarithms of crests and troughs while they are a tenth of the first, twice which is the decrement.
fn by_crests(series: &[f64]) -> Option<f64> {
    let is_turn = |k: &usize| (series[*k] - series[k - 1]) * (series[k + 1] - series[*k]) <= 0.0;
    let apart = (0.35 * FPS / HZ) as usize;
    let mut turns: Vec<usize> = Vec::new();
    for turn in (1..series.len() - 1).filter(is_turn) {
        if turns.last().is_none_or(|last| turn - last > apart) {
            turns.push(turn);
        }
    }
    let first = series[*turns.first()?].abs();
    let seen: Vec<f64> = turns.iter().map(|k| series[*k].abs()).take_while(|v| *v > 0.1 * first).collect();
    let n = seen.len() as f64;
    if n < 3.0 {
        return None;
    }
    let (middle, mean) = ((n - 1.0) / 2.0, seen.iter().map(|v| v.ln()).sum::<f64>() / n);
    let slope = seen.iter().enumerate().map(|(k, v)| (k as f64 - middle) * (v.ln() - mean)).sum::<f64>()
        / (0..seen.len()).map(|k| (k as f64 - middle).powi(2)).sum::<f64>();
    let decrement = -2.0 * slope;
    Some(decrement / (TAU * TAU + decrement * decrement).sqrt())
}
