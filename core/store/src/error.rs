//! What can go wrong with a project file, by what the caller can do about it.

use std::path::PathBuf;

use honami_model::document::{ClusteringId, MatteId, RunId};
use honami_model::edit::EditError;
use honami_model::history::EntryId;
use honami_model::space::SpaceId;
use honami_model::track::TrackId;
use rusqlite::ffi;

use crate::lock::Holder;

/// Why the store could not do what it was asked to. Nothing is half done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The file is there but is no project.
    #[error("not a honami project; give a .honami file, or make one with `honami new`: {0}")]
    NotAProject(PathBuf),
    /// A later honami wrote it.
    #[error("the project has schema {came}, this honami knows up to {known}; update honami: {path}")]
    Newer {
        /// Schema of the file.
        came: u32,
        /// Newest schema this program knows.
        known: u32,
        /// The file.
        path: PathBuf,
    },
    /// An earlier honami wrote it, and this session may not bring it up.
    #[error("the project has schema {came}, this honami {known}; open it once for writing: {path}")]
    Older {
        /// Schema of the file.
        came: u32,
        /// Schema this program reads.
        known: u32,
        /// The file.
        path: PathBuf,
    },
    /// Another session writes to it.
    #[error(
        "the project is open for writing by {}; close it there, or look at it meanwhile with `honami {path}`",
        holder.as_ref().map_or_else(|| "another session".to_owned(), ToString::to_string)
    )]
    Locked {
        /// Who holds it, where the lock file says so.
        holder: Option<Holder>,
        /// The file.
        path: PathBuf,
    },
    /// A project is never overwritten.
    #[error("the file exists already; choose another name or remove it: {0}")]
    Exists(PathBuf),
    /// The session may only read.
    #[error("the project is open read-only; open it for writing to change it")]
    ReadOnly,
    /// The edit cannot be done; nothing changed.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// There is no such run.
    #[error("there is no run {0} in this project")]
    NoSuchRun(RunId),
    /// The run still works.
    #[error("run {0} still works; wait until it ends, or stop it")]
    RunWorks(RunId),
    /// A run may only be shown on tracks it has samples of.
    #[error("run {run} has no samples of track {track}")]
    NotInRun {
        /// The run.
        run: RunId,
        /// The first such track.
        track: TrackId,
    },
    /// There are no such tracks in space.
    #[error("there are no tracks in space of the number {0} in this project")]
    NoSuchSpace(SpaceId),
    /// There is no such clustering.
    #[error("there is no clustering {0} in this project")]
    NoSuchClustering(ClusteringId),
    /// There is no such matte.
    #[error("there is no matte {0} in this project")]
    NoSuchMatte(MatteId),
    /// The clustering cannot be kept.
    #[error("a dendrogram of {leaves} leaves cannot group {tracks} tracks")]
    Clustering {
        /// Leaves of the dendrogram.
        leaves: u32,
        /// Tracks given.
        tracks: usize,
    },
    /// The matte cannot be kept.
    #[error("a plane of a matte has a byte for each of {wanted} pixels, not {came}")]
    Planes {
        /// Pixels.
        wanted: u64,
        /// Bytes given.
        came: usize,
    },
    /// There is no such entry in the history.
    #[error("there is no entry {0} in the history")]
    NoSuchEntry(EntryId),
    /// Track numbers are used once.
    #[error("track {0} is in use or was; numbers from {1} on are free")]
    TrackTaken(TrackId, u32),
    /// A sample's position is NaN or infinite.
    #[error("track {track}: the position at frame {frame} is not finite; the tracker must not return it")]
    NotFinite {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// The clip is neither where it was nor beside the project.
    #[error(
        "the clip is not where it was nor beside the project, as {}; say where it is now: {}",
        path.file_name().map_or_else(|| path.display().to_string(), |name| name.display().to_string()),
        path.display()
    )]
    MediaMissing {
        /// Where it was.
        path: PathBuf,
    },
    /// A file of that name has other content.
    #[error("the file is not the project's clip: wanted SHA-256 {wanted:.12}…, came {came:.12}…: {path}")]
    MediaDiffers {
        /// Hash of the clip.
        wanted: String,
        /// Hash of the file.
        came: String,
        /// The file.
        path: PathBuf,
    },
    /// The disk is full.
    #[error("the disk is full; nothing was changed, free some space and repeat")]
    DiskFull,
    /// The disk did not take what was written, though it has room: a quota, or a limit of how large files may be.
    #[error(
        "the disk refuses to take more of the project ({0}), by a quota or a limit; nothing was changed, make room and repeat"
    )]
    Refused(rusqlite::Error),
    /// The file has another name now, or none, and what this session would write would be lost.
    #[error(
        "the project was moved, removed or replaced while it was open; nothing was changed, open it where it is now"
    )]
    Moved,
    /// Another session kept the file busy.
    #[error("the project was busy for {} s; repeat", crate::schema::BUSY_TIMEOUT.as_secs())]
    Busy,
    /// The file is damaged.
    #[error("the project is damaged ({0}); go back to a copy, or keep this file for repair")]
    Corrupt(String),
    /// A file could not be used.
    #[error("{what}: {source}: {path}")]
    Io {
        /// What was wanted.
        what: &'static str,
        /// What came.
        source: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// SQLite refused for another reason.
    #[error("the project file could not be used: {0}")]
    Sqlite(rusqlite::Error),
}

impl StoreError {
    pub(crate) fn corrupt(why: impl std::fmt::Display) -> Self {
        Self::Corrupt(why.to_string())
    }
}

impl From<rusqlite::Error> for StoreError {
    fn from(error: rusqlite::Error) -> Self {
        use rusqlite::ErrorCode as Code;
        if matches!(error, rusqlite::Error::QueryReturnedNoRows) {
            return Self::corrupt("a row that every project has is missing");
        }
        match error.sqlite_error().map(|error| error.extended_code) {
            Some(ffi::SQLITE_IOERR_WRITE) => return Self::Refused(error),
            Some(ffi::SQLITE_READONLY_DBMOVED) => return Self::Moved,
            _ => {}
        }
        match error.sqlite_error_code() {
            Some(Code::DiskFull) => Self::DiskFull,
            Some(Code::DatabaseBusy | Code::DatabaseLocked) => Self::Busy,
            Some(Code::DatabaseCorrupt | Code::NotADatabase) => Self::corrupt(error),
            Some(Code::ReadOnly) => Self::ReadOnly,
            _ => Self::Sqlite(error),
        }
    }
}
