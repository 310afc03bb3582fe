//! `export PROJECT movie`: the clip with what was measured drawn over it.

use std::path::Path;

use anyhow::ensure;
use honami_model::brief::counted;
use honami_workbench::media::write::Kind;
use honami_workbench::movie::{self, Layer, MovieRequest, MovieSize, TRAIL_S};
use honami_workbench::session::{Session, SessionOptions};
use serde_json::json;

use super::args::{Common, Export, Movie, Size};
use super::{Answer, Usage, grow, report, there, told_options, want};
use crate::app::opening::where_is_the_clip;

/// The longest trail, seconds: what lies longer back hides the picture.
const LONGEST_S: f64 = 3600.0;

/// Refuses what is of movies alone.
pub(super) fn refuse(args: &Movie) -> anyhow::Result<()> {
    let typed = [
        (!args.show.is_empty(), "--show"),
        (args.frames.is_some(), "--frames"),
        (args.size.is_some(), "--size"),
        (args.scale.is_some(), "--scale"),
        (args.fps.is_some(), "--fps"),
        (args.trail.is_some(), "--trail"),
    ];
    let typed = typed.iter().find(|(is_typed, _)| *is_typed);
    want(typed.is_none(), || {
        format!("{} is of movies: honami export PROJECT movie OUT", typed.map_or("", |(_, option)| option))
    })?;
    Ok(())
}

/// Writes a movie.
pub(super) fn movie(args: &Export, common: &Common) -> anyhow::Result<Answer> {
    let of_tracks = [
        (args.format.is_some(), "--format"),
        (args.origin.is_some(), "--origin"),
        (args.every_frame, "--every-frame"),
    ];
    let typed = of_tracks.iter().find(|(is_typed, _)| *is_typed);
    want(typed.is_none(), || {
        format!("{} is of tables; a movie is as its ending says", typed.map_or("", |(_, option)| option))
    })?;
    let request = request(args)?;
    there(&args.project)?;
    admit(&args.out, false)?;
    let options = SessionOptions { read_only: true, ..told_options(common) };
    let session =
        Session::open(&args.project, &options).map_err(|error| where_is_the_clip(error, &args.project))?;
    let done = movie::write(&session, &args.out, &request, &report::Bar::with(common))?;
    let shown: Vec<&str> = done.shown.iter().map(|layer| layer.word()).collect();
    let [width, height] = done.size;
    let last = done.frames.end - 1;
    let mut text = format!(
        "{}: {} of {width}x{height} at {} a second, {:.1} MB; the clip's frames {}-{last} with {}",
        args.out.display(),
        counted(done.n_frames, "frame"),
        rounded(done.fps),
        done.bytes as f64 / 1e6,
        done.frames.start,
        shown.join(", "),
    );
    let drawn = [(done.n_tracks, "track"), (done.n_groups, "group"), (done.n_bones, "bone")];
    let drawn: Vec<String> =
        drawn.iter().filter(|(n, _)| *n > 0).map(|(n, what)| counted(*n, what)).collect();
    if !drawn.is_empty() {
        text += &format!("\n{}", drawn.join(", "));
    }
    if (done.speed - 1.0).abs() > 0.005 {
        text += &format!("\nspeed: {} times as filmed", rounded(done.speed));
    }
    done.notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let json = json!({
        "file": args.out,
        "shown": shown,
        "frames": done.n_frames,
        "clip_frames": [done.frames.start, done.frames.end],
        "size": done.size,
        "fps": done.fps,
        "speed": done.speed,
        "tracks": done.n_tracks,
        "groups": done.n_groups,
        "bones": done.n_bones,
        "bytes": done.bytes,
        "notes": done.notes,
        "seconds": done.seconds,
    });
    Ok(Answer { json, text, done: true })
}

/// Whether there can be a movie, or an image, of this name: said before the work for it.
pub(super) fn admit(out: &Path, can_be_image: bool) -> anyhow::Result<()> {
    // It may be the clip itself, or a day's work.
    ensure!(!out.exists(), "{} is there already: choose another name", out.display());
    let kind = Kind::of(out).map_err(|error| Usage(error.to_string()))?;
    want(can_be_image || kind != Kind::Still, || {
        format!("{} is one image: a movie is .mp4, .y4m or a folder of PNG images", out.display())
    })?;
    Ok(kind.admit(out)?)
}

fn request(args: &Export) -> anyhow::Result<MovieRequest> {
    let Movie { show, frames, size, scale, fps, trail } = &args.movie;
    let trail_s = trail.unwrap_or(TRAIL_S);
    want(trail_s > 0.0 && trail_s <= LONGEST_S, || {
        format!(
            "--trail wants seconds, above 0 and to {LONGEST_S}, got {trail_s}: leave trails out of --show for none"
        )
    })?;
    let size = match (size, scale) {
        (Some(Size { width, height }), _) => MovieSize::Pixels([*width, *height]),
        (None, scale) => MovieSize::Scale(scale.unwrap_or(1.0)),
    };
    Ok(MovieRequest {
        show: (!show.is_empty()).then(|| show.iter().copied().collect::<std::collections::BTreeSet<Layer>>()),
        frames: frames.as_ref().map_or((0, None), |frames| (frames.start, frames.end)),
        size,
        fps: *fps,
        trail_s,
        tracks: args.tracks.as_ref().map(|wanted| wanted.tracks()),
        groups: args.groups.as_ref().map(|wanted| wanted.numbers().collect()),
        structure: grow::DEFAULT.to_owned(),
    })
}

/// Without zeros at its end.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
