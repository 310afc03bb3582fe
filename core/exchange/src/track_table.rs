//! The own long table of tracks, written row by row as CSV or Parquet.

use std::path::Path;

use crate::foreign::Format;
use crate::parquet::ParquetWriter;
use crate::rows::TrackRow;
use crate::table::{TableError, Writer};

/// A table of tracks being written; it takes its name in [`finish`](Self::finish).
#[derive(Debug)]
pub enum TrackTable {
    /// As CSV.
    Csv(Writer<TrackRow>),
    /// As Parquet.
    Parquet(ParquetWriter),
}

impl TrackTable {
    /// Starts the table `path`; `None` where the format is not the own table's.
    ///
    /// # Errors
    /// [`TableError::File`] when the folder cannot be written to.
    pub fn create(path: &Path, format: Format) -> Result<Option<Self>, TableError> {
        Ok(match format {
            Format::Csv => Some(Self::Csv(Writer::create(path)?)),
            Format::Parquet => Some(Self::Parquet(ParquetWriter::create(path)?)),
            _ => None,
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`TableError::NotFinite`] for a number that no table may hold, [`TableError::File`] on a full disk.
    pub fn write(&mut self, row: &TrackRow) -> Result<(), TableError> {
        match self {
            Self::Csv(table) => table.write(row),
            Self::Parquet(table) => table.write(row),
        }
    }

    /// Puts the whole table on the disk under its name, over what stood there.
    ///
    /// # Errors
    /// [`TableError::File`] on a full disk; what stood there before then still does.
    pub fn finish(self) -> Result<(), TableError> {
        match self {
            Self::Csv(table) => table.finish(),
            Self::Parquet(table) => table.finish(),
        }
    }
}
