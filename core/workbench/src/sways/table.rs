//! Tables of series: columns of numbers that somebody recorded, and the sensors of `simulate`.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;

use honami_exchange::plant::SwayRow;
use honami_motion::accuracy;

use super::{Within, variance};
use crate::error::WorkbenchError;

/// Steps of a table may differ by so much of the usual one: times are rounded.
const EVEN: f64 = 0.05;
/// And all of them together from the rate that was given.
const SAME_RATE: f64 = 0.01;
/// Heads of a column of times.
pub(crate) const TIMES: [&str; 7] = ["time_s", "t_s", "time", "t", "seconds", "time (s)", "time [s]"];

/// What a table is, by its first line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Sensors of `simulate`.
    Sensors,
    /// Columns with their times.
    Timed,
    /// Numbers alone.
    Untimed,
    /// Something else.
    Other,
}

/// What a table is; a file that cannot be read is something else, whose reader says what is wrong with it.
#[must_use]
pub fn kind(path: &Path) -> Kind {
    let mut line = String::new();
    let is_read = fs::File::open(path).is_ok_and(|file| BufReader::new(file).read_line(&mut line).is_ok());
    let names: Vec<String> = cells(&line).map(str::to_lowercase).collect();
    let has = |name: &str| names.iter().any(|other| other == name);
    match is_read {
        true if has("sensor") => Kind::Sensors,
        true if !has("track") && names.iter().any(|name| TIMES.contains(&name.as_str())) => Kind::Timed,
        true if names.iter().all(|name| number(name).is_some()) => Kind::Untimed,
        _ => Kind::Other,
    }
}

/// Series, evenly sampled.
pub(super) struct Table {
    pub(super) fps: f64,
    /// Time of the first sample, seconds.
    pub(super) start_s: f64,
    /// What the series are measured in, if that is known.
    pub(super) unit: Option<&'static str>,
    pub(super) series: Vec<(String, Vec<f64>)>,
}

/// Sensors, each in the direction in which it moves most.
pub(super) fn sensors(path: &Path, within: Within) -> Result<Table, WorkbenchError> {
    let wrong = |what: String| WorkbenchError::Series { path: path.to_owned(), what };
    let mut sensors = BTreeMap::<u32, Vec<SwayRow>>::new();
    for row in honami_exchange::read::<SwayRow>(path)? {
        let row = row?;
        sensors.entry(row.sensor).or_default().push(row);
    }
    let times: Vec<f64> = sensors.values().next().into_iter().flatten().map(|row| row.time_s).collect();
    for (sensor, rows) in &sensors {
        let other = rows.iter().zip(&times).find(|(row, t)| (row.time_s - **t).abs() > 1e-9);
        if let Some((row, t)) = other {
            let came = row.time_s;
            return Err(wrong(format!("sensor {sensor} is at {came} s where the first is at {t} s")));
        }
        if rows.len() != times.len() {
            let (came, wanted) = (rows.len(), times.len());
            return Err(wrong(format!("sensor {sensor} has {came} rows, the first has {wanted}")));
        }
    }
    let at = |row: usize| {
        format!(
            "frame {} of sensor {}",
            sensors.values().next().map_or(0, |rows| rows[row].frame),
            sensors.keys().next().unwrap_or(&0)
        )
    };
    let (range, fps) = timed(&times, within, at).map_err(wrong)?;
    let series = sensors.iter().map(|(sensor, rows)| {
        let along = |of: fn(&SwayRow) -> f64| rows[range.clone()].iter().map(of).collect::<Vec<f64>>();
        let axes = [along(|row| row.x), along(|row| row.y), along(|row| row.z)];
        let most = axes.into_iter().max_by(|a, b| variance(a).total_cmp(&variance(b)));
        (format!("sensor {sensor}"), most.unwrap_or_default())
    });
    Ok(Table { fps, start_s: times[range.start], unit: Some("m"), series: series.collect() })
}

/// Columns: samples in rows, at a rate that somebody knows or with a column of times.
pub(super) fn columns(path: &Path, fps: Option<f64>, within: Within) -> Result<Table, WorkbenchError> {
    let wrong = |what: String| WorkbenchError::Series { path: path.to_owned(), what };
    let text = fs::read_to_string(path).map_err(|source| WorkbenchError::Io {
        what: "cannot read the series",
        source,
        path: path.to_owned(),
    })?;
    let Columns { mut names, lines, mut values } = parsed(&text).map_err(wrong)?;
    let of_times = names.iter().position(|name| TIMES.contains(&name.to_lowercase().as_str()));
    let times = match (of_times, fps) {
        (Some(column), _) => {
            names.remove(column);
            values.remove(column)
        }
        (None, Some(fps)) => (0..lines.len()).map(|k| k as f64 / fps).collect(),
        (None, None) => {
            return Err(wrong("its rows have no times: --fps says how many there are a second".to_owned()));
        }
    };
    if values.is_empty() {
        return Err(wrong("it has times and no other column".to_owned()));
    }
    let (range, found) = timed(&times, within, |row| format!("line {}", lines[row])).map_err(wrong)?;
    if let Some(fps) = fps.filter(|fps| (fps / found - 1.0).abs() > SAME_RATE) {
        return Err(wrong(format!(
            "its times say {found:.4} rows a second, and --fps says {fps}: leave it out"
        )));
    }
    let series = names.into_iter().zip(values).map(|(name, column)| (name, column[range.clone()].to_vec()));
    Ok(Table { fps: found, start_s: times[range.start], unit: None, series: series.collect() })
}

