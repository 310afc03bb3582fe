//! Re-tracking from key-frames, and every other word of a script, through the real program.

use std::collections::BTreeMap;
use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};

use honami_tests::{Bench, Row, by_track, program};
use honami_workbench::WorkbenchError;
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::retrack::{RetrackRequest, Way, finish, prepare};
use honami_workbench::script;
use honami_workbench::session::{Session, SessionOptions};

/// Frames of the clip.
const N_FRAMES: u32 = 25;

/// A clip so large that crops are much smaller than its pictures, and what a tracker found in it.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.json(&format!("synth clip.y4m --size 560x440 --frames {N_FRAMES} --leaves 250"));
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami --with klt --set max_features=30");
    bench
}

/// Positions by track and frame.
fn positions(rows: &[Row]) -> BTreeMap<(u32, u32), [f64; 2]> {
    let number = |row: &Row, column: &str| row[column].parse::<f64>().unwrap();
    rows.iter()
        .map(|row| {
            let at = (number(row, "track") as u32, number(row, "frame") as u32);
            (at, [number(row, "x"), number(row, "y")])
        })
        .collect()
}

#[track_caller]
fn assert_near(a: &BTreeMap<(u32, u32), [f64; 2]>, b: &BTreeMap<(u32, u32), [f64; 2]>, within_px: f64) {
    assert_eq!(a.len(), b.len());
    for (at, p) in a {
        let q = b[at];
        let apart = (p[0] - q[0]).hypot(p[1] - q[1]);
        assert!(apart <= within_px, "track and frame {at:?}: {p:?} and {q:?}");
    }
}

#[test]
fn a_crop_gives_what_the_whole_picture_gives() {
    let bench = bench();
    let whole = bench.samples("p.honami");
    let script: String = by_track(&whole)
        .keys()
        .map(|track| format!("retrack {track} forward 0 {}\n", N_FRAMES - 1))
        .collect();
    let said = bench.edit("p.honami", &script).text();
    assert!(said.lines().all(|line| line.ends_with("re-tracked 1-24 forward")), "nothing moves: {said}");
    let again = bench.samples("p.honami");
    assert_near(&positions(&whole), &positions(&again), 0.01);
    // What is shown comes from the new runs, whose provenance says what they are; the runs themselves are not shown.
    assert!(
        again.iter().filter(|row| row["frame"] != "0").all(|row| row["run"] != "1"),
        "laid with their runs"
    );
    let runs = bench.log("p.honami", "run");
    assert_eq!(runs.len(), 1 + by_track(&whole).len());
    let made = |run: usize, what: &str| runs[run]["provenance"][what].clone();
    assert_eq!(made(1, "what"), "retrack forward from 0");
    assert_eq!(
        (made(1, "plugin_id"), made(1, "params")),
        (made(0, "plugin_id"), made(0, "params")),
        "the tracker and the parameters that made the track"
    );
    assert_eq!(runs[1]["frames"], serde_json::json!([0, N_FRAMES]));
}

/// A Y4M file whose frames come in the opposite order.
fn reversed(clip: &[u8]) -> Vec<u8> {
    let head = clip.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let size = (clip.len() - head) / N_FRAMES as usize;
    let frames = clip[head..].chunks(size).rev().flatten();
    clip[..head].iter().chain(frames).copied().collect()
}

