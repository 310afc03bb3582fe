//! `matte`: how much of every pixel is plant, and the mask of what is worth tracking.

use std::path::{Path, PathBuf};

use honami_model::brief::counted;
use honami_workbench::matte::{self, MarkSource, MatteRequest, Matted, carried, kept};
use honami_workbench::matting::{Matte as Opacities, Options, Part, Parts, PartsWish};
use honami_workbench::media::{self, OpenOptions, Still};
use honami_workbench::plugins::quoted;
use honami_workbench::session::{Session, SessionOptions};
use serde_json::{Map, Value, json};

use super::args::matte::Matte;
use super::args::{Common, Export};
use super::{Answer, Usage, look, report, session, there, told_options, want};
use crate::app::opening::where_is_the_clip;

/// Finds a matte and writes what was asked for; of a project it is kept, and what is kept is listed.
pub(super) fn matte(args: &Matte, common: &Common) -> anyhow::Result<Answer> {
    let of_matte: Vec<&PathBuf> = [&args.out, &args.mask, &args.parts].into_iter().flatten().collect();
    let written: Vec<&PathBuf> = args.picture.iter().chain(of_matte.iter().copied()).collect();
    written.iter().try_for_each(|out| want_png(out))?;
    let is_project = args.picture_of.extension().is_some_and(|e| e == "honami");
    if args.remove {
        want(is_project, || format!("--remove is of projects, not of {}", args.picture_of.display()))?;
        return remove(args, common);
    }
    if let Some(every) = args.every {
        want(is_project, || format!("--every is of projects, not of {}", args.picture_of.display()))?;
        return carry(args, every, common);
    }
    let marks = match (&args.scribbles, &args.trimap) {
        (Some(path), _) => Some(MarkSource::Scribbles(path.clone())),
        (None, Some(path)) => Some(MarkSource::Trimap(path.clone())),
        (None, None) => None,
    };
    if marks.is_none() && is_project && args.picture.is_none() {
        return if of_matte.is_empty() { list(args) } else { write_kept(args, common, &of_matte) };
    }
    want(marks.is_some() || (args.picture.is_some() && of_matte.is_empty()), || {
        "--scribbles or --trimap says what is plant and what lies behind; --picture OUT.png writes the picture to paint on"
            .to_owned()
    })?;
    let frame = args.frame.unwrap_or(0);
    let mut session = is_project.then(|| open(&args.picture_of, marks.is_none(), common)).transpose()?;
    let still = match &session {
        Some(session) => matte::frame(&session.media, frame)?,
        None => still(&args.picture_of, frame)?,
    };
    if let Some(path) = &args.picture {
        media::write::still(path, &still.rgb, still.width, still.height)?;
    }
    let Some(marks) = marks else {
        let json = json!({ "width": still.width, "height": still.height, "files": written });
        return Ok(Answer { json, text: listed(&written), done: true });
    };
    let request = MatteRequest {
        path: args.picture_of.clone(),
        marks,
        options: Options { epsilon: args.epsilon, lambda: args.lambda },
        parts: PartsWish { boundary_px: args.band, speck: args.speck, trunk: !args.with_trunk },
    };
    let bar = report::Bar::with(common);
    let found = matte::run(&still, &request, &bar)?;
    drop(bar);
    write(args, &found.matte, &found.parts, &still)?;
    let mut answer = answer(&found, &written);
    if let Some(session) = &mut session {
        let kept = kept::keep(&mut session.project, &[(frame, &request, &found)])?;
        answer.json["matte"] = json!(kept.first().map(|(_, id)| id));
        answer.json["frame"] = json!(frame);
        answer.text += &format!(
            "\nkept as the matte of frame {frame}: features are looked for inside it; back: echo undo | honami edit {}",
            quoted(&args.picture_of)
        );
    }
    Ok(answer)
}

