//! Tracks in space: where features are, metres, as two cameras see them.
//!
//! Axes are those of the left camera: x right, y down, z forward, from where it stands.

use serde::{Deserialize, Serialize};

use crate::track::TrackId;

/// Number of tracks in space that were found together: one use of `triangulate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SpaceId(pub u32);

impl std::fmt::Display for SpaceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Where a feature is in a frame, and how well that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// The frame of the left clip, whose time is the fix's.
    pub frame: u32,
    /// x, y, z, metres; finite.
    pub place_m: [f64; 3],
    /// Standard errors along x, y and z, metres.
    pub errors_m: [f32; 3],
    /// How far what both cameras see is from one place: root mean square over both pictures, pixels.
    pub residual_px: f32,
}

/// A track in space: two tracks that are one feature, seen by two cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceTrack {
    /// The left project's, which names it.
    pub track: TrackId,
    /// The right project's.
    pub right: TrackId,
    /// Where it is in those frames in which both cameras see it, in order.
    pub fixes: Vec<Fix>,
}
