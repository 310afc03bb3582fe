//! `triangulate`: where tracks of two views are in space.

use honami_model::brief::counted;
use honami_workbench::cameras::clock::Offset;
use honami_workbench::space::{self, Because, Clocks, Found, Paired, SpaceRequest};
use honami_workbench::store::{Access, Project};
use serde_json::json;

use super::args::Common;
use super::args::space::Triangulate;
use super::sync::two_views;
use super::{Answer, look, report, sync, there};

/// Another pair that costs so little more is a doubt, pixels.
const DOUBTFUL_PX: f64 = 1.0;

/// Finds tracks in space and keeps them in the left project.
pub(super) fn triangulate(args: &Triangulate, common: &Common) -> anyhow::Result<Answer> {
    there(&args.left)?;
    two_views([&args.left, &args.right])?;
    let right = look(&args.right)?;
    let (clocks, how) = clocks(args, common)?;
    let mut left = Project::open(&args.left, Access::Write)?;
    let request = SpaceRequest {
        cameras: args.cameras.clone(),
        unit: args.unit,
        clocks,
        pairing: args.pairing.into(),
        farthest_px: args.farthest,
        sigma_px: args.sigma,
    };
    let job = space::prepare(&left, &right, request)?;
    let bar = report::Bar::with(common);
    let done = job.run(&bar)?;
    drop(bar);
    let found = space::finish(&mut left, done)?;
    Ok(answer(&found, &how, args))
}

/// How far the clocks are apart, and what is said of it.
fn clocks(args: &Triangulate, common: &Common) -> anyhow::Result<(Clocks, String)> {
    if let Some(seconds) = args.offset {
        let offset = Offset { seconds, error_s: args.offset_error, alike: 1.0, rival_s: None };
        return Ok((Clocks::Apart(offset), "the right clock is ahead as given".to_owned()));
    }
    if let Some(synced) = sync::by_flash([&args.left, &args.right], &args.flash, common)? {
        return Ok((Clocks::Apart(synced.offset), synced.how));
    }
    let how = "both clips are taken to begin at the same moment: honami sync tells, --offset says otherwise";
    Ok((Clocks::BeginTogether, how.to_owned()))
}

fn answer(found: &Found, how: &str, args: &Triangulate) -> Answer {
    let named = found.pairs.iter().filter(|pair| pair.because == Because::Named).count();
    let n_fixes: usize = found.pairs.iter().map(|pair| pair.n_fixes).sum();
    let n_lost: usize = found.pairs.iter().map(|pair| pair.n_lost).sum();
    let [alone_left, alone_right] = found.n_unmatched;
    let [along, across] = found.errors_m.map(|m| 1e3 * m);
    let mut text = format!(
        "{} in space ({named} by name, {} by motion), {}; without a partner {alone_left} left, {alone_right} right\n\
         clocks: {}; {how}\n\
         median residual {:.2} px: a sample is known to {:.2} px; median errors {along:.2} mm along the view, {across:.2} mm across",
        counted(found.pairs.len(), "track"),
        found.pairs.len() - named,
        counted(n_fixes, "place"),
        sync::signed(&found.offset),
        found.residual_px,
        found.sigma_px
    );
    if n_lost > 0 {
        text +=
            &format!("\nin {} the lines of sight do not meet before both cameras", counted(n_lost, "frame"));
    }
    let [beyond_left, beyond_right] = found.n_beyond;
    if beyond_left + beyond_right > 0 {
        text += &format!(
            "\nleft out: {} of the left tracks and {beyond_right} of the right ones lie beyond what the cameras' distortion can describe: \
             calibrate with views that reach there",
            counted(beyond_left, "sample")
        );
    }
    let doubts = found.pairs.iter().filter_map(|pair| doubt(pair, args.farthest));
    text.extend(doubts.map(|doubt| format!("\n{doubt}")));
    let pairs: Vec<_> = found.pairs.iter().map(entry).collect();
    let json = json!({
        "space": found.id,
        "pairs": pairs,
        "unmatched": { "left": alone_left, "right": alone_right },
        "beyond": { "left": beyond_left, "right": beyond_right },
        "fixes": n_fixes,
        "offset_s": found.offset.seconds,
        "offset_error_s": found.offset.error_s,
        "begin_together": args.offset.is_none() && args.flash.flash.is_none(),
        "residual_px": found.residual_px,
        "sigma_px": found.sigma_px,
        "error_along_m": found.errors_m[0],
        "error_across_m": found.errors_m[1],
    });
    Answer { json, text, done: true }
}

/// A sentence of a pair that may be none.
fn doubt(pair: &Paired, farthest_px: f64) -> Option<String> {
    let Paired { left, right, because, residual_px, .. } = pair;
    match because {
        Because::Moves(found) if found.margin_px < DOUBTFUL_PX => Some(format!(
            "doubtful: {left} and {right}: another pair would be {:.1} px worse; the same name in both says for sure",
            found.margin_px
        )),
        Because::Named if *residual_px > farthest_px => Some(format!(
            "doubtful: {left} and {right} have one name, and are {residual_px:.1} px from being one place"
        )),
        _ => None,
    }
}

fn entry(pair: &Paired) -> serde_json::Value {
    let mut json = json!({
        "left": pair.left,
        "right": pair.right,
        "by": if pair.because == Because::Named { "name" } else { "motion" },
        "fixes": pair.n_fixes,
        "lost": pair.n_lost,
        "residual_px": pair.residual_px,
    });
    if let Because::Moves(found) = pair.because {
        json["epipolar_px"] = json!(found.epipolar_px);
        json["alike"] = json!(found.alike);
        // Infinite where there is no other: none in JSON.
        json["margin_px"] = json!(found.margin_px.is_finite().then_some(found.margin_px));
    }
    json
}
