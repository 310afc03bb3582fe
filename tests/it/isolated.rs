//! A plugin that dies costs what it was doing: the rest of the run is kept, and goes on.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use honami_tests::{Bench, has_compiler, program, root, skipped};
use honami_workbench::plugins::{CallContext, Host, Hosting, Kind, Registry, Values};

/// A tracker `bad.so` that leaves its points where they are, with one fault; `None` without a C compiler.
fn bad(bench: &Bench, fault: &str) -> Option<PathBuf> {
    has_cc().then(|| compile(bench, "bad.so", &[&format!("-DFAULT={fault}")]))
}

/// Whether there is a C compiler; says so if not.
pub(crate) fn has_cc() -> bool {
    has_compiler("cc")
}

/// Whether this kernel keeps files away from a process that has given them up; says so if not.
pub(crate) fn is_shut_in() -> bool {
    let bench = Bench::new();
    let registry = Registry::scan(&[program().parent().unwrap().to_owned()]);
    let klt = registry.find(Kind::Tracker, "klt").unwrap();
    let host = Host::with_store(bench.path("store")).hosting(Hosting::Isolated);
    let (_, origin) = host.tracker(klt, &Values::default(), &CallContext::silent()).unwrap();
    if origin.sandbox != "full" {
        skipped("landlock in the kernel");
    }
    origin.sandbox == "full"
}

/// The tracker that has a fault by these flags, under this name.
pub(crate) fn compile(bench: &Bench, name: &str, flags: &[&str]) -> PathBuf {
    compile_source(bench, "bad.c", name, flags)
}

fn compile_source(bench: &Bench, source: &str, name: &str, flags: &[&str]) -> PathBuf {
    let library = bench.path(name);
    let output = Command::new("cc")
        .args(["-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"])
        .arg(root().join("core/abi/include"))
        .args(flags)
        .arg("-o")
        .arg(&library)
        .arg(root().join("core/host/tests/bad").join(source))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    library
}

/// A project with a clip of eight frames, and two points to follow.
pub(crate) fn project(bench: &Bench) {
    bench.synth("clip.y4m", 8, "--leaves 20");
    let _said = bench.text("new p.honami clip.y4m");
    fs::write(bench.path("points.csv"), "id,x,y\n1,20.5,30\n2,60,40.25\n").unwrap();
}

const TRACK: &str = "track p.honami --plugin bad.so --with bad --points points.csv";

#[test]
fn a_plugin_that_dies_in_a_frame_loses_that_frame() {
    let bench = Bench::new();
    if bad(&bench, "SEGFAULT").is_none() {
        return;
    }
    project(&bench);
    let said = bench.text(TRACK);
    let wanted = "started again at frame 2: it died of SIGSEGV (it used memory that is not its own)";
    assert!(said.contains("2 tracks, frames 0-7") && said.matches(wanted).count() == 1, "{said}");
    let _said = bench.text("export p.honami tracks out.csv");
    let table = fs::read_to_string(bench.path("out.csv")).unwrap();
    let of_track_2 = |line: &&str| line.starts_with("2,");
    let rows: Vec<Vec<&str>> =
        table.lines().filter(of_track_2).map(|line| line.split(',').collect()).collect();
    let seen: Vec<(&str, &str)> = rows.iter().map(|row| (row[1], row[5])).collect();
    // Status 1 is tracked, 0 lost.
    assert_eq!(seen, ["01", "11", "20", "31", "41", "51", "61", "71"].map(|pair| pair.split_at(1)));
    assert!(rows.iter().all(|row| (row[3], row[4]) == ("60", "40.25")), "{table}");
}

#[test]
fn a_plugin_that_dies_again_and_again_is_held_until_somebody_lets_it_go_on() {
    let bench = Bench::new();
    if bad(&bench, "WITHERS").is_none() {
        return;
    }
    project(&bench);
    let ran = bench.line(TRACK);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let all = format!("{}{}", ran.stdout, ran.stderr);
    assert!(all.contains("failed at frame 4, 2 tracks up to there kept"), "{all}");
    let held = "has failed three times within ten minutes and is not started again";
    assert!(all.contains(held), "{all}");
    let again = bench.line(TRACK);
    assert!(again.code == Some(1) && again.stderr.contains(held), "{again:?}");
    assert_eq!(bench.text("plugin retry bad.so").trim(), "bad may start again");
    // Rebuilt, it is another one.
    bad(&bench, "NONE");
    assert!(bench.text(TRACK).contains("2 tracks, frames 0-7"));
}