/// Rows of numbers under names.
struct Columns {
    names: Vec<String>,
    /// Line of each row, from 1.
    lines: Vec<usize>,
    values: Vec<Vec<f64>>,
}

fn parsed(text: &str) -> Result<Columns, String> {
    let mut names: Vec<String> = Vec::new();
    let (mut lines, mut values) = (Vec::new(), Vec::<Vec<f64>>::new());
    let is_row = |(_, text): &(usize, &str)| !text.trim().is_empty() && !text.trim_start().starts_with('#');
    for (line, text) in (1..).zip(text.lines()).filter(is_row) {
        let is_head = lines.is_empty()
            && names.is_empty()
            && cells(text).all(|cell| number(cell).is_none() && !cell.is_empty());
        if is_head && !cells(text).any(|cell| cell.eq_ignore_ascii_case("nan")) {
            names = cells(text).map(str::to_owned).collect();
            continue;
        }
        let row = cells(text).zip(1..).map(|(cell, column)| {
            let why = || {
                let what = if cell.is_empty() { "nothing".to_owned() } else { format!("{cell:?}") };
                format!(
                    "line {line}, column {column}: wanted a number, came {what}: fill it in, or delete the line and \
                     keep to one side of the gap with --from or --to"
                )
            };
            number(cell).ok_or_else(why)
        });
        let row = row.collect::<Result<Vec<f64>, String>>()?;
        if values.is_empty() {
            values = vec![Vec::new(); if names.is_empty() { row.len() } else { names.len() }];
        }
        if row.len() != values.len() {
            let (came, wanted) = (row.len(), values.len());
            return Err(format!("line {line}: wanted {wanted} numbers as before, came {came}"));
        }
        values.iter_mut().zip(row).for_each(|(column, v)| column.push(v));
        lines.push(line);
    }
    if lines.is_empty() {
        return Err("it has no rows".to_owned());
    }
    if names.is_empty() {
        names = (1..=values.len()).map(|k| format!("column {k}")).collect();
    }
    Ok(Columns { names, lines, values })
}

/// Cells of a line: between semicolons, else commas, else white space.
pub(crate) fn cells(line: &str) -> impl Iterator<Item = &str> {
    // Spreadsheets put a mark before what they call UTF-8.
    let line = line.trim_start_matches('\u{feff}').trim();
    let (separator, is_blank) = match line {
        _ if line.contains(';') => (';', false),
        _ if line.contains(',') => (',', false),
        _ => (' ', true),
    };
    let is_between = move |c: char| if is_blank { c.is_whitespace() } else { c == separator };
    line.split(is_between)
        .map(|cell| cell.trim().trim_matches('"'))
        .filter(move |cell| !(is_blank && cell.is_empty()))
}

/// A finite number, whose decimal mark may be a comma where columns are not parted by it.
pub(crate) fn number(cell: &str) -> Option<f64> {
    cell.replace(',', ".").parse().ok().filter(|value: &f64| value.is_finite())
}

/// The rows between two times, and how many there are a second.
fn timed(
    times: &[f64],
    within: Within,
    place: impl Fn(usize) -> String,
) -> Result<(std::ops::Range<usize>, f64), String> {
    if let Some(back) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(format!(
            "{}: its time, {} s, is not after the one before",
            place(back + 1),
            times[back + 1]
        ));
    }
    if times.is_empty() {
        return Err("it has no rows".to_owned());
    }
    let range = within.range(times)?;
    let steps: Vec<f64> = times[range.clone()].windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = accuracy::median(steps.clone()).unwrap_or(0.0);
    let gap = steps.iter().position(|step| (step - usual).abs() > EVEN * usual);
    match gap {
        Some(row) => {
            let row = range.start + row + 1;
            let gap_s = times[row] - times[row - 1];
            Err(format!(
                "{}: {gap_s:.4} s after the one before, where {usual:.4} s are usual: sample it evenly again, or cut \
                 what is even out of it with --from and --to",
                place(row)
            ))
        }
        // Times are rounded, and their mean step is less so.
        None => Ok((range, steps.len() as f64 / steps.iter().sum::<f64>())),
    }
}
