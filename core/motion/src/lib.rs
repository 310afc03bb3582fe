//! From tracks to groups and frequencies: distances of movement, linkage, spectra. Pure: no IO, no clock.
//!
//! Positions are pixels, times seconds, angles radians. Sums over many terms are f64; the same input gives
//! the same bits for any number of threads and any SIMD level.

pub mod accuracy;
pub mod bod;
pub mod composite;
pub mod disagreement;
pub mod likeness;
pub mod linkage;
pub mod ncut;
pub mod overlay;
mod pool;
pub mod positions;
pub mod score;
pub mod spectrum;
pub mod swing;
pub mod welch;

pub use bod::{Bod, Table, denoised};
pub use composite::{Composite, composite};
pub use likeness::{Grouped, Likeness, grouped};
pub use linkage::{Criterion, linkage};
pub use ncut::{Ncut, ncut};
pub use positions::Positions;

/// Why tracks cannot be compared or grouped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A distance needs two.
    #[error("grouping needs at least 2 tracks, came {0}")]
    TooFewTracks(usize),
    /// A velocity needs two frames.
    #[error("movement needs at least 2 frames, came {0}")]
    TooFewFrames(usize),
    /// No two tracks were seen over the same step.
    #[error("no two tracks are seen in the same two consecutive frames; track longer, or pick others")]
    NeverTogether,
    /// The weights or the outlier factor are not what they can be.
    #[error("{name} must be a finite number, 0 or more, and not all weights 0; came {came}")]
    Option {
        /// The option.
        name: &'static str,
        /// Its value.
        came: f64,
    },
    /// The matrix of distances does not fit.
    #[error("the distances of {n_tracks} tracks need {bytes} bytes, more than there are; group fewer tracks")]
    Memory {
        /// Number of tracks.
        n_tracks: usize,
        /// Size of the condensed matrix.
        bytes: usize,
    },
    /// A list of distances is no condensed matrix.
    #[error("{n_tracks} tracks have {wanted} distances, came {came}")]
    Condensed {
        /// Number of tracks.
        n_tracks: usize,
        /// n (n - 1) / 2.
        wanted: usize,
        /// Length of the list.
        came: usize,
    },
    /// A distance is negative, NaN or infinite.
    #[error("distance {index} of the condensed matrix is {value}; wanted finite numbers, 0 or more")]
    Distance {
        /// Place in the matrix.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The caller stopped the work.
    #[error("stopped")]
    Stopped,
}
