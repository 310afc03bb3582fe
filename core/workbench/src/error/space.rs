//! What can keep two views of a plant from telling where it is.

use std::path::PathBuf;

use honami_cameras::CameraError;

/// Why two clips say nothing together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpaceError {
    /// One clip says nothing.
    #[error("{source}: {}", path.display())]
    Clip {
        /// The clip, or its project.
        path: PathBuf,
        /// Why.
        source: CameraError,
    },
    /// Both together say nothing.
    #[error("{source}: {} and {}", left.display(), right.display())]
    Both {
        /// The left project.
        left: PathBuf,
        /// The right one.
        right: PathBuf,
        /// Why.
        source: CameraError,
    },
    /// A project has no tracks to compare.
    #[error("no tracks: honami track finds some, --flash does without: {}", path.display())]
    NoTracks {
        /// The project.
        path: PathBuf,
    },
    /// A region in which nothing can be seen.
    #[error("no pixel of the clip, {}x{}, lies in the region {},{},{},{}: {}", size[0], size[1], region[0], region[1],
        region[2], region[3], path.display())]
    NoPixel {
        /// The clip, or its project.
        path: PathBuf,
        /// x, y, width, height, pixels.
        region: [f64; 4],
        /// Width and height of the clip.
        size: [u32; 2],
    },
}

impl SpaceError {
    /// Whether other options or numbers are wanted than were typed.
    #[must_use]
    pub fn is_as_typed(&self) -> bool {
        matches!(self, Self::NoPixel { .. })
    }
}
