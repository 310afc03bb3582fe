//! What can be wrong with a file of another program.

use std::path::{Path, PathBuf};

use super::MAX_SAMPLES;
use crate::table::TableError;

/// What is wrong inside a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Flaw {
    /// Something is not what the format wants there.
    #[error("{at}: wanted {wanted}, came {came}")]
    Wrong {
        /// Where: `line 12, column x`.
        at: String,
        /// What the format has there.
        wanted: String,
        /// What stood there.
        came: String,
    },
    /// A track has two positions in one frame.
    #[error("track {track} has frame {frame} twice: each frame once is wanted")]
    Twice {
        /// Number or name of the track.
        track: String,
        /// The frame.
        frame: u32,
    },
    /// More than honami reads.
    #[error("more than {MAX_SAMPLES} samples: split the file")]
    TooMany,
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] std::io::Error),
}

/// The longest piece of a file that an error repeats, characters.
const MAX_CAME: usize = 60;

impl Flaw {
    pub(crate) fn wrong(at: impl Into<String>, wanted: impl Into<String>, came: &str) -> Self {
        let short: String = came.chars().take(MAX_CAME).collect();
        let came = if short.len() < came.len() { format!("`{short}…`") } else { format!("`{came}`") };
        Self::Wrong { at: at.into(), wanted: wanted.into(), came }
    }
}

/// Why a file of another program could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ForeignError {
    /// The file cannot be opened or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The own table of tracks is wrong.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The file is not what its format wants.
    #[error("{}: {flaw}", path.display())]
    Flaw {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        flaw: Flaw,
    },
    /// Nobody knows what it is.
    #[error(
        "{}: not recognised; say what it is with --format: {}",
        path.display(),
        super::Format::words().join(", ")
    )]
    Unknown {
        /// The file.
        path: PathBuf,
    },
}

impl ForeignError {
    pub(crate) fn file(path: &Path, source: std::io::Error) -> Self {
        Self::File { path: path.to_owned(), source }
    }
}
