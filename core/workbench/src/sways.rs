//! How fast and how long things swing that were recorded elsewhere, or that `simulate` has written: from tables of series.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use honami_exchange::plant::SwayRow;
pub use honami_motion::swing::Swing;
use honami_motion::swing::swing;

use crate::error::WorkbenchError;

/// Slower than so many times in the whole series is a drift.
const LOWEST_CYCLES: f64 = 3.0;
/// Steps of a table may differ by so much of the usual one.
const EVEN: f64 = 0.01;

/// Series of a file, and how each swings.
#[derive(Clone, Debug, PartialEq)]
pub struct Sways {
    /// Samples a second.
    pub fps: f64,
    /// Samples.
    pub n_samples: usize,
    /// The name of each, and its strongest swing, if it has one.
    pub series: Vec<(String, Option<Swing>)>,
    /// Their median.
    pub median: Option<Swing>,
}

/// Whether a file is a table of sensors.
#[must_use]
pub fn is_sensors(path: &Path) -> bool {
    let text = fs::read_to_string(path).unwrap_or_default();
    text.lines().next().is_some_and(|line| line.split(',').any(|name| name.trim() == "sensor"))
}

/// How sensors swing, each in the direction in which it moves most; nothing slower than `above_hz` counts.
///
/// # Errors
/// What the table says of its lines, and [`WorkbenchError::Series`] for times that are uneven.
pub fn of_sensors(path: &Path, above_hz: f64) -> Result<Sways, WorkbenchError> {
    let wrong = |what: &str| WorkbenchError::Series { path: path.to_owned(), what: what.to_owned() };
    let mut sensors = BTreeMap::<u32, Vec<(f64, [f64; 3])>>::new();
    for row in honami_exchange::read::<SwayRow>(path)? {
        let row = row?;
        sensors.entry(row.sensor).or_default().push((row.time_s, [row.x, row.y, row.z]));
    }
    let first = sensors.values().next().ok_or_else(|| wrong("it has no rows"))?;
    let n = first.len();
    let span = first[n - 1].0 - first[0].0;
    let step = span / (n.max(2) - 1) as f64;
    let is_even = |rows: &Vec<(f64, [f64; 3])>| {
        rows.len() == n && rows.windows(2).all(|pair| (pair[1].0 - pair[0].0 - step).abs() < EVEN * step)
    };
    if n < 2 || !sensors.values().all(is_even) {
        return Err(wrong("its sensors are not all there at the same, evenly spaced times"));
    }
    let series = sensors.iter().map(|(sensor, rows)| {
        let along = |axis: usize| rows.iter().map(|row| row.1[axis]).collect::<Vec<f64>>();
        let axes = [along(0), along(1), along(2)];
        let most = axes.into_iter().max_by(|a, b| variance(a).total_cmp(&variance(b)));
        (format!("sensor {sensor}"), most.unwrap_or_default())
    });
    Ok(of(series.collect(), 1.0 / step, above_hz))
}

/// How columns of numbers swing: samples in rows, at a rate that somebody knows; nothing slower than `above_hz` counts.
///
/// # Errors
/// [`WorkbenchError::Series`] with the line.
pub fn of_columns(path: &Path, fps: f64, above_hz: f64) -> Result<Sways, WorkbenchError> {
    let wrong = |what: String| WorkbenchError::Series { path: path.to_owned(), what };
    let text = fs::read_to_string(path).map_err(|source| WorkbenchError::Io {
        what: "cannot read the series",
        source,
        path: path.to_owned(),
    })?;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (line, text) in (1..).zip(text.lines()).filter(|(_, text)| !text.trim().is_empty()) {
        let cells = text.split([' ', '\t', ',', ';']).filter(|cell| !cell.is_empty());
        let number = |cell: &str| {
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(format!("line {line}: {cell:?} is no number")))
        };
        let row = cells.map(number).collect::<Result<Vec<f64>, _>>()?;
        if columns.is_empty() {
            columns = vec![Vec::new(); row.len()];
        }
        if row.len() != columns.len() {
            let (came, wanted) = (row.len(), columns.len());
            return Err(wrong(format!("line {line}: wanted {wanted} numbers as before, came {came}")));
        }
        columns.iter_mut().zip(row).for_each(|(column, v)| column.push(v));
    }
    if columns.is_empty() {
        return Err(wrong("it has no rows".to_owned()));
    }
    let named = columns.into_iter().enumerate().map(|(k, column)| (format!("column {}", k + 1), column));
    Ok(of(named.collect(), fps, above_hz))
}

fn of(named: Vec<(String, Vec<f64>)>, fps: f64, above_hz: f64) -> Sways {
    let n_samples = named.first().map_or(0, |(_, series)| series.len());
    let lowest = above_hz.max(LOWEST_CYCLES * fps / n_samples.max(1) as f64);
    let series: Vec<(String, Option<Swing>)> =
        named.into_iter().map(|(name, series)| (name, swing(&series, fps, [lowest, fps / 2.0]))).collect();
    let median = median(series.iter().filter_map(|(_, swing)| *swing).collect());
    Sways { fps, n_samples, series, median }
}

/// Medians of frequencies and of dampings.
pub(crate) fn median(swings: Vec<Swing>) -> Option<Swing> {
    let middle = |of: fn(&Swing) -> f64| {
        let mut values: Vec<f64> = swings.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    Some(Swing { hz: middle(|swing| swing.hz)?, ratio: middle(|swing| swing.ratio)? })
}

pub(crate) fn variance(series: &[f64]) -> f64 {
    let n = series.len().max(1) as f64;
    let mean = series.iter().sum::<f64>() / n;
    series.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n
}
