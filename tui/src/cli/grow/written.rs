//! Files of the skeleton, and what is told of each.

use std::path::{Path, PathBuf};

use honami_model::brief::{Brief, counted};
use honami_workbench::grow::{self, Carried, Growth, Out, SkeletonFormat};

use super::super::args::grow::Grow;

/// Writes all files; a line of each.
pub(super) fn write(
    args: &Grow,
    files: &[(Out, &PathBuf)],
    growth: &Growth,
    carried: &Carried,
) -> anyhow::Result<Vec<String>> {
    let folder = |out: &PathBuf| out.parent().map(Path::to_owned).unwrap_or_default();
    let is_new = |folder: &PathBuf| !folder.as_os_str().is_empty() && !folder.exists();
    let made: Vec<PathBuf> = files.iter().map(|(_, out)| folder(out)).filter(is_new).collect();
    let mut lines = Vec::new();
    for (kind, out) in files {
        grow::write(&growth.skeleton, growth.frames.start, *kind, carried, out)?;
        let what = what(args, *kind, out, growth, carried);
        let made = if made.contains(&folder(out)) { ", in a folder made for them" } else { "" };
        lines.push(format!("{}: {what}{made}", out.display()));
    }
    Ok(lines)
}

fn what(args: &Grow, kind: Out, out: &Path, growth: &Growth, carried: &Carried) -> String {
    let unit = format!("a pixel taken as {} m", Brief(carried.unit));
    let what = match kind {
        Out::Skeleton(SkeletonFormat::Bvh) => "motion, degrees, y up",
        Out::Skeleton(SkeletonFormat::Angles) => "joints and angles, radians, a row a joint and frame",
        Out::Skeleton(SkeletonFormat::Swc) => "the shape at rest, z up",
        Out::Rig | Out::Usd if args.onto.is_some() => "the plant as a rig that moves, y up",
        Out::Rig | Out::Usd if !args.branches.is_empty() => {
            return format!("the plant of branches as a rig that moves, y up, {unit}");
        }
        Out::Rig | Out::Usd => return format!("a rig that moves, y up, {unit}"),
        Out::Cache => "where the vertices of the plant are in every frame",
        Out::Frames(_) => {
            let n_frames = growth.skeleton.times().len();
            let behind = match kind.n_behind(out, n_frames) {
                0 => String::new(),
                n => {
                    format!("; {n} more stand behind them, of a longer motion that was written there before")
                }
            };
            return format!("{} of what it carries{behind}", counted(n_frames as usize, "frame"));
        }
    };
    what.to_owned()
}
