//! Tracks: a feature's positions over frames, each with status, source and quality.

use serde::{Deserialize, Serialize};

pub use set::{TrackSet, TrackSetError};

mod set;

/// Number of a track; unique in a project, never used twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TrackId(pub u32);

impl std::fmt::Display for TrackId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// What is known of a feature in one frame. The numbers are those of the ABI and of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Status {
    /// The tracker has lost it; the position is its last guess.
    Lost = 0,
    /// Seen and followed.
    Tracked = 1,
    /// Hidden; the position is predicted.
    Occluded = 2,
    /// Has left the picture.
    Outside = 3,
    /// Judged wrong.
    Rejected = 4,
    /// A particle of limited life, born in this frame.
    Newborn = 5,
}

impl Status {
    /// The status with this number.
    #[must_use]
    pub fn from_u8(n: u8) -> Option<Self> {
        [Self::Lost, Self::Tracked, Self::Occluded, Self::Outside, Self::Rejected, Self::Newborn]
            .into_iter()
            .find(|s| *s as u8 == n)
    }

    /// Whether the position is a measurement: tracked or newborn.
    #[must_use]
    pub fn is_seen(self) -> bool {
        matches!(self, Self::Tracked | Self::Newborn)
    }
}

/// Where a sample came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Source {
    /// Set or confirmed by a person.
    Key = 0,
    /// Drawn by hand while the clip played.
    Sketch = 1,
    /// Found by a tracker.
    Tracked = 2,
    /// Computed: between two key-frames, or as the mean of several tracks.
    Interpolated = 3,
    /// Read from somebody else's file.
    Imported = 4,
}

impl Source {
    /// The word used in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Key => "key",
            Self::Sketch => "sketch",
            Self::Tracked => "tracked",
            Self::Interpolated => "interpolated",
            Self::Imported => "imported",
        }
    }
}

/// How far a sample can be trusted; a part that was not measured is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Forward-backward error of the step that led here, pixels.
    pub fb_px: Option<f32>,
    /// Normalised cross-correlation with the template, -1..=1.
    pub ncc: Option<f32>,
}

/// A track in one frame. Positions are finite, also where the feature is lost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// What is known of the feature here.
    pub status: Status,
    /// Where the position came from.
    pub source: Source,
    /// How far to trust it.
    pub quality: Quality,
}

/// Consecutive samples of one track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Span {
    /// Frame of the first sample.
    pub first_frame: u32,
    /// One sample a frame, without gaps.
    pub samples: Vec<Sample>,
}

impl Span {
    /// The sample in a frame, if the span covers it.
    #[must_use]
    pub fn get(&self, frame: u32) -> Option<&Sample> {
        self.samples.get(frame.checked_sub(self.first_frame)? as usize)
    }

    /// The frames it covers.
    #[must_use]
    pub fn frames(&self) -> std::ops::Range<u32> {
        let n_frames = u32::try_from(self.samples.len()).unwrap_or(u32::MAX);
        self.first_frame..self.first_frame.saturating_add(n_frames)
    }
    /// A number that changes when a position or status in these frames does: FNV-1a (Fowler, Noll, Vo), 32 bits.
    #[must_use]
    pub fn seal(&self, frames: std::ops::Range<u32>) -> u32 {
        let bytes = frames.filter_map(|frame| Some((frame, self.get(frame)?))).flat_map(|(frame, sample)| {
            let Sample { x, y, status, .. } = sample;
            let words = [frame, x.to_bits(), y.to_bits(), *status as u32];
            words.into_iter().flat_map(u32::to_le_bytes)
        });
        bytes.fold(0x811c_9dc5, |seal, byte| (seal ^ u32::from(byte)).wrapping_mul(0x0100_0193))
    }
}
