//! Leaves that flutter each for itself: taken down in time before tracks are decomposed.
//!
//! What is left of the tracks without their strongest components is noise and flutter. Its mean power over
//! frequency, smoothed, is divided out of every track, so that frequencies at which leaves flutter count less.
//!
//! What is left may also be modes of the plant, where it has many. Those are shared by tracks: at the frequencies at which
//! most is left, few directions have it all. Of flutter every track has its own, and all directions have as much as chance
//! gives them.
//!
//! Where frames are missing in which too few tracks are seen, what is left is that of the longest run without a seam, and each
//! run is taken down for itself: over a seam there are no frequencies. In fewer frames fewer are told apart, so a run is divided
//! by what that power comes to in as few: of one frame by its mean.

use std::ops::Range;

use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

use super::{Bod, Table, product};

/// Components that are taken for motion of the plant.
const STRONGEST: usize = 15;
/// Frequencies that power is smoothed over.
const SMOOTH: usize = 9;
/// Power is not divided by less than this share of its median.
const FLOOR: f64 = 1e-3;
/// A frequency is loud with more than so many times the median power; of fewer loud ones nothing is said.
const LOUD: f64 = 3.0;
const FEWEST_LOUD: usize = 3;
/// And of more the loudest are looked at: memory and time grow with their number and its square.
const MOST_LOUD: usize = 256;
/// Leaves flutter where more than this share of all motion is left without the strongest components, and it is more each
/// track's own than this.
const MUCH_LEFT: f64 = 0.1;
const OWN: f64 = 0.72;

/// The spectrum of what is left of tracks without their 15 strongest components, over the longest run of frames that follow one
/// another, the first of such.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Mean power over all tracks at 0, 1, 2 … cycles in these frames, smoothed, px^2; more than 0.
    pub power: Vec<f64>,
    /// Share of all motion that is left, 0 to 1.
    pub share: f64,
    /// How far what is loud is each track's own: near 1 where no track shares it with others, towards 0 where few motions make
    /// up all of it; `None` of a spectrum without 3 loud frequencies, as white noise has. With Z the n loudest frequencies, 256
    /// at most, of all 2 N series, each over the root of its power, and s its singular values: (Σ s²)² / (n Σ s⁴), over 1 / (1 + n / 2 N),
    /// which is what it comes to of noise.
    pub own: Option<f64>,
}

impl Residual {
    /// Whether tracks look like leaves that flutter each for itself: much is left of them without their strongest components,
    /// at some frequencies more than at others, and there it is each track's own.
    #[must_use]
    pub fn is_flutter(&self) -> bool {
        self.share > MUCH_LEFT && self.own.is_some_and(|own| own > OWN)
    }
}

/// What is left without the strongest components; `None` of tables that have no more than twice so many or no run of more
/// frames, and of those in which nothing is left but rounding.
#[must_use]
pub fn residual(table: &Table, bod: &Bod) -> Option<Residual> {
    let n_frames = table.n_frames();
    let run = longest(table);
    if bod.singular.len() <= 2 * STRONGEST || run.len() <= 2 * STRONGEST || bod.len() < STRONGEST {
        return None;
    }
    let strongest = bod.sum(STRONGEST, |_| 1.0);
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(run.len());
    let waves_of = |(row, told): (&[f64], &[f64])| {
        let parts = row[run.clone()].iter().zip(&told[run.clone()]);
        let mut left: Vec<f64> = parts.map(|(v, told)| v - told).collect();
        let square = left.iter().map(|v| v * v).sum::<f64>();
        let mut waves = plan.make_output_vec();
        // Only wrong lengths fail, and these are the transform's own.
        let done = plan.process(&mut left, &mut waves);
        debug_assert!(done.is_ok(), "{done:?}");
        (waves, square)
    };
    let rows = table.series().par_chunks(n_frames).zip(strongest.par_chunks(n_frames));
    let (waves, squares): (Vec<Vec<Complex<f64>>>, Vec<f64>) = rows.map(waves_of).unzip();
    let mut power = vec![0.0; run.len() / 2 + 1];
    for row in &waves {
        power.iter_mut().zip(row).for_each(|(sum, wave)| *sum += wave.norm_sqr() / waves.len() as f64);
    }
    let left: f64 = squares.iter().sum();
    let series = || table.series().chunks(n_frames).flat_map(|row| &row[run.clone()]);
    let all: f64 = series().map(|v| v * v).sum();
    if left <= table.rounding_px().powi(2) * series().count() as f64 {
        return None;
    }
    let mut power = smoothed(&power);
    let mut sorted = power.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    power.iter_mut().for_each(|p| *p = p.max(FLOOR * median));
    let loud = loudest(&power, LOUD * median);
    (median > 0.0).then(|| Residual { own: own(&waves, &power, &loud), power, share: left / all })
}

/// Frequencies of more power than this, rising; of many those of the most.
pub(super) fn loudest(power: &[f64], threshold: f64) -> Vec<usize> {
    // At 0 cycles there is nothing. The last is counted: its neighbours may be loud only because it is.
    let mut loud: Vec<usize> = (1..power.len()).filter(|&k| power[k] > threshold).collect();
    loud.sort_by(|&a, &b| power[b].total_cmp(&power[a]));
    loud.truncate(MOST_LOUD);
    loud.sort_unstable();
    loud
}

