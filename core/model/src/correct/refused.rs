//! Why corrections are refused, in the user's words.

use std::ops::Range;

use super::mark::word;
use super::said;
use crate::document::RunId;
use crate::edit::EditError;
use crate::track::{Status, TrackId};

/// Why a correction cannot be done, and what to do instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// There is nothing to move.
    #[error("track {track} is not seen at frame {frame}; go to a frame where it is")]
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
    #[error("track {track}: {} already {}", are(frames), word(*status))]
    Unchanged {
        /// The track.
        track: TrackId,
        /// The frames asked for.
        frames: Range<u32>,
        /// What they are.
        status: Status,
    },
    /// What a run found is what is shown.
    #[error("track {track}: {} already as run {run} found {}", are(frames), if frames.len() == 1 { "it" } else { "them" })]
    ShownAlready {
        /// The track.
        track: TrackId,
        /// The frames asked for.
        frames: Range<u32>,
        /// The run.
        run: RunId,
    },
    /// The sample cannot be right where the feature is not seen.
    #[error("track {track} is {} at frame {frame}: place it, or leave it so", word(*status))]
    Unseen {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
        /// What it is.
        status: Status,
    },
    /// A shift in time needs samples beside the one that slides.
    #[error("track {track}: frame {frame} has no samples beside it to slide along")]
    NoRoom {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// Two tracks are wanted.
    #[error("track {0} cannot be worked on with itself: name another one beside it")]
    Itself(TrackId),
    /// Nothing of the track would be left.
    #[error("that is all of track {0}: delete the track instead")]
    WholeTrack(TrackId),
    /// What was drawn lies between two frames, or beside the clip.
    #[error("the stroke covers no frame; draw while the clip plays, for longer than its delay")]
    NoStroke,
    /// There is nothing to average, or to fill a track with.
    #[error("none of these tracks is seen where it would help; pick others")]
    NothingSeen,
    /// The document refuses the edits.
    #[error(transparent)]
    Edit(#[from] EditError),
}

/// `frames 3-7 are`, `frame 3 is`.
fn are(frames: &Range<u32>) -> String {
    format!("{} {}", said(frames), if frames.len() == 1 { "is" } else { "are" })
}
