//! `log`: everything that was done to a project, with its provenance.

use honami_model::brief::counted;
use honami_model::provenance::Provenance;
use honami_workbench::store::{LogItem, LogLine, Seam};
use serde_json::json;

use super::args::Project;
use super::{Answer, look};

/// Prints the log, oldest first.
pub(super) fn log(args: &Project) -> anyhow::Result<Answer> {
    let project = look(&args.project)?;
    let lines = project.log()?;
    let text = lines.iter().map(line).collect::<Vec<_>>().join("\n");
    let text = if text.is_empty() { "nothing was done to this project yet".to_owned() } else { text };
    let json = json!({ "revision": project.revision(), "log": lines.iter().map(entry).collect::<Vec<_>>() });
    Ok(Answer { json, text, done: true })
}

fn line(line: &LogLine) -> String {
    let date = &line.date;
    match &line.item {
        LogItem::Edit(edit) => format!("{date}  edit {}  {} ({})", edit.id, edit.label, edit.author),
        LogItem::Run(run) => {
            let (made, found) = (&run.head.provenance, &run.found);
            let state = &run.state;
            let seams: String = run.seams.iter().map(|seam| format!(", {seam}")).collect();
            format!(
                "{date}  run {}  {}: {} frames {}..{}, {state}{seams}  {made}{}",
                run.id,
                made.what,
                run.tracks,
                found.start,
                found.end,
                place(made)
            )
        }
        LogItem::Clustering(info) => {
            let made = &info.provenance;
            let (tracks, groups) = (counted(info.n_tracks, "track"), counted(info.cut as usize, "group"));
            format!("{date}  clustering {}  {tracks} in {groups}  {made}", info.id)
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

fn entry(line: &LogLine) -> serde_json::Value {
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
    }
}

/// A seam; the version and hash of the build that goes on are null where it is the same as before.
pub(super) fn started_again(seam: &Seam) -> serde_json::Value {
    let (version, sha256) = seam.build.as_ref().map(|build| (&build.version, &build.sha256)).unzip();
    json!({ "frame": seam.frame, "why": seam.why, "plugin_version": version, "plugin_sha256": sha256 })
}
