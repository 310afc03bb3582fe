//! A run that is stopped, and one that is killed: what was tracked is kept, and nothing else is hurt.

use std::fs::File;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, Stdio};

use honami_tests::{Bench, by_track};
use rusqlite::{Connection, OpenFlags};
use rustix::process::{Pid, Signal, kill_process};

use crate::isolated::has_cc;
use crate::rebuilt;

/// Frames of the clip: many more than are tracked before the signal comes.
const N_FRAMES: u32 = 400;

/// Looks for new features, away from those of the first run.
const NEW: &str = " --detect";
/// Follows those of the first run again.
const AGAIN: &str = "";

/// A project with a run and a correction in it, and a second run at work that has kept some frames.
///
/// Features that are followed again reach to the clip's end already; new ones are found beside a short run.
fn at_work(what: &str) -> (Bench, Child) {
    let bench = Bench::new();
    bench.synth("clip.y4m", N_FRAMES, "--leaves 40");
    bench.json("new p.honami clip.y4m");
    let end = if what == AGAIN { N_FRAMES } else { 8 };
    bench.json(&format!("track p.honami --with klt --frames 0..{end} --set max_features=20"));
    assert_eq!(bench.edit("p.honami", "key 0 3 20 30").code, Some(0));
    // A large window makes every frame slow.
    let line = format!("track p.honami --with klt --json --set radius=50 --set levels=1{what}");
    let mut command = bench.command(line.split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let database =
        Connection::open_with_flags(bench.path("p.honami"), OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap();
    database.busy_timeout(std::time::Duration::from_secs(20)).unwrap();
    let n_chunks =
        || database.query_row("SELECT COUNT(*) FROM chunk", [], |row| row.get::<_, u32>(0)).unwrap();
    while n_chunks() == 0 {
        assert_eq!(child.try_wait().unwrap(), None, "the run has ended before it could be stopped");
        std::thread::yield_now();
    }
    (bench, child)
}

/// The correction, as exported.
fn assert_corrected(bench: &Bench) {
    let samples = bench.samples("p.honami");
    let keys: Vec<_> = samples.iter().filter(|row| row["source"] == "key").collect();
    assert_eq!(keys.len(), 1);
    assert_eq!(["track", "frame", "x", "y"].map(|column| keys[0][column].as_str()), ["0", "3", "20", "30"]);
}

/// Ctrl-C, and what the run then says; to be stopped is not to be done.
fn stop(child: Child) -> serde_json::Value {
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let track: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(track["stopped"], true);
    track
}

#[test]
fn half_a_run_leaves_no_seam_in_tracks_that_reach_further() {
    let (bench, child) = at_work(AGAIN);
    let before = bench.samples("p.honami");
    let track = stop(child);
    assert_eq!(bench.samples("p.honami"), before);
    let run = &bench.log("p.honami", "run")[1];
    assert_eq!((&run["state"], &run["frames"]), (&"stopped: stopped".into(), &track["frames"]));
}

#[test]
fn a_run_that_is_stopped_keeps_its_frames() {
    let (bench, child) = at_work(NEW);
    let track = stop(child);
    let end = track["frames"][1].as_u64().unwrap();
    assert!((1..u64::from(N_FRAMES)).contains(&end), "{track}");

    let run = &bench.log("p.honami", "run")[1];
    assert_eq!((&run["state"], &run["frames"]), (&"stopped: stopped".into(), &track["frames"]));
    let samples = bench.samples("p.honami");
    let n_frames = samples.iter().filter(|row| row["run"] == "2").map(|row| &row["frame"]);
    assert_eq!(n_frames.collect::<std::collections::BTreeSet<_>>().len() as u64, end);
    assert_corrected(&bench);
    // What it showed is one edit.
    assert_eq!(bench.edit("p.honami", "undo").code, Some(0));
    assert!(bench.samples("p.honami").iter().all(|row| row["run"] != "2"));
}

#[test]
fn a_run_that_is_killed_keeps_its_frames() {
    let (bench, mut child) = at_work(NEW);
    let before = bench.json("log p.honami");
    child.kill().unwrap();
    child.wait().unwrap();

    // A reader sees it as it is, without writing.
    assert_eq!(bench.log("p.honami", "run")[1]["state"], "interrupted");
    assert_corrected(&bench);

    // The next writer keeps its frames.
    let ran = bench.edit("p.honami", "key 1 5 40 50");
    assert!(ran.code == Some(0) && ran.stderr.contains("run 2 was interrupted at frame"), "{ran:?}");
    let run = &bench.log("p.honami", "run")[1];
    assert_eq!(run["state"], "interrupted");
    let end = run["frames"][1].as_u64().unwrap();
    assert!((1..u64::from(N_FRAMES)).contains(&end), "{run}");
    let samples = bench.samples("p.honami");
    let found: Vec<_> = samples.into_iter().filter(|row| row["run"] == "2").collect();
    assert!(!found.is_empty());
    for (id, track) in by_track(&found) {
        let frames: Vec<u64> = track.iter().map(|row| row["frame"].parse().unwrap()).collect();
        assert_eq!(frames, (0..end).collect::<Vec<_>>(), "track {id} is whole");
    }
    let edits = |log: &serde_json::Value| {
        let lines = log["log"].as_array().unwrap().iter().filter(|line| line["what"] == "edit");
        lines.cloned().collect::<Vec<_>>()
    };
    let now = edits(&bench.json("log p.honami"));
    let before = edits(&before);
    assert_eq!(now[..before.len()], before, "nothing that was done before is hurt");
}

#[test]
fn a_run_that_is_killed_in_a_slow_frame_keeps_all_before_it() {
    if !has_cc() {
        return;
    }
    let bench = rebuilt::project();
    rebuilt::build(&bench, &["-DWAIT=12"]);
    let gate = bench.path("gate");
    let mut command =
        bench.command("track p.honami --with mine --plugin mine.so --points points.csv".split(' '));
    command.args(["--set", &format!("gate={}", gate.display())]).env("HONAMI_NO_WATCHDOG", "1");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let _within = rebuilt::Within::begin(&child, &gate);
    // It is in frame 12 once it waits at the pipe, and stays there.
    let _open = File::options().write(true).open(&gate).unwrap();
    let run = || bench.log("p.honami", "run")[0].clone();
    while run()["frames"] != serde_json::json!([0, 12]) {
        assert_eq!(child.try_wait().unwrap(), None, "{}", run());
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let run = run();
    assert_eq!((&run["state"], &run["frames"]), (&"interrupted".into(), &serde_json::json!([0, 12])));
    // The next session shows them.
    assert_eq!(bench.edit("p.honami", "key 1 5 40 50").code, Some(0));
    assert_eq!(bench.samples("p.honami").len(), 3 * 12);
}

/// Whether this process was begun with a signal ignored, which all that it begins inherits.
fn is_ignored(signal: Signal) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() >> (signal.as_raw() - 1) & 1 == 1)
}

#[test]
fn what_ends_a_command_is_not_blamed_on_the_plugin_that_is_inside() {
    if !has_cc() {
        return;
    }
    for (signal, wanted) in [
        (Signal::TERM, (None, Some(15))),
        (Signal::HUP, (None, Some(1))),
        // The first asks it to stop, which it does not hear.
        (Signal::INT, (Some(130), None)),
    ] {
        // What `nohup` begins lives through it, as it should.
        if signal == Signal::HUP && is_ignored(signal) {
            continue;
        }
        let bench = rebuilt::project();
        rebuilt::build(&bench, &["-DWAIT=12"]);
        let gate = bench.path("gate");
        let line = "track p.honami --with mine --plugin mine.so --points points.csv --set";
        let mut command = bench.command(line.split(' '));
        command.arg(format!("gate={}", gate.display())).env("HONAMI_HOSTING", "in-process");
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let _within = rebuilt::Within::begin(&child, &gate);
        let _open = File::options().write(true).open(&gate).unwrap();
        let trails = || {
            let known = std::fs::read_dir(bench.path("XDG_CACHE_HOME/honami/quarantine")).unwrap();
            known
                .filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|e| e == "inside"))
                .count()
        };
        assert_eq!(trails(), 1, "it is inside");
        let status = loop {
            kill_process(Pid::from_child(&child), signal).unwrap();
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            std::thread::yield_now();
        };
        assert_eq!((status.code(), status.signal()), wanted);
        assert_eq!(trails(), 0, "{signal:?}");
    }
}

