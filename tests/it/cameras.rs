//! `calibrate`: cameras from pictures, by the program.

use honami_tests::{Bench, data};
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
    let kept: Value =
        serde_json::from_str(&std::fs::read_to_string(bench.path("cameras.json")).unwrap()).unwrap();
    assert_eq!(kept["honami"], "cameras");
    assert_eq!(kept["stereo"], found["stereo"]);
    let found = bench.run(args(&["--window", "squares"])).json();
    is_near(&found, "fx", 533.0, 1.0);
    is_near(&found, "rms", 0.178, 0.01);
    is_near(&found["stereo"], "rms", 0.194, 0.01);
    assert_eq!(found["by_squares"], Value::Null);
}