#[test]
fn backward_is_forward_through_the_clip_turned_round() {
    let bench = bench();
    let last = N_FRAMES - 1;
    let ends: Vec<Row> =
        bench.samples("p.honami").into_iter().filter(|row| row["frame"] == last.to_string()).collect();
    let mut script = String::new();
    let mut points = String::from("id,x,y\n");
    for row in &ends {
        script += &format!("confirm {0} {last}\nclear {0} {last}\nconfirm {0} {last}\n", row["track"]);
        script += &format!("retrack {} backward 0 {last}\n", row["track"]);
        points += &format!("{},{},{}\n", row["track"], row["x"], row["y"]);
    }
    assert_eq!(bench.edit("p.honami", &script).code, Some(0));
    fs::write(bench.path("turned.y4m"), reversed(&fs::read(bench.path("clip.y4m")).unwrap())).unwrap();
    fs::write(bench.path("points.csv"), points).unwrap();
    bench.json("new turned.honami turned.y4m");
    bench.json("track turned.honami --with klt --points points.csv");
    // The birth of a track is what the feature is; a backward pass ends before it.
    let without_birth = |rows: Vec<Row>, birth: u32| -> Vec<Row> {
        rows.into_iter().filter(|row| row["frame"] != birth.to_string()).collect()
    };
    let back = positions(&without_birth(bench.samples("p.honami"), 0));
    let turned = positions(&without_birth(bench.samples("turned.honami"), last));
    let turned = turned.into_iter().map(|((track, frame), at)| ((track, last - frame), at)).collect();
    assert_near(&back, &turned, 0.01);
}

#[test]
fn hand_work_is_kept_and_undo_takes_all_back() {
    let bench = bench();
    let before = bench.samples("p.honami");
    let at = positions(&before)[&(3, 12)];
    let hand = format!(
        "key 3 12 {} {}\nmark occluded 3 4 6\nsketch 3 15 1 0.1,100,100 0.3,130,110\nrange-delete 3 23 24\n",
        at[0] + 2.0,
        at[1] - 1.0
    );
    assert_eq!(bench.edit("p.honami", &hand).code, Some(0));
    let by_hand = bench.samples("p.honami");
    let said = bench.edit("p.honami", "retrack 3 both 0 24\n").text();
    assert!(
        said.contains("track 3: re-tracked 1-22 both ways, moved up to ") && said.contains(" hand work kept"),
        "{said}"
    );
    let now = bench.samples("p.honami");
    let of = |rows: &[Row]| -> BTreeMap<u32, Row> {
        let rows = rows.iter().filter(|row| row["track"] == "3");
        rows.map(|row| (row["frame"].parse().unwrap(), row.clone())).collect()
    };
    let (was, is) = (of(&by_hand), of(&now));
    let mut n_changed = 0;
    for (frame, row) in &was {
        let hand = matches!(row["source"].as_str(), "key" | "sketch") || (4..=6).contains(frame);
        assert!(!hand || is[frame] == *row, "frame {frame}: {:?} was {row:?}", is[frame]);
        n_changed += u32::from(is[frame] != *row);
    }
    assert!(
        n_changed > 8 && was.contains_key(&22) && !is.contains_key(&23),
        "{n_changed} frames tracked again"
    );
    assert_eq!(bench.edit("p.honami", "undo").code, Some(0));
    assert_eq!(bench.samples("p.honami"), by_hand);
    assert_eq!(bench.edit("p.honami", "redo\nundo\nundo\nundo\nundo\nundo\n").code, Some(0));
    assert_eq!(bench.samples("p.honami"), before);
}

#[test]
fn two_ways_meet_the_key_frames() {
    let bench = bench();
    let at = positions(&bench.samples("p.honami"))[&(5, 20)];
    let script = format!("key 5 20 {} {}\nretrack 5 both 0 20 klt radius=7\n", at[0] + 3.0, at[1]);
    let said = bench.edit("p.honami", &script).text();
    let last = said.lines().last().unwrap();
    assert!(last.contains("track 5: re-tracked 1-19 both ways, moved up to "), "{said}");
    let rows = bench.samples("p.honami");
    let now = positions(&rows);
    let moved = (now[&(5, 19)][0] - now[&(5, 20)][0]).hypot(now[&(5, 19)][1] - now[&(5, 20)][1]);
    let step = positions(&bench.samples("p.honami"))[&(5, 20)][0] - at[0];
    assert!(
        (step - 3.0).abs() < 1e-3 && moved < 8.0,
        "the path bends to the key-frame: {moved} px beside it"
    );
    let runs = bench.log("p.honami", "run");
    let what: Vec<&str> = runs[1..].iter().map(|run| run["provenance"]["what"].as_str().unwrap()).collect();
    assert_eq!(what, ["retrack forward from 0", "retrack backward from 20"]);
    assert!(runs[1..].iter().all(|run| run["provenance"]["params"]["radius"] == 7));
    let of = |frame: &str| rows.iter().find(|row| row["track"] == "5" && row["frame"] == frame).unwrap();
    assert_eq!([of("1"), of("19")].map(|row| row["run"].as_str()), ["2", "3"], "the nearer key-frame's run");
}

