//! Wind as an anemometer has recorded it: a table, a row an instant.
//!
//! The first column is the time in seconds, the next two or three are the velocity in metres per second: x, y and, where
//! it was measured, z (0 elsewhere). Columns are separated by commas, semicolons, tabs or blanks. The first row may name
//! them; how does not matter. Empty lines and those that begin with `#` are passed over.

#[cfg(test)]
mod tests;

use super::PlantFileError;
use honami_model::brief::Brief;

/// Steps of a recording may differ by so much of the usual one.
const EVEN: f64 = 0.01;
/// Metres per second: none that was ever measured is faster, tornadoes are not (135 m/s). What is faster is a value for what
/// is missing, -999 or -9999, or of another unit.
const FASTEST: f64 = 200.0;

/// A wind at one place, evenly timed.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Seconds between samples.
    pub step: f64,
    /// Metres per second: x, y, z.
    pub samples: Vec<[f64; 3]>,
}

/// A row: its line, its time and the wind.
type Sample = (usize, f64, [f64; 3]);

/// Reads a recording from the text of a table.
///
/// # Errors
/// [`PlantFileError`] with the line: cells that are no finite numbers, rows of fewer or more than three or four of them,
/// time that stands still, runs back or is uneven by more than a hundredth of a step, as at a gap, winds of more than 200
/// metres per second, as values for what is missing are; and fewer than two rows.
pub fn parse(text: &str) -> Result<Recording, PlantFileError> {
    let lines = (1..).zip(text.lines()).map(|(line, text)| (line, text.trim()));
    let mut lines = lines.filter(|(_, text)| !(text.is_empty() || text.starts_with('#'))).peekable();
    // The first may name the columns.
    lines.next_if(|(_, text)| cells(text).all(|cell| cell.parse::<f64>().is_err()));
    let rows = lines.map(|(line, text)| row(line, text)).collect::<Result<Vec<_>, _>>()?;
    if rows.len() < 2 {
        let n = if rows.is_empty() { "none" } else { "one" };
        return Err(PlantFileError::Lacks(format!(
            "a recording of wind has two rows at least, this has {n}"
        )));
    }
    let step = step(&rows)?;
    Ok(Recording { step, samples: rows.into_iter().map(|(_, _, wind)| wind).collect() })
}

fn cells(text: &str) -> impl Iterator<Item = &str> {
    text.split([',', ';', '\t', ' ']).map(str::trim).filter(|cell| !cell.is_empty())
}

fn row(line: usize, text: &str) -> Result<Sample, PlantFileError> {
    let wrong = |what: String| PlantFileError::Line { line, what };
    let number = |cell: &str| {
        let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| wrong(format!("{cell:?} is no number: fill in what is missing, or cut it off")))
    };
    let numbers = cells(text).map(number).collect::<Result<Vec<f64>, _>>()?;
    let (time, wind) = match numbers[..] {
        [time, x, y] => (time, [x, y, 0.0]),
        [time, x, y, z] => (time, [x, y, z]),
        _ => {
            return Err(wrong(format!(
                "wanted a time and two or three components of the wind, came {}",
                numbers.len()
            )));
        }
    };
    if wind.iter().fold(0.0, |speed: f64, v| speed.hypot(*v)) > FASTEST {
        let [x, y, z] = wind.map(Brief);
        return Err(wrong(format!(
            "a wind of {x}, {y}, {z} m/s, and none is faster than {FASTEST}: where that stands for what is missing, as -999 \
             and -9999 do, fill it in, or cut it off; where it is of another unit, metres per second are wanted"
        )));
    }
    Ok((line, time, wind))
}

/// Seconds from row to row, which are as even as can be; the median is what is usual, also beside a gap.
fn step(rows: &[Sample]) -> Result<f64, PlantFileError> {
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let uneven = |k: usize, what: String| Err(PlantFileError::Line { line: rows[k + 1].0, what });
    if let Some(k) = steps.iter().position(|step| *step <= 0.0) {
        let [before, time] = [rows[k].1, rows[k + 1].1].map(Brief);
        return uneven(k, format!("time {time} s does not come after {before} s, the row before"));
    }
    let in_order = steps.clone();
    steps.sort_by(f64::total_cmp);
    let usual = f64::midpoint(steps[(steps.len() - 1) / 2], steps[steps.len() / 2]);
    if let Some(k) = in_order.iter().position(|step| (step - usual).abs() >= EVEN * usual) {
        return uneven(
            k,
            format!(
                "{:.4} s after the row before, where rows are {usual:.4} s apart: a gap is filled in, or cut off",
                in_order[k]
            ),
        );
    }
    Ok((rows[rows.len() - 1].1 - rows[0].1) / steps.len() as f64)
}
