//! `honami compare`: what it measures, on clips, projects and pairs of pictures.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

use honami_tests::{Bench, data};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use crate::isolated::{compile, has_cc, project};

/// The row of a tracker.
fn row<'a>(said: &'a Value, tracker: &str) -> &'a Value {
    said["trackers"].as_array().unwrap().iter().find(|row| row["tracker"] == tracker).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A flow that is the same in every pixel.
fn flow(bench: &Bench, name: &str, [width, height]: [u32; 2], vector: [f32; 2]) {
    let mut bytes = b"PIEH".to_vec();
    bytes.extend([width, height].map(u32::to_le_bytes).as_flattened());
    for _ in 0..width * height {
        bytes.extend(vector.map(f32::to_le_bytes).as_flattened());
    }
    fs::write(bench.path(name), bytes).unwrap();
}

#[test]
fn a_generated_clip_is_measured_from_all_sides_and_drawn() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 20, "--leaves 60");
    let line = "compare clip.y4m --truth clip.truth.csv --with klt --svg out.svg";
    let said = bench.json(line);
    let (klt, still) = (row(&said, "klt"), row(&said, "static"));
    let shares: Vec<f64> = klt["within"].as_array().unwrap().iter().map(number).collect();
    assert!(shares.is_sorted() && shares.len() == 5, "{klt}");
    assert!((shares.iter().sum::<f64>() / 5.0 - number(&klt["delta_avg"])).abs() < 1e-9, "{klt}");
    for share in ["precision", "recall", "visibility", "survival"] {
        assert!((0.0..=1.0).contains(&number(&klt[share])), "{share}: {klt}");
    }
    assert_eq!(klt["drift"].as_array().unwrap().len(), 12);
    assert!(number(&klt["ms_p95"]) >= number(&klt["ms_median"]));
    assert!(number(&klt["back"]["within_1px"]) > 0.5, "{klt}");
    assert!(number(&klt["mean_px"]) < number(&still["mean_px"]), "{said}");
    assert_eq!((&still["back"], &still["ms_per_frame"]), (&Value::Null, &Value::Null));
    // As people read it, and drawn; less of both where that is enough.
    let svg = fs::read_to_string(bench.path("out.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("clip.y4m"), "{svg}");
    let text = bench.text(line);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let quick = bench.json("compare clip.y4m --truth clip.truth.csv --with klt --quick --frames 5..15");
    assert_eq!((&row(&quick, "klt")["back"], &quick["frames"]), (&Value::Null, &serde_json::json!([5, 15])));
}

#[test]
fn a_clip_without_truth_is_compared_on_what_a_tracker_finds() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 8, "");
    let said = bench.json("compare clip.y4m --with klt");
    assert!(number(&said["points"]) > 10.0, "{said}");
    assert_eq!(row(&said, "klt").get("delta_avg"), None);
    assert!(number(&row(&said, "klt")["back"]["median_px"]) < 0.5, "{said}");
}

#[test]
fn key_frames_are_left_out_one_after_the_other() {
    let bench = Bench::tracked();
    // What the tracker found is right; one key-frame of three is 30 px off.
    let edited = bench.edit("p.honami", "confirm 0 10\nconfirm 0 20\nkey 1 10 1 1\n");
    assert_eq!(edited.code, Some(0), "{edited:?}");
    let said = bench.json("compare p.honami --with klt");
    // The births of the tracks are key-frames that nobody leaves out.
    let klt = &row(&said, "klt")["left_out"];
    assert_eq!((&klt["key_frames"], &klt["found"]), (&3.into(), &3.into()), "{said}");
    assert!(number(&klt["median_px"]) < 0.5, "{klt}");
    assert!(row(&said, "static")["left_out"].is_object(), "{said}");
}

