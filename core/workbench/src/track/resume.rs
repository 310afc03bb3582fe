//! Going on with a run that has ended early: a new run begins where it saw the features last.

use std::path::absolute;
use std::sync::Arc;

use honami_host::{Kind, Values};
use honami_model::clip::Clip;
use honami_model::document::{RunId, ShownRun};
use honami_model::edit::{Edit, Transaction};
use honami_model::track::{Span, Status, TrackId, TrackSet};
use honami_store::{Project, RunInfo, RunState, Seam, StoreError};
use serde::{Deserialize, Serialize};

use super::{Area, PointSource, TrackJob, TrackRequest, begin};
use crate::drive::{Detect, Seed, check_seeds, is_inside};
use crate::error::WorkbenchError;
use crate::session::Session;

/// What a run was asked for beyond what its head says; kept with it, so that it can be gone on with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Asked {
    /// Frame, track, and where.
    seeds: Vec<(u32, u32, f32, f32)>,
    /// New features are looked for, from this frame on.
    found_from: Option<u32>,
    every: Option<u32>,
    area: Area,
    /// The run that it goes on with.
    resumes: Option<u32>,
}

impl Asked {
    /// Of a request with the features that came of it.
    pub(super) fn of(request: &TrackRequest, seeds: &[Seed], detect: Option<&Detect>) -> Self {
        // What the command line names is another file from another folder.
        let area = match &request.area {
            Area::Mask(path) => Area::Mask(absolute(path).unwrap_or_else(|_| path.clone())),
            area => area.clone(),
        };
        Self {
            seeds: seeds.iter().map(|seed| (seed.frame, seed.track.0, seed.x, seed.y)).collect(),
            found_from: detect.map(|detect| detect.since),
            every: request.every,
            area,
            resumes: None,
        }
    }

