//! The long table of tracks as Parquet: the columns of the CSV table, typed, in groups of rows.
//!
//! Written with Snappy, which every reader has; read with Snappy, Zstandard or without compression, integers and
//! floats of either width, columns in any order. Unknown columns are passed over.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use crate::atomic::AtomicFile;
use crate::rows::{TrackRow, trust};
use crate::table::TableError;

pub(crate) use read::parse;

mod read;

/// The columns, as the manual has them.
const SCHEMA: &str = "message tracks {
    required int32 track (INTEGER(32, false));
    required int32 frame (INTEGER(32, false));
    optional double time_s;
    required float x;
    required float y;
    required int32 status (INTEGER(8, false));
    required binary source (STRING);
    optional float quality;
    optional float fb;
    optional float ncc;
    optional int64 run (INTEGER(64, false));
}";

/// Rows of a group: enough for every reader to work in parallel, few enough to hold.
const GROUP_ROWS: usize = 1 << 18;

/// A table being written; it takes its name in [`finish`](Self::finish) and leaves nothing behind before that.
pub struct ParquetWriter {
    file: SerializedFileWriter<AtomicFile>,
    rows: Vec<TrackRow>,
    n_rows: u64,
}

impl std::fmt::Debug for ParquetWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetWriter").field("path", &self.file.inner().path()).finish_non_exhaustive()
    }
}

impl ParquetWriter {
    /// Starts the table `path`.
    ///
    /// # Errors
    /// [`TableError::File`] when the folder cannot be written to.
    pub fn create(path: &Path) -> Result<Self, TableError> {
        let fail = |error| failed(path, error);
        let schema = Arc::new(parse_message_type(SCHEMA).map_err(fail)?);
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("honami ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let file = SerializedFileWriter::new(
            AtomicFile::create(path, |head| head.starts_with(b"PAR1"))?,
            schema,
            Arc::new(properties),
        );
        Ok(Self { file: file.map_err(fail)?, rows: Vec::new(), n_rows: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`TableError::NotFinite`] for a number that no table may hold, [`TableError::File`] on a full disk.
    pub fn write(&mut self, row: &TrackRow) -> Result<(), TableError> {
        self.n_rows += 1;
        let numbers = [
            ("time_s", row.time_s),
            ("x", Some(row.sample.x.into())),
            ("y", Some(row.sample.y.into())),
            ("fb", row.sample.quality.fb_px.map(f64::from)),
            ("ncc", row.sample.quality.ncc.map(f64::from)),
        ];
        if let Some((column, value)) =
            numbers.into_iter().find_map(|(name, v)| Some((name, v.filter(|v| !v.is_finite())?)))
        {
            let (path, line) = (self.file.inner().path().to_owned(), self.n_rows);
            return Err(TableError::NotFinite { path, line, column, value });
        }
        self.rows.push(*row);
        if self.rows.len() == GROUP_ROWS { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), TableError> {
        let path = self.file.inner().path().to_owned();
        let rows = std::mem::take(&mut self.rows);
        let mut written = || {
            let mut group = self.file.next_row_group()?;
            columns(&mut group, &rows)?;
            group.close()
        };
        written().map(drop).map_err(|error| failed(&path, error))
    }

    /// Puts the whole table on the disk under its name, over what stood there.
    ///
    /// # Errors
    /// [`TableError::File`] on a full disk; what stood there before then still does.
    pub fn finish(mut self) -> Result<(), TableError> {
        if !self.rows.is_empty() {
            self.flush()?;
        }
        let path = self.file.inner().path().to_owned();
        let mut file = self.file.into_inner().map_err(|error| failed(&path, error))?;
        file.flush().map_err(|source| TableError::File { path, source })?;
        file.finish()
    }
}

/// Writes the columns of a group, in the order of the schema.
fn columns<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    rows: &[TrackRow],
) -> Result<(), ParquetError> {
    let every = |of: &dyn Fn(&TrackRow) -> i32| rows.iter().map(of).map(Some).collect::<Vec<_>>();
    let float = |of: &dyn Fn(&TrackRow) -> Option<f32>| rows.iter().map(of).collect::<Vec<_>>();
    // Unsigned in the schema: the bits are kept.
    column::<Int32Type>(group, &every(&|row| row.track.0.cast_signed()))?;
    column::<Int32Type>(group, &every(&|row| row.frame.cast_signed()))?;
    column::<DoubleType>(group, &rows.iter().map(|row| row.time_s).collect::<Vec<_>>())?;
    column::<FloatType>(group, &float(&|row| Some(row.sample.x)))?;
    column::<FloatType>(group, &float(&|row| Some(row.sample.y)))?;
    column::<Int32Type>(group, &every(&|row| (row.sample.status as u8).into()))?;
    let source = |row: &TrackRow| Some(ByteArray::from(row.sample.source.word()));
    column::<ByteArrayType>(group, &rows.iter().map(source).collect::<Vec<_>>())?;
    column::<FloatType>(group, &float(&|row| trust(row.sample.quality)))?;
    column::<FloatType>(group, &float(&|row| row.sample.quality.fb_px))?;
    column::<FloatType>(group, &float(&|row| row.sample.quality.ncc))?;
    column::<Int64Type>(group, &rows.iter().map(|row| row.run.map(u64::cast_signed)).collect::<Vec<_>>())
}

fn column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    cells: &[Option<T::T>],
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("a column more than the schema has".to_owned()));
    };
    let there: Vec<i16> = cells.iter().map(|cell| cell.is_some().into()).collect();
    let values: Vec<T::T> = cells.iter().flatten().cloned().collect();
    column.typed::<T>().write_batch(&values, Some(&there), None)?;
    column.close()
}

fn failed(path: &Path, error: ParquetError) -> TableError {
    let source = match error {
        ParquetError::External(cause) => match cause.downcast::<std::io::Error>() {
            Ok(io) => *io,
            Err(other) => std::io::Error::other(other),
        },
        other => std::io::Error::other(other),
    };
    TableError::File { path: path.to_owned(), source }
}

#[cfg(test)]
mod tests;
