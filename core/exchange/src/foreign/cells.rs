//! Rows of comma-separated cells, by their place; errors name line and column.

use std::io::Read;

use super::Flaw;

/// An open file of rows.
pub(crate) struct Cells<R> {
    csv: csv::Reader<R>,
    record: csv::StringRecord,
}

/// A row.
#[derive(Clone, Copy)]
pub(crate) struct Cell<'a> {
    pub(crate) line: u64,
    record: &'a csv::StringRecord,
}

impl<R: Read> Cells<R> {
    pub(crate) fn new(reader: R) -> Self {
        let csv = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(reader);
        Self { csv, record: csv::StringRecord::new() }
    }

    /// The next row that is not empty.
    pub(crate) fn next(&mut self) -> Result<Option<Cell<'_>>, Flaw> {
        match self.csv.read_record(&mut self.record) {
            Ok(true) => {
                let line = self.record.position().map_or(0, csv::Position::line);
                Ok(Some(Cell { line, record: &self.record }))
            }
            Ok(false) => Ok(None),
            Err(error) if error.is_io_error() => Err(Flaw::Read(error.into())),
            Err(error) => Err(Flaw::wrong("table", "comma-separated UTF-8 text", &error.to_string())),
        }
    }

    /// A row that must be there.
    pub(crate) fn need(&mut self, wanted: &str) -> Result<Vec<String>, Flaw> {
        let row = self.next()?.ok_or_else(|| Flaw::wrong("table", wanted, "the end of the file"))?;
        Ok(row.words().map(|word| word.trim_start_matches('\u{feff}').to_owned()).collect())
    }
}

impl<'a> Cell<'a> {
    /// The text of a cell; empty beyond the last.
    pub(crate) fn text(&self, column: usize) -> &'a str {
        self.record.get(column).unwrap_or_default()
    }

    pub(crate) fn words(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.record.iter()
    }

    pub(crate) fn n_columns(&self) -> usize {
        self.record.len()
    }

    /// A number; `None` where the cell is empty or says NaN.
    pub(crate) fn number(&self, column: usize, title: &str) -> Result<Option<f64>, Flaw> {
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        match text.parse::<f64>() {
            Ok(number) if number.is_nan() => Ok(None),
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(self.wrong(title, "a finite number, nothing or NaN", text)),
        }
    }

    pub(crate) fn wrong(&self, title: &str, wanted: &str, came: &str) -> Flaw {
        Flaw::wrong(format!("line {}, column {title}", self.line), wanted, came)
    }

    /// A position whose axes stand in two cells; `None` where both are missing.
    pub(crate) fn position(&self, columns: [usize; 2], titles: [&str; 2]) -> Result<Option<[f64; 2]>, Flaw> {
        let [x, y] = [self.number(columns[0], titles[0])?, self.number(columns[1], titles[1])?];
        match (x, y) {
            (Some(x), Some(y)) => Ok(Some([x, y])),
            (None, None) => Ok(None),
            (Some(_), None) => Err(self.wrong(titles[1], "a number where there is an x", "nothing")),
            (None, Some(_)) => Err(self.wrong(titles[0], "a number where there is a y", "nothing")),
        }
    }
}

/// A position as samples hold it; `None` where f32 cannot.
pub(crate) fn narrow(at: [f64; 2]) -> Option<[f32; 2]> {
    Some(at.map(|v| v as f32)).filter(|at| at.iter().all(|v| v.is_finite()))
}
