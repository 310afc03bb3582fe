//! `new` and `export`: a project's beginning, and what leaves it.

use std::path::Path;

use honami_workbench::export;
use honami_workbench::media::{self, OpenOptions};
use honami_workbench::session::Session;
use honami_workbench::store::{Access, Project};
use serde_json::json;

use super::args::{Common, Export, ExportWhat, New, Relink};
use super::{Answer, look, options, there, want};

/// Makes a project of a clip and says what the clip is.
pub(super) fn new(args: &New, common: &Common) -> anyhow::Result<Answer> {
    let is_honami = args.project.extension().is_some_and(|e| e == "honami");
    want(is_honami, || format!("a project is a .honami file: {}", args.project.display()))?;
    let session = make(&args.project, &args.clip, args.fps, common)?;
    Ok(describe(&session))
}

/// Makes a project of a clip.
pub(super) fn make(
    project: &Path,
    clip: &Path,
    fps: Option<f64>,
    common: &Common,
) -> anyhow::Result<Session> {
    Ok(Session::create(project, clip, fps, &options(common))?)
}

/// Size, length and rate of a project's clip.
fn describe(session: &Session) -> Answer {
    let (clip, notes) = (&session.project.clip().clip, session.media.notes());
    let fps = clip.times.nominal_fps();
    let rate = match fps {
        Some(fps) if clip.times.is_variable() => format!("{fps:.2} fps, irregular"),
        Some(fps) => format!("{fps:.2} fps"),
        None => "a single frame".to_owned(),
    };
    let mut text = format!(
        "{}: {} frames of {}x{} pixels, {rate}",
        session.project.path().display(),
        clip.n_frames(),
        clip.width,
        clip.height
    );
    for note in notes {
        text += &format!("\nnote: {note}");
    }
    let json = json!({
        "project": session.project.path(),
        "frames": clip.n_frames(),
        "width": clip.width,
        "height": clip.height,
        "fps": fps,
        "variable_rate": clip.times.is_variable(),
        "sha256": session.project.clip().sha256,
        "notes": notes,
    });
    Answer { json, text, done: true }
}

/// Says where a project's clip is now.
pub(super) fn relink(args: &Relink) -> anyhow::Result<Answer> {
    there(&args.project)?;
    let mut project = Project::open(&args.project, Access::Write)?;
    let options = OpenOptions { fps: project.clip().fps_override, ..OpenOptions::default() };
    let media = media::open(&args.clip, &options)?;
    project.relink(&args.clip, &media.sha256())?;
    let text = format!("{}: its clip is {}", args.project.display(), args.clip.display());
    Ok(Answer { json: json!({ "project": args.project, "clip": args.clip }), text, done: true })
}

/// Writes what was asked for.
pub(super) fn export(args: &Export) -> anyhow::Result<Answer> {
    let is_csv = args.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    want(is_csv, || format!("tables are written as .csv, not as {}", args.out.display()))?;
    let (project, out) = (look(&args.project)?, args.out.display());
    let (text, json) = match args.what {
        ExportWhat::Tracks => {
            let written = export::tracks(&project, &args.out)?;
            let text = format!("{out}: {} tracks, {} samples", written.n_tracks, written.n_rows);
            (text, json!({ "file": args.out, "tracks": written.n_tracks, "samples": written.n_rows }))
        }
        ExportWhat::Groups => {
            let n_tracks = export::groups(&project, &args.out)?;
            (
                format!("{out}: the groups of {n_tracks} tracks"),
                json!({ "file": args.out, "tracks": n_tracks }),
            )
        }
    };
    Ok(Answer { json, text, done: true })
}
