//! Benchmarks: each prints JSON, next to its peer where there is one, from the same run.

use crate::shell::{Step, cargo};

/// Name, what it measures, and how to run it.
const BENCHES: [(&str, &str, fn(&[&str]) -> anyhow::Result<()>); 5] = [
    ("trackers", "KLT against OpenCV's calcOpticalFlowPyrLK, same frames, alternating", trackers),
    ("cluster", "composite distance + Ward, N = 2000, T = 500, against SciPy's linkage", cluster),
    ("media", "decoding, seeking, stepping back: `bench media CLIP`", media),
    ("store", "opening, editing and appending to a project of 10,000 tracks", store),
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

fn cluster(args: &[&str]) -> anyhow::Result<()> {
    example("honami-motion", "cluster_bench", args).run()
}

fn media(args: &[&str]) -> anyhow::Result<()> {
    example("honami-media", "media_bench", args).run()
}

fn store(args: &[&str]) -> anyhow::Result<()> {
    example("honami-store", "store_bench", args).run()
}

fn plugins(args: &[&str]) -> anyhow::Result<()> {
    example("honami-host", "overhead", args).run()
}
