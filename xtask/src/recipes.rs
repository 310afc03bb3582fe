//! `bench recipes`: many short clips, one at a time and two, and what it costs to find that nothing is to be done.

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::Context as _;
use serde_json::{Value, json};

use crate::BUILD;
use crate::shell::{self, Step, cargo, target_dir};

const RECIPE: &str = "steps = [\"track --with klt\", \"cluster\", \"export tracks tracks.csv\"]\n";

/// `bench recipes [CLIPS]`: turns of -j 1 and -j 2, one thread a step.
pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let n_clips: usize =
        args.first().map_or(Ok(40), |word| word.parse()).context("wanted a number of clips")?;
    cargo(BUILD).run()?;
    let folder = target_dir()?.join("bench/recipes");
    // What an earlier bench has left.
    fs::remove_dir_all(&folder).or_else(|error| if folder.exists() { Err(error) } else { Ok(()) })?;
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("r.toml"), RECIPE)?;
    let clips: Vec<String> = (0..n_clips).map(|k| format!("c{k}.y4m")).collect();
    for (seed, clip) in clips.iter().enumerate() {
        let seed = seed.to_string();
        let args = ["synth", clip, "--frames", "60", "--size", "640x480", "--seed", &seed];
        honami(&folder)?.args(args).output()?;
    }
    let mut seconds = [Vec::new(), Vec::new()];
    let mut overhead_ms = Vec::new();
    for turn in 0..3 {
        for (jobs, seconds) in ["1", "2"].into_iter().zip(&mut seconds) {
            let into = format!("j{jobs}_{turn}");
            let (wall, answer) = follow(&folder, &clips, jobs, &into)?;
            seconds.push(wall);
            if jobs == "1" {
                let steps: f64 = numbers(&answer).sum();
                overhead_ms.push(1e3 * (wall - steps) / n_clips as f64);
            }
        }
    }
    let (fresh, _) = follow(&folder, &clips, "1", "j1_0")?;
    let ratios: Vec<f64> = seconds[1].iter().zip(&seconds[0]).map(|(two, one)| two / one).collect();
    let figures = json!({
        "clips": n_clips,
        "seconds_j1": seconds[0],
        "seconds_j2": seconds[1],
        "ratio_j2": ratios,
        "overhead_ms_a_clip": overhead_ms,
        "fresh_ms_a_clip": 1e3 * fresh / n_clips as f64,
    });
    println!("{}", serde_json::to_string_pretty(&figures)?);
    fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))
}

fn honami(folder: &Path) -> anyhow::Result<Step> {
    Ok(shell::built("release", "honami")?.within(folder).env("RAYON_NUM_THREADS", "1"))
}

/// Seconds that it takes, and what it says.
fn follow(folder: &Path, clips: &[String], jobs: &str, into: &str) -> anyhow::Result<(f64, Value)> {
    let since = Instant::now();
    let step = honami(folder)?.args(["run", "r.toml", "--json", "--into", into, "-j", jobs]).args(clips);
    let said = step.output()?;
    Ok((since.elapsed().as_secs_f64(), serde_json::from_str(&said)?))
}

/// Seconds of all steps of all clips.
fn numbers(answer: &Value) -> impl Iterator<Item = f64> {
    let clips = answer["clips"].as_array().into_iter().flatten();
    let steps = clips.flat_map(|clip| clip["done"].as_array().into_iter().flatten());
    steps.filter_map(|step| step["seconds"].as_f64())
}
