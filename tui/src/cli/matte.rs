//! `matte`: how much of every pixel is plant, and the mask of what is worth tracking.

use std::path::PathBuf;

use honami_workbench::matte::{self, MarkSource, MatteRequest, Matted};
use honami_workbench::matting::{Options, Part, PartsWish};
use honami_workbench::media::{self, OpenOptions, Still};
use honami_workbench::session::{Session, SessionOptions};
use serde_json::json;

use super::args::Common;
use super::args::matte::Matte;
use super::{Answer, report, there, told_options, want};
use crate::app::opening::where_is_the_clip;

/// Finds a matte and writes what was asked for.
pub(super) fn matte(args: &Matte, common: &Common) -> anyhow::Result<Answer> {
    let of_matte: Vec<&PathBuf> = [&args.out, &args.mask, &args.parts].into_iter().flatten().collect();
    let written: Vec<&PathBuf> = args.picture.iter().chain(of_matte.iter().copied()).collect();
    for out in &written {
        want(out.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")), || {
            format!("pictures are written as .png, not as {}", out.display())
        })?;
    }
    let marks = match (&args.scribbles, &args.trimap) {
        (Some(path), _) => Some(MarkSource::Scribbles(path.clone())),
        (None, Some(path)) => Some(MarkSource::Trimap(path.clone())),
        (None, None) => None,
    };
    want(marks.is_some() || (args.picture.is_some() && of_matte.is_empty()), || {
        "--scribbles or --trimap says what is plant and what lies behind; --picture OUT.png writes the picture to paint on"
            .to_owned()
    })?;
    let still = still(args, common)?;
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
    let size = [still.width, still.height];
    if let Some(path) = &args.out {
        matte::write_gray(path, &found.matte.gray(), size)?;
    }
    if let Some(path) = &args.mask {
        matte::write_gray(path, &found.parts.mask(), size)?;
    }
    if let Some(path) = &args.parts {
        matte::write_parts(path, &found.parts, &still)?;
    }
    Ok(answer(&found, &written))
}

/// The picture: an image as it is, or a frame.
fn still(args: &Matte, common: &Common) -> anyhow::Result<Still> {
    let path = &args.picture_of;
    if Still::is_one(path) {
        want(args.frame == 0, || format!("{} is one picture: --frame is of clips", path.display()))?;
        return Ok(Still::read(path)?);
    }
    if path.extension().is_none_or(|e| e != "honami") {
        let options = OpenOptions { cache_bytes: Some(0), ..OpenOptions::default() };
        return Ok(matte::frame(&media::open(path, &options)?, args.frame)?);
    }
    there(path)?;
    let options = SessionOptions { read_only: true, ..told_options(common) };
    let session = Session::open(path, &options).map_err(|error| where_is_the_clip(error, path))?;
    Ok(matte::frame(&session.media, args.frame)?)
}

fn listed(written: &[&PathBuf]) -> String {
    written.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join("\n")
}

fn answer(found: &Matted, written: &[&PathBuf]) -> Answer {
    let (width, height) = (found.matte.width, found.matte.height);
    let n_pixels = f64::from(width) * f64::from(height);
    let [background, foreground] = found.n_marked;
    let mean = found.matte.alpha.iter().map(|&alpha| f64::from(alpha)).sum::<f64>() / n_pixels;
    let shares = Part::ALL.map(|part| (part.word(), found.parts.n_pixels(part)));
    let mut text = format!(
        "{width}x{height}: {:.1} % plant, from {foreground} pixels of plant and {background} of background; {} steps",
        100.0 * mean,
        found.matte.n_steps
    );
    for (word, n) in shares {
        text += &format!("\n{word:<16} {:>5.1} %", 100.0 * n as f64 / n_pixels);
    }
    if found.parts.n_pixels(Part::Kept) == 0 {
        text += "\nNothing is kept: a smaller --band keeps more";
    }
    if !written.is_empty() {
        text += &format!("\n{}", listed(written));
    }
    let parts: serde_json::Map<_, _> =
        shares.iter().map(|(word, n)| (word.replace(' ', "_"), json!(n))).collect();
    let json = json!({
        "width": width,
        "height": height,
        "alpha_mean": mean,
        "marked": { "background": background, "foreground": foreground },
        "parts": parts,
        "steps": found.matte.n_steps,
        "files": written,
    });
    Answer { json, text, done: true }
}
