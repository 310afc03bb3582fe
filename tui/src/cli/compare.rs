//! `compare`: trackers side by side.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::brief::counted;
use honami_workbench::WorkbenchError;
use honami_workbench::compare::{self, Comparison, Contestant, KeyPaths, Question};
use honami_workbench::drive::Seed;
use honami_workbench::export;
use honami_workbench::media::{self, Media, OpenOptions};
use honami_workbench::plugins::{Host, Kind, Param, Registry, Values};
use honami_workbench::session::{Session, SessionOptions};

use super::args::{Common, Compare};
use super::{Answer, report, told_options, track, want};

mod entry;
mod sensors;
mod svg;
mod tables;

/// Runs every tracker on the same points and prints one row for each.
pub(super) fn compare(args: &Compare, common: &Common) -> anyhow::Result<Answer> {
    if let Some(path) = &args.beside.sensors {
        return sensors::sensors(args, path);
    }
    let opened = open(args, common)?;
    let folder = args.svg.as_deref().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        anyhow::bail!("--svg: there is no folder {}", folder.display());
    }
    let (media, registry, host) =
        (Arc::clone(&opened.media), Arc::clone(&opened.registry), opened.host.clone());
    let contestants = contestants(args, &registry)?;
    let Asked { question, n_unseen } = ask(args, opened, &contestants)?;
    let frames = question.frames.clone();
    let found =
        compare::compare(&media, &registry, &host, &contestants, question, &report::Bar::with(common))?;
    let head = head(&found, &frames, n_unseen);
    if let Some(path) = &args.svg {
        let name = args.clip[0].file_name().unwrap_or_default().to_string_lossy().into_owned();
        export::text(path, &svg::draw(&format!("{name}: {head}"), &found.rows))?;
    }
    for (name, error) in &found.missing {
        report::say(&match error {
            WorkbenchError::Stopped => format!("{name}: stopped, so it has no row"),
            error => format!("{name}: no row: {error}"),
        });
    }
    Ok(Answer {
        json: entry::answer(&found, n_unseen, &frames),
        text: format!("{head}\n{}", tables::all(&found.rows)),
        done: found.missing.is_empty(),
    })
}

/// On what was compared: `56 points, frames 0-59 (4 more are visible in no frame)`.
fn head(found: &Comparison, frames: &Range<u32>, n_unseen: usize) -> String {
    let left_out = [(n_unseen, "never visible"), (found.n_outside, "given in other frames")];
    let left_out = left_out.iter().filter(|(n, _)| *n > 0);
    let left_out: Vec<String> = left_out.map(|(n, why)| format!("{n} {why}")).collect();
    let left_out = match &left_out[..] {
        [] => String::new(),
        some => format!(" (left out: {})", some.join(", ")),
    };
    let points = counted(found.n_points, "point");
    format!("{points}, frames {}-{}{left_out}", frames.start, frames.end - 1)
}

/// What is compared on.
struct Opened {
    media: Arc<Media>,
    registry: Arc<Registry>,
    host: Host,
    /// The project's own points; none of a clip.
    points: Vec<Seed>,
    keys: KeyPaths,
}

fn open(args: &Compare, common: &Common) -> anyhow::Result<Opened> {
    let [clip] = &args.clip[..] else {
        let options = OpenOptions { fps: args.fps, ..OpenOptions::default() };
        return Ok(of_clip(media::open_images(&args.clip, &options)?, common));
    };
    if clip.extension().is_none_or(|e| e != "honami") {
        let options = OpenOptions { fps: args.fps, ..OpenOptions::default() };
        return Ok(of_clip(media::open(clip, &options)?, common));
    }
    let session = Session::open(clip, &SessionOptions { read_only: true, ..told_options(common) })?;
    let mut points = Vec::new();
    for (id, span) in session.project.shown_all()? {
        let seen = span.frames().zip(&span.samples).find(|(_, sample)| sample.status.is_seen());
        points.extend(seen.map(|(frame, sample)| Seed { frame, track: id, x: sample.x, y: sample.y }));
    }
    let keys = compare::key_paths(&session)?;
    let Session { media, registry, options, .. } = session;
    Ok(Opened { media, registry, host: options.host, points, keys })
}