#[test]
fn a_pair_of_pictures_is_compared_with_a_flow() {
    let bench = Bench::new();
    bench.json("synth frames --size 160x120 --frames 2");
    let mut pictures: Vec<_> =
        fs::read_dir(bench.path("frames")).unwrap().map(|e| e.unwrap().path()).collect();
    pictures.sort();
    let first = pictures[0].to_str().unwrap();
    flow(&bench, "still.flo", [160, 120], [0.0, 0.0]);
    // The same picture twice, under two names: nothing moves, and it is two frames.
    let twice = bench.path("b twice.png");
    fs::copy(first, &twice).unwrap();
    let args = ["compare", first, twice.to_str().unwrap(), "--truth", "still.flo", "--with", "klt", "--json"];
    let said = bench.run(args).json();
    let klt = row(&said, "klt");
    assert!(number(&klt["rms_px"]) < 1e-3 && number(&klt["field"]["mean_px"]) < 1e-3, "{klt}");
    assert_eq!(row(&said, "static")["rms_px"], 0.0);
    assert!(bench.run(args.into_iter().take(5)).text().contains("end-point error"));
    // One that says that all moves by (3, 4): 5 px, and nobody is near.
    flow(&bench, "moves.flo", [160, 120], [3.0, 4.0]);
    let args = ["compare", first, twice.to_str().unwrap(), "--truth", "moves.flo", "--with", "klt", "--json"];
    let off = row(&bench.run(args).json(), "klt").clone();
    assert!((number(&off["median_px"]) - 5.0).abs() < 0.01, "{off}");
    assert!((number(&off["bias_px"][1]) + 4.0).abs() < 0.1, "{off}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 4, "");
    bench.json("synth large.y4m --size 320x240 --frames 4");
    bench.json("synth pair.y4m --size 160x120 --frames 2");
    for (name, size) in [("small.flo", [80, 60]), ("right.flo", [160, 120])] {
        flow(&bench, name, size, [0.0, 0.0]);
    }
    flow(&bench, "unknown.flo", [160, 120], [1e10, 1e10]);
    fs::write(bench.path("none.csv"), "id,x,y\n").unwrap();
    fs::write(bench.path("cut.flo"), "PIEH").unwrap();
    for (line, code, words) in [
        (
            "compare clip.y4m --truth large.truth.csv",
            1,
            &["the truth shows point", "160x120", "another clip's"][..],
        ),
        ("compare pair.y4m --truth clip.truth.csv", 1, &["frames 0..2", "another clip's"]),
        ("compare pair.y4m --truth small.flo", 1, &["80x60", "160x120", "small.flo"]),
        ("compare clip.y4m --truth right.flo", 1, &["4 frames", "--frames A..A+2"]),
        ("compare pair.y4m --truth unknown.flo", 1, &["none of the tracked points"]),
        ("compare pair.y4m --truth cut.flo", 1, &["no .flo file", "cut.flo"]),
        ("compare clip.y4m --truth pair.truth.csv", 1, &["ends with frame 1", "0..4", "--frames 0..2"]),
        ("compare clip.y4m --with ktl", 2, &["\"ktl\" (did you mean klt?)"]),
        ("compare clip.y4m --with klt --set radis=3", 2, &["\"radis\" (did you mean radius?)"]),
        ("compare clip.y4m --points none.csv", 2, &["no points", "--points"]),
        ("compare clip.y4m --frames 2..9", 2, &["2..9", "0..4"]),
        ("compare clip.y4m --svg nowhere/out.svg", 1, &["no folder nowhere"]),
        ("compare clip.y4m pair.y4m", 1, &["clip.y4m"]),
    ] {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(code), "{line}: {ran:?}");
        assert!(words.iter().all(|word| ran.stderr.contains(word)), "{line}: {words:?}: {}", ran.stderr);
        assert_eq!((ran.stdout.as_str(), ran.stderr.lines().count()), ("", 1), "{line}: {ran:?}");
    }
}

#[test]
fn the_columns_and_what_was_left_out_are_said_in_words() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 8, "");
    fs::write(bench.path("some.csv"), "id,x,y,frame\n1,80,60,0\n2,70,50,0\n3,60,60,7\n").unwrap();
    let ran = bench.line("compare clip.y4m --with klt --points some.csv --frames 0..4");
    assert_eq!(ran.stderr, "klt 1 of 1\n", "whose turn it is, for want of a terminal");
    let text = ran.text();
    assert_eq!(text.lines().next(), Some("2 points, frames 0-3 (left out: 1 given in other frames)"));
    for words in
        ["kept      share of points", "occluded is not kept", "home      share of points that come back"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn what_was_measured_before_ctrl_c_is_told() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 400, "--leaves 20");
    let line = "compare clip.y4m --json --quick --with klt --with anchored --with box --set max_features=20";
    let mut command = bench.command(line.split(' '));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.by_ref().any(|line| line.unwrap() == "anchored 2 of 3"));
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let rest: Vec<String> = lines.map(Result::unwrap).collect();
    assert_eq!(rest, ["anchored: stopped, so it has no row", "box: stopped, so it has no row"]);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "to be stopped is not to be done");
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let names = |rows: &str| -> Vec<String> {
        said[rows].as_array().unwrap().iter().map(|row| row["tracker"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(
        (names("trackers"), names("missing")),
        (vec!["klt".to_owned(), "static".to_owned()], vec!["anchored".to_owned(), "box".to_owned()])
    );
}

#[test]
fn middlebury_trees_are_followed_to_a_tenth_of_a_pixel() {
    let Some(folder) = data("flow/middlebury/Grove2") else { return };
    let bench = Bench::new();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (from, to, truth) = (file("frame10.png"), file("frame11.png"), file("flow10.flo"));
    let said = bench.run(["compare", &from, &to, "--truth", &truth, "--with", "klt", "--json"]).json();
    assert!(number(&row(&said, "klt")["median_px"]) < 0.1, "{said}");
    assert!(number(&row(&said, "static")["median_px"]) > 1.0, "{said}");
}

#[test]
fn a_tracker_that_dies_in_a_frame_loses_it_and_one_that_dies_thrice_its_row() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    project(&bench);
    let line = "compare clip.y4m --points points.csv --plugin bad.so --with bad";
    compile(&bench, "bad.so", &["-DFAULT=SEGFAULT"]);
    let said = bench.json(&format!("{line} --quick"));
    let bad = row(&said, "bad");
    // It dies in frame 2, and again: both points are lost there.
    assert_eq!((&bad["deaths"], number(&bad["kept"])), (&2.into(), 0.0), "{said}");
    // On the way back it dies there, too: that is not measured, and the row stays. By now it would be held.
    let _said = bench.text("plugin retry bad.so");
    let said = bench.json(line);
    let bad = row(&said, "bad");
    assert_eq!((&bad["deaths"], &bad["back"]), (&3.into(), &Value::Null), "{said}");
    compile(&bench, "bad.so", &["-DFAULT=WITHERS"]);
    let ran = bench.line(&format!("{line} --with klt"));
    let why = "bad: no row: org.honami.bad has failed three times within ten minutes";
    assert!(ran.code == Some(1) && ran.stderr.contains(why) && ran.stdout.contains("klt"), "{ran:?}");
}
