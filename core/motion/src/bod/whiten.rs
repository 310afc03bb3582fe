//! Leaves that flutter each for itself: taken down in time before tracks are decomposed.
//!
//! What is left of the tracks without their strongest components is noise and flutter. Its mean power over
//! frequency, smoothed, is divided out of every track, so that frequencies at which leaves flutter count less.

use rayon::prelude::*;
use realfft::RealFftPlanner;

use super::{Bod, Table};

/// Components that are taken for motion of the plant.
const STRONGEST: usize = 15;
/// Frequencies that power is smoothed over.
const SMOOTH: usize = 9;
/// Power is not divided by less than this share of its median.
const FLOOR: f64 = 1e-3;

/// The spectrum of what is left of tracks without their 15 strongest components.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// Mean power over all tracks at 0, 1, 2 … cycles in the table's frames, smoothed, px^2; more than 0.
    pub power: Vec<f64>,
    /// Share of all motion that is left, 0 to 1.
    pub share: f64,
}

impl Residual {
    /// How flat the spectrum is: 1 for white noise, less where it has peaks (geometric over arithmetic mean).
    #[must_use]
    pub fn flatness(&self) -> f64 {
        let power = &self.power[1..];
        let n = power.len() as f64;
        let logarithm = power.iter().map(|p| p.ln()).sum::<f64>() / n;
        logarithm.exp() / (power.iter().sum::<f64>() / n)
    }
}

/// What is left without the strongest components; `None` of tables that have no more than twice so many, and of those
/// in which nothing is left but rounding.
#[must_use]
pub fn residual(table: &Table, bod: &Bod) -> Option<Residual> {
    let n_frames = table.n_frames();
    if bod.singular.len() <= 2 * STRONGEST || bod.len() < STRONGEST {
        return None;
    }
    let strongest = bod.sum(STRONGEST, |_| 1.0);
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(n_frames);
    let power_of = |(row, told): (&[f64], &[f64])| {
        let mut left: Vec<f64> = row.iter().zip(told).map(|(v, told)| v - told).collect();
        let square = left.iter().map(|v| v * v).sum::<f64>();
        let mut waves = plan.make_output_vec();
        // Only wrong lengths fail, and these are the transform's own.
        let done = plan.process(&mut left, &mut waves);
        debug_assert!(done.is_ok(), "{done:?}");
        (waves.iter().map(|wave| wave.norm_sqr()).collect::<Vec<f64>>(), square)
    };
    let rows = table.series().par_chunks(n_frames).zip(strongest.par_chunks(n_frames));
    let powers: Vec<(Vec<f64>, f64)> = rows.map(power_of).collect();
    let mut power = vec![0.0; n_frames / 2 + 1];
    for (row, _) in &powers {
        power.iter_mut().zip(row).for_each(|(sum, p)| *sum += p / powers.len() as f64);
    }
    let left: f64 = powers.iter().map(|(_, square)| square).sum();
    let all: f64 = table.series().iter().map(|v| v * v).sum();
    if left <= table.rounding_px().powi(2) * table.series().len() as f64 {
        return None;
    }
    let mut power = smoothed(&power);
    let mut sorted = power.clone();
    sorted.sort_by(f64::total_cmp);
    let floor = FLOOR * sorted[sorted.len() / 2];
    power.iter_mut().for_each(|p| *p = p.max(floor));
    (floor > 0.0).then_some(Residual { power, share: left / all })
}

/// The same tracks with the spectrum of a residual divided out.
#[must_use]
pub fn whitened(table: &Table, residual: &Residual) -> Table {
    let n_frames = table.n_frames();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(n_frames), planner.plan_fft_inverse(n_frames));
    let mut series = table.series().to_vec();
    series.par_chunks_mut(n_frames).for_each(|row| {
        let (mut values, mut waves) = (row.to_vec(), forward.make_output_vec());
        let mut done = forward.process(&mut values, &mut waves);
        for (wave, power) in waves.iter_mut().zip(&residual.power) {
            *wave /= power.sqrt();
        }
        // These two are real; the mean is 0.
        waves[0].im = 0.0;
        if n_frames.is_multiple_of(2)
            && let Some(last) = waves.last_mut()
        {
            last.im = 0.0;
        }
        done = done.and_then(|()| inverse.process(&mut waves, row));
        debug_assert!(done.is_ok(), "{done:?}");
    });
    table.with(series)
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
