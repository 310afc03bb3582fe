//! Why corrections are refused, in the user's words.

use std::ops::Range;

use super::said;
use crate::edit::EditError;
use crate::track::TrackId;

/// Why a correction cannot be done, and what to do instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// There is nothing to move.
    #[error("track {track} has no sample at frame {frame}; go to a frame where it is shown")]
    NoSample {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// The range lies beside the track.
    #[error("track {track} has no samples in {}", said(frames))]
    NoSamples {
        /// The track.
        track: TrackId,
        /// The frames asked for.
        frames: Range<u32>,
    },
    /// Nothing would change.
    #[error("track {track}: {} are so already", said(frames))]
    Unchanged {
        /// The track.
        track: TrackId,
        /// The frames asked for.
        frames: Range<u32>,
    },
    /// A shift in time needs samples beside the one that slides.
    #[error("track {track}: frame {frame} has no samples beside it to slide along")]
    NoRoom {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// A blend goes from one key-frame to another.
    #[error("track {track} has no key-frame at {frame}; a blend goes from one key-frame to the next")]
    NoKey {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// Nothing of the track would be left.
    #[error("that is all of track {0}: delete the track instead")]
    WholeTrack(TrackId),
    /// What was drawn lies between two frames, or beside the clip.
    #[error("the stroke covers no frame; draw while the clip plays, for longer than its delay")]
    NoStroke,
    /// There is nothing to average, or to fill a track with.
    #[error("the tracks to work on are seen in no frame that counts; pick others")]
    NothingSeen,
    /// The document refuses the edits.
    #[error(transparent)]
    Edit(#[from] EditError),
}