/// Writes the mask that counts in a frame of a project.
pub(super) fn export(args: &Export) -> anyhow::Result<Answer> {
    want_png(&args.out)?;
    let (of, matte) = kept::at(&look(&args.project)?, args.frame)?;
    let parts = kept::parts(&matte)?;
    matte::write_gray(&args.out, &parts.mask(), [parts.width, parts.height])?;
    let n_kept = parts.n_pixels(Part::Kept);
    let text = format!(
        "{}: the mask of frame {of}, {} of {}x{} kept",
        args.out.display(),
        counted(n_kept, "pixel"),
        parts.width,
        parts.height
    );
    let json = json!({ "file": args.out, "frame": of, "width": parts.width, "height": parts.height, "kept": n_kept });
    Ok(Answer { json, text, done: true })
}

fn want_png(out: &Path) -> Result<(), Usage> {
    want(out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")), || {
        format!("pictures are written as .png, not as {}", out.display())
    })
}

fn remove(args: &Matte, common: &Common) -> anyhow::Result<Answer> {
    let mut session = open(&args.picture_of, false, common)?;
    let frames = kept::remove(&mut session.project, args.frame)?;
    let text = format!(
        "{} of {} kept no longer; back: echo undo | honami edit {}",
        if frames.len() == 1 { "the matte" } else { "the mattes" },
        kept::frames(&frames),
        quoted(&args.picture_of)
    );
    Ok(Answer { json: json!({ "removed": frames }), text, done: true })
}

/// Carries the matte of a frame on over the clip.
fn carry(args: &Matte, every: u32, common: &Common) -> anyhow::Result<Answer> {
    let mut session = open(&args.picture_of, false, common)?;
    let bar = report::Bar::with(common);
    let done = carried::carry(&mut session, args.frame.unwrap_or(0), every, &bar)?;
    drop(bar);
    let frames: Vec<u32> = done.kept.iter().map(|(frame, _)| *frame).collect();
    let mut text = format!(
        "carried from frame {} to {}; back: echo undo | honami edit {}",
        done.from,
        kept::frames(&frames),
        quoted(&args.picture_of)
    );
    if frames.is_empty() {
        text = format!(
            "nothing was carried: the clip has no such frame after frame {}, or all have mattes of their own",
            done.from
        );
    }
    if let Some((frame, why)) = &done.ended {
        text += &format!("\nit ends before frame {frame}: {why}");
    }
    let ended = done.ended.as_ref().map(|(frame, why)| json!({ "frame": frame, "why": why.to_string() }));
    let json = json!({ "from": done.from, "frames": frames, "ended": ended });
    Ok(Answer { json, text, done: done.ended.is_none() })
}

/// What a project keeps.
fn list(args: &Matte) -> anyhow::Result<Answer> {
    let mut all = kept::all(&look(&args.picture_of)?)?;
    let frames: Vec<u32> = all.iter().map(|one| one.frame).collect();
    all.retain(|one| args.frame.is_none_or(|frame| frame == one.frame));
    let line = |one: &kept::Counting| {
        let n_pixels = one.parts.parts.len().max(1) as f64;
        let share = |part: &Part| {
            format!("{} {:.1} %", part.word(), 100.0 * one.parts.n_pixels(*part) as f64 / n_pixels)
        };
        let shares: Vec<String> = Part::ALL.iter().rev().map(share).collect();
        let marks = one.provenance.params.get("marks").map_or_else(String::new, |marks| format!("  {marks}"));
        format!("frame {}  {}{marks}  {}", one.frame, shares.join(", "), one.provenance.date)
    };
    let text = match (&all[..], args.frame) {
        ([], Some(frame)) if !frames.is_empty() => {
            format!("no matte of frame {frame} is kept; there are those of {}", kept::frames(&frames))
        }
        ([], _) => "no matte is kept: features are looked for everywhere".to_owned(),
        (all, _) => all.iter().map(line).collect::<Vec<_>>().join("\n"),
    };
    let entry = |one: &kept::Counting| {
        json!({
            "matte": one.id,
            "frame": one.frame,
            "width": one.parts.width,
            "height": one.parts.height,
            "parts": counts(&one.parts),
            "provenance": one.provenance,
        })
    };
    Ok(Answer { json: json!({ "mattes": all.iter().map(entry).collect::<Vec<_>>() }), text, done: true })
}