#[test]
fn every_word_is_an_edit_that_undo_takes_back() {
    let bench = bench();
    bench.json("cluster p.honami");
    let samples = || bench.samples("p.honami");
    let before = samples();
    let at = |track: u32, frame: u32| positions(&before)[&(track, frame)];
    let near = |track, frame| at(track, frame).map(|v| (v + 2.0).to_string()).join(" ");
    let (second, fourth) = (near(1, 12), near(2, 9));
    let script = [
        format!("add 3 {}", near(1, 3)),
        format!("key 1 6 {}", near(1, 6)),
        "clear 1 6".to_owned(),
        "confirm 1 6".to_owned(),
        format!("linear 1 12 {second}"),
        format!("hermite 1 9 {}", near(1, 9)),
        format!("space 2 9 {fourth}"),
        "time 2 5 0.02".to_owned(),
        "sketch 4 3 0.5 0,100,90 0.5,120,95 1.5,130,99".to_owned(),
        "retrack 2 both 0 24".to_owned(),
        "take 2 1 0 24".to_owned(),
        "mark lost 3 20 22".to_owned(),
        "mark outside 3 20 22".to_owned(),
        "range-delete 5 20 24".to_owned(),
        "split 6 10".to_owned(),
        "swap 7 8 10 14".to_owned(),
        "join 5 9".to_owned(),
        "duplicate 10".to_owned(),
        "average 11 12 13".to_owned(),
        "name 14 the top leaf".to_owned(),
        "name 14".to_owned(),
        "judge 14 3 9 accepted".to_owned(),
        "unjudge 14 3".to_owned(),
        "delete 15 16".to_owned(),
        "restore 15".to_owned(),
        "cut 2".to_owned(),
    ];
    let help = bench.text("edit --help");
    let said = bench.edit("p.honami", &script.join("\n")).text();
    assert_eq!(said.lines().count(), script.len(), "{said}");
    for line in &script {
        let word = line.split(' ').next().unwrap();
        assert!(help.contains(&format!("\n  {word} ")), "{word} is not in the help");
    }
    assert!(samples() != before);
    let undo = "undo\n".repeat(script.len());
    assert_eq!(bench.edit("p.honami", &undo).code, Some(0));
    assert_eq!(samples(), before);
}

#[test]
fn what_cannot_be_tracked_again_says_why() {
    let bench = bench();
    for (script, words) in [
        ("retrack 3 forward 5 9", "track 3 has no key-frame in 5-9 to track from"),
        ("retrack 3 backward 0 24", "track 3 has no key-frame in 0-24 to track from"),
        ("retrack 3 both 5 99", "frames 5..100 were asked for, but the clip has frames 0..25"),
        ("retrack 3 both 9 5", "wanted a last frame from 9 on, got 5"),
        ("retrack 999 both 0 9", "there is no track 999"),
        ("retrack 3 sideways 0 9", "wanted forward, backward or both, got sideways"),
        ("retrack 3 both 0 9 magic", "magic"),
        ("retrack 3 both 0 9 klt radius=0", "radius: wanted a whole number"),
        ("retrack 3 both 0", "wanted retrack TRACK forward|backward|both FIRST LAST"),
        ("mark gone 3 0 9", "wanted lost, occluded, outside or seen, got gone"),
        ("judge 3 0 9 good", "wanted one of accepted, fixed"),
        ("sketch 3 0 1 5,6", "wanted a point of the stroke as S,X,Y, got 5,6"),
        ("time 3 5 soon", "wanted a shift in seconds, got soon"),
    ] {
        let ran = bench.edit("p.honami", script);
        assert_eq!(ran.code, Some(1), "{script}: {ran:?}");
        assert!(ran.stderr.contains(words), "{script}: {words:?} is not in {:?}", ran.stderr);
    }
    assert_eq!(bench.log("p.honami", "run").len(), 1, "nothing is kept of what was refused");
}

