//! Plants as others have measured them, in.

pub mod anemometer;
mod beam_table;
mod glb;
pub mod mtg;
mod point_cache;
pub mod qsm;
mod rooted;
mod sway_table;
pub mod swc;

pub use beam_table::BeamRow;
pub use glb::{Body, GlbError, Placed, Sizes, Target, write_glb};
pub use point_cache::{PointCache, PointCacheError};
pub use sway_table::SwayRow;

use honami_model::plant::{Plant, PlantError};
use std::path::{Path, PathBuf};

/// A plant that was read, and what was done to make it one.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Metres.
    pub plant: Plant,
    /// What was dropped or guessed, a sentence each; empty where all was as it should be.
    pub notes: Vec<String>,
}

/// Why a file is no plant.
#[derive(Debug, thiserror::Error)]
pub enum PlantFileError {
    /// It cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A line of it is not what it must be.
    #[error("line {line}: {what}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What was wanted, and what came.
        what: String,
    },
    /// It lacks something that every such file has.
    #[error("{0}")]
    Lacks(String),
    /// None of the classes of parts that were asked for occurs.
    #[error("no part is of class {wanted}: there are {}", there.join(", "))]
    Classes {
        /// The first that does not.
        wanted: String,
        /// Those that do, with how many parts are of each.
        there: Vec<String>,
    },
    /// What is in it is no plant.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// In which file.
    #[error("{}: {source}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<PlantFileError>,
    },
}

impl PlantFileError {
    /// The same, with the file.
    #[must_use]
    pub fn of(self, path: &Path) -> Self {
        Self::In { path: path.to_owned(), source: Box::new(self) }
    }

    /// Whether other options would do: the file is a plant.
    #[must_use]
    pub fn is_as_typed(&self) -> bool {
        match self {
            Self::Classes { .. } => true,
            Self::In { source, .. } => source.is_as_typed(),
            Self::Io { .. } | Self::Line { .. } | Self::Lacks(_) | Self::Plant(_) => false,
        }
    }
}
