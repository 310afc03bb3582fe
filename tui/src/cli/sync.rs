//! `sync`: how far the clocks of two clips are apart.

use std::path::Path;
use std::sync::Arc;

use honami_model::brief::counted;
use honami_workbench::cameras::clock::Offset;
use honami_workbench::media::{self, Media, OpenOptions};
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::sync::{self, Lamp};
use serde_json::{Value, json};

use super::args::Common;
use super::args::space::{Flash, Lit, Sync};
use super::{Answer, look, report, there, told_options, want};
use crate::app::opening::where_is_the_clip;

/// An offset, and what it is from.
pub(super) struct Synced {
    pub(super) offset: Offset,
    /// For people.
    pub(super) how: String,
    /// For machines.
    pub(super) from: Value,
}

/// Says how far two clocks are apart.
pub(super) fn sync(args: &Sync, common: &Common) -> anyhow::Result<Answer> {
    let (left, right) = (&args.left, &args.right);
    two_views([left, right])?;
    let by_flash = by_flash([left, right], &args.flash, common)?;
    let Synced { offset, how, from } = match by_flash {
        Some(synced) => synced,
        None => by_motion([left, right], args.most)?,
    };
    let Offset { seconds, error_s, alike, rival_s } = offset;
    let text = format!(
        "what happens at t in {} happens at t {} in {}: {how}",
        left.display(),
        signed(&offset),
        right.display()
    );
    let mut json = json!({ "offset_s": seconds, "error_s": error_s, "alike": alike, "rival_s": rival_s });
    if let (Some(json), Value::Object(from)) = (json.as_object_mut(), from) {
        json.extend(from);
    }
    Ok(Answer { json, text, done: true })
}

/// Refuses the same file for both views.
pub(super) fn two_views([left, right]: [&Path; 2]) -> Result<(), super::Usage> {
    let is_one = left.canonicalize().is_ok_and(|left| right.canonicalize().is_ok_and(|right| left == right));
    want(!is_one, || format!("{} is given as left and as right: wanted two views", left.display()))
}

/// `+ 0.4137 s ± 0.0002 s`; what was given without an error has none.
pub(super) fn signed(Offset { seconds, error_s, .. }: &Offset) -> String {
    let sign = if *seconds < 0.0 { '-' } else { '+' };
    if *error_s <= 0.0 {
        return format!("{sign} {:.4} s", seconds.abs());
    }
    // Two digits of the error, between milliseconds and microseconds.
    let digits = (1.0 - error_s.max(1e-6).log10().floor()).clamp(3.0, 6.0) as usize;
    format!("{sign} {:.digits$} s ± {error_s:.digits$} s", seconds.abs())
}

/// By the flash that was asked for, if one was.
pub(super) fn by_flash(
    [left, right]: [&Path; 2],
    flash: &Flash,
    common: &Common,
) -> anyhow::Result<Option<Synced>> {
    let Some(Lit(in_left)) = flash.flash else { return Ok(None) };
    let in_right = flash.flash_right.map_or(in_left, |Lit(region)| region);
    let find = |path: &Path, region: Option<super::args::Region>, exposure| {
        let region = region.map(|at| [at.x, at.y, at.width, at.height]);
        let lamp = Lamp { region, exposure, gamma: flash.gamma };
        Ok::<_, anyhow::Error>(sync::flash(&*clip(path, common)?, path, &lamp, &report::Bar::with(common))?)
    };
    let flashes = [find(left, in_left, flash.exposure[0])?, find(right, in_right, flash.exposure[1])?];
    let [a, b] = flashes.map(|flash| flash.seconds);
    Ok(Some(Synced {
        offset: sync::by_flash(flashes),
        how: format!("a flash at {a:.4} s and at {b:.4} s"),
        from: json!({ "by": "flash", "flash_s": [a, b] }),
    }))
}

fn by_motion([left, right]: [&Path; 2], most_s: f64) -> anyhow::Result<Synced> {
    for path in [left, right] {
        want(path.extension().is_some_and(|e| e == "honami"), || {
            format!(
                "{} is no project: movement is compared of projects with tracks, clips want --flash",
                path.display()
            )
        })?;
    }
    let found = sync::by_motion(&look(left)?, &look(right)?, most_s)?;
    let [n_left, n_right] = found.n_tracks;
    let alike = found.offset.alike;
    let of = if found.named {
        format!("{} of the same names", counted(n_left, "track"))
    } else {
        format!("{} and {n_right}", counted(n_left, "track"))
    };
    let rival = found.offset.rival_s.map_or_else(String::new, |rival_s| {
        format!(
            "\ndoubtful: at {rival_s:+.2} s they are nearly as alike, as what sways evenly is a swing away; --most leaves out what is \
             too far, a lamp in both (--flash) tells"
        )
    });
    Ok(Synced {
        offset: found.offset,
        how: format!("movement of {of}, alike {alike:.3}{rival}"),
        from: json!({ "by": "motion", "tracks": [n_left, n_right], "named": found.named }),
    })
}

/// The clip that a path names: of a project its own.
fn clip(path: &Path, common: &Common) -> anyhow::Result<Arc<Media>> {
    if path.extension().is_none_or(|e| e != "honami") {
        let options = OpenOptions { cache_bytes: Some(0), ..OpenOptions::default() };
        return Ok(Arc::new(media::open(path, &options)?));
    }
    there(path)?;
    let options = SessionOptions { read_only: true, ..told_options(common) };
    let session = Session::open(path, &options).map_err(|error| where_is_the_clip(error, path))?;
    Ok(session.media)
}
