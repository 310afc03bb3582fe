//! Tables in and out: tracks, points and truth as CSV with a header line, one row a sample; and tracks of other
//! programs in [`foreign`]; and dense motion in [`flo`].
//!
//! Columns are found by name, in any order; unknown ones are ignored. Numbers are written in the shortest
//! form that reads back to the same bits. A table is written beside its place and renamed when complete, so
//! what stands under its name is never half a table.
//!
//! ```
//! use honami_exchange::{PointRow, read, Writer};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("points.csv");
//! let mut table = Writer::create(&path)?;
//! table.write(&PointRow { id: 7, x: 12.25, y: 3.0, frame: Some(4) })?;
//! table.finish()?;
//! for row in read::<PointRow>(&path)? {
//!     assert_eq!(row?.x, 12.25);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod atomic;
pub mod c3d;
pub mod flo;
pub mod foreign;
pub mod glb;
pub mod mesh;
pub mod origin;
mod parquet;
pub mod plant;
pub mod rows;
pub mod skeleton;
mod space;
pub mod spans;
pub mod table;
mod track_table;
pub mod verdicts;
mod watch;

pub use atomic::{AtomicFile, is_begun_alike};
pub use parquet::ParquetWriter;
pub use rows::{GroupRow, PointRow, TrackRow, TruthRow, trust};
pub use space::SpaceRow;
pub use spans::spans;
pub use table::{Reader, Row, TableError, Writer, read};
pub use track_table::TrackTable;
pub use verdicts::{EffortRow, VerdictRow};
pub use watch::Watch;
