//! The one door for CSV tables: typed rows, errors with line numbers, atomic writing.

use std::fs::File;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::atomic::AtomicFile;
use crate::watch::{Watch, Watched};

/// Why a table could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file cannot be opened, read, or written.
    #[error("{path}: {source}", path = path.display())]
    File {
        /// The table.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something stands there that must not be lost.
    #[error("{path} is {what}, and honami does not write over it: choose another name", path = path.display())]
    Precious {
        /// The file.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// A file stands there that would not have been written so.
    #[error(
        "{path} is there already and is another kind of file: honami writes over its own only; choose another name",
        path = path.display()
    )]
    Unlike {
        /// The file.
        path: PathBuf,
    },
    /// The text is not CSV: uneven rows, or not UTF-8.
    #[error("{path}: not a CSV table: {source}", path = path.display())]
    Csv {
        /// The table.
        path: PathBuf,
        /// What the reader said, with its line.
        source: csv::Error,
    },
    /// A column that every such table has is missing.
    #[error("{path} line 1: wanted the columns {wanted}; `{missing}` is missing from `{came}`", path = path.display())]
    Column {
        /// The table.
        path: PathBuf,
        /// The missing column.
        missing: &'static str,
        /// The columns that are needed.
        wanted: String,
        /// The header line.
        came: String,
    },
    /// A field does not hold what its column holds.
    #[error("{path} line {line}, column `{column}`: wanted {wanted}, came `{came}`", path = path.display())]
    Field {
        /// The table.
        path: PathBuf,
        /// Line of the row, from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// What the column holds.
        wanted: &'static str,
        /// What stood there.
        came: String,
    },
    /// A number to be written is NaN or infinite.
    #[error("{path} line {line}: column `{column}` would be {value}; only finite numbers are written", path = path.display())]
    NotFinite {
        /// The table.
        path: PathBuf,
        /// Line it would have had, from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// The number.
        value: f64,
    },
    /// A row lies beyond the clip.
    #[error("track {track} has a row for frame {frame}, but the clip has {n_frames} frames (0 the first)")]
    Frame {
        /// The track.
        track: honami_model::track::TrackId,
        /// The frame.
        frame: u32,
        /// Number of frames of the clip.
        n_frames: u32,
    },
}

/// A row of one kind of table.
pub trait Row: Sized {
    /// Names of the columns, in the order in which they are written.
    const COLUMNS: &'static [&'static str];
    /// Columns without which a table cannot be read.
    const NEEDED: &'static [&'static str];

    /// Takes the row from its fields.
    ///
    /// # Errors
    /// [`TableError::Field`] for a field that does not hold what its column holds.
    fn parse(fields: &Fields<'_>) -> Result<Self, TableError>;

    /// Puts the fields, one call a column, in the order of [`Row::COLUMNS`].
    fn put(&self, line: &mut Line);
}

/// The fields of one row by column name.
#[derive(Debug)]
pub struct Fields<'a> {
    path: &'a Path,
    line: u64,
    record: &'a csv::StringRecord,
    columns: &'a [(&'static str, Option<usize>)],
}

impl Fields<'_> {
    /// The text of a column; `None` where it is empty or the table does not have it.
    #[must_use]
    pub fn text(&self, column: &'static str) -> Option<&str> {
        let place = self.columns.iter().find(|(name, _)| *name == column)?.1?;
        self.record.get(place).map(str::trim).filter(|text| !text.is_empty())
    }

    /// The value of a column, if there is one.
    ///
    /// # Errors
    /// [`TableError::Field`] when `parse` has no value for the text; `wanted` says what would have been one.
    pub fn optional<T>(
        &self,
        column: &'static str,
        wanted: &'static str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, TableError> {
        let Some(text) = self.text(column) else { return Ok(None) };
        parse(text).map(Some).ok_or_else(|| self.wrong(column, wanted, text))
    }

    /// The value of a column that may not be empty.
    ///
    /// # Errors
    /// [`TableError::Field`] as for [`Fields::optional`], and for an empty field.
    pub fn required<T>(
        &self,
        column: &'static str,
        wanted: &'static str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<T, TableError> {
        self.optional(column, wanted, parse)?.ok_or_else(|| self.wrong(column, wanted, ""))
    }

    fn wrong(&self, column: &'static str, wanted: &'static str, came: &str) -> TableError {
        TableError::Field { path: self.path.into(), line: self.line, column, wanted, came: came.into() }
    }
}

/// A whole number of 0 or more.
pub(crate) fn whole<T: FromStr>(text: &str) -> Option<T> {
    text.parse().ok()
}

/// A finite number.
pub(crate) fn finite<T: FromStr + Copy + Into<f64>>(text: &str) -> Option<T> {
    text.parse::<T>().ok().filter(|&number| number.into().is_finite())
}

/// Opens a table for reading, row by row.
///
/// # Errors
/// [`TableError`] when the file cannot be opened or a needed column is missing.
pub fn read<R: Row>(path: &Path) -> Result<Reader<R>, TableError> {
    let file = File::open(path).map_err(|source| TableError::File { path: path.into(), source })?;
    read_from(path, Watched { file, watch: Watch::default() })
}

