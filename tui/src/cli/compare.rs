//! `compare`: trackers side by side.

use std::sync::Arc;

use honami_workbench::compare::{self, Contestant, Row};
use honami_workbench::drive::Seed;
use honami_workbench::media::{self, Media, OpenOptions};
use honami_workbench::plugins::{Kind, Param, Registry, Values};
use honami_workbench::session::{Session, SessionOptions};
use serde_json::json;

use super::args::{Common, Compare};
use super::{Answer, options, report, track, want};

/// Runs every tracker on the same points and prints one row for each.
pub(super) fn compare(args: &Compare, common: &Common) -> anyhow::Result<Answer> {
    let (media, own, registry) = open(args, common)?;
    let truth =
        args.truth.as_deref().map(|path| compare::read_truth(path, media.clip().n_frames())).transpose()?;
    let points = match (&args.points, &truth) {
        (Some(path), _) => compare::read_points(path)?,
        (None, Some(truth)) => compare::points_of(truth),
        (None, None) => own,
    };
    want(!points.is_empty(), || {
        "there are no points to compare on: give --truth or --points, or a project that has tracks".to_owned()
    })?;
    let none = args.with.is_empty() && args.tracks.is_empty();
    let names = if none { vec![track::DEFAULT.to_owned()] } else { args.with.clone() };
    if let (Some(first), Some(stray)) = (names.first(), stray(&registry, &names, &args.set)?) {
        track::values(&registry, Kind::Tracker, first, &[stray])?;
    }
    let trackers = names.into_iter().map(|name| {
        let values = values(&registry, &name, &args.set)?;
        Ok(Contestant::Tracker(name, values))
    });
    let mut contestants = trackers.collect::<anyhow::Result<Vec<_>>>()?;
    contestants.extend(args.tracks.iter().map(|f| Contestant::Foreign(f.name.clone(), f.file.clone())));
    let rows =
        compare::compare(&media, &registry, &contestants, &points, truth.as_ref(), &report::Bar::new())?;
    Ok(describe(&rows, points.len()))
}

/// The clip; the points and plugins that come with it.
fn open(args: &Compare, common: &Common) -> anyhow::Result<(Arc<Media>, Vec<Seed>, Arc<Registry>)> {
    if args.clip.extension().is_some_and(|e| e == "honami") {
        let session = Session::open(&args.clip, &SessionOptions { read_only: true, ..options(common) })?;
        let mut seeds = Vec::new();
        for (id, span) in session.project.shown_all()? {
            let seen = span.frames().zip(&span.samples).find(|(_, sample)| sample.status.is_seen());
            seeds.extend(seen.map(|(frame, sample)| Seed { frame, track: id, x: sample.x, y: sample.y }));
        }
        return Ok((session.media, seeds, session.registry));
    }
    let options = OpenOptions { fps: args.fps, ..OpenOptions::default() };
    let media = Arc::new(media::open(&args.clip, &options)?);
    Ok((media, Vec::new(), Arc::new(Registry::scan(&common.plugins))))
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

fn describe(rows: &[Row], n_points: usize) -> Answer {
    let head = ["tracker", "δavg", "<1 px", "median", "survival", "ok", "lost", "kept", "ms/frame"];
    let mut table = vec![head.map(str::to_owned).to_vec()];
    for row in rows {
        let number =
            |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
        let of = |part: fn(&honami_workbench::compare::Accuracy) -> f64| row.accuracy.as_ref().map(part);
        table.push(vec![
            row.tracker.clone(),
            number(of(|a| a.delta_avg), 3),
            number(of(|a| a.within_1px), 3),
            number(row.accuracy.and_then(|a| a.median_px), 2),
            number(of(|a| a.survival), 3),
            number(of(|a| a.ok_tracks), 3),
            number(of(|a| a.n_lost as f64 / a.n_samples as f64), 3),
            number(Some(row.kept), 3),
            number(row.ms_per_frame, 2),
        ]);
    }
    let text = format!("{n_points} points\n{}", report::table(&table));
    Answer {
        json: json!({ "points": n_points, "trackers": rows.iter().map(entry).collect::<Vec<_>>() }),
        text,
        done: true,
    }
}

fn entry(row: &Row) -> serde_json::Value {
    let mut entry = json!({ "tracker": row.tracker, "kept": row.kept, "ms_per_frame": row.ms_per_frame });
    if let Some(accuracy) = row.accuracy {
        entry["delta_avg"] = accuracy.delta_avg.into();
        entry["within_1px"] = accuracy.within_1px.into();
        entry["median_px"] = accuracy.median_px.into();
        entry["survival"] = accuracy.survival.into();
        entry["ok_tracks"] = accuracy.ok_tracks.into();
        entry["visibility"] = accuracy.visibility.into();
        entry["samples"] = accuracy.n_samples.into();
        entry["lost"] = accuracy.n_lost.into();
    }
    entry
}
