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
    #[error("no tracks: honami track finds some: {}", path.display())]
    NoTracks {
        /// The project.
        path: PathBuf,
    },
    /// Cameras in a unit that nobody knows.
    #[error("{}: lengths have no unit; --unit mm says which, or calibrate with one, as --square 25mm", cameras.display())]
    NoUnit {
        /// The file of cameras.
        cameras: PathBuf,
    },
    /// A clip that the camera did not take.
    #[error(
        "{} is of {}x{} pixels, its camera in {} took pictures of {}x{}: calibrate with pictures of the clip's size",
        path.display(), came[0], came[1], cameras.display(), wanted[0], wanted[1]
    )]
    Size {
        /// The project.
        path: PathBuf,
        /// Width and height of its clip.
        came: [u32; 2],
        /// Those of the camera's pictures.
        wanted: [u32; 2],
        /// The file of cameras.
        cameras: PathBuf,
    },
    /// No two tracks are one feature.
    #[error(
        "none of {} left tracks is one of {} right ones: names that are the same in both say so, as does movement no farther than \
         {farthest_px} px from epipolar lines (--farthest) in 8 frames at least, by clocks that are not off (honami sync)",
        n[0], n[1]
    )]
    NoPairs {
        /// Tracks of either side.
        n: [usize; 2],
        /// How far from its line a track may be, pixels.
        farthest_px: f64,
    },
    /// No tracks in space.
    #[error("no tracks in space are shown: honami triangulate finds them: {}", path.display())]
    NoSpace {
        /// The project.
        path: PathBuf,
    },
    /// No C3D file.
    #[error(transparent)]
    C3d(#[from] honami_exchange::c3d::C3dError),
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
        matches!(self, Self::NoPixel { .. } | Self::NoUnit { .. })
    }
}
