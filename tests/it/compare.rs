//! `honami compare`: what it measures, on clips, projects and pairs of pictures.

use std::fs;

use honami_tests::{Bench, data};
use serde_json::Value;

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
        ("compare clip.y4m --points none.csv", 2, &["no points", "--points"]),
        ("compare clip.y4m --frames 2..9", 1, &["2..9", "0..4"]),
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
fn middlebury_trees_are_followed_to_a_tenth_of_a_pixel() {
    let Some(folder) = data("flow/middlebury/Grove2") else { return };
    let bench = Bench::new();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (from, to, truth) = (file("frame10.png"), file("frame11.png"), file("flow10.flo"));
    let said = bench.run(["compare", &from, &to, "--truth", &truth, "--with", "klt", "--json"]).json();
    assert!(number(&row(&said, "klt")["median_px"]) < 0.1, "{said}");
    assert!(number(&row(&said, "static")["median_px"]) > 1.0, "{said}");
}