#[test]
fn what_begins_in_a_lost_frame_is_followed_and_a_death_at_once_leaves_no_run() {
    let bench = Bench::new();
    if bad(&bench, "SEGFAULT").is_none() {
        return;
    }
    project(&bench);
    fs::write(bench.path("points.csv"), "id,x,y,frame\n1,20,30,0\n2,60,40,2\n").unwrap();
    let _said = bench.text(TRACK);
    let _said = bench.text("export p.honami tracks out.csv");
    let table = fs::read_to_string(bench.path("out.csv")).unwrap();
    let frames = |track: &str| table.lines().filter(|line| line.starts_with(track)).count();
    assert_eq!((frames("1,"), frames("2,")), (8, 6), "{table}");
    // It dies in the first frame: what is told is why, and nothing is kept.
    let ran = bench.line(&format!("{TRACK} --frames 2..6"));
    assert!(ran.code == Some(1) && ran.stderr.contains("died of SIGSEGV"), "{ran:?}");
    assert!(!bench.text("log p.honami").contains("run 2"));
}

/// Three points through twelve frames by the mortal tracker, built with these flags: what is said, and the table.
fn mortal(bench: &Bench, flags: &[&str]) -> (String, String) {
    compile_source(bench, "mortal.c", "mortal.so", flags);
    let name = flags.concat().replace(|c: char| !c.is_alphanumeric(), "");
    fs::write(bench.path("points.csv"), "id,x,y,frame\n1,20.5,30,0\n2,60,40.25,0\n3,9,9,4\n").unwrap();
    let _said = bench.text(&format!("new {name}.honami clip.y4m"));
    let said =
        bench.text(&format!("track {name}.honami --plugin mortal.so --with mortal --points points.csv"));
    let _said = bench.text(&format!("export {name}.honami tracks {name}.csv"));
    (said, fs::read_to_string(bench.path(&format!("{name}.csv"))).unwrap())
}

#[test]
fn a_plugin_that_saves_what_it_carries_goes_on_as_if_it_had_not_died() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    bench.synth("clip.y4m", 12, "--leaves 20");
    let (said, undisturbed) = mortal(&bench, &["-DDIES=-1"]);
    assert!(!said.contains("started again"), "{said}");
    for dies_in in [2, 5, 11] {
        let (said, table) = mortal(&bench, &[&format!("-DDIES={dies_in}")]);
        assert!(said.contains(&format!("started again at frame {dies_in}: it died of SIGSEGV")), "{said}");
        assert_eq!(table, undisturbed, "dead in frame {dies_in}");
    }
}

#[test]
fn a_plugin_that_is_bad_at_saving_what_it_carries_goes_on_from_where_points_were_seen() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    bench.synth("clip.y4m", 12, "--leaves 20");
    // It dies in frame 5 every time but after load, which never comes: the frame is lost.
    for (flags, frame, n_lost) in [
        (["-DDIES=5", "-DSAVING=REFUSES_TO_SAVE"], 5, 3),
        (["-DDIES=5", "-DSAVING=REFUSES_TO_LOAD"], 5, 3),
        (["-DDIES=-1", "-DSAVING=DIES_OF_SAVING"], 1, 0),
    ] {
        let (said, table) = mortal(&bench, &flags);
        assert_eq!(said.matches(&format!("started again at frame {frame}: it")).count(), 1, "{said}");
        assert_eq!(said.matches("started again").count(), 1, "{said}");
        let statuses: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').nth(5)).collect();
        // Twelve samples of two points, eight of the one that begins in frame 4.
        assert_eq!((statuses.len(), statuses.iter().filter(|s| **s == "0").count()), (32, n_lost), "{table}");
    }
}
