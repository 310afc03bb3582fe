//! `grow --siblings`: skeletons that are alike, but not the same.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use honami_workbench::grow::{self, Carried, Out, Siblings};
use serde_json::json;

use super::super::Answer;
use super::super::args::grow::Grow;

/// Unless another is typed.
pub(super) const SEED: u64 = 1;

/// Draws `n` siblings, and writes each beside every file of the skeleton, frames numbered from `first` on; tells of it in the
/// answer.
pub(super) fn draw(
    n: u32,
    siblings: &Siblings,
    first: u32,
    args: &Grow,
    files: &[(Out, &PathBuf)],
    carried: &Carried,
    answer: &mut Answer,
) -> anyhow::Result<()> {
    let seed = args.seed.unwrap_or(SEED);
    let (mut written, mut drawing) = (Vec::new(), Duration::ZERO);
    for number in 1..=n {
        let begun = Instant::now();
        let sibling = grow::draw(siblings, seed, number)?;
        drawing += begun.elapsed();
        let carried = carried.of_sibling(&sibling, number)?;
        for (kind, out) in files {
            let out = numbered(out, number);
            grow::write(&sibling, first, *kind, &carried, &out)?;
            written.push(out);
        }
        if let Some(leaves) = &args.leaves {
            let out = numbered(leaves, number);
            grow::write_leaves(&sibling, first, &out)?;
            written.push(out);
        }
    }
    let mean_s = drawing.as_secs_f64() / f64::from(n);
    answer.text += &format!("\nsiblings: {n} of seed {seed}, {mean_s:.4} s each");
    for level in siblings.levels() {
        let [mu, least, most] = [level.angles.mu, level.range()[0], level.range()[1]].map(f64::to_degrees);
        answer.text += &format!(
            "\nlevel {}: {} bones turn off by {mu:.1} degrees (κ {:.2}), siblings' by {least:.1} to {most:.1}",
            level.level, level.n_bones, level.angles.kappa,
        );
    }
    if let (Some(first), Some(last)) = (written.first(), written.last()) {
        answer.text += &format!("\n{} to {}", first.display(), last.display());
    }
    let levels: Vec<_> = siblings
        .levels()
        .iter()
        .map(|level| {
            json!({
                "level": level.level,
                "bones": level.n_bones,
                "mu": level.angles.mu,
                "kappa": level.angles.kappa,
                "threshold": level.threshold,
                "range": level.range(),
            })
        })
        .collect();
    answer.json["siblings"] = json!({ "seed": seed, "levels": levels, "seconds": mean_s, "files": written });
    Ok(())
}

/// `motion.bvh` as `motion-3.bvh`.
pub(super) fn numbered(out: &Path, number: u32) -> PathBuf {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let ending = out.extension().unwrap_or_default().to_string_lossy();
    out.with_file_name(format!("{stem}-{number}.{ending}"))
}
