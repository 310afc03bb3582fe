//! `new` and `relink`: a project and its clip.

use std::path::Path;

use honami_model::brief::counted;
use honami_workbench::media::{self, OpenOptions};
use honami_workbench::session::Session;
use honami_workbench::store::{Access, Project};
use serde_json::json;

use super::args::{Common, New, Relink};
use super::{Answer, options, there, want};

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
        "{}: {} of {}x{} pixels, {rate}",
        session.project.path().display(),
        counted(clip.n_frames() as usize, "frame"),
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
