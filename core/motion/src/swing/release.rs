//! Where what was held is let go: the sample from which a series is a free swing, and before which it is not.

use std::f64::consts::TAU;

use super::free::Fit;
use super::periodogram::straightened;
use super::{FEWEST, Seen};

/// A plateau ends where the series is farther from its extreme than this share of it, and than so many times the noise.
const PLATEAU: f64 = 0.02;
const NOISES: f64 = 6.0;
/// So many swings come after a release, at least.
const SWINGS: f64 = 2.0;
/// Before a release it is so much slower than after, on average; or there is less than a swing before it.
const QUIET: f64 = 0.3;
/// What comes before a release makes the fit of what follows worse than chance does, so many times (Chow, Econometrica
/// 28, 1960).
const WORSE: f64 = 6.0;
/// A straight line before it is better by so many numbers than Schwarz's criterion wants.
const MARGIN: f64 = 3.0;

/// The first sample after the release; 0 where there is none.
pub(super) fn find(series: &[f64], fps: f64, seen: &Seen, whole: &Fit) -> usize {
    let mut starts = [after_extreme(series), before_step(series)];
    starts.sort_unstable();
    let (mut first, mut before) = (0, None);
    for start in starts {
        let rest = &series[start..];
        let Ok(after) = Seen::new(rest, fps, seen.within_hz) else { continue };
        let samples_a_swing = rest.len() as f64 / after.peak as f64;
        let is_long = rest.len() >= FEWEST && after.peak as f64 >= SWINGS;
        let is_quiet = (start as f64) < samples_a_swing || is_slower_before(series, start, samples_a_swing);
        if start <= first || !is_long || !is_quiet {
            continue;
        }
        let fit = Fit::new(&after);
        let together = before.as_ref().unwrap_or(whole);
        if is_other(&series[first..start], together, &fit, after.rounding) {
            (first, before) = (start, Some(fit));
        }
    }
    first
}

/// Whether what comes before a release is other than what follows: it makes the fit of that worse, or it is rather a
/// straight line.
fn is_other(held: &[f64], together: &Fit, after: &Fit, rounding: f64) -> bool {
    let n_after = after.n_samples() as f64;
    let later = after.squares_from(0).max(rounding * n_after);
    let numbers = after.n_numbers() as f64;
    let worse = (together.squares_from(held.len()) - later) / numbers;
    let n = held.len() as f64 + n_after;
    let apart = later + straightened(held).iter().map(|v| v * v).sum::<f64>();
    // A level, a slope and the time of the release.
    let more = 3.0 + numbers - together.n_numbers() as f64;
    worse > WORSE * later / (n_after - numbers).max(1.0)
        || n * (together.squares_from(0) / apart).ln() > (more + MARGIN) * n.ln()
}

/// Where a series leaves the value farthest from where it ends.
fn after_extreme(series: &[f64]) -> usize {
    let end = &series[series.len() / 2..];
    let level = end.iter().sum::<f64>() / end.len() as f64;
    let away = |k: usize| (series[k] - level).abs();
    let top = (0..series.len()).max_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap_or(0);
    let near = away(top) - (PLATEAU * away(top)).max(NOISES * noise(series));
    (top..series.len()).take_while(|k| away(*k) >= near).last().unwrap_or(0)
}

/// Where the largest step of a series begins: the last turn or rest before it.
fn before_step(series: &[f64]) -> usize {
    let steps: Vec<f64> = series.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let top = (0..steps.len()).max_by(|a, b| steps[*a].abs().total_cmp(&steps[*b].abs())).unwrap_or(0);
    let least = (0.05 * steps[top].abs()).max(NOISES * noise(series));
    let is_same = |k: &usize| steps[*k] * steps[top].signum() > least;
    (0..top).rev().take_while(is_same).last().unwrap_or(top)
}

/// Standard deviation of white noise in a series, from its second differences, whose median a swing hardly moves.
fn noise(series: &[f64]) -> f64 {
    let bends = series.windows(3).map(|three| (three[0] - 2.0 * three[1] + three[2]).abs());
    crate::accuracy::median(bends.collect()).unwrap_or(0.0) / (0.6745 * 6.0_f64.sqrt())
}

/// Whether a series moves less before a sample than in the swing after it.
fn is_slower_before(series: &[f64], start: usize, samples_a_swing: f64) -> bool {
    let after = (start + samples_a_swing.ceil() as usize).min(series.len());
    let square = |range: std::ops::Range<usize>| {
        let steps = series[range].windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let (n, sum) = steps.fold((0.0, 0.0), |(n, sum), square| (n + 1.0, sum + square));
        // Noise moves both.
        (sum / f64::max(n, 1.0) - 2.0 * noise(series).powi(2)).max(0.0)
    };
    // A slow swing has steps that are no larger than noise.
    let least = (TAU / samples_a_swing).powi(2) * noise(series).powi(2);
    square(0..start + 1) < QUIET * QUIET * square(start..after).max(least)
}
