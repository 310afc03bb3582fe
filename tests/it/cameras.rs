//! `calibrate`: cameras from pictures, by the program.

use honami_tests::{Bench, data, rows};
use serde_json::Value;

/// OpenCV's pictures of one side, in order.
fn pictures(side: &str) -> Option<Vec<String>> {
    let folder = data("calib/opencv")?;
    let path = |number: u32| folder.join(format!("{side}{number:02}.jpg")).display().to_string();
    Some((1..10).chain(11..15).map(path).collect())
}

#[track_caller]
fn is_near(json: &Value, key: &str, want: f64, within: f64) {
    let got = json[key].as_f64().unwrap();
    assert!((got - want).abs() <= within, "{key}: {got} for {want}");
}

#[test]
fn opencvs_pairs_give_opencvs_numbers() {
    let Some((left, right)) = pictures("left").zip(pictures("right")) else { return };
    let bench = Bench::new();
    let args = |window: &[&str]| {
        let mut args = vec!["calibrate".to_owned()];
        args.extend(left.iter().cloned());
        args.push("--right".to_owned());
        args.extend(right.iter().cloned());
        args.extend(["--board", "9x6", "--square", "25", "--json"].map(str::to_owned));
        args.extend(window.iter().map(|&word| word.to_owned()));
        args
    };
    let found = bench.run(args(&["--out", "cameras.json"])).json();
    is_near(&found, "fx", 536.0, 0.5);
    is_near(&found, "rms", 0.408, 0.01);
    is_near(&found["stereo"], "rms", 0.444, 0.01);
    is_near(&found["stereo"], "baseline", 83.6, 0.3);
    is_near(&found["by_squares"], "rms", 0.178, 0.01);
    assert_eq!(found["views"].as_array().unwrap().len(), 13);
    assert_eq!(found["left_out"], Value::Array(Vec::new()));
    assert_eq!(found["views"][12]["picture"], "left14.jpg");
    let kept: Value =
        serde_json::from_str(&std::fs::read_to_string(bench.path("cameras.json")).unwrap()).unwrap();
    assert_eq!(kept["honami"], "cameras");
    assert_eq!(kept["stereo"], found["stereo"]);
    // What they were made from: names without folders, and hashes.
    let made = &kept["provenance"];
    assert_eq!((&made["what"], &made["params"]["board"]), (&"calibrate".into(), &"9x6".into()));
    assert!(made["params"]["right"].as_str().unwrap().starts_with("right01.jpg, right02.jpg"), "{made}");
    assert_eq!(made["params"]["left_sha256"].as_str().unwrap().len(), 64);
    let found = bench.run(args(&["--window", "squares"])).json();
    is_near(&found, "fx", 533.0, 1.0);
    is_near(&found, "rms", 0.178, 0.01);
    is_near(&found["stereo"], "rms", 0.194, 0.01);
    assert_eq!(found["by_squares"], Value::Null);
}

/// The numbers of cameras that were found beside the true ones, whatever the unit: focal lengths and distance within a share.
#[track_caller]
fn are_as_filmed(bench: &Bench, found: &Value, folder: &str, metres: f64, share: f64) {
    let truth = std::fs::read_to_string(bench.path(&format!("{folder}/cameras.json"))).unwrap();
    let truth: Value = serde_json::from_str(&truth).unwrap();
    let number = |json: &Value, path: &str| json.pointer(path).and_then(Value::as_f64).unwrap();
    for (path, from) in [("/fx", "/stereo/left/fx"), ("/right/fx", "/stereo/right/fx")] {
        let off = number(found, from) / number(&truth, path) - 1.0;
        assert!(off.abs() < share, "{path}: {} % off", 100.0 * off);
    }
    let baseline = number(&truth, "/stereo/baseline");
    for k in 0..3 {
        let path = format!("/stereo/shift/{k}");
        let off = (number(found, &path) * metres - number(&truth, &path)) / baseline;
        assert!(off.abs() < share, "{path}: {} % of the distance off", 100.0 * off);
    }
}

/// Every number of a camera within five of its told errors of the true one.
#[track_caller]
fn is_honest(found: &Value, truth: &Value) {
    for name in ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"] {
        let [got, error, want] =
            [&found[name], &found["errors"][name], &truth[name]].map(|v| v.as_f64().unwrap());
        assert!((got - want).abs() < 5.0 * error, "{name}: {got} ± {error} for {want}");
    }
}

