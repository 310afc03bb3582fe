//! Benchmarks: each prints JSON, next to its peer where there is one, from the same run.

use std::fs;

use anyhow::Context as _;

use crate::shell::{Step, cargo, target_dir};
use crate::{BUILD, accuracy, forest, recipes};

/// Name, what it measures, and how to run it.
type Bench = (&'static str, &'static str, fn(&[&str]) -> anyhow::Result<()>);

const BENCHES: [Bench; 20] = [
    ("encode", "the encoder's time, bytes and likeness: `bench encode [BYTES] [CLIP…]`", encode),
    ("trackers", "KLT against OpenCV's calcOpticalFlowPyrLK, same frames, alternating", trackers),
    ("box", "box matching against OpenCV's matchTemplate: `bench box [CLIP…]`", box_matching),
    (
        "accuracy",
        "every tracker on everything whose answer is known: `bench accuracy [SET…] [--with NAME…]`",
        accuracy::run,
    ),
    (
        "forest",
        "forests in the wind beside numpy's product of matrices: `bench forest [--json] [KxNxM…]`",
        forest::run,
    ),
    ("modes", "vibrations of trees beside SciPy's, a row a size: `bench modes [NODES…]`", modes),
    (
        "cluster",
        "distances, components and normalised cuts, N = 2000 and more, against SciPy's linkage",
        cluster,
    ),
    (
        "grouping",
        "groups of branches that are known, by every method: `bench grouping [--trees N] [--large] [--development]`",
        grouping,
    ),
    ("skeleton", "from 2,000 tracks over 500 frames to a skeleton and its siblings, step by step", skeleton),
    ("media", "decoding, seeking, stepping back: `bench media CLIP`", media),
    (
        "store",
        "opening and editing 2,000 tracks of 10,000 frames, beside goals; the same and appending, 10,000 tracks",
        store,
    ),
    (
        "suspicion",
        "how well suspicion tells bad samples, by tracker and wind: `bench suspicion [--seed N] [--fit]`",
        suspicion,
    ),
    ("queue", "the review queue with 100,000 items, an edit among 10,000 tracks", queue),
    (
        "review",
        "keys per track that a simulated reviewer needs, a row a correction: `bench review [--tracks N]`",
        review,
    ),
    ("correct", "what a correction on a track of 300 frames takes, a row a model", correct),
    ("matting", "mattes beside PyMatting's, in turns: `bench matting [WxH… | PICTURE SCRIBBLES]`", matting),
    (
        "recipes",
        "many short clips, one and two at a time, and what each costs beside its steps: `bench recipes [CLIPS]`",
        recipes::run,
    ),
    ("robust", "mean, median and mode of displacements of which a part moves another way", robust),
    (
        "plugins",
        "what a plugin costs: a call in this process and in its own, its start, its death, the list",
        plugins,
    ),
    (
        "viewer",
        "a forest drawn, part by part: `bench viewer [COPIES [NODES [MODES]]] [--card|--cpu] [--all] [--sharp] [--out IMAGE]`",
        viewer,
    ),
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

fn viewer(args: &[&str]) -> anyhow::Result<()> {
    example("honami-viewer", "viewer_bench", args).run()
}

fn trackers(args: &[&str]) -> anyhow::Result<()> {
    example("honami-vision", "klt_bench", args).run()
}

fn box_matching(args: &[&str]) -> anyhow::Result<()> {
    example("honami-vision", "box_bench", args).run()
}

fn modes(args: &[&str]) -> anyhow::Result<()> {
    example("honami-mechanics", "modes_bench", args).run()
}

fn cluster(args: &[&str]) -> anyhow::Result<()> {
    example("honami-motion", "cluster_bench", args).run()?;
    example("honami-motion", "bod_bench", &[]).run()?;
    Step::new("python3").arg("tests/peers/linkage_scipy.py").run()
}

fn grouping(args: &[&str]) -> anyhow::Result<()> {
    example("honami-motion", "grouping_bench", args).run()
}

fn skeleton(args: &[&str]) -> anyhow::Result<()> {
    example("honami-workbench", "skeleton_bench", args).run()
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
        // As shipped ones work.
        .env("HONAMI_HOSTING", "in-process")
        .args(["--plugin".as_ref(), plugins.as_os_str(), "--folder".as_ref(), folder.as_os_str()])
        .run()
}

/// The real corrections, committed.
fn correct(args: &[&str]) -> anyhow::Result<()> {
    on_project("correct", args)
}

fn matting(args: &[&str]) -> anyhow::Result<()> {
    example("honami-matting", "matting_bench", args).run()
}

fn robust(args: &[&str]) -> anyhow::Result<()> {
    example("honami-vision", "robust_bench", args).run()
}

fn plugins(args: &[&str]) -> anyhow::Result<()> {
    example("honami-host", "overhead", args).run()
}

fn suspicion(args: &[&str]) -> anyhow::Result<()> {
    on_project("suspicion", args)
}

fn queue(args: &[&str]) -> anyhow::Result<()> {
    example("honami-review", "queue_bench", args).run()
}