fn of_clip(media: Media, common: &Common) -> Opened {
    let options = told_options(common);
    let (media, registry) = (Arc::new(media), Arc::new(options.registry()));
    Opened { media, registry, host: options.host, points: Vec::new(), keys: KeyPaths::new() }
}

fn contestants(args: &Compare, registry: &Registry) -> anyhow::Result<Vec<Contestant>> {
    let none = args.with.is_empty() && args.tracks.is_empty();
    let names = if none { vec![track::DEFAULT.to_owned()] } else { args.with.clone() };
    if let (Some(first), Some(stray)) = (names.first(), stray(registry, &names, &args.set)?) {
        track::values(registry, Kind::Tracker, first, &[stray])?;
    }
    let trackers = names.into_iter().map(|name| {
        let values = values(registry, &name, &args.set)?;
        Ok(Contestant::Tracker(name, values))
    });
    let mut contestants = trackers.collect::<anyhow::Result<Vec<_>>>()?;
    contestants.extend(args.tracks.iter().map(|f| Contestant::Foreign(f.name.clone(), f.file.clone())));
    Ok(contestants)
}

/// What the trackers are given.
struct Asked {
    question: Question,
    /// Points that are left out because they can be seen in no frame.
    n_unseen: usize,
}

/// The points, and what is known of where they go.
fn ask(args: &Compare, opened: Opened, contestants: &[Contestant]) -> anyhow::Result<Asked> {
    let Opened { media, registry, host, points: own, keys } = opened;
    let clip = media.clip();
    let n_frames = clip.n_frames();
    let frames = args.frames.map_or(0..n_frames, |range| range.start..range.end.unwrap_or(n_frames));
    if frames.start >= frames.end || frames.end > n_frames {
        return Err(WorkbenchError::Frames { start: frames.start, end: frames.end, n_frames }.into());
    }
    let is_flow = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("flo"));
    let flow = args.truth.as_ref().filter(is_flow).map(|path| compare::read_flow(path, clip)).transpose()?;
    let table = args.truth.as_ref().filter(|path| !is_flow(path));
    let mut truth = table.map(|path| compare::read_truth(path, n_frames)).transpose()?;
    truth.iter().try_for_each(|truth| compare::check_truth(truth, clip, &frames))?;
    let mut n_unseen = 0;
    let points = match (&args.points, &truth) {
        (Some(path), _) => compare::read_points(path)?,
        (None, Some(truth)) => {
            let points = compare::points_of(truth);
            n_unseen = truth.len() - points.len();
            points
        }
        (None, None) if own.is_empty() => {
            let trackers: Vec<(&str, &Values)> = contestants.iter().filter_map(tracker).collect();
            compare::detect(&media, &registry, &host, &trackers, frames.start)?
        }
        (None, None) => own,
    };
    want(!points.is_empty(), || {
        "there are no points to compare on: give --points, or a project that has tracks".to_owned()
    })?;
    if let Some(flow) = &flow {
        let len = u32::try_from(frames.len())?;
        truth = Some(compare::truth_of_flow(flow, &points, len)?);
    }
    Ok(Asked { question: Question { points, frames, truth, flow, keys, passes: !args.quick }, n_unseen })
}

fn tracker(contestant: &Contestant) -> Option<(&str, &Values)> {
    match contestant {
        Contestant::Tracker(name, values) => Some((name, values)),
        Contestant::Foreign(..) => None,
    }
}

/// `--set` for a tracker: those of its parameters that are set.
fn values(registry: &Registry, name: &str, set: &[String]) -> anyhow::Result<Values> {
    let params = &registry.find(Kind::Tracker, name)?.params;
    let set: Vec<String> = set.iter().filter(|text| has(params, text)).cloned().collect();
    track::values(registry, Kind::Tracker, name, &set)
}

/// A `--set` that no tracker has.
fn stray(registry: &Registry, names: &[String], set: &[String]) -> anyhow::Result<Option<String>> {
    let plugins = names.iter().map(|name| registry.find(Kind::Tracker, name));
    let plugins = plugins.collect::<Result<Vec<_>, _>>()?;
    Ok(set.iter().find(|text| !plugins.iter().any(|plugin| has(&plugin.params, text))).cloned())
}

fn has(params: &[Param], text: &str) -> bool {
    let id = text.split('=').next().unwrap_or_default().trim();
    params.iter().any(|param| param.id == id)
}

#[cfg(test)]
mod tests;
