//! What can keep cameras from being known.

use std::path::PathBuf;

use honami_cameras::CameraError;

/// Why there are no cameras.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CamerasError {
    /// A picture that was given twice.
    #[error("{first} and {second} are one picture: every point is at the same place in both; give it once")]
    Same {
        /// The first of both.
        first: String,
        /// The second.
        second: String,
    },
    /// What was seen does not tell them.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// No picture shows the target.
    #[error("none of {n_pictures} pictures shows the whole target; of the first: {why}")]
    NotShown {
        /// Pictures there were.
        n_pictures: usize,
        /// What was wrong with the first.
        why: String,
    },
    /// One of the views is wrong.
    #[error("{source}: {name}")]
    View {
        /// Its file or frame.
        name: String,
        /// What is wrong with it.
        source: CameraError,
    },
    /// Two cameras that took other pictures.
    #[error(
        "the right camera took {right} pictures and the left one {left}: give the same moments of both, in the same order"
    )]
    Pairs {
        /// Pictures of the left one.
        left: usize,
        /// Pictures of the right one.
        right: usize,
    },
    /// Pictures of another camera.
    #[error("the camera's pictures have {}x{} pixels, the clip {}x{}: calibrate it as it films", wanted[0], wanted[1], came[0], came[1])]
    Size {
        /// The camera's.
        wanted: [u32; 2],
        /// The clip's.
        came: [u32; 2],
    },
    /// A file that has no cameras, or no target.
    #[error("{path}: {why}")]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}
