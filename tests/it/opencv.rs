//! OpenCV's trackers in the real program, where their library was built.

use honami_tests::{Bench, missing};

#[test]
fn opencvs_lk_does_in_the_program_what_klt_does() {
    let bench = Bench::new();
    let doctor = bench.json("doctor");
    let mut findings = doctor["findings"].as_array().unwrap().iter();
    if findings.any(|finding| finding["what"] == "OpenCV" && finding["there"] == false) {
        return missing("library of OpenCV's trackers beside the program (cargo xtask opencv)");
    }
    let made = bench.json("synth clip.y4m --size 320x180 --frames 20 --leaves 120 --seed 3");
    let truth = made["truth"].as_str().unwrap();
    let compare = bench.json(&format!("compare clip.y4m --with klt --with opencv-lk --truth {truth}"));
    let [klt, lk] = ["klt", "opencv-lk"].map(|name| {
        let rows = compare["trackers"].as_array().unwrap();
        let row = rows.iter().find(|row| row["tracker"] == name).unwrap_or_else(|| panic!("{compare:#}"));
        row["delta_avg"].as_f64().unwrap()
    });
    assert!((klt - lk).abs() < 0.02 && klt > 0.5, "klt {klt}, OpenCV's {lk}");
}
