//! Recipes through the real program: many clips, what is stale, what was done by hand, Ctrl-C, a clip that fails.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::Stdio;

use honami_tests::Bench;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

const RECIPE: &str = r#"steps = [
    "track --with klt --set max_features=30",
    "cluster --groups 3",
    "grow {clip}.bvh",
    "export tracks tracks.csv",
    "export groups groups.csv",
]
"#;

/// What the steps write into the folder of a clip.
const FILES: [&str; 3] = ["tracks.csv", "groups.csv", "NAME.bvh"];

/// Three clips, and a recipe for them.
fn bench() -> Bench {
    let bench = Bench::new();
    for seed in 1..4 {
        bench.synth(&format!("c{seed}.y4m"), 12, &format!("--seed {seed} --leaves 30"));
    }
    fs::write(bench.path("r.toml"), RECIPE).unwrap();
    bench
}

fn assert_same(bench: &Bench, one: &str, other: &str) {
    for name in ["c1", "c2", "c3"] {
        for file in FILES.map(|file| file.replace("NAME", name)) {
            let read = |into: &str| fs::read(bench.path(into).join(name).join(&file)).unwrap();
            assert!(read(one) == read(other), "{name}/{file} differs");
        }
    }
}

/// Of every clip: how many steps stood, and which were done.
fn told(answer: &Value) -> Vec<(u64, Vec<u64>)> {
    let clips = answer["clips"].as_array().unwrap().iter();
    let done = |clip: &Value| {
        clip["done"].as_array().unwrap().iter().map(|step| step["step"].as_u64().unwrap()).collect()
    };
    clips.map(|clip| (clip["fresh"].as_u64().unwrap(), done(clip))).collect()
}

#[test]
fn many_clips_give_the_same_bytes_and_one_that_fails_holds_up_no_other() {
    let bench = bench();
    fs::write(bench.path("bad.y4m"), "no clip").unwrap();
    let planned = bench.json("run r.toml c1.y4m c2.y4m c3.y4m --into one --dry-run");
    assert_eq!(planned["clips"][2]["todo"].as_array().unwrap().len(), 5);
    assert!(!bench.path("one").exists(), "a plan does nothing");
    bench.json("run r.toml c1.y4m c2.y4m c3.y4m --into one");
    let ran = bench.line("run r.toml c1.y4m bad.y4m c2.y4m c3.y4m --into two -j 3 --json");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains("bad: the clip failed: "), "{ran:?}");
    let answer: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!((&answer["failed"], &answer["stopped"]), (&1.into(), &0.into()));
    assert_eq!(answer["clips"][1]["failed"]["step"], 0);
    assert_same(&bench, "one", "two");
    let again = bench.json("run r.toml c1.y4m c2.y4m c3.y4m --into two");
    assert_eq!(told(&again), vec![(5, vec![]); 3]);
}

/// Changes one thing, and gives the first step that is done again, of `c1`.
fn first_again(bench: &Bench, change: impl FnOnce(&Path)) -> Option<u64> {
    change(&bench.path("out/c1"));
    let answer = bench.json("run r.toml c1.y4m --into out");
    let (_, done) = told(&answer).remove(0);
    let is_whole =
        done.last().is_none_or(|last| *last == 5) && done.windows(2).all(|two| two[1] == two[0] + 1);
    assert!(is_whole, "{answer}");
    assert_eq!(told(&bench.json("run r.toml c1.y4m --into out")), [(5, vec![])], "it is fresh then");
    done.first().copied()
}

