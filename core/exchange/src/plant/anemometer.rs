//! Wind as an anemometer has recorded it: a table, a row an instant.
//!
//! The first column is the time in seconds, the next two or three are the velocity in metres per second: x, y and, where
//! it was measured, z. Their names do not matter.

#[cfg(test)]
mod tests;

use super::PlantFileError;

/// Steps of a recording may differ by so much of the usual one.
const EVEN: f64 = 0.01;

/// A wind at one place, evenly timed.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Seconds between samples.
    pub step: f64,
    /// Metres per second: x, y, z.
    pub samples: Vec<[f64; 3]>,
}

/// Reads a recording from the text of a table.
///
/// # Errors
/// [`PlantFileError`] with the line.
pub fn parse(text: &str) -> Result<Recording, PlantFileError> {
    let mut rows = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let wrong = |what: String| PlantFileError::Line { line, what };
        let text = text.trim();
        // The first line may name the columns.
        if text.is_empty() || text.starts_with('#') || line == 1 && text.contains(|c: char| c.is_alphabetic())
        {
            continue;
        }
        let cells = text.split([',', ';', '\t', ' ']).map(str::trim).filter(|cell| !cell.is_empty());
        let number = |cell: &str| {
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(format!("{cell:?} is no number")))
        };
        let cells = cells.map(number).collect::<Result<Vec<f64>, _>>()?;
        let (time, wind) = match cells[..] {
            [time, x, y] => (time, [x, y, 0.0]),
            [time, x, y, z] => (time, [x, y, z]),
            _ => {
                let what =
                    format!("wanted a time and two or three components of the wind, came {}", cells.len());
                return Err(wrong(what));
            }
        };
        rows.push((line, time, wind));
    }
    let (Some(&(_, first, _)), Some(&(_, last, _))) = (rows.first(), rows.last()) else {
        return Err(PlantFileError::Lacks("a recording of wind has two rows at least, this has none".into()));
    };
    if rows.len() < 2 {
        return Err(PlantFileError::Lacks("a recording of wind has two rows at least, this has one".into()));
    }
    let step = (last - first) / (rows.len() - 1) as f64;
    for pair in rows.windows(2) {
        let [(_, before, _), (line, after, _)] = pair else { continue };
        // Also where time stands still or runs back.
        if (after - before - step).abs() >= EVEN * step {
            let what =
                format!("{:.4} s after the row before, where rows are {step:.4} s apart", after - before);
            return Err(PlantFileError::Line { line: *line, what });
        }
    }
    Ok(Recording { step, samples: rows.into_iter().map(|(_, _, wind)| wind).collect() })
}
