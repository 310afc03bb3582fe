//! Tables of places over time, of tracks and of sensors alike, and of wind.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use honami_cameras::Place;

use super::{FEWEST, Record};
use crate::error::{SensorsError, WorkbenchError};
use crate::sways::table::{TIMES, cells, number};

/// Heads of a column that says whose row it is.
const WHOSE: [&str; 3] = ["marker", "sensor", "track"];

/// Values of a wind over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Wind {
    /// What it is called.
    pub name: String,
    /// Seconds by the sensors' clock.
    pub times_s: Vec<f64>,
    /// As recorded.
    pub values: Vec<f64>,
}

/// Places of a table, metres: a row a sample (`marker,time_s,x,y,z`; also of `sensor` or `track`, and `x_m`), or a row a time
/// (`time_s,NAME_x,NAME_y,NAME_z, …`). Empty cells, and `nan`, are gaps.
///
/// # Errors
/// [`SensorsError::Table`] with the line.
pub fn records(path: &Path) -> Result<Vec<Record>, WorkbenchError> {
    let wrong = |what: String| SensorsError::Table { path: path.to_owned(), what };
    let table = Table::read(path)?;
    let mut samples = BTreeMap::<(usize, String), Vec<(f64, Place)>>::new();
    if let Some(whose) = WHOSE.iter().find_map(|name| table.column(&[name])) {
        let time = table.time().map_err(wrong)?;
        let axes = table.axes("").ok_or_else(|| {
            wrong("wanted columns x, y and z (or x_m, y_m, z_m) in metres beside the one of names".to_owned())
        })?;
        for row in 0..table.rows.len() {
            if let Some(place) = table.place(row, axes).map_err(wrong)? {
                let t = table.number(row, time).map_err(wrong)?;
                let t = t.ok_or_else(|| wrong(format!("line {}: it has no time", table.rows[row].0)))?;
                let name = table.rows[row].1[whose].clone();
                samples.entry((0, name)).or_default().push((t, place));
            }
        }
    } else {
        let time = table.time().map_err(wrong)?;
        let names = table
            .heads
            .iter()
            .filter_map(|head| head.strip_suffix("_x").or_else(|| head.strip_suffix("_x_m")));
        let names: Vec<String> = names.map(str::to_owned).collect();
        for (order, name) in names.iter().enumerate() {
            let axes = table.axes(&format!("{name}_"));
            let axes =
                axes.ok_or_else(|| wrong(format!("{name}_x has no {name}_y and {name}_z beside it")))?;
            for row in 0..table.rows.len() {
                if let (Some(t), Some(place)) =
                    (table.number(row, time).map_err(wrong)?, table.place(row, axes).map_err(wrong)?)
                {
                    samples.entry((order, name.clone())).or_default().push((t, place));
                }
            }
        }
    }
    if samples.is_empty() {
        return Err(wrong(
            "wanted marker,time_s,x,y,z, a row a sample, or time_s,NAME_x,NAME_y,NAME_z, a row a time"
                .to_owned(),
        )
        .into());
    }
    let record = |((_, name), samples): ((usize, String), Vec<(f64, Place)>)| {
        if samples.len() < FEWEST {
            return Err(
                wrong(format!("{name}: wanted {FEWEST} samples or more, came {}", samples.len())).into()
            );
        }
        if let Some(pair) = samples.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return Err(
                wrong(format!("{name}: its time, {} s, is not after the one before", pair[1].0)).into()
            );
        }
        let (times_s, places) = samples.into_iter().unzip();
        Ok(Record { name, times_s, places })
    };
    samples.into_iter().map(record).collect()
}

/// Columns of wind over time.
///
/// # Errors
/// [`SensorsError::Table`] with the line.
pub fn wind(path: &Path) -> Result<Vec<Wind>, WorkbenchError> {
    let wrong = |what: String| SensorsError::Table { path: path.to_owned(), what };
    let table = Table::read(path)?;
    let time = table.time().map_err(wrong)?;
    let mut winds = Vec::new();
    for column in (0..table.heads.len()).filter(|column| *column != time) {
        let mut wind = Wind { name: table.heads[column].clone(), times_s: Vec::new(), values: Vec::new() };
        for row in 0..table.rows.len() {
            if let (Some(t), Some(value)) =
                (table.number(row, time).map_err(wrong)?, table.number(row, column).map_err(wrong)?)
            {
                wind.times_s.push(t);
                wind.values.push(value);
            }
        }
        winds.push(wind);
    }
    Ok(winds)
}

/// Cells under heads.
struct Table {
    heads: Vec<String>,
    /// The line of each row, from 1, and its cells.
    rows: Vec<(usize, Vec<String>)>,
}

impl Table {
    fn read(path: &Path) -> Result<Self, WorkbenchError> {
        let wrong = |what: String| SensorsError::Table { path: path.to_owned(), what };
        let text = fs::read_to_string(path).map_err(|source| WorkbenchError::Io {
            what: "cannot read the table",
            source,
            path: path.to_owned(),
        })?;
        let is_row =
            |(_, text): &(usize, &str)| !text.trim().is_empty() && !text.trim_start().starts_with('#');
        let mut lines = (1..).zip(text.lines()).filter(is_row);
        let (_, head) = lines.next().ok_or_else(|| wrong("it has no rows".to_owned()))?;
        let heads: Vec<String> = cells(head).map(str::to_owned).collect();
        let mut rows = Vec::new();
        for (line, text) in lines {
            let row: Vec<String> = cells(text).map(str::to_owned).collect();
            if row.len() != heads.len() {
                let (came, wanted) = (row.len(), heads.len());
                return Err(
                    wrong(format!("line {line}: wanted {wanted} cells as in the head, came {came}")).into()
                );
            }
            rows.push((line, row));
        }
        Ok(Self { heads, rows })
    }

    fn column(&self, names: &[&str]) -> Option<usize> {
        self.heads.iter().position(|head| names.iter().any(|name| head.eq_ignore_ascii_case(name)))
    }

    fn time(&self) -> Result<usize, String> {
        self.column(&TIMES).ok_or_else(|| "wanted a column time_s, came none".to_owned())
    }

    /// The columns of x, y and z after a name.
    fn axes(&self, before: &str) -> Option<[usize; 3]> {
        let axis = |axis: &str| self.column(&[&format!("{before}{axis}"), &format!("{before}{axis}_m")]);
        Some([axis("x")?, axis("y")?, axis("z")?])
    }

    /// A number; `None` where there is none.
    fn number(&self, row: usize, column: usize) -> Result<Option<f64>, String> {
        let (line, cells) = &self.rows[row];
        let cell = cells[column].as_str();
        if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
            return Ok(None);
        }
        let value = number(cell);
        value
            .map(Some)
            .ok_or_else(|| format!("line {line}, column {}: wanted a number, came {cell:?}", column + 1))
    }

    fn place(&self, row: usize, axes: [usize; 3]) -> Result<Option<Place>, String> {
        let [x, y, z] = [self.number(row, axes[0])?, self.number(row, axes[1])?, self.number(row, axes[2])?];
        Ok(x.zip(y).zip(z).map(|((x, y), z)| Place::new(x, y, z)))
    }
}
