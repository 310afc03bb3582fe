//! `log`: everything that was done to a project, with its provenance.

use honami_model::brief::counted;
use honami_model::provenance::Provenance;
use honami_workbench::WorkbenchError;
use honami_workbench::store::{LogItem, LogLine, Project, Seam};
use honami_workbench::track::{detection_of, inside};
use serde_json::json;

use super::args;
use super::{Answer, look};

/// Prints the log, oldest first.
pub(super) fn log(args: &args::Project) -> anyhow::Result<Answer> {
    let project = look(&args.project)?;
    let lines = project.log()?;
    let mattes = lines.iter().map(|line| mattes(&project, line)).collect::<Result<Vec<_>, _>>()?;
    let both = || lines.iter().zip(&mattes);
    let text = both().map(|(of, mattes)| line(of, inside(mattes))).collect::<Vec<_>>().join("\n");
    let text = if text.is_empty() { "nothing was done to this project yet".to_owned() } else { text };
    let json = json!({ "revision": project.revision(), "log": both().map(|(of, mattes)| entry(of, mattes)).collect::<Vec<_>>() });
    Ok(Answer { json, text, done: true })
}

/// Frames of the mattes that a run has heeded.
fn mattes(project: &Project, line: &LogLine) -> Result<Vec<u32>, WorkbenchError> {
    match &line.item {
        LogItem::Run(run) => match detection_of(project, run.id)? {
            Some((area, _)) => area.mattes(project),
            None => Ok(Vec::new()),
        },
        _ => Ok(Vec::new()),
    }
}

fn line(line: &LogLine, inside: Option<String>) -> String {
    let date = &line.date;
    match &line.item {
        LogItem::Edit(edit) => format!("{date}  edit {}  {} ({})", edit.id, edit.label, edit.author),
        LogItem::Run(run) => {
            let (made, found) = (&run.head.provenance, &run.found);
            let state = &run.state;
            let seams: String = run.seams.iter().map(|seam| format!(", {seam}")).collect();
            format!(
                "{date}  run {}  {}: {} frames {}..{}, {state}{seams}  {made}{}{}",
                run.id,
                made.what,
                run.tracks,
                found.start,
                found.end,
                place(made),
                inside.map_or_else(String::new, |inside| format!("  {inside}"))
            )
        }
        LogItem::Clustering(info) => {
            let made = &info.provenance;
            let (tracks, groups) = (counted(info.n_tracks, "track"), counted(info.cut as usize, "group"));
            format!("{date}  clustering {}  {tracks} in {groups}  {made}", info.id)
        }
        LogItem::Matte(info) => {
            let params = info.provenance.params.iter().map(|(id, value)| format!(" {id}={value}"));
            format!("{date}  matte {}  of frame {}{}", info.id, info.frame, params.collect::<String>())
        }
        LogItem::Space(info) => {
            let tracks = counted(info.n_tracks, "track");
            format!("{date}  {tracks} in space {}  {}", info.id, info.provenance)
        }
    }
}

/// Where a plugin worked, and how far it was shut in there; nothing of what no plugin made.
fn place(made: &Provenance) -> String {
    match made.sandbox.as_str() {
        _ if made.simd == "none" => String::new(),
        "in process" => "  in process".to_owned(),
        level => format!("  in a process of its own, sandbox {level}"),
    }
}

fn entry(line: &LogLine, mattes: &[u32]) -> serde_json::Value {
    let date = &line.date;
    match &line.item {
        LogItem::Edit(edit) => {
            json!({ "date": date, "what": "edit", "id": edit.id, "label": edit.label, "author": edit.author })
        }
        LogItem::Run(run) => json!({
            "date": date,
            "what": "run",
            "id": run.id,
            "state": run.state.to_string(),
            "tracks": run.tracks.len(),
            "frames": [run.found.start, run.found.end],
            "started_again": run.seams.iter().map(started_again).collect::<Vec<_>>(),
            "mattes": mattes,
            "provenance": run.head.provenance,
        }),
        LogItem::Clustering(info) => json!({
            "date": date,
            "what": "clustering",
            "id": info.id,
            "tracks": info.n_tracks,
            "groups": info.cut,
            "provenance": info.provenance,
        }),
        LogItem::Matte(info) => json!({
            "date": date,
            "what": "matte",
            "id": info.id,
            "frame": info.frame,
            "provenance": info.provenance,
        }),
        LogItem::Space(info) => json!({
            "date": date,
            "what": "space",
            "id": info.id,
            "tracks": info.n_tracks,
            "fixes": info.n_fixes,
            "provenance": info.provenance,
        }),
    }
}

/// A seam; the version and hash of the build that goes on are null where it is the same as before.
pub(super) fn started_again(seam: &Seam) -> serde_json::Value {
    let (version, sha256) = seam.build.as_ref().map(|build| (&build.version, &build.sha256)).unzip();
    json!({ "frame": seam.frame, "why": seam.why, "plugin_version": version, "plugin_sha256": sha256 })
}