    pub(super) fn text(&self) -> String {
        // It has no maps, so nothing of it cannot be written.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// What a run of this project was asked for; `None` where that was not kept: it was imported, or corrects a track.
    fn read(project: &Project, run: RunId) -> Result<Option<Self>, WorkbenchError> {
        Ok(project.request_of(run)?.and_then(|text| serde_json::from_str(&text).ok()))
    }

    fn seeds(&self) -> impl Iterator<Item = Seed> {
        self.seeds.iter().map(|&(frame, track, x, y)| Seed { frame, track: TrackId(track), x, y })
    }
}

/// Where a run has looked for features, and every how many frames again; `None` where it has not, or where that was not kept.
///
/// # Errors
/// What the project met.
pub fn detection_of(project: &Project, run: RunId) -> Result<Option<(Area, Option<u32>)>, WorkbenchError> {
    let asked = Asked::read(project, run)?.filter(|asked| asked.found_from.is_some());
    Ok(asked.map(|asked| (asked.area, asked.every)))
}

/// The newest run that has ended early, that no other goes on with, and whose tracks newer ones have not replaced; `None`
/// where all are through.
///
/// # Errors
/// What the project met.
pub fn unfinished(project: &Project) -> Result<Option<RunId>, WorkbenchError> {
    let mut taken_up = Vec::new();
    for run in project.runs()?.iter().rev() {
        let Some(asked) = Asked::read(project, run.id)? else { continue };
        if is_early(run) && !taken_up.contains(&run.id.0) && !is_replaced(project, run) {
            return Ok(Some(run.id));
        }
        taken_up.extend(asked.resumes);
    }
    Ok(None)
}

/// Whether newer runs show all of its tracks; of one that has found none, whether there are any.
fn is_replaced(project: &Project, run: &RunInfo) -> bool {
    let newer: Vec<&ShownRun> = project.document().runs().iter().filter(|shown| shown.run > run.id).collect();
    let mut tracks = run.tracks.iter().chain(run.head.tracks.iter());
    !newer.is_empty() && tracks.all(|track| newer.iter().any(|shown| shown.tracks.contains(track)))
}

fn is_early(run: &RunInfo) -> bool {
    matches!(run.state, RunState::Stopped { .. } | RunState::Interrupted)
}

/// Loads the tracker of a run as it is now, and begins a run that goes on with it: from the last frame in which it saw a
/// feature, to the end that it was asked for.
///
/// # Errors
/// [`WorkbenchError::NothingToResume`], when the run is through; [`WorkbenchError::RequestLost`], when it is not known what
/// it was asked for; as [`prepare`](super::prepare).
pub fn resume(session: &mut Session, run: RunId) -> Result<TrackJob, WorkbenchError> {
    let info = session.project.run(run)?;
    if !is_early(&info) {
        return Err(WorkbenchError::NothingToResume { run: Some(run) });
    }
    let asked = Asked::read(&session.project, run)?.ok_or(WorkbenchError::RequestLost { run })?;
    let registry = Arc::clone(&session.registry);
    let made = &info.head.provenance;
    let plugin = registry.find(Kind::Tracker, &made.plugin_id)?;
    let (last, hidden) = seen_last(&session.project, run, session.media.clip())?;
    let start = last.first().map_or(info.head.frames.start, |seed| seed.frame);
    let later = asked.seeds().filter(|seed| last.is_empty() || seed.frame > start);
    let seeds: Vec<Seed> = last.iter().copied().chain(later).collect();
    let detect = match asked.found_from {
        Some(since) => {
            let areas = asked.area.read(&session.project, session.media.clip())?;
            Some(Detect { every: asked.every, areas, present: session.project.shown_all()?, since })
        }
        None => None,
    };
    // It comes from a file, which others may have written.
    super::check_frames(&(start..info.head.frames.end), session.media.clip())?;
    if detect.is_none() || !seeds.is_empty() {
        check_seeds(&seeds, session.media.clip())?;
    }
    let request = TrackRequest {
        plugin: made.plugin_id.clone(),
        params: made.params.clone().into_iter().collect::<Values>(),
        points: PointSource::Given(Vec::new()),
        frames: start..info.head.frames.end,
        every: asked.every,
        area: asked.area.clone(),
    };
    let kept = Asked { resumes: Some(run.0), ..Asked::of(&request, &seeds, detect.as_ref()) };
    let mut job = begin(session, plugin, &request, seeds, detect, &kept)?;
    let why = format!("ended in run {run}");
    job.writer.seam(&Seam { frame: start + 1, why, build: None })?;
    (job.resumes, job.hidden) = (Some(run), hidden);
    Ok(job)
}

/// The features that a run saw in the last frame in which it saw any, and those that were hidden there, where it took them
/// to be; and which are these. What had left the picture is not among them.
fn seen_last(project: &Project, run: RunId, clip: &Clip) -> Result<(Vec<Seed>, TrackSet), StoreError> {
    let spans = project.run_tracks(run)?;
    let seen = spans.iter().flat_map(|(_, span)| span.frames().zip(&span.samples));
    let seen = seen.filter(|(_, sample)| sample.status.is_seen());
    let Some(frame) = seen.map(|(frame, _)| frame).max() else { return Ok(Default::default()) };
    let live = |(track, span): &(TrackId, Span)| {
        let sample = span.get(frame)?;
        let seed = Seed { frame, track: *track, x: sample.x, y: sample.y };
        let is_live = sample.status.is_seen() || sample.status == Status::Occluded;
        (is_live && is_inside(&seed, clip)).then_some((seed, sample.status))
    };
    let live: Vec<(Seed, Status)> = spans.iter().filter_map(live).collect();
    let hidden = live.iter().filter(|(_, status)| *status == Status::Occluded).map(|(seed, _)| seed.track);
    let hidden = hidden.collect();
    Ok((live.into_iter().map(|(seed, _)| seed).collect(), hidden))
}

/// Shows a run, and below it the one that it goes on with, where that is not shown yet.
pub(super) fn shown(
    project: &Project,
    run: RunId,
    found: TrackSet,
    resumes: Option<RunId>,
) -> Result<Transaction, StoreError> {
    let shown = Transaction::show_run(run, found);
    let is_hidden =
        |before: &RunId| !project.document().runs().iter().any(|one: &ShownRun| one.run == *before);
    let Some(before) = resumes.filter(is_hidden) else { return Ok(shown) };
    let below = Edit::ShowRun { run: before, tracks: project.run(before)?.tracks, above: None };
    Ok(Transaction::new(shown.label, [vec![below], shown.edits].concat()))
}

#[cfg(test)]
mod tests;