#[test]
fn a_board_that_was_filmed_gives_the_cameras_that_filmed_it() {
    let bench = Bench::new();
    bench.text("synth board --target board --frames 20 --size 640x480 --seed 4");
    let line = "calibrate board/left.y4m --right board/right.y4m --square 30mm --window squares";
    let found = bench.json(line);
    are_as_filmed(&bench, &found, "board", 1e-3, 1e-3);
    let truth: Value =
        serde_json::from_str(&std::fs::read_to_string(bench.path("board/cameras.json")).unwrap()).unwrap();
    is_honest(&found, &truth);
    is_honest(&found["right"], &truth["right"]);
    let pair = |json: &Value, key: &str, k: usize| json["stereo"][key][k].as_f64().unwrap();
    for k in 0..3 {
        let off = pair(&found, "turn_rad", k) - pair(&truth, "turn_rad", k);
        assert!(off.abs() < 5.0 * pair(&found, "turn_error_rad", k), "turn {k}: {off}");
    }
    assert_eq!(found["unit"], "mm");
    assert_eq!(found["views"].as_array().unwrap().len(), 20);
    // Some of them, that differ most, tell nearly as much; what is held stays.
    let few = bench.json(&format!("{line} --views 12 --hold k3,tangential"));
    are_as_filmed(&bench, &few, "board", 1e-3, 5e-3);
    assert_eq!((few["views"].as_array().unwrap().len(), &few["shown"]), (12, &20.into()));
    assert_eq!((&few["k3"], &few["errors"]["p1"]), (&0.0.into(), &0.0.into()));
    let text = bench.text(&format!("{line} --views 12"));
    assert!(text.contains("left: 12 of 20 views of the target"), "{text}");
}

#[test]
fn bars_that_were_tracked_give_the_cameras_that_filmed_them() {
    let bench = Bench::new();
    bench.text("synth bars --target bars --frames 240 --size 640x480 --seed 2");
    for side in ["left", "right"] {
        let truth = rows(&bench.path(&format!("bars/{side}.truth.csv")));
        let first = truth.iter().filter(|row| row["frame"] == "0");
        // A click is half a pixel off.
        let points: String = first
            .map(|row| {
                let [x, y] = ["x", "y"].map(|axis| row[axis].parse::<f64>().unwrap() + 0.5);
                format!("{},{x},{y}\n", row["track"])
            })
            .collect();
        std::fs::write(bench.path(&format!("{side}.csv")), format!("id,x,y\n{points}")).unwrap();
        bench.text(&format!("new {side}.honami bars/{side}.y4m"));
        bench.text(&format!("track {side}.honami --with klt --points {side}.csv"));
    }
    let found =
        bench.json("calibrate left.honami --right right.honami --rig bars/bars.toml --out found.json");
    are_as_filmed(&bench, &found, "bars", 1.0, 0.01);
    let n_middles = |key: &str| found["middles"][key].as_u64().unwrap();
    assert!(n_middles("measured") > 400 && n_middles("tracked") < 100, "{}", found["middles"]);
    assert_eq!(found["provenance"]["params"]["targets"], "bars.toml");
    // With numbers that are known, from one file or from two, only how they stand is looked for.
    let line = "calibrate left.honami --right right.honami --rig bars/bars.toml --known";
    let known = bench.json(&format!("{line} bars/cameras.json"));
    are_as_filmed(&bench, &known, "bars", 1.0, 0.002);
    assert_eq!(known["fx"], 640.0);
    let each = bench.json(&format!("{line} found.json bars/cameras.json"));
    is_near(&each, "fx", 640.0, 6.4);
    assert_eq!(each["right"]["fx"], each["stereo"]["right"]["fx"]);
    // By names, in another order; and what is wrong with a rig.
    let rig = std::fs::read_to_string(bench.path("bars/bars.toml")).unwrap();
    let turned = rig.replace("[0.0, 0.0], [-2.5, 0.0]", "[-2.5, 0.0], [0.0, 0.0]");
    let named = r#"names = ["end", "middle", "2", "3", "4", "5"]"#;
    std::fs::write(bench.path("named.toml"), format!("{turned}{named}\n")).unwrap();
    let why = "no track is called end";
    let failed = bench.run(["calibrate", "left.honami", "--rig", "named.toml"]);
    assert!(failed.stderr.contains(why), "{}", failed.stderr);
    let script = "name 0 middle\nname 1 end\nname 2 2\nname 3 3\nname 4 4\nname 5 5\n";
    assert_eq!(bench.edit("left.honami", script).code, Some(0));
    let alone = bench.json("calibrate left.honami --rig named.toml");
    is_near(&alone, "fx", 640.0, 6.4);
    for (text, why) in [
        ("targets = [[0, 0], [1, 0], [2, 0], [3, 0]]", "lie on a line"),
        ("targets = [[0, 0], [1, 0], [0, 1]]", "at least 4 points"),
        ("targets = [[0, 0], [1, 0], [0, 1], [1, 1]]\nnames = [\"a\"]", "4 different names"),
        ("targets = [[0, 0], [1, 0], [0, 1], [1, 1]]\ndiameter = 0", "above 0"),
        ("bars = 2", "unknown field"),
    ] {
        std::fs::write(bench.path("wrong.toml"), text).unwrap();
        let failed = bench.run(["calibrate", "left.honami", "--rig", "wrong.toml"]);
        assert!(failed.stderr.contains(why) && failed.stderr.contains("wrong.toml"), "{}", failed.stderr);
    }
}
