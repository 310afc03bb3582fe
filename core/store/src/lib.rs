//! The project file: one SQLite database that holds everything but the pictures.
//!
//! A [`Project`] is open for writing in one session at a time; an advisory lock beside the file names the
//! holder, and others read. Edits are acknowledged only after SQLite's commit: a kill at any instant loses
//! nothing acknowledged. Results (runs, clusterings) never change once they have ended; undo is a tree that
//! survives restarts. A rollback journal, not a WAL: the file works on NFS and can be copied alone.

mod clustering;
mod codec;
mod error;
mod journal;
mod lock;
mod log;
mod matte;
mod media;
mod project;
mod run;
mod schema;
mod shown;
mod space;
mod step;
#[cfg(test)]
mod testing;

pub use clustering::{Clustering, ClusteringInfo, Grouping, Stale};
pub use error::StoreError;
pub use lock::{Claim, Holder};
pub use log::{LogItem, LogLine};
pub use matte::{KeptMatte, MatteInfo};
pub use media::ClipRecord;
pub use project::{Access, Project};
pub use run::{Build, RunHead, RunInfo, RunState, RunWriter, Seam};
pub use space::{Space, SpaceInfo};
pub use step::{KeptFile, Step};

/// The time now, UTC to the second, RFC 3339: the form of every date in a project.
#[must_use]
pub fn now() -> String {
    let now = jiff::Timestamp::now();
    jiff::Timestamp::from_second(now.as_second()).unwrap_or(now).to_string()
}
