//! Why edits are refused, in the user's words.

use crate::document::RunId;
use crate::shape::ShapeError;
use crate::track::TrackId;

/// Why an edit cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A scale bar measures nothing.
    #[error(transparent)]
    Bar(#[from] crate::scale::BarError),
    /// The document knows no such track.
    #[error("there is no track {0}")]
    NoSuchTrack(TrackId),
    /// The track is deleted.
    #[error("track {0} is deleted; restore it first")]
    Deleted(TrackId),
    /// A track that is not deleted cannot be restored.
    #[error("track {0} is not deleted")]
    NotDeleted(TrackId),
    /// The number is taken.
    #[error("track {0} exists already; reserve a new number")]
    TrackExists(TrackId),
    /// Forgetting the track would lose hand work.
    #[error("track {0} has hand work; delete it instead")]
    HasWork(TrackId),
    /// The frame is not in the clip.
    #[error("frame {frame} is beyond the clip, whose last frame is {}", n_frames.saturating_sub(1))]
    BeyondClip {
        /// The frame asked for.
        frame: u32,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// A range without frames.
    #[error("a range of frames is wanted; this one is empty")]
    NoFrames,
    /// A position is NaN or infinite.
    #[error("track {track}: the position at frame {frame} is not finite")]
    NotFinite {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// There is no key-frame to clear.
    #[error("track {track} has no key-frame at {frame}")]
    NoKey {
        /// The track.
        track: TrackId,
        /// The frame.
        frame: u32,
    },
    /// The run is shown already.
    #[error("run {0} is shown already")]
    RunShown(RunId),
    /// The run is not shown.
    #[error("run {0} is not shown")]
    RunHidden(RunId),
    /// Only a track that a person placed, and no run has found, can be removed.
    #[error("track {track} is in run {run}; delete it instead")]
    InRun {
        /// The run.
        run: RunId,
        /// The track.
        track: TrackId,
    },
    /// Only what was born in a run, and is in no other, is forgotten with it.
    #[error("track {track} is not run {run}'s own; it cannot be forgotten with it")]
    NotItsOwn {
        /// The run.
        run: RunId,
        /// The track.
        track: TrackId,
    },
    /// There is nothing to cut.
    #[error("no clustering is shown; show one before cutting it")]
    NoClustering,
    /// A cut makes at least one group.
    #[error("a cut makes at least 1 group, not 0")]
    NoGroups,
    /// A group that is held has a node at least, and none of another.
    #[error("groups made by hand need tracks of their own: one is empty, or has what is another's")]
    NotApart,
    /// A root that is nowhere; as it came.
    #[error("a root lies at two finite numbers of pixels, not at {0}")]
    Root(String),
    /// A shape that a bone cannot have.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A name must have letters; `None` takes it away.
    #[error("a name cannot be empty")]
    EmptyName,
    /// The transaction holds no edit.
    #[error("there is nothing to do")]
    Empty,
}
