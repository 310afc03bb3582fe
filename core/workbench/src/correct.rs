//! Steps on the tracks of a project: ranges marked or taken away; tracks split, swapped, joined, doubled, averaged.
//!
//! The screen and the scripts ask for the same steps; what each does is the model's (see
//! [`correct`](mod@honami_model::correct)).

use std::collections::BTreeMap;
use std::ops::Range;

use honami_model::correct::{Refused, Shown, Stroke, delete_range, mark, sketch, take, tracks};
use honami_model::document::RunId;
use honami_model::edit::Transaction;
use honami_model::track::{Span, Status, TrackId, TrackSet};
use honami_store::Project;

use crate::error::WorkbenchError;
use crate::ground::Ground;
use crate::versus::whole;

/// What is to be done.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Say what is known of features in a range of frames.
    Mark {
        /// Their tracks; those that have nothing there are left out.
        tracks: TrackSet,
        /// The frames.
        frames: Range<u32>,
        /// What is known.
        status: Status,
    },
    /// Take a range of frames away.
    DeleteRange {
        /// From these tracks; those that have nothing there are left out.
        tracks: TrackSet,
        /// The frames.
        frames: Range<u32>,
    },
    /// Lay what a run found over a range of frames.
    Take {
        /// Of these tracks; those that it has not found there are left out.
        tracks: TrackSet,
        /// The frames.
        frames: Range<u32>,
        /// The run, shown or not.
        run: RunId,
    },
    /// Lay what was drawn while the clip played over a track.
    Sketch {
        /// The track.
        track: TrackId,
        /// What was drawn.
        strokes: Vec<Stroke>,
    },
    /// Cut a track in two.
    Split {
        /// The track.
        track: TrackId,
        /// First frame of the second part, which is a new track.
        frame: u32,
    },
    /// Exchange two tracks.
    Swap {
        /// The two.
        tracks: [TrackId; 2],
        /// The frames.
        frames: Range<u32>,
    },
    /// Fill a track with what another one has seen, and delete the other.
    Join {
        /// The one that stays.
        track: TrackId,
        /// The one that fills it.
        with: TrackId,
    },
    /// Make a new track like another one.
    Duplicate(TrackId),
    /// Make a new track in the middle of others.
    Average(TrackSet),
}

/// A step as one edit, not committed yet, and the track that it makes.
///
/// # Errors
/// What the correction is refused for, and what the project met.
pub fn prepare(project: &mut Project, step: &Step) -> Result<(Transaction, Option<TrackId>), WorkbenchError> {
    if let Step::Swap { tracks: [a, b], .. } | Step::Join { track: a, with: b } = step
        && a == b
    {
        return Err(Refused::Itself(*a).into());
    }
    let ids = step.tracks();
    let grounds = ids.iter().map(|&id| Ground::of(project, id)).collect::<Result<Vec<Ground>, _>>()?;
    let times = project.clip().clip.times.clone();
    let shown: Vec<Shown<'_>> = grounds.iter().map(|ground| ground.shown(&times)).collect();
    let found = match step {
        Step::Take { run, .. } => found(project, &ids, *run)?,
        _ => BTreeMap::new(),
    };
    let edit = |new: TrackId| match (step, &shown[..]) {
        (Step::Mark { frames, status, .. }, _) => {
            tracks::many(&shown, |shown| mark(shown, frames.clone(), *status))
        }
        (Step::DeleteRange { frames, .. }, _) => {
            tracks::many(&shown, |shown| delete_range(shown, frames.clone()))
        }
        (Step::Take { frames, run, .. }, _) => tracks::many(&shown, |shown| {
            let nothing = Span::default();
            take(shown, *run, found.get(&shown.id()).unwrap_or(&nothing), frames.clone())
        }),
        (Step::Sketch { strokes, .. }, [shown]) => {
            sketch(shown, strokes).map(|correction| correction.transaction)
        }
        (Step::Split { frame, .. }, [shown]) => tracks::split(shown, *frame, new),
        (Step::Swap { frames, .. }, [a, b]) => tracks::swap(a, b, frames.clone()),
        (Step::Join { .. }, [a, b]) => tracks::join(a, b),
        (Step::Duplicate(_), [shown]) => tracks::duplicate(shown, new),
        (Step::Average(_), _) => tracks::average(&shown, new),
        _ => Err(Refused::NothingSeen),
    };
    // Numbers are never used twice: a step that is refused must not use one up, so that it is tried with any first.
    let tried = edit(TrackId(u32::MAX))?;
    if !step.makes_one() {
        return Ok((tried, None));
    }
    let new = TrackId(project.reserve_tracks(1)?.start);
    Ok((edit(new)?, Some(new)))
}

/// What a run found of some tracks.
fn found(
    project: &Project,
    tracks: &[TrackId],
    run: RunId,
) -> Result<BTreeMap<TrackId, Span>, WorkbenchError> {
    project.run(run)?;
    let of = |&track: &TrackId| Ok((track, whole(project.run_spans(run, track)?, 0)));
    tracks.iter().map(of).collect()
}

impl Step {
    /// Whether a new track comes of it.
    fn makes_one(&self) -> bool {
        matches!(self, Self::Split { .. } | Self::Duplicate(_) | Self::Average(_))
    }

    /// The tracks it works on, the one that stays first.
    fn tracks(&self) -> Vec<TrackId> {
        match self {
            Self::Mark { tracks, .. }
            | Self::DeleteRange { tracks, .. }
            | Self::Take { tracks, .. }
            | Self::Average(tracks) => tracks.iter().collect(),
            Self::Sketch { track, .. } | Self::Split { track, .. } | Self::Duplicate(track) => vec![*track],
            Self::Swap { tracks, .. } => tracks.to_vec(),
            Self::Join { track, with } => vec![*track, *with],
        }
    }
}