/// See [`Residual::own`]; `None`, too, where nothing is at these frequencies.
pub(super) fn own(waves: &[Vec<Complex<f64>>], power: &[f64], loud: &[usize]) -> Option<f64> {
    let n = loud.len();
    if n < FEWEST_LOUD {
        return None;
    }
    // Z and i Z as real rows: their products are the real and imaginary parts of those of Z, each twice.
    let mut rows = Vec::with_capacity(4 * n * waves.len());
    for turn in [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0)] {
        for &k in loud {
            let row = || waves.iter().map(move |row| row[k] * turn / power[k].sqrt());
            rows.extend(row().map(|wave| wave.re).chain(row().map(|wave| wave.im)));
        }
    }
    let gram = product::gram(&rows, 2 * n);
    let trace: f64 = (0..2 * n).map(|k| gram[k * (2 * n + 1)]).sum();
    let squares: f64 = gram.iter().map(|product| product * product).sum();
    let evenness = trace * trace / (2 * n) as f64 / squares;
    (squares > 0.0).then(|| evenness * (1.0 + n as f64 / waves.len() as f64))
}

/// The first of the longest runs of frames that follow one another.
fn longest(table: &Table) -> Range<usize> {
    table.runs().iter().rev().max_by_key(|run| run.len()).cloned().unwrap_or_default()
}

/// The same tracks with the spectrum of a residual divided out, of each run of frames for itself.
#[must_use]
pub fn whitened(table: &Table, residual: &Residual) -> Table {
    let mut planner = RealFftPlanner::<f64>::new();
    let n_longest = longest(table).len();
    let lags = lags(&residual.power, n_longest, &mut planner);
    let least = residual.power.iter().copied().fold(f64::INFINITY, f64::min);
    let plan = |run: &Range<usize>| {
        let (forward, inverse) = (planner.plan_fft_forward(run.len()), planner.plan_fft_inverse(run.len()));
        // A transform there and back is as long as its run; least is what rounding may take it below.
        let longer = n_longest as f64 / run.len() as f64;
        let gain = |power: f64| longer / power.max(least).sqrt();
        let gains: Vec<f64> = in_fewer(&lags, &*forward).into_iter().map(gain).collect();
        (run.clone(), forward, inverse, gains)
    };
    let plans: Vec<_> = table.runs().iter().map(plan).collect();
    let mut series = table.series().to_vec();
    series.par_chunks_mut(table.n_frames()).for_each(|row| {
        for (run, forward, inverse, gains) in &plans {
            let (mut values, mut waves) = (row[run.clone()].to_vec(), forward.make_output_vec());
            let mut done = forward.process(&mut values, &mut waves);
            waves.iter_mut().zip(gains).for_each(|(wave, gain)| *wave *= *gain);
            // These two are real.
            waves[0].im = 0.0;
            if run.len().is_multiple_of(2)
                && let Some(last) = waves.last_mut()
            {
                last.im = 0.0;
            }
            done = done.and_then(|()| inverse.process(&mut waves, &mut row[run.clone()]));
            debug_assert!(done.is_ok(), "{done:?}");
        }
    });
    table.with(series)
}

/// The autocovariance at 0, 1, 2 … frames apart that goes with the power of `n` frames.
fn lags(power: &[f64], n: usize, planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let inverse = planner.plan_fft_inverse(n);
    let mut waves: Vec<_> = power.iter().map(|power| Complex::new(power / n as f64, 0.0)).collect();
    let mut lags = inverse.make_output_vec();
    let done = inverse.process(&mut waves, &mut lags);
    debug_assert!(done.is_ok(), "{done:?}");
    lags
}

/// The power that series of this autocovariance have in as many frames as a transform takes, in the mean: of `len` frames
/// `len - m` are `m` before another, and the others as far beyond the end of the run.
fn in_fewer(lags: &[f64], forward: &dyn RealToComplex<f64>) -> Vec<f64> {
    let len = forward.len();
    let at = |m: usize| ((len - m) as f64 * lags[m] + m as f64 * lags[(len - m) % lags.len()]) / len as f64;
    let (mut folded, mut waves) = ((0..len).map(at).collect::<Vec<_>>(), forward.make_output_vec());
    let done = forward.process(&mut folded, &mut waves);
    debug_assert!(done.is_ok(), "{done:?}");
    waves.iter().map(|wave| wave.re).collect()
}

/// Means over neighbours with the weights of Hann; at the ends over those there are.
fn smoothed(power: &[f64]) -> Vec<f64> {
    let half = SMOOTH / 2;
    let weight = |k: usize| {
        let phase = std::f64::consts::PI * (k + 1) as f64 / (SMOOTH + 1) as f64;
        phase.sin().powi(2)
    };
    let at = |bin: usize| {
        let near = (0..SMOOTH).filter_map(|k| Some((weight(k), power.get((bin + k).checked_sub(half)?)?)));
        let (sum, all) = near.fold((0.0, 0.0), |(sum, all), (weight, p)| (sum + weight * p, all + weight));
        sum / all
    };
    (0..power.len()).map(at).collect()
}
