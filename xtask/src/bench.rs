//! Benchmarks: each prints JSON, next to its peer where there is one, from the same run.

use std::fs;
use std::path::Path;

use anyhow::Context as _;

use crate::BUILD;
use crate::shell::{Step, built, cargo, target_dir};

/// Name, what it measures, and how to run it.
type Bench = (&'static str, &'static str, fn(&[&str]) -> anyhow::Result<()>);

const BENCHES: [Bench; 12] = [
    ("encode", "the encoder's time, bytes and likeness: `bench encode [BYTES] [CLIP…]`", encode),
    ("trackers", "KLT against OpenCV's calcOpticalFlowPyrLK, same frames, alternating", trackers),
    ("accuracy", "δavg of KLT and of OpenCV's on calm, wind and storm: `bench accuracy [SEED]`", accuracy),
    ("cluster", "composite distance + Ward, N = 2000, T = 500, against SciPy's linkage", cluster),
    ("media", "decoding, seeking, stepping back: `bench media CLIP`", media),
    ("store", "opening, editing and appending to a project of 10,000 tracks", store),
    ("suspicion", "how well suspicion tells bad samples: `bench suspicion [--seed N] [--fit]`", suspicion),
    ("queue", "the review queue with 100,000 items, an edit among 10,000 tracks", queue),
    (
        "review",
        "keys per track that a simulated reviewer needs, a row a correction: `bench review [--tracks N]`",
        review,
    ),
    ("correct", "what a correction on a track of 300 frames takes, a row a model", correct),
    ("robust", "mean, median and mode of displacements of which a part moves another way", robust),
    ("plugins", "cost of a plugin call, in process", plugins),
];

pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    if let Some((name, rest)) = args.split_first() {
        if let Some((_, _, bench)) = BENCHES.iter().find(|(known, ..)| known == name) {
            return bench(rest);
        }
        anyhow::bail!("no benchmark is named {name}; `cargo xtask bench` lists them");
    }
    for (name, what, _) in BENCHES {
        println!("{name:10} {what}");
    }
    Ok(())
}

fn example(package: &str, name: &str, args: &[&str]) -> Step {
    cargo(&["run", "--quiet", "--release", "-p", package, "--example", name, "--"]).args(args)
}

fn trackers(args: &[&str]) -> anyhow::Result<()> {
    example("honami-vision", "klt_bench", args).run()
}

/// The same clip and points for both, at the three levels; the baseline that tracks nothing is in each table.
fn accuracy(args: &[&str]) -> anyhow::Result<()> {
    cargo(BUILD).run()?;
    let seed = args.first().copied().unwrap_or("1");
    let folder = target_dir()?.join("bench").join(format!("accuracy-{seed}"));
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let honami = || built("release", "honami");
    for level in ["calm", "wind", "storm"] {
        let clip = folder.join(format!("{level}.y4m"));
        let (truth, points) = (clip.with_extension("truth.csv"), clip.with_extension("points.csv"));
        let words = ["--wind", level, "--leaves", "2600", "--frames", "150", "--seed", seed];
        honami()?.arg("synth").arg(&clip).args(words).run()?;
        fs::write(&points, visible_at_first(&truth)?)?;
        let peer = clip.with_extension("opencv.csv");
        Step::new("python3")
            .args(["tests/peers/klt_opencv.py", "track"])
            .args([&clip, &points, &peer])
            .run()?;
        let opencv = format!("opencv={}", peer.display());
        honami()?
            .arg("compare")
            .arg(&clip)
            .args(["--with", "klt", "--tracks", &opencv])
            .arg("--truth")
            .arg(&truth)
            .arg("--points")
            .arg(&points)
            .run()?;
    }
    Ok(())
}

/// The points of a truth table that can be seen in frame 0, as a table of points.
fn visible_at_first(truth: &Path) -> anyhow::Result<String> {
    let text = fs::read_to_string(truth).with_context(|| format!("cannot read {}", truth.display()))?;
    let mut points = String::from("id,x,y\n");
    for line in text.lines().skip(1) {
        if let [id, "0", x, y, "1", ..] = line.split(',').collect::<Vec<_>>()[..] {
            points += &format!("{id},{x},{y}\n");
        }
    }
    Ok(points)
}

fn cluster(args: &[&str]) -> anyhow::Result<()> {
    example("honami-motion", "cluster_bench", args).run()?;
    Step::new("python3").arg("tests/peers/linkage_scipy.py").run()
}

fn media(args: &[&str]) -> anyhow::Result<()> {
    example("honami-media", "media_bench", args).run()
}

fn encode(args: &[&str]) -> anyhow::Result<()> {
    example("honami", "encode_bench", args).run()
}

fn store(args: &[&str]) -> anyhow::Result<()> {
    example("honami-store", "store_bench", args).run()
}

/// The real corrections in real projects, on clips whose truth is known.
fn review(args: &[&str]) -> anyhow::Result<()> {
    on_project("review", args)
}

/// An example that works in projects in a folder of its own, with the shipped plugins.
fn on_project(name: &str, args: &[&str]) -> anyhow::Result<()> {
    cargo(BUILD).run()?;
    let folder = target_dir()?.join("bench").join(name);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let plugins = target_dir()?.join("release");
    example("honami-workbench", &format!("{name}_bench"), args)
        .args(["--plugin".as_ref(), plugins.as_os_str(), "--folder".as_ref(), folder.as_os_str()])
        .run()
}

/// The real corrections, committed.
fn correct(args: &[&str]) -> anyhow::Result<()> {
    on_project("correct", args)
}

fn robust(args: &[&str]) -> anyhow::Result<()> {
    example("honami-vision", "robust_bench", args).run()
}

fn plugins(args: &[&str]) -> anyhow::Result<()> {
    example("honami-host", "overhead", args).run()
}

fn suspicion(args: &[&str]) -> anyhow::Result<()> {
    example("honami-review", "suspicion_bench", args).run()
}

fn queue(args: &[&str]) -> anyhow::Result<()> {
    example("honami-review", "queue_bench", args).run()
}
