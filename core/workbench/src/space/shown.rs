//! The tracks in space that a project shows: places of each track by frame, and the frames' times.

use std::path::Path;

use honami_model::clip::FrameTimes;
use honami_model::history::EntryId;
use honami_model::provenance::{Provenance, Value};
use honami_model::space::{SpaceId, SpaceTrack};
use honami_model::track::TrackSet;
use honami_store::{Access, Project};

use crate::error::{SpaceError, WorkbenchError};

/// Tracks in space.
#[derive(Clone, Debug, PartialEq)]
pub struct InSpace {
    /// Their number.
    pub id: SpaceId,
    /// The tracks, in order of their numbers; metres in the left camera's axes, x right, y down, z forward.
    pub tracks: Vec<SpaceTrack>,
    /// What each is called, if anything, in the same order.
    pub names: Vec<Option<String>>,
    /// When frames are, seconds of the left clock.
    pub times: FrameTimes,
    /// What made them.
    pub provenance: Provenance,
    /// Why they no longer speak of what the projects show, a line each; empty: they do.
    pub stale: Vec<String>,
}

/// Reads the tracks in space that a project shows.
///
/// # Errors
/// [`SpaceError::NoSpace`] where none are shown, and what the project met.
pub fn shown(project: &Project) -> Result<InSpace, WorkbenchError> {
    let none = || SpaceError::NoSpace { path: project.path().to_owned() };
    let id = project.document().space().ok_or_else(none)?;
    let space = project.space(id)?;
    let name = |track: &SpaceTrack| project.document().track(track.track)?.name.clone();
    let names = space.tracks.iter().map(name).collect();
    let left = project.is_space_stale(id)?.map(|stale| stale.to_string());
    let stale = left.into_iter().chain(right_stale(&space.provenance, &space.tracks)).collect();
    let times = project.clip().clip.times.clone();
    Ok(InSpace { id, names, times, stale, provenance: space.provenance, tracks: space.tracks })
}

/// Whether the right project shows other tracks than it did then; where it has gone, nobody knows.
fn right_stale(made: &Provenance, tracks: &[SpaceTrack]) -> Option<String> {
    let (Value::Text(path), Value::Int(revision)) =
        (made.params.get("right")?, made.params.get("right_revision")?)
    else {
        return None;
    };
    let right = Project::open(Path::new(path), Access::Read).ok()?;
    let clip = Value::Text(right.clip().sha256.clone());
    if made.params.get("right_clip_sha256") != Some(&clip) {
        return Some(format!("stale: another clip's project stands there now: {path}"));
    }
    let used: TrackSet = tracks.iter().map(|track| track.right).collect();
    match right.changed_since(EntryId(u32::try_from(*revision).ok()?), &used) {
        Ok(stale) => stale.map(|stale| format!("{stale}: {path}")),
        Err(_unknown) => Some(format!("stale: it has no such revision any more: {path}")),
    }
}