#[test]
fn a_command_that_a_signal_ends_leaves_no_part_of_what_it_writes() {
    for line in [
        "simulate synth::tree:30,1 --forest 50 --seconds 1000 --cache sway.pc2 --out sway.csv --beams beams.csv",
        "synth clip.y4m --frames 5000",
    ] {
        for signal in [Signal::TERM, Signal::HUP, Signal::INT] {
            if signal == Signal::HUP && is_ignored(signal) {
                continue;
            }
            let bench = Bench::new();
            let mut command = bench.command(line.split(' '));
            let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            let names = || {
                let entries = std::fs::read_dir(bench.path("")).unwrap();
                entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect::<Vec<_>>()
            };
            let parts = || names().into_iter().filter(|name| name.ends_with(".part")).count();
            while parts() == 0 {
                assert_eq!(child.try_wait().unwrap(), None, "it has ended before it could be stopped");
                std::thread::yield_now();
            }
            kill_process(Pid::from_child(&child), signal).unwrap();
            let status = child.wait().unwrap();
            let by_name = if signal == Signal::INT { None } else { Some(signal.as_raw()) };
            assert!(status.signal() == by_name && !status.success(), "{signal:?}: {status}");
            let left: Vec<String> = names().into_iter().filter(|name| name.contains('.')).collect();
            assert_eq!(left, [""; 0], "{line}, {signal:?}");
        }
    }
}

#[test]
fn a_killed_run_is_kept_though_its_clip_is_missing_at_first() {
    let (bench, mut child) = at_work(NEW);
    child.kill().unwrap();
    child.wait().unwrap();
    std::fs::rename(bench.path("clip.y4m"), bench.path("away")).unwrap();
    assert_eq!(bench.line("track p.honami").code, Some(1));
    std::fs::rename(bench.path("away"), bench.path("clip.y4m")).unwrap();
    assert!(bench.samples("p.honami").iter().any(|row| row["run"] == "2"));
}