/// [`read`] of a file that is open and watched.
pub(crate) fn read_from<R: Row>(path: &Path, file: Watched) -> Result<Reader<R>, TableError> {
    let mut csv = csv::ReaderBuilder::new().trim(csv::Trim::Headers).from_reader(file);
    let header = csv.headers().map_err(|source| csv_error(path, source))?.clone();
    let place_of = |name: &str| header.iter().position(|title| title.trim_start_matches('\u{feff}') == name);
    if let Some(&missing) = R::NEEDED.iter().find(|name| place_of(name).is_none()) {
        let came = header.iter().collect::<Vec<_>>().join(",");
        return Err(TableError::Column { path: path.into(), missing, wanted: R::NEEDED.join(","), came });
    }
    let columns = R::COLUMNS.iter().map(|&name| (name, place_of(name))).collect();
    Ok(Reader {
        path: path.into(),
        csv,
        columns,
        record: csv::StringRecord::new(),
        ended: false,
        rows: PhantomData,
    })
}

/// The rows of an open table. A wrong field costs its row; what is no CSV any more ends the reading.
#[derive(Debug)]
pub struct Reader<R> {
    path: PathBuf,
    csv: csv::Reader<Watched>,
    columns: Vec<(&'static str, Option<usize>)>,
    record: csv::StringRecord,
    ended: bool,
    rows: PhantomData<R>,
}

impl<R: Row> Iterator for Reader<R> {
    type Item = Result<R, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        match self.csv.read_record(&mut self.record) {
            Ok(false) => None,
            Ok(true) => {
                let line = self.record.position().map_or(0, csv::Position::line);
                let fields = Fields { path: &self.path, line, record: &self.record, columns: &self.columns };
                Some(R::parse(&fields))
            }
            Err(source) => {
                self.ended = true;
                Some(Err(csv_error(&self.path, source)))
            }
        }
    }
}

fn csv_error(path: &Path, source: csv::Error) -> TableError {
    if !source.is_io_error() {
        return TableError::Csv { path: path.into(), source };
    }
    TableError::File { path: path.into(), source: source.into() }
}

/// The fields of a row on their way out.
#[derive(Debug, Default)]
pub struct Line {
    text: String,
    column: usize,
    not_finite: Option<(usize, f64)>,
}

impl Line {
    /// A field as it prints; it may hold no comma, quote or line break.
    pub fn put(&mut self, value: impl std::fmt::Display) {
        use std::fmt::Write as _;
        if self.column > 0 {
            self.text.push(',');
        }
        self.column += 1;
        // Writing to a string cannot fail.
        write!(self.text, "{value}").unwrap_or_default();
    }

    /// A text of any kind, in quotes where it needs them.
    pub fn text(&mut self, text: &str) {
        if text.contains([',', '"', '\n', '\r']) {
            self.put(format_args!("\"{}\"", text.replace('"', "\"\"")));
        } else {
            self.put(text);
        }
    }

    /// A number, in the shortest form that reads back to the same bits.
    pub fn number<T: std::fmt::Display + Copy + Into<f64>>(&mut self, value: T) {
        if !value.into().is_finite() {
            self.not_finite = Some((self.column, value.into()));
        }
        self.put(value);
    }

    /// A number, or nothing.
    pub fn maybe<T: std::fmt::Display + Copy + Into<f64>>(&mut self, value: Option<T>) {
        match value {
            Some(value) => self.number(value),
            None => self.put(""),
        }
    }
}

/// A table being written; it takes its name in [`Writer::finish`] and leaves nothing behind before that.
#[derive(Debug)]
pub struct Writer<R> {
    file: AtomicFile,
    line: Line,
    n_lines: u64,
    rows: PhantomData<R>,
}

impl<R: Row> Writer<R> {
    /// Starts the table `path` and writes its header; in place of a table of the same columns.
    ///
    /// # Errors
    /// As [`AtomicFile::create`].
    pub fn create(path: &Path) -> Result<Self, TableError> {
        let columns = R::COLUMNS.join(",");
        let is_alike = |head: &[u8]| {
            let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
            line.trim_ascii_end() == columns.as_bytes()
        };
        let file = AtomicFile::create(path, is_alike)?;
        let mut writer = Self { file, line: Line::default(), n_lines: 0, rows: PhantomData };
        R::COLUMNS.iter().for_each(|name| writer.line.put(name));
        writer.end_line()?;
        Ok(writer)
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`TableError::NotFinite`] for a number that no table may hold, [`TableError::File`] on a full disk.
    pub fn write(&mut self, row: &R) -> Result<(), TableError> {
        row.put(&mut self.line);
        self.end_line()
    }

    fn end_line(&mut self) -> Result<(), TableError> {
        use std::io::Write as _;
        debug_assert_eq!(self.line.column, R::COLUMNS.len(), "one field a column");
        self.n_lines += 1;
        if let Some((column, value)) = self.line.not_finite {
            let column = R::COLUMNS[column];
            return Err(TableError::NotFinite { path: self.path(), line: self.n_lines, column, value });
        }
        self.line.text.push('\n');
        let written = self.file.write_all(self.line.text.as_bytes());
        self.line.text.clear();
        self.line.column = 0;
        written.map_err(|source| TableError::File { path: self.path(), source })
    }

    fn path(&self) -> PathBuf {
        self.file.path().to_owned()
    }

    /// Puts the whole table on the disk under its name, over what stood there.
    ///
    /// # Errors
    /// [`TableError::File`] on a full disk; what stood there before then still does.
    pub fn finish(self) -> Result<(), TableError> {
        self.file.finish()
    }
}

#[cfg(test)]
mod tests;