/// Writes pictures of the matte that counts in a frame.
fn write_kept(args: &Matte, common: &Common, written: &[&PathBuf]) -> anyhow::Result<Answer> {
    let session = open(&args.picture_of, true, common)?;
    let (frame, kept) = kept::at(&session.project, args.frame.unwrap_or(0))?;
    let parts = kept::parts(&kept)?;
    write(args, &kept::matte(&kept), &parts, &matte::frame(&session.media, frame)?)?;
    let json = json!({ "frame": frame, "parts": counts(&parts), "files": written });
    Ok(Answer { json, text: format!("of the matte of frame {frame}:\n{}", listed(written)), done: true })
}

/// Opens a project with its clip.
fn open(path: &Path, read_only: bool, common: &Common) -> anyhow::Result<Session> {
    if !read_only {
        return session(path, common);
    }
    there(path)?;
    let options = SessionOptions { read_only, ..told_options(common) };
    Session::open(path, &options).map_err(|error| where_is_the_clip(error, path))
}

/// The picture: an image as it is, or a frame of a clip.
fn still(path: &Path, frame: u32) -> anyhow::Result<Still> {
    if Still::is_one(path) {
        want(frame == 0, || format!("{} is one picture: --frame is of clips", path.display()))?;
        return Ok(Still::read(path)?);
    }
    let options = OpenOptions { cache_bytes: Some(0), ..OpenOptions::default() };
    Ok(matte::frame(&media::open(path, &options)?, frame)?)
}

fn write(args: &Matte, opacities: &Opacities, parts: &Parts, still: &Still) -> anyhow::Result<()> {
    let size = [still.width, still.height];
    if let Some(path) = &args.out {
        matte::write_gray(path, &opacities.gray(), size)?;
    }
    if let Some(path) = &args.mask {
        matte::write_gray(path, &parts.mask(), size)?;
    }
    if let Some(path) = &args.parts {
        matte::write_parts(path, parts, still)?;
    }
    Ok(())
}

fn listed(written: &[&PathBuf]) -> String {
    written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join("\n")
}

fn answer(found: &Matted, written: &[&PathBuf]) -> Answer {
    let (width, height) = (found.matte.width, found.matte.height);
    let n_pixels = f64::from(width) * f64::from(height);
    let [background, foreground] = found.n_marked();
    let mean = found.matte.alpha.iter().map(|&alpha| f64::from(alpha)).sum::<f64>() / n_pixels;
    let mut text = format!(
        "{width}x{height}: {:.1} % plant, from {foreground} pixels of plant and {background} of background; {} steps",
        100.0 * mean,
        found.matte.n_steps
    );
    for part in Part::ALL {
        text +=
            &format!("\n{:<16} {:>5.1} %", part.word(), 100.0 * found.parts.n_pixels(part) as f64 / n_pixels);
    }
    if found.parts.n_pixels(Part::Kept) == 0 {
        text += "\nNothing is kept: a smaller --band keeps more";
    }
    if !written.is_empty() {
        text += &format!("\n{}", listed(written));
    }
    let json = json!({
        "width": width,
        "height": height,
        "alpha_mean": mean,
        "marked": { "background": background, "foreground": foreground },
        "parts": counts(&found.parts),
        "steps": found.matte.n_steps,
        "files": written,
    });
    Answer { json, text, done: true }
}

/// Pixels of every part.
fn counts(parts: &Parts) -> Map<String, Value> {
    Part::ALL.iter().map(|part| (part.word().replace(' ', "_"), json!(parts.n_pixels(*part)))).collect()
}
