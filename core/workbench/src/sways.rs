//! How fast and how long things swing that were recorded elsewhere, or that `simulate` has written: from tables of series.

pub(crate) mod table;
#[cfg(test)]
mod tests;

use std::path::Path;

use honami_motion::accuracy;
use honami_motion::spectrum;
use honami_motion::swing::swing;
pub use honami_motion::swing::{Manner, NoSwing, Swing, Told};

use crate::densities::{Density, HalfPower, Pieces};
use crate::error::WorkbenchError;
use table::Table;
pub use table::{Kind, kind};

/// Slower than so many times in the whole series is a drift.
const LOWEST_CYCLES: f64 = 3.0;
/// A peak and its swing lie within this factor of one another.
pub(crate) const ABOUT: f64 = 1.3;

/// What of a record is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Within {
    /// Nothing slower, hertz: what blows is mostly slower than what swings in it.
    pub above_hz: f64,
    /// From this time on, seconds.
    pub from_s: Option<f64>,
    /// To this time, seconds.
    pub to_s: Option<f64>,
}

/// Series of a file, and how each swings.
#[derive(Clone, Debug, PartialEq)]
pub struct Sways {
    /// Samples a second.
    pub fps: f64,
    /// Samples.
    pub n_samples: usize,
    /// Time of the first, seconds.
    pub start_s: f64,
    /// Nothing slower was looked for, hertz.
    pub lowest_hz: f64,
    /// Length of the pieces that densities are of, seconds, if the record is as long as one.
    pub piece_s: Option<f64>,
    /// What the series are measured in, if that is known.
    pub unit: Option<&'static str>,
    /// Each of them.
    pub series: Vec<Series>,
    /// Their median.
    pub median: Option<Swing>,
}

/// A series.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Its strongest swing, or why it has none.
    pub swing: Result<Swing, NoSwing>,
    /// Its power over frequency, the unit squared for each hertz; `None` where the record is too short for a piece.
    pub density: Option<Density>,
}

/// How sensors swing, each in the direction in which it moves most.
///
/// # Errors
/// What the table says of its lines, [`WorkbenchError::Series`] for times that are uneven, and
/// [`WorkbenchError::TooFast`], [`WorkbenchError::Piece`].
pub fn of_sensors(path: &Path, within: Within, pieces: Pieces) -> Result<Sways, WorkbenchError> {
    of(table::sensors(path, within)?, within, pieces)
}

/// How columns of numbers swing: samples in rows, at a rate that somebody knows or with a column of times.
///
/// # Errors
/// [`WorkbenchError::Series`] with the line, [`WorkbenchError::TooFast`], and [`WorkbenchError::Piece`].
pub fn of_columns(
    path: &Path,
    fps: Option<f64>,
    within: Within,
    pieces: Pieces,
) -> Result<Sways, WorkbenchError> {
    of(table::columns(path, fps, within)?, within, pieces)
}

fn of(table: Table, within: Within, pieces: Pieces) -> Result<Sways, WorkbenchError> {
    let Table { fps, start_s, unit, series } = table;
    let n_samples = series.first().map_or(0, |(_, series)| series.len());
    within.check_above(fps / 2.0)?;
    let lowest_hz = within.above_hz.max(LOWEST_CYCLES * fps / n_samples.max(1) as f64);
    let welch = pieces.welch(fps, n_samples)?;
    let told = |(name, series): (String, Vec<f64>)| Series {
        name,
        swing: swing(&series, fps, [lowest_hz, fps / 2.0]),
        density: welch.as_ref().and_then(|welch| welch.density(&[&series])),
    };
    let series: Vec<_> = series.into_iter().map(told).collect();
    let median = median(series.iter().filter_map(|series| series.swing.clone().ok()).collect());
    let piece_s = welch.map(|welch| welch.piece_s());
    Ok(Sways { fps, n_samples, start_s, lowest_hz, piece_s, unit, series, median })
}

impl Sways {
    /// How broad the density of a series is about its swing, if it has one.
    #[must_use]
    pub fn half_power(&self, series: &Series) -> Option<HalfPower> {
        let hz = series.swing.as_ref().ok()?.damped_hz();
        series.density.as_ref()?.peak([hz / ABOUT, hz * ABOUT])
    }

    /// What else the strongest swing may be, hertz: it is so near half the rate that it may be faster than can be seen.
    #[must_use]
    pub fn may_be_alias(&self) -> Option<(f64, Vec<f64>)> {
        let hz = self.median?.damped_hz();
        spectrum::may_be_alias(hz, self.fps / 2.0).then(|| (hz, spectrum::aliases_hz(hz, self.fps)))
    }
}

impl Within {
    /// The rows of these times, two at least.
    pub(crate) fn range(&self, times_s: &[f64]) -> Result<std::ops::Range<usize>, String> {
        let first = times_s.partition_point(|t| self.from_s.is_some_and(|from| *t < from));
        let end = times_s.partition_point(|t| self.to_s.is_none_or(|to| *t <= to));
        if first + 1 < end {
            return Ok(first..end);
        }
        let [from, to] = [times_s.first(), times_s.last()].map(|t| t.copied().unwrap_or(0.0));
        Err(format!(
            "fewer than two samples are left: it lasts from {from} to {to} s, and was asked for from {} to {} s",
            self.from_s.unwrap_or(from),
            self.to_s.unwrap_or(to)
        ))
    }

    pub(crate) fn check_above(&self, nyquist_hz: f64) -> Result<(), WorkbenchError> {
        let above_hz = self.above_hz;
        if above_hz < nyquist_hz { Ok(()) } else { Err(WorkbenchError::TooFast { above_hz, nyquist_hz }) }
    }
}

/// Medians of frequencies and of dampings, and the most usual manner. Their errors are the medians of errors, or, where
/// the swings differ by more, what their differences tell.
pub(crate) fn median(swings: Vec<Swing>) -> Option<Swing> {
    let middle = |of: &dyn Fn(&Swing) -> f64| accuracy::median(swings.iter().map(of).collect());
    let told = |of: &dyn Fn(&Swing) -> Told| {
        let value = middle(&|swing| of(swing).value)?;
        // Of normal numbers the median is off by 1.2533 deviations over the root of how many they are, and a
        // deviation is 1.4826 of the median distance.
        let spread = 1.2533 * 1.4826 * middle(&|swing| (of(swing).value - value).abs())?;
        let error = middle(&|swing| of(swing).error)?.max(spread / (swings.len() as f64).sqrt());
        Some(Told { value, error })
    };
    let count = |manner: Manner| swings.iter().filter(|swing| swing.manner == manner).count();
    Some(Swing {
        manner: swings.iter().map(|swing| swing.manner).max_by_key(|manner| (count(*manner), *manner))?,
        hz: told(&|swing| swing.hz)?,
        ratio: told(&|swing| swing.ratio)?,
        n_cycles: middle(&|swing| swing.n_cycles)?,
        first: middle(&|swing| swing.first as f64)? as usize,
    })
}

pub(crate) fn variance(series: &[f64]) -> f64 {
    let n = series.len().max(1) as f64;
    let mean = series.iter().sum::<f64>() / n;
    series.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n
}
