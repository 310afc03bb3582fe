//! `grow`: the branches behind the tracks.

mod siblings;

use std::path::PathBuf;

use honami_model::brief::Brief;
use honami_workbench::grow::siblings::Settings;
use honami_workbench::grow::{self, GrowRequest, Growth, Judged, Out, SkeletonFormat};
use serde_json::json;

use super::args::grow::{Grow, Method};
use super::{Answer, look, want};

/// Grows a skeleton, and writes it.
pub(super) fn grow(args: &Grow) -> anyhow::Result<Answer> {
    let files = files(args)?;
    let method = method(args)?;
    let project = look(&args.project)?;
    let request = GrowRequest {
        method,
        root: args.root.map(|place| place.0),
        groups: args.groups,
        is_flat: args.flat,
        is_loop: args.is_loop,
    };
    let growth = grow::grow(&project, &request)?;
    let judged = args.truth.as_ref().map(|truth| grow::judge(&growth, &project, truth)).transpose()?;
    let settings = Settings { level: args.level, threshold: args.threshold };
    let siblings = args.siblings.map(|n| grow::siblings(&growth, settings).map(|of| (n, of))).transpose()?;
    let unit = args.unit.unwrap_or(grow::UNIT);
    for (kind, out) in &files {
        grow::write(&growth.skeleton, *kind, unit, out)?;
    }
    let n_rows = args.leaves.as_ref().map(|out| grow::write_leaves(&growth.skeleton, out)).transpose()?;
    let mut answer = describe(args, &growth);
    if let Some(judged) = judged {
        answer.text += &format!("\n{}", told(&judged));
        answer.json["truth"] = json!({
            "groups": judged.n_groups,
            "tracks": judged.n_tracks,
            "median_px": judged.median_px,
            "still_px": judged.still_px,
            "motion_px": judged.motion_px,
        });
    }
    for (kind, out) in &files {
        let what = match kind {
            Out::Skeleton(SkeletonFormat::Bvh) => "motion, degrees, y up".to_owned(),
            Out::Skeleton(SkeletonFormat::Angles) => {
                "joints and angles, radians, a row a joint and frame".to_owned()
            }
            Out::Skeleton(SkeletonFormat::Swc) => "the shape at rest, z up".to_owned(),
            Out::Rig => format!("a rig that moves, y up, a pixel taken as {} m", Brief(unit)),
        };
        answer.text += &format!("\n{}: {what}", out.display());
    }
    if let (Some(out), Some(n_rows)) = (&args.leaves, n_rows) {
        answer.text += &format!("\n{}: leaves, {n_rows} rows", out.display());
    }
    if let Some((n, siblings)) = &siblings {
        siblings::draw(*n, siblings, args, &files, &mut answer)?;
    }
    Ok(answer)
}

/// The method, with what is asked of it.
fn method(args: &Grow) -> anyhow::Result<grow::Method> {
    let asked = [
        ("--shift", args.shift.is_some()),
        ("--copies", args.copies.is_some()),
        ("--envelope", args.envelope.is_some()),
    ];
    match args.method {
        Method::Diener => {
            let typed = asked.iter().find(|(_, is_typed)| *is_typed);
            want(typed.is_none(), || {
                format!("{} goes with --method zeng", typed.map_or("", |typed| typed.0))
            })?;
            Ok(grow::Method::Diener)
        }
        Method::Zeng => {
            let shift = args.shift.unwrap_or(grow::SHIFT);
            want((0.0..1.0).contains(&shift), || format!("--shift takes 0 to less than 1, not {shift}"))?;
            let copies = args.copies.unwrap_or(grow::COPIES);
            Ok(grow::Method::Zeng { shift, copies, envelope: args.envelope.clone() })
        }
    }
}

/// What is to be written, and as what.
fn files(args: &Grow) -> anyhow::Result<Vec<(Out, &PathBuf)>> {
    let mut files = Vec::new();
    for out in &args.out {
        let kind = Out::of(out);
        want(kind.is_some(), || {
            format!("skeletons are written as .bvh, .csv, .swc or .glb, not as {}", out.display())
        })?;
        files.extend(kind.map(|kind| (kind, out)));
    }
    want(args.unit.is_none_or(|unit| unit.is_finite() && unit > 0.0), || {
        "--unit takes metres of a pixel, more than 0".to_owned()
    })?;
    let has_rig = files.iter().any(|(kind, _)| *kind == Out::Rig);
    want(args.unit.is_none() || has_rig, || "--unit goes with a .glb, as out.glb".to_owned())?;
    let is_csv = |file: &PathBuf| file.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    if let Some(leaves) = args.leaves.as_ref().filter(|file| !is_csv(file)) {
        want(false, || format!("leaves are written as .csv, not as {}", leaves.display()))?;
    }
    want(args.siblings.is_none() || !files.is_empty(), || {
        "siblings are written beside a skeleton: name its file, as out.bvh".to_owned()
    })?;
    Ok(files)
}

fn describe(args: &Grow, growth: &Growth) -> Answer {
    let skeleton = &growth.skeleton;
    let n_joints = skeleton.joints().len();
    let n_tracks = growth.places.len();
    let [x, y] = honami_model::skeleton::seen(skeleton.root());
    let is_deep = skeleton.rest().iter().any(|direction| direction[1].abs() > 0.0);
    let depth = match (is_deep, args.method) {
        (false, _) => "in the plane of the picture".to_owned(),
        (true, Method::Diener) => "in depth, with a mirror image behind".to_owned(),
        (true, Method::Zeng) => format!("in depth, copies: {}", args.copies.unwrap_or(grow::COPIES)),
    };
    let mut text = format!(
        "{}: {} groups of {n_tracks} tracks, {n_joints} joints {depth}, root at {x:.1},{y:.1}",
        args.project.display(),
        growth.n_groups
    );
    if growth.n_collapsed > 0 {
        text += &format!("\nforks that are one with another: {}", growth.n_collapsed);
    }
    if growth.n_cut > 0 {
        text += &format!("\njoints outside the envelope, cut with what they bear: {}", growth.n_cut);
    }
    let frames = &growth.frames;
    text += &format!("\nframes {}..{}, {:.3} s", frames.start, frames.end, growth.seconds);
    let is_uneven = skeleton.times().is_variable()
        && args.out.iter().any(|out| Out::of(out) == Some(Out::Skeleton(SkeletonFormat::Bvh)));
    let uneven =
        "frames of the clip are not evenly spaced, those of .bvh are: their times are not kept there";
    let notes: Vec<&str> =
        growth.notes.iter().map(String::as_str).chain(is_uneven.then_some(uneven)).collect();
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let json = json!({
        "groups": growth.n_groups,
        "tracks": n_tracks,
        "joints": n_joints,
        "collapsed": growth.n_collapsed,
        "cut": growth.n_cut,
        "alphas": growth.alphas,
        "root": [x, y],
        "frames": [frames.start, frames.end],
        "seconds": growth.seconds,
        "files": args.out,
        "leaves": args.leaves,
        "notes": notes,
    });
    Answer { json, text, done: true }
}

fn told(judged: &Judged) -> String {
    format!(
        "beside the truth of {} tracks in {} groups: joints are {:.2} px off in the median; standing still they would be \
         {:.2} px off, and their motion alone is {:.2} px off",
        judged.n_tracks, judged.n_groups, judged.median_px, judged.still_px, judged.motion_px
    )
}
