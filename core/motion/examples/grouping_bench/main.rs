//! How well groups are found: trees in turbulent wind, their tips as tracks with noise and flutter, every method raw and
//! on denoised tracks; prints a table of mean adjusted Rand indices.
//!
//! `grouping_bench [--development] [--trees N] [--large]`: the trees that settings were chosen on, fewer of them, or one
//! with 2,000 tips. Trees that were measured are in the folder that `HONAMI_DATA` names, and left out where it is not set.

mod methods;
mod swaying;
mod trees;

use honami_motion::score::adjusted_rand_index;
use methods::METHODS;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::error::Error;
use trees::Habit;

/// Groups that the truth is cut into, and every hierarchy into as many as there then are.
const GROUPS: [usize; 6] = [8, 12, 16, 24, 32, 48];
/// Noise and flutter, pixels, and what a column is called.
const CASES: [(f64, f64, &str); 4] =
    [(0.0, 0.0, "0 px"), (0.3, 0.0, "0.3 px"), (1.0, 0.0, "1 px"), (0.3, 1.0, "flutter 1 px")];
/// Trees that no setting was chosen on.
const TEST: [(Habit, u64); 11] = [
    (Habit::Forking, 501),
    (Habit::Forking, 502),
    (Habit::Forking, 503),
    (Habit::Forking, 504),
    (Habit::Conifer, 511),
    (Habit::Conifer, 512),
    (Habit::Shrub, 521),
    (Habit::Shrub, 522),
    (Habit::Wytham("Tf12"), 531),
    (Habit::Wytham("Tf20_LeafOff"), 532),
    (Habit::Wytham("Tf3_LeafOff"), 533),
];
const DEVELOPMENT: [(Habit, u64); 7] = [
    (Habit::Forking, 1),
    (Habit::Conifer, 2),
    (Habit::Shrub, 3),
    (Habit::Forking, 4),
    (Habit::Conifer, 5),
    (Habit::Shrub, 6),
    (Habit::Walnut, 7),
];
/// Winds a tree.
const WINDS: [u64; 2] = [0, 1];

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "the result of a benchmark")]
fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| args.iter().any(|arg| arg == name);
    let n_trees =
        args.iter().skip_while(|arg| *arg != "--trees").nth(1).map_or(Ok(TEST.len()), |n| n.parse())?;
    let all: &[_] = if has("--development") { &DEVELOPMENT } else { &TEST };
    let (n_tips, n_trees) = if has("--large") { (2000, 1) } else { (500, n_trees) };
    // A list of indices for every case and method, tree after tree.
    let mut found = vec![vec![Vec::new(); METHODS.len()]; CASES.len()];
    let (trees, lacking): (Vec<_>, Vec<_>) = all.iter().partition(|(habit, _)| habit.is_there());
    if !lacking.is_empty() {
        eprintln!("{} trees that were measured are left out: HONAMI_DATA is not set", lacking.len());
    }
    let trees = &trees[..n_trees.min(trees.len())];
    for (habit, seed) in trees {
        let beams = trees::grow(*habit, n_tips, *seed)?;
        let mut tips = beams.ends();
        tips.shuffle(&mut Pcg64::seed_from_u64(*seed));
        tips.truncate(n_tips);
        let modes = swaying::modes(&beams)?;
        let truths: Vec<Vec<Option<u32>>> =
            GROUPS.iter().filter_map(|n| trees::groups(&beams, &tips, *n)).collect();
        let mut sums = vec![vec![0.0; METHODS.len()]; CASES.len()];
        for wind in WINDS {
            let filmed = swaying::film(&beams, &modes, &tips, 10 * seed + wind);
            for ((noise_px, flutter_px, _), sums) in CASES.iter().zip(&mut sums) {
                let tracks = filmed.tracked(*noise_px, *flutter_px, 10 * seed + wind);
                for ((_, method), sum) in METHODS.iter().zip(sums) {
                    let tree = method(&tracks)?;
                    let index = |truth: &Vec<Option<u32>>| {
                        let cut = tree.cut(truth.iter().flatten().max().map_or(1, |last| last + 1));
                        let (a, b): (Vec<u32>, Vec<u32>) =
                            truth.iter().zip(cut).filter_map(|(truth, cut)| Some(((*truth)?, cut))).unzip();
                        adjusted_rand_index(&a, &b).unwrap_or(0.0)
                    };
                    let mean = truths.iter().map(index).sum::<f64>() / truths.len() as f64;
                    *sum += mean / WINDS.len() as f64;
                }
            }
        }
        for (found, sums) in found.iter_mut().zip(sums) {
            found.iter_mut().zip(sums).for_each(|(found, sum)| found.push(sum));
        }
    }
    for ((.., case), found) in CASES.iter().zip(&found) {
        let names: Vec<String> = trees.iter().map(|(habit, seed)| format!("{habit} {seed}")).collect();
        println!("| {case} | mean | sd | {} |", names.join(" | "));
        println!("|---|---|---|{}", "---|".repeat(trees.len()));
        for ((name, _), found) in METHODS.iter().zip(found) {
            let n = found.len() as f64;
            let mean = found.iter().sum::<f64>() / n;
            let sd = (found.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
            let each: Vec<String> = found.iter().map(|v| format!("{v:.2}")).collect();
            println!("| {name} | {mean:.3} | {sd:.2} | {} |", each.join(" | "));
        }
        println!();
    }
    Ok(())
}
