//! `import` and `export`: tracks of other programs, in and out.

use std::path::Path;

use honami_model::brief::counted;
use honami_workbench::WorkbenchError;
use honami_workbench::export::{self, ExportRequest, InSpaceWritten};
use honami_workbench::foreign::Format;
use honami_workbench::import::{self, ImportRequest};
use honami_workbench::review;
use honami_workbench::store::{Access, Project};
use serde_json::json;

use super::args::{Common, Export, ExportWhat, Import, Size};
use super::report::Bar;
use super::{Answer, look, matte, movie, there, want};

/// Reads somebody else's tracks into a project.
pub(super) fn import(args: &Import) -> anyhow::Result<Answer> {
    there(&args.project)?;
    want(args.pixel_size.is_none_or(|size| size.is_finite() && size > 0.0), || {
        "--pixel-size wants a positive number of the file's units".to_owned()
    })?;
    let mut project = Project::open(&args.project, Access::Write)?;
    let request = ImportRequest {
        file: args.file.clone(),
        format: args.format,
        origin: args.origin,
        size: args.size.map(|Size { width, height }| [width, height]),
        camera: args.camera,
        pixel_size: args.pixel_size,
        keys: !args.no_keys,
    };
    let done = import::tracks(&mut project, &request, &Bar::new())?;
    let (file, format) = (args.file.display(), done.format.word());
    let mut text = format!(
        "{file} ({format}): {}, {}",
        counted(done.n_tracks, "track"),
        counted(done.n_samples as usize, "sample")
    );
    if done.n_keys > 0 {
        text += &format!(", {} of them key-frames", done.n_keys);
    }
    text += &format!("; run {}", done.run);
    let notes = [
        (
            done.n_renumbered as u64,
            ["track has a new number", "tracks have new numbers"],
            ": its own is in use here, or once was",
        ),
        (done.n_beyond, ["sample", "samples"], " left out: the clip has no such frames"),
        (
            done.n_outside,
            ["sample lies", "samples lie"],
            " outside the picture: is the --origin or the --size another?",
        ),
    ];
    let notes = notes.iter().filter(|(n, ..)| *n > 0);
    let notes =
        notes.map(|(n, [one, many], why)| format!("\nnote: {n} {}{why}", if *n == 1 { one } else { many }));
    let dropped = done.dropped.iter().map(|what| format!("\nnot read: {what}"));
    text.extend(notes.chain(dropped));
    let json = json!({
        "project": args.project,
        "file": args.file,
        "format": format,
        "run": done.run,
        "tracks": done.n_tracks,
        "samples": done.n_samples,
        "key_frames": done.n_keys,
        "renumbered": done.n_renumbered,
        "beyond_clip": done.n_beyond,
        "outside_picture": done.n_outside,
        "not_read": done.dropped,
    });
    Ok(Answer { json, text, done: true })
}

/// Writes what was asked for.
pub(super) fn export(args: &Export, common: &Common) -> anyhow::Result<Answer> {
    want(args.out != Path::new("-"), || {
        "export writes a file that is whole or not there, never to standard output: name one instead of -"
            .to_owned()
    })?;
    if args.what != ExportWhat::Movie {
        movie::refuse(&args.movie)?;
    }
    match args.what {
        ExportWhat::Movie => movie::movie(args, common),
        ExportWhat::Tracks => tracks(args),
        ExportWhat::Groups => groups(args),
        ExportWhat::Space => space(args),
        ExportWhat::Verdicts => of_review(args, review::tables::verdicts, "verdicts"),
        ExportWhat::Mask => matte::export(args),
        ExportWhat::Effort => of_review(args, review::tables::efforts, "reviewed tracks"),
    }
}

/// Writes a table of the review; these are CSV.
fn of_review(
    args: &Export,
    write: fn(&Project, &Path) -> Result<usize, WorkbenchError>,
    what: &str,
) -> anyhow::Result<Answer> {
    let is_csv = args.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    want(is_csv, || format!("{what} are written as .csv, not as {}", args.out.display()))?;
    let n = write(&look(&args.project)?, &args.out)?;
    let text = format!("{}: {n} {what}", args.out.display());
    Ok(Answer { json: json!({ "file": args.out, "rows": n }), text, done: true })
}

fn tracks(args: &Export) -> anyhow::Result<Answer> {
    let ending = args.out.extension().unwrap_or_default().to_string_lossy();
    let format = args.format.or_else(|| Format::of_extension(&ending));
    let words = Format::words().join(", ");
    want(format.is_some(), || {
        format!("{}: no format has that ending alone; say --format: {words}", args.out.display())
    })?;
    want(args.box_px.is_finite() && args.box_px > 0.0, || {
        "--box wants a positive number of pixels".to_owned()
    })?;
    let request = ExportRequest {
        tracks: args.tracks.as_ref().map(|wanted| wanted.tracks()),
        groups: args.groups.as_ref().map(|wanted| wanted.numbers().collect()),
        origin: args.origin,
        every_frame: args.every_frame,
        box_px: args.box_px,
        ..ExportRequest::of(format.unwrap_or(Format::Csv))
    };
    let written = export::tracks(&look(&args.project)?, &args.out, &request)?;
    let word = request.format.word();
    let mut text = format!(
        "{} ({word}): {}, {}",
        args.out.display(),
        counted(written.n_tracks, "track"),
        counted(written.n_samples as usize, "sample")
    );
    text.extend(written.losses.iter().map(|loss| format!("\nnot kept: {loss}")));
    let losses: Vec<_> = written
        .losses
        .iter()
        .map(|loss| json!({ "what": loss.what, "n": loss.n, "how": loss.how }))
        .collect();
    let json = json!({
        "file": args.out,
        "format": word,
        "tracks": written.n_tracks,
        "samples": written.n_samples,
        "not_kept": losses,
    });
    Ok(Answer { json, text, done: true })
}

fn space(args: &Export) -> anyhow::Result<Answer> {
    let is_one = |of: &str| args.out.extension().is_some_and(|e| e.eq_ignore_ascii_case(of));
    want(is_one("csv") || is_one("c3d"), || {
        format!("tracks in space are written as .csv or .c3d, not as {}", args.out.display())
    })?;
    let InSpaceWritten { n_tracks, n_fixes, stale, losses } =
        export::space(&look(&args.project)?, &args.out)?;
    let (tracks, places) = (counted(n_tracks, "track"), counted(n_fixes, "place"));
    let mut text = format!("{}: {tracks} in space, {places}", args.out.display());
    stale.iter().for_each(|why| text += &format!("\n{why}; honami triangulate finds them anew"));
    losses.iter().for_each(|loss| text += &format!("\nnot kept: {loss}"));
    let json = json!({
        "file": args.out,
        "tracks": n_tracks,
        "fixes": n_fixes,
        "stale": stale,
        "not_kept": losses,
    });
    Ok(Answer { json, text, done: true })
}

fn groups(args: &Export) -> anyhow::Result<Answer> {
    let is_csv = Path::new(&args.out).extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    want(is_csv, || format!("groups are written as .csv, not as {}", args.out.display()))?;
    let n_tracks = export::groups(&look(&args.project)?, &args.out)?;
    let text = format!("{}: the groups of {}", args.out.display(), counted(n_tracks, "track"));
    Ok(Answer { json: json!({ "file": args.out, "tracks": n_tracks }), text, done: true })
}