/// Stops after so many reports.
struct StopAfter(AtomicU64);

impl Progress for StopAfter {
    fn report(&self, _: u64, _: u64, _: &str) -> Flow {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        if left.is_ok() { Flow::Continue } else { Flow::Stop }
    }
}

#[test]
fn a_stopped_re_tracking_leaves_nothing_behind() {
    let bench = bench();
    assert_eq!(bench.edit("p.honami", "confirm 3 12").code, Some(0));
    let (before, n_entries) = (bench.samples("p.honami"), bench.log("p.honami", "log").len());
    let options = SessionOptions {
        plugin_paths: vec![program().parent().unwrap().to_owned()],
        ..SessionOptions::default()
    };
    let session = Session::open(&bench.path("p.honami"), &options).unwrap();
    let (track, _) = session.project.document().tracks().find(|(track, _)| track.0 == 3).unwrap();
    let request =
        RetrackRequest { track, way: Way::Both, frames: 0..=N_FRAMES - 1, keys: Vec::new(), with: None };
    for n_reports in [0, 5, 15] {
        let job = prepare(&session, &request).unwrap();
        let stopped = job.run(&StopAfter(AtomicU64::new(n_reports)));
        assert!(matches!(stopped, Err(WorkbenchError::Stopped)), "after {n_reports} reports");
    }
    drop(session);
    assert_eq!(bench.samples("p.honami"), before);
    assert_eq!((bench.log("p.honami", "run").len(), bench.log("p.honami", "log").len()), (1, n_entries));
}

#[test]
fn a_re_tracking_of_what_has_changed_meanwhile_is_not_laid() {
    let bench = bench();
    assert_eq!(bench.edit("p.honami", "confirm 3 12").code, Some(0));
    let options = SessionOptions {
        plugin_paths: vec![program().parent().unwrap().to_owned()],
        ..SessionOptions::default()
    };
    let mut session = Session::open(&bench.path("p.honami"), &options).unwrap();
    let (track, _) = session.project.document().tracks().find(|(track, _)| track.0 == 3).unwrap();
    let request =
        RetrackRequest { track, way: Way::Both, frames: 0..=N_FRAMES - 1, keys: Vec::new(), with: None };
    let changed = "track 3 was changed while it was re-tracked: nothing was laid, re-track it again";
    for (meanwhile, refused) in [
        ("key 3 12 50 50", Some(changed)),
        ("key 3 17 50 50", Some(changed)),
        ("clear 3 12", Some(changed)),
        ("mark occluded 3 4 6", None),
        ("delete 3", Some("there is no track 3")),
    ] {
        let done = prepare(&session, &request).unwrap().run(&()).unwrap();
        script::step(&mut session, &script::words(meanwhile)).unwrap();
        let before = session.project.revision();
        let laid = finish(&mut session, done).map_err(|why| why.to_string());
        assert_eq!(laid.as_ref().err().map(String::as_str), refused, "{meanwhile}");
        assert_eq!(session.project.revision() == before, refused.is_some(), "{meanwhile}");
    }
    drop(session);
    assert_eq!(bench.log("p.honami", "run").len(), 3, "what was not laid leaves no runs behind");
}