#[test]
fn only_what_is_stale_is_done_again() {
    let bench = bench();
    bench.json("run r.toml c1.y4m --into out");
    assert_eq!(first_again(&bench, |_| ()), None);
    let edit = |script: &str| assert_eq!(bench.edit("out/c1/c1.honami", script).code, Some(0));
    assert_eq!(first_again(&bench, |folder| fs::remove_file(folder.join("c1.bvh")).unwrap()), Some(3));
    // Tracks that were corrected stay, and what follows from them is found anew.
    assert_eq!(first_again(&bench, |_| edit("key 0 3 20 30")), Some(2));
    assert!(bench.samples("out/c1/c1.honami").iter().any(|row| row["source"] == "key"));
    let recipe = |from: &str, to: &str| fs::write(bench.path("r.toml"), RECIPE.replace(from, to)).unwrap();
    assert_eq!(first_again(&bench, |_| recipe("--groups 3", "--groups 4")), Some(2));
    // A time of its own does not make a file another.
    let touch = |file: &Path| fs::write(file, fs::read(file).unwrap()).unwrap();
    assert_eq!(first_again(&bench, |_| touch(&bench.path("c1.y4m"))), None);
    // What somebody has changed is never written over.
    fs::write(bench.path("out/c1/tracks.csv"), "mine").unwrap();
    recipe("--groups 3", "--groups 5");
    let ran = bench.line("run r.toml c1.y4m --into out");
    assert!(
        ran.code == Some(1) && ran.stderr.contains("tracks.csv was changed since it was written"),
        "{ran:?}"
    );
    assert_eq!(fs::read_to_string(bench.path("out/c1/tracks.csv")).unwrap(), "mine");
}

#[test]
fn work_by_hand_is_never_tracked_over_unasked() {
    let bench = bench();
    bench.json("run r.toml c1.y4m --into out");
    assert_eq!(bench.edit("out/c1/c1.honami", "key 0 3 20 30\n").code, Some(0));
    fs::write(bench.path("r.toml"), RECIPE.replace("max_features=30", "max_features=20")).unwrap();
    let ran = bench.line("run r.toml c1.y4m --into out");
    assert!(ran.code == Some(1) && ran.stderr.contains("was edited 1 time by hand"), "{ran:?}");
    for file in FILES.map(|file| file.replace("NAME", "c1")) {
        assert!(bench.path("out/c1").join(&file).exists(), "{file} is gone, though nothing was done");
    }
    let answer = bench.json("run r.toml c1.y4m --into out --over-edits");
    assert_eq!(told(&answer), [(0, vec![0, 1, 2, 3, 4, 5])]);
    let keys = |project: &str| bench.samples(project).iter().filter(|row| row["source"] == "key").count();
    assert_eq!((keys("out/c1/c1.before.honami"), keys("out/c1/c1.honami")), (1, 0));
    // A clip of other content is another clip.
    fs::copy(bench.path("c2.y4m"), bench.path("c1.y4m")).unwrap();
    assert_eq!(told(&bench.json("run r.toml c1.y4m --into out")), [(0, vec![0, 1, 2, 3, 4, 5])]);
}

#[test]
fn what_ctrl_c_has_ended_goes_on_to_the_same_bytes() {
    let bench = bench();
    let line = "run r.toml c1.y4m c2.y4m c3.y4m --into";
    bench.json(&format!("{line} whole"));
    let mut command = bench.command(format!("{line} cut").split(' '));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with("c1: 5 steps"), "{first}");
    // Whatever the second clip is at now.
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    child.wait().unwrap();
    let answer = bench.json(&format!("{line} cut"));
    assert_eq!(told(&answer)[0], (5, vec![]), "{answer}");
    assert_same(&bench, "whole", "cut");
}

#[test]
fn a_kill_just_after_the_project_was_made_holds_nobody_up() {
    let bench = bench();
    bench.json("run r.toml c1.y4m --into whole");
    fs::create_dir_all(bench.path("cut/c1")).unwrap();
    bench.json("new cut/c1/c1.honami c1.y4m");
    // What was begun to be written when it was killed.
    fs::write(bench.path("cut/c1/.honami-Xy12.part"), "half").unwrap();
    assert_eq!(told(&bench.json("run r.toml c1.y4m --into cut")), [(0, vec![0, 1, 2, 3, 4, 5])]);
    for file in FILES.map(|file| file.replace("NAME", "c1")) {
        let read = |into: &str| fs::read(bench.path(into).join("c1").join(&file)).unwrap();
        assert!(read("whole") == read("cut"), "{file} differs");
    }
    assert!(!bench.path("cut/c1/.honami-Xy12.part").exists());
    // One in which somebody has worked stays.
    fs::create_dir_all(bench.path("mine/c1")).unwrap();
    bench.json("new mine/c1/c1.honami c1.y4m");
    assert_eq!(bench.edit("mine/c1/c1.honami", "add 0 5 5").code, Some(0));
    let ran = bench.line("run r.toml c1.y4m --into mine");
    assert!(ran.code == Some(1) && ran.stderr.contains("that no recipe has made"), "{ran:?}");
}

