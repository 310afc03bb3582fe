//! Quantitative structure models: trees that laser scanners have seen, as cylinders (Raumonen and others, Remote Sens. 5,
//! 2013).
//!
//! A table has a row a cylinder; columns by name: `radius`, `length`, `start` and `axis` in x, y, z, `parent` (the
//! cylinder that bears it, counted from 1; 0 the trunk's first). A MATLAB file (version 5) has them in this order in the
//! columns of a matrix, one of the first whose name begins with `Cyl`.

mod mat;
#[cfg(test)]
mod tests;

use super::rooted::{self, Raw};
use super::{Measured, PlantFileError};
use honami_model::brief::Brief;

/// A cylinder; metres.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cylinder {
    radius: f64,
    length: f64,
    start: [f64; 3],
    axis: [f64; 3],
    /// Counted from 1; 0: none.
    parent: usize,
    line: usize,
}

/// Columns, in the order of the matrix.
const COLUMNS: [&str; 9] =
    ["radius", "length", "start_x", "start_y", "start_z", "axis_x", "axis_y", "axis_z", "parent"];

/// Cylinders that begin farther than so many radii of what bears them from its end are counted.
const APART: f64 = 2.0;

/// Reads a plant from the text of a table.
///
/// # Errors
/// [`PlantFileError`] with the line.
pub fn parse_table(text: &str) -> Result<Measured, PlantFileError> {
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let cells = |line: &str| -> Vec<String> {
        line.split([',', ';', '\t']).map(|cell| cell.trim().trim_matches('"').to_lowercase()).collect()
    };
    let names = lines.next().map(|(_, line)| cells(line)).unwrap_or_default();
    let place = |wanted: &str| {
        let plain = |name: &str| name.replace(['_', ' ', '.', '(', ')'], "").replace("cylinder", "");
        let found = names.iter().position(|name| {
            let (name, wanted) = (plain(name), plain(wanted));
            // `start_x`, `startX`, `xstart`, `start_1`.
            let turned: String =
                wanted.chars().rev().take(1).chain(wanted.chars().take(wanted.len() - 1)).collect();
            let counted = wanted.replace("tx", "t1").replace("ty", "t2").replace("tz", "t3");
            let counted = counted.replace("sx", "s1").replace("sy", "s2").replace("sz", "s3");
            name == wanted || name == turned || name == counted
        });
        found.ok_or_else(|| {
            let there = if names.is_empty() { "no line".to_owned() } else { names.join(", ") };
            PlantFileError::Lacks(format!("a table of cylinders has a column {wanted}, this one has {there}"))
        })
    };
    let places = COLUMNS.map(place).into_iter().collect::<Result<Vec<usize>, _>>()?;
    let mut rows = Vec::new();
    for (line, text) in lines {
        let row = cells(text);
        let number = |place: &usize| {
            let cell = row.get(*place).map_or("", String::as_str);
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| PlantFileError::Line { line, what: format!("{cell:?} is no number") })
        };
        rows.push((line, places.iter().map(number).collect::<Result<Vec<f64>, _>>()?));
    }
    plant(&rows)
}

/// Reads a plant from the bytes of a MATLAB file.
///
/// # Errors
/// [`PlantFileError`].
pub fn parse_mat(bytes: &[u8]) -> Result<Measured, PlantFileError> {
    let matrix = mat::matrix(bytes, "cyl")?;
    if matrix.n_columns < COLUMNS.len() {
        return Err(PlantFileError::Lacks(format!(
            "a matrix of cylinders has {} columns at least, {} has {}",
            COLUMNS.len(),
            matrix.name,
            matrix.n_columns
        )));
    }
    let n_rows = matrix.numbers.len() / matrix.n_columns;
    let row = |row: usize| (row + 1, (0..COLUMNS.len()).map(|k| matrix.numbers[k * n_rows + row]).collect());
    plant(&(0..n_rows).map(row).collect::<Vec<_>>())
}

fn plant(rows: &[(usize, Vec<f64>)]) -> Result<Measured, PlantFileError> {
    let cylinders = rows.iter().map(|(line, row)| cylinder(*line, row)).collect::<Result<Vec<_>, _>>()?;
    let mut notes = Vec::new();
    // Node 2k + 1 ends cylinder k; 2k begins it where it is the first.
    let mut raw = Vec::with_capacity(cylinders.len() + 1);
    let mut n_moved = 0;
    for (k, at) in cylinders.iter().enumerate() {
        let (begin, end) = (2 * k as i64, 2 * k as i64 + 1);
        let radius = Some(at.radius);
        let parent = match at.parent.checked_sub(1) {
            None => {
                raw.push(Raw { id: begin, parent: None, position: at.start, radius, line: at.line });
                begin
            }
            Some(parent) if parent >= cylinders.len() || parent == k => {
                let what =
                    format!("cylinder {} is borne by {}, there are {}", k + 1, at.parent, cylinders.len());
                return Err(PlantFileError::Line { line: at.line, what });
            }
            Some(parent) => {
                let bears = &cylinders[parent];
                let (to_end, to_start) =
                    (distance(&at.start, &bears.end()), distance(&at.start, &bears.start));
                n_moved += usize::from(to_end.min(to_start) > APART * bears.radius);
                let is_start = to_start < to_end;
                // The node where what bears it begins is the end of what bears that.
                match (is_start, bears.parent.checked_sub(1)) {
                    (true, None) => 2 * parent as i64,
                    (true, Some(before)) => 2 * before as i64 + 1,
                    (false, _) => 2 * parent as i64 + 1,
                }
            }
        };
        raw.push(Raw { id: end, parent: Some(parent), position: at.end(), radius, line: at.line });
    }
    if n_moved > 0 {
        notes.push(format!(
            "cylinders that begin more than {APART} radii from both ends of what bears them: {n_moved}; each is joined to \
             the nearer end"
        ));
    }
    if raw.is_empty() {
        return Err(PlantFileError::Lacks("a tree of cylinders has one at least, this has none".into()));
    }
    let plant = rooted::plant(&raw, &mut notes)?;
    Ok(Measured { plant, notes })
}

fn cylinder(line: usize, row: &[f64]) -> Result<Cylinder, PlantFileError> {
    let wrong = |what: String| PlantFileError::Line { line, what };
    let [radius, length, sx, sy, sz, ax, ay, az, parent] = row[..] else {
        return Err(wrong(format!("wanted {} numbers, came {}", COLUMNS.len(), row.len())));
    };
    if !row.iter().all(|v| v.is_finite()) || radius <= 0.0 || length < 0.0 {
        return Err(wrong(format!(
            "a cylinder has a radius of more than 0 m and a length of 0 m or more, not of {} m and {} m",
            Brief(radius),
            Brief(length)
        )));
    }
    let size = ax.hypot(ay).hypot(az);
    if size <= 0.0 {
        return Err(wrong("an axis that points nowhere".into()));
    }
    if parent < 0.0 || parent.fract().abs() > 0.0 {
        return Err(wrong(format!("a parent is a whole number of 0 or more, not {}", Brief(parent))));
    }
    let axis = [ax / size, ay / size, az / size];
    Ok(Cylinder { radius, length, start: [sx, sy, sz], axis, parent: parent as usize, line })
}

impl Cylinder {
    fn end(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.start[k] + self.length * self.axis[k])
    }
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}
