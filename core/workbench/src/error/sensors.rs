//! What can keep tracks from being compared with what sensors have recorded.

use std::path::PathBuf;

use honami_cameras::CameraError;

/// Why tracks and sensors say nothing together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SensorsError {
    /// A file is no table of places, or of wind.
    #[error("{}: {what}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// Two clocks could not be brought together.
    #[error("no offset of the clocks brings tracks and sensors together: {0}; --offset SECONDS gives it")]
    Clock(CameraError),
    /// They are never there at once.
    #[error(
        "at an offset of {offset_s:.3} s tracks and sensors are never seen at the same time: tracks last from {} to {} s, sensors \
         from {} to {} s by their own clock",
        tracks_s[0], tracks_s[1], sensors_s[0], sensors_s[1]
    )]
    Apart {
        /// Of the sensors' clock, seconds.
        offset_s: f64,
        /// First and last time of tracks.
        tracks_s: [f64; 2],
        /// First and last time of sensors.
        sensors_s: [f64; 2],
    },
    /// No turn brings them together.
    #[error("the axes of tracks and sensors cannot be brought together: {0}")]
    Axes(CameraError),
    /// A height that is none.
    #[error("a plant's height is a number of metres above 0, not {0}")]
    Height(f64),
}