#[test]
fn a_kill_just_after_a_step_has_shown_what_it_found_is_no_work_by_hand() {
    let bench = bench();
    bench.json("run r.toml c1.y4m --into out");
    // As a kill leaves it: begun and shown, and not said to be done.
    let begun = || {
        let database = rusqlite::Connection::open(bench.path("out/c1/c1.honami")).unwrap();
        database.execute("DELETE FROM step WHERE id > 1", []).unwrap();
        database.execute("UPDATE step SET made_of = '', after = before WHERE id = 1", []).unwrap();
    };
    begun();
    assert_eq!(told(&bench.json("run r.toml c1.y4m --into out")), [(0, vec![0, 1, 2, 3, 4, 5])]);
    assert!(!bench.path("out/c1/c1.before.honami").exists());
    // What somebody has done since is.
    begun();
    assert_eq!(bench.edit("out/c1/c1.honami", "key 0 3 20 30\n").code, Some(0));
    let ran = bench.line("run r.toml c1.y4m --into out");
    assert!(ran.code == Some(1) && ran.stderr.contains("was edited 1 time by hand"), "{ran:?}");
}

#[test]
fn the_recipe_of_a_project_makes_it_again() {
    let bench = bench();
    bench.json("new p.honami c1.y4m");
    bench.json("track p.honami --with klt --set max_features=25 --frames 0..10");
    bench.json("cluster p.honami --groups 3");
    let saved = bench.json("recipe save p.honami s.toml");
    assert_eq!(
        saved["steps"],
        serde_json::json!([
            "track --with klt --set max_features=25 --frames 0..10",
            "cluster --with bod --groups 3"
        ])
    );
    bench.json("run s.toml p=c1.y4m --into out");
    let tables = |project: &str| {
        for what in ["tracks", "groups"] {
            bench.json(&format!("export {project} {what} {what}.csv"));
        }
        ["tracks.csv", "groups.csv"].map(|file| fs::read(bench.path(file)).unwrap())
    };
    assert!(tables("p.honami") == tables("out/p/p.honami"));
    // Of a project that a recipe has made it is that recipe.
    assert_eq!(bench.text("recipe save out/p/p.honami"), fs::read_to_string(bench.path("s.toml")).unwrap());
    for project in ["p.honami", "out/p/p.honami"] {
        let again = bench.json(&format!("rerun {project}"));
        assert_eq!((&again["same"], &again["runs"][0]["moved"]), (&true.into(), &0.into()), "{again}");
    }
}

#[test]
fn a_project_that_does_not_repeat_says_how_far_it_is_off() {
    let bench = bench();
    bench.json("run r.toml c1.y4m --into out");
    let again = bench.json("rerun out/c1/c1.honami");
    let files = again["files"].as_array().unwrap();
    assert!(files.len() == 3 && files.iter().all(|file| file["same"] == true), "{again}");
    // As if another machine had tracked it: the clip is another, and its project says it were this one.
    let database = rusqlite::Connection::open(bench.path("out/c1/c1.honami")).unwrap();
    let line = "track --with klt --set max_features=30 --set radius=6";
    assert_eq!(database.execute("UPDATE step SET line = ?1 WHERE id = 1", [line]).unwrap(), 1);
    let ran = bench.line("rerun out/c1/c1.honami");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(
        ran.stdout.contains(" lie elsewhere, at most ") && ran.stdout.ends_with("it differs\n"),
        "{ran:?}"
    );
}
