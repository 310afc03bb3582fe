//! Kills the real program while it follows a recipe: what it said was done stands, and what it makes in the end is, byte
//! for byte, what an undisturbed run makes.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

use honami_tests::Bench;
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg32;
use serde_json::Value;

use super::{Plan, assert_whole, spin};

const RECIPE: &str = r#"steps = [
    "track --with klt --set max_features=30",
    "cluster --groups 3",
    "grow {clip}.bvh",
    "export tracks tracks.csv",
    "export groups groups.csv",
]
"#;
const N_STEPS: u64 = 5;
const CLIPS: [&str; 2] = ["c1", "c2"];

/// Every file that a recipe has made and whatever else is left, but projects, which say when they were made, and locks,
/// which are taken over.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for clip in CLIPS {
        for entry in fs::read_dir(folder.join(clip)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.extension().is_some_and(|ending| ending != "honami" && ending != "lock") {
                found.insert(format!("{clip}/{name}"), fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Steps that a process has said were done, and how many stood when it began.
struct Said {
    fresh: Option<u64>,
    done: u64,
}

/// Reads so many lines of a process that follows the recipe with one clip, and kills it so long after.
fn kill_alone(mut child: Child, n_lines: usize, moment: Duration) -> (Said, bool) {
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let mut said: Vec<String> = lines.by_ref().take(n_lines).collect();
    spin(moment);
    child.kill().unwrap();
    let is_killed = child.wait().unwrap().signal().is_some();
    // What it had said before it died is in the pipe still.
    said.extend(lines);
    let said: Vec<Value> = said.iter().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let fresh = said.iter().find_map(|line| line["fresh"]["n"].as_u64());
    let done = said.iter().filter_map(|line| line["done"]["step"].as_u64()).max().unwrap_or(0);
    (Said { fresh, done }, is_killed)
}

/// Kills whoever follows the recipe with all clips, wherever the process is that it has started.
fn kill_all(bench: &Bench, moment: Duration) -> bool {
    let mut command = bench.command("run r.toml c1.y4m c2.y4m --into cut -j 2".split(' '));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    spin(moment);
    child.kill().unwrap();
    child.wait().unwrap().signal().is_some()
}

/// Every project that is there is whole.
fn assert_all_whole(bench: &Bench) {
    for clip in CLIPS {
        let project = format!("cut/{clip}/{clip}.honami");
        if bench.path(&project).exists() {
            assert_whole(bench, &project);
            bench.json(&format!("log {project}"));
        }
    }
}

/// Goes on to the end, once those that a killed one has started have noticed that nobody listens.
fn go_on(bench: &Bench) -> Value {
    loop {
        let ran = bench.line("run r.toml c1.y4m c2.y4m --into cut --json");
        if ran.code == Some(0) {
            return serde_json::from_str(&ran.stdout).unwrap();
        }
        assert!(ran.stderr.contains("another honami is at work on it"), "{ran:?}");
    }
}

#[test]
fn a_recipe_that_is_killed_again_and_again_gives_the_same_bytes() {
    let bench = Bench::new();
    for (seed, clip) in (1..).zip(CLIPS) {
        bench.synth(&format!("{clip}.y4m"), 12, &format!("--seed {seed} --leaves 30"));
    }
    fs::write(bench.path("r.toml"), RECIPE).unwrap();
    bench.json("run r.toml c1.y4m c2.y4m --into whole");
    let whole = results(&bench.path("whole"));
    assert_eq!(whole.len(), 6, "{:?}", whole.keys());
    let plan = Plan::asked(25, 10);
    let mut rng = Pcg32::seed_from_u64(plan.seed);
    let (mut kills, mut n_done) = (0, 0);
    // Kills of one set of projects before it goes on to its end.
    while plan.goes_on(kills) {
        let mut stood = BTreeMap::from(CLIPS.map(|clip| (clip, 0)));
        for _ in 0..rng.random_range(1..8) {
            let clip = CLIPS[rng.random_range(0..CLIPS.len())];
            let line = format!("run r.toml --alone --into cut -- {clip}={clip}.y4m");
            let mut command = bench.command(line.split(' '));
            let child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
            let moment = Duration::from_micros(rng.random_range(0..15_000));
            let (said, is_killed) = kill_alone(child, rng.random_range(0..12), moment);
            let steps = stood.get_mut(clip).unwrap();
            if let Some(fresh) = said.fresh {
                assert!(fresh >= *steps, "{clip}: {fresh} steps stand, {steps} were done");
            }
            *steps = said.done.max(*steps);
            n_done += usize::from(said.done > 0);
            kills += u32::from(is_killed);
            assert_all_whole(&bench);
        }
        // Processes that it has started live on until they are through, so this comes last.
        if rng.random_range(0..3) == 0 {
            let moment = Duration::from_micros(rng.random_range(0..200_000));
            kills += u32::from(kill_all(&bench, moment));
        }
        let answer = go_on(&bench);
        for (name, clip) in CLIPS.iter().zip(answer["clips"].as_array().unwrap()) {
            let fresh = clip["fresh"].as_u64().unwrap();
            assert!(fresh >= stood[name] && fresh <= N_STEPS, "{clip}: {} were done", stood[name]);
        }
        let cut = results(&bench.path("cut"));
        let differ = whole.iter().filter(|(name, bytes)| cut.get(*name) != Some(bytes));
        let differ: Vec<_> = differ.map(|(name, _)| name).collect();
        let more: Vec<_> = cut.keys().filter(|name| !whole.contains_key(*name)).collect();
        assert!(
            differ.is_empty() && more.is_empty(),
            "kill {kills} (seed {}): {differ:?} differ, {more:?} are left",
            plan.seed
        );
        fs::remove_dir_all(bench.path("cut")).unwrap();
    }
    plan.tell("recipe", kills, n_done);
}
