//! `track`: follow features through the clip.

use std::path::Path;

use honami_model::document::RunId;
use honami_workbench::WorkbenchError;
use honami_workbench::compare::read_points;
use honami_workbench::plugins::{HostError, Kind, Registry, Values, quoted};
use honami_workbench::progress::Progress;
use honami_workbench::rebuilt::Difference;
use honami_workbench::session::Session;
use honami_workbench::track::{self, Area, PointSource, TrackJob, TrackOutcome, TrackRequest};
use serde_json::json;

use super::args::{Common, Region, Track};
use super::{Answer, log, report, session, want};

/// The tracker that is used unless one is named.
pub(super) const DEFAULT: &str = "anchored";

/// Tracks, and shows what was found.
pub(super) fn track(args: &Track, common: &Common) -> anyhow::Result<Answer> {
    let mut session = session(&args.project, common)?;
    if let Some(run) = args.resume {
        let run = run.map(RunId).map_or_else(|| track::unfinished(&session.project), |run| Ok(Some(run)))?;
        let run = run.ok_or(WorkbenchError::NothingToResume { run })?;
        let bar = report::Bar::with(common);
        let job = track::resume(&mut session, run)?;
        return Ok(describe(&end(&mut session, job, &bar)?, &args.project));
    }
    let request = asked(args, &session)?;
    // Before the run begins: from here on Ctrl-C stops it and keeps what it has.
    let bar = report::Bar::with(common);
    Ok(describe(&run(&mut session, &request, &bar)?, &args.project))
}

/// What the command line asks for.
pub(super) fn asked(args: &Track, session: &Session) -> anyhow::Result<TrackRequest> {
    let detect = args.detect.as_deref().filter(|name| !name.is_empty());
    // `--detect NAME` alone means that this tracker tracks, too.
    let plugin = args.plugin.with.as_deref().or(detect).unwrap_or(DEFAULT).to_owned();
    if let Some(detect) = detect {
        let id = |name| session.registry.find(Kind::Tracker, name).map(|plugin| &plugin.id);
        want(id(detect)? == id(&plugin)?, || {
            format!(
                "features are chosen by the tracker that follows them: --detect {detect} needs --with {detect}"
            )
        })?;
    }
    let params = values(&session.registry, Kind::Tracker, &plugin, &args.plugin.set)?;
    let n_frames = session.media.clip().n_frames();
    let frames = args.frames.map_or(0..n_frames, |range| range.start..range.end.unwrap_or(n_frames));
    let points = points(args, session)?;
    Ok(TrackRequest { plugin, params, points, frames, every: args.every, area: area(args) })
}

/// The default tracker with its default parameters, over the whole clip.
pub(super) fn request(session: &Session, points: PointSource) -> TrackRequest {
    TrackRequest {
        plugin: DEFAULT.to_owned(),
        params: Values::default(),
        points,
        frames: 0..session.media.clip().n_frames(),
        every: None,
        area: Area::Usual,
    }
}

/// Prepares, runs and finishes.
pub(super) fn run(
    session: &mut Session,
    request: &TrackRequest,
    progress: &dyn Progress,
) -> anyhow::Result<TrackOutcome> {
    let job = track::prepare(session, request)?;
    end(session, job, progress)
}

/// Runs and finishes.
fn end(session: &mut Session, job: TrackJob, progress: &dyn Progress) -> anyhow::Result<TrackOutcome> {
    let done = job.run(progress)?;
    let outcome = track::finish(session, done)?;
    match &outcome.error {
        Some(error) => anyhow::bail!(
            "{}; `{}` goes on from frame {}",
            outcome.line,
            line_to_resume(session, outcome.run, error),
            outcome.unseen_from
        ),
        None => Ok(outcome),
    }
}

/// What is typed to go on with a run: its plugin is let go first where it is held, and named again where it was.
fn line_to_resume(session: &Session, run: RunId, error: &WorkbenchError) -> String {
    let mut line = String::new();
    if let WorkbenchError::Plugin(HostError::Quarantined { library, .. }) = error {
        line = format!("honami plugin retry {} && ", quoted(library));
    }
    line += &format!("honami track {} --resume {run}", quoted(session.project.path()));
    for (option, paths) in [("plugin", &session.options.plugin_paths), ("dev", &session.options.dev)] {
        for path in paths {
            line += &format!(" --{option} {}", quoted(path));
        }
    }
    line
}

fn points(args: &Track, session: &Session) -> anyhow::Result<PointSource> {
    if let Some(path) = &args.points {
        return Ok(PointSource::Given(read_points(path)?));
    }
    // Whoever says where or how often to detect wants detection; a project without a track has nothing else.
    let detect = args.detect.is_some()
        || args.no_mask
        || args.mask.is_some()
        || args.region.is_some()
        || args.every.is_some();
    let none_yet = session.project.document().tracks().next().is_none();
    if detect || none_yet { Ok(PointSource::Detect) } else { Ok(PointSource::Existing) }
}

fn area(args: &Track) -> Area {
    match (&args.mask, args.region) {
        (Some(path), _) => Area::Mask(path.clone()),
        (None, Some(Region { x, y, width, height })) => Area::Rect([x, y, width, height]),
        (None, None) if args.no_mask => Area::Whole,
        (None, None) => Area::Usual,
    }
}

/// Parameter values from `--set k=v`.
pub(super) fn values(
    registry: &Registry,
    kind: Kind,
    plugin: &str,
    set: &[String],
) -> anyhow::Result<Values> {
    let plugin = registry.find(kind, plugin)?;
    let mut values = Values::defaults(&plugin.params);
    for assignment in set {
        values.set_text(&plugin.params, assignment)?;
    }
    Ok(values)
}

pub(super) fn describe(outcome: &TrackOutcome, project: &Path) -> Answer {
    let line = match outcome.instead_of {
        Some(before) => format!(
            "{}\nrun {} is shown now instead of run {before}; back: echo undo | honami edit {}",
            outcome.line,
            outcome.run,
            quoted(project)
        ),
        None => outcome.line.clone(),
    };
    let json = json!({
        "run": outcome.run.0,
        "instead_of": outcome.instead_of.map(|before| before.0),
        "seen": outcome.ends.n_seen as f64 / outcome.ends.n_frames.max(1) as f64,
        "tracks": outcome.n_tracks,
        "lost": outcome.ends.n_lost,
        "hidden": outcome.ends.n_hidden,
        "outside": outcome.ends.n_outside,
        "born": outcome.ends.n_born,
        "frames": [outcome.frames.start, outcome.frames.end],
        "stopped": outcome.stopped,
        "seconds": outcome.seconds,
        "tracker_seconds": outcome.tracker_secs,
        "mattes": outcome.mattes,
        "warnings": outcome.warnings,
        "started_again": outcome.seams.iter().map(log::started_again).collect::<Vec<_>>(),
        "rebuilt": outcome.rebuilt.as_ref().map(|rebuilt| json!({
            "frame": rebuilt.seam,
            "plugin_version": rebuilt.build.version,
            "plugin_sha256": rebuilt.build.sha256,
            "beside": rebuilt.run.0,
            "difference": difference(&rebuilt.difference),
        })),
    });
    Answer { json, text: report::with_warnings(&line, &outcome.warnings), done: !outcome.stopped }
}

/// How two builds differ.
pub(super) fn difference(found: &Difference) -> serde_json::Value {
    json!({
        "frames": [found.frames.start, found.frames.end],
        "tracks": found.n_tracks,
        "apart": found.n_apart,
        "median_px": found.median_px,
        "unseen": found.n_unseen,
    })
}

#[cfg(test)]
mod tests;
