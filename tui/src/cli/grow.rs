//! `grow`: the branches behind the tracks.

mod carried;
mod siblings;
mod written;

use std::path::PathBuf;

use honami_model::brief::counted;
use honami_workbench::grow::siblings::Settings;
use honami_workbench::grow::{self, ENDINGS, GrowRequest, Growth, Judged, Out, SkeletonFormat};
use honami_workbench::plugins::{Kind, PluginInfo, Value, Values};
use serde_json::json;

use super::args::Common;
use super::args::grow::Grow;
use super::{Answer, look, report, told_options, want};

/// The structure builder that is used unless one is named.
pub(super) const DEFAULT: &str = "diener";

/// What is to be written, and as what.
type Files<'a> = Vec<(Out, &'a PathBuf)>;

/// Grows a skeleton, and writes it.
pub(super) fn grow(args: &Grow, common: &Common) -> anyhow::Result<Answer> {
    let files = files(args)?;
    let options = told_options(common);
    let registry = options.registry();
    let plugin = registry.find(Kind::Structure, args.plugin.with.as_deref().unwrap_or(DEFAULT))?;
    let params = values(args, plugin)?;
    let project = look(&args.project)?;
    carried::check_names(args, &files, project.clip().clip.times.len())?;
    let request = GrowRequest {
        params,
        envelope: args.envelope.clone(),
        root: args.root.map(|place| place.0),
        as_grown: args.as_grown,
        groups: args.groups,
        is_loop: args.is_loop,
    };
    let growth = grow::grow(&project, &options.host, plugin, &request, &report::Bar::with(common))?;
    let judged = args.truth.as_ref().map(|truth| grow::judge(&growth, &project, truth)).transpose()?;
    let settings = Settings { level: args.level, threshold: args.threshold };
    let siblings = args.siblings.map(|n| grow::siblings(&growth, settings).map(|of| (n, of))).transpose()?;
    let carried = carried::carried(args, &growth)?;
    let lines = written::write(args, &files, &growth, &carried)?;
    let leaves = |out: &PathBuf| grow::write_leaves(&growth.skeleton, growth.frames.start, out);
    let n_rows = args.leaves.as_ref().map(leaves).transpose()?;
    let mut answer = describe(args, &growth);
    carried::describe(args, &carried, &mut answer);
    if let Some(judged) = judged {
        answer.text += &format!("\n{}", told(&judged, &growth));
        answer.json["truth"] = json!({
            "groups": judged.n_groups,
            "tracks": judged.n_tracks,
            "frames": [judged.frames.start, judged.frames.end],
            "median_px": judged.median_px,
            "still_px": judged.still_px,
            "motion_px": judged.motion_px,
        });
    }
    lines.iter().for_each(|line| answer.text += &format!("\n{line}"));
    if let (Some(out), Some(n_rows)) = (&args.leaves, n_rows) {
        answer.text += &format!("\n{}: leaves, {}", out.display(), counted(n_rows, "row"));
    }
    if let Some((n, siblings)) = &siblings {
        siblings::draw(*n, siblings, growth.frames.start, args, &files, &carried, &mut answer)?;
    }
    Ok(answer)
}

/// Values of the plugin's parameters: options that were typed are those of their names.
fn values(args: &Grow, plugin: &PluginInfo) -> anyhow::Result<Values> {
    let typed = [
        ("flat", args.flat.then_some(Value::Bool(true))),
        ("shift", args.shift.map(Value::Float)),
        ("copies", args.copies.map(Value::Int)),
    ];
    let mut values = Values::defaults(&plugin.params);
    for (id, value) in typed {
        let Some(value) = value else { continue };
        want(plugin.params.iter().any(|param| param.id == id), || {
            format!("--{id} is of plugins with a parameter of that name, and {} has none", plugin.short_name)
        })?;
        values.set(&plugin.params, id, value)?;
    }
    for assignment in &args.plugin.set {
        values.set_text(&plugin.params, assignment)?;
    }
    Ok(values)
}

/// What is to be written, and as what.
fn files(args: &Grow) -> anyhow::Result<Files<'_>> {
    let mut files = Vec::new();
    for out in &args.out {
        let kind = Out::of(out);
        want(kind.is_some(), || format!("skeletons are written as {ENDINGS}, not as {}", out.display()))?;
        files.extend(kind.map(|kind| (kind, out)));
    }
    carried::check(args, &files)?;
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
    let (n_groups, n_tracks) = (growth.groups.len(), growth.groups.iter().map(Vec::len).sum::<usize>());
    let [x, y] = honami_model::skeleton::seen(skeleton.root());
    let is_deep = skeleton.rest().iter().any(|direction| direction[1].abs() > 0.0);
    let depth = match is_deep {
        false => "in the plane of the picture".to_owned(),
        true => format!("in depth, copies: {}", growth.n_copies),
    };
    let mut text = format!(
        "{}: {} of {}, {} {depth}, root at {x:.1},{y:.1}",
        args.project.display(),
        counted(n_groups, "group"),
        counted(n_tracks, "track"),
        counted(n_joints, "joint"),
    );
    if growth.n_collapsed > 0 {
        text += &format!("\nforks that are one with another: {}", growth.n_collapsed);
    }
    if growth.n_left_out > 0 {
        text += &format!("\ngroups outside the envelope, left out: {}", growth.n_left_out);
    }
    let (frames, by) = (&growth.frames, &growth.provenance.plugin_id);
    let last = frames.end.saturating_sub(1);
    text += &format!("\nframes {}-{last}, by {by}, {:.3} s", frames.start, growth.seconds);
    let is_uneven = skeleton.times().is_variable()
        && args.out.iter().any(|out| Out::of(out) == Some(Out::Skeleton(SkeletonFormat::Bvh)));
    let uneven =
        "frames of the clip are not evenly spaced, those of .bvh are: their times are not kept there";
    let notes: Vec<&str> =
        growth.notes.iter().map(String::as_str).chain(is_uneven.then_some(uneven)).collect();
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let hands =
        growth.hand.bones.iter().map(|(bone, shape)| super::shape::row(bone, shape)).collect::<Vec<_>>();
    let json = json!({
        "groups": n_groups,
        "tracks": n_tracks,
        "joints": n_joints,
        "collapsed": growth.n_collapsed,
        "left_out": growth.n_left_out,
        "copies": growth.n_copies,
        "root": [x, y],
        "hand": {"root": growth.hand.root, "bones": hands},
        "frames": [frames.start, frames.end],
        "seconds": growth.seconds,
        "provenance": growth.provenance,
        "files": args.out,
        "leaves": args.leaves,
        "notes": notes,
    });
    Answer { json, text, done: true }
}

fn told(judged: &Judged, growth: &Growth) -> String {
    let frames = &judged.frames;
    let of = match *frames == growth.frames {
        true => String::new(),
        false => format!(", in frames {}-{} that both have", frames.start, frames.end.saturating_sub(1)),
    };
    format!(
        "beside the truth of {} in {}{of}: joints are {:.2} px off in the median; standing still they would be \
         {:.2} px off, and their motion alone is {:.2} px off",
        counted(judged.n_tracks, "track"),
        counted(judged.n_groups, "group"),
        judged.median_px,
        judged.still_px,
        judged.motion_px
    )
}
