//! Two cameras before one plant: `honami sync`, `honami triangulate` and what is exported of it.

use std::fmt::Write as _;
use std::fs;

use honami_tests::{Bench, python_with, root, rows};
use serde_json::json;

const SIZE: [u32; 2] = [160, 120];
const FOCAL_PX: f64 = 180.0;
const FPS: [f64; 2] = [25.0, 30.0];
/// What happens at t by the left clock happens so much later by the right one.
const OFFSET_S: f64 = 0.3137;
/// When the lamp is lit, by the left clock.
const LIT_S: f64 = 1.3519;
const N_FRAMES: [usize; 2] = [110, 130];
const N_LEAVES: usize = 8;

/// Where a leaf is, metres: they sway together, each a little otherwise.
fn leaf(k: usize, t: f64) -> [f64; 3] {
    // Gusts: what sways begins and ends softly.
    let push = |since: f64, hz: f64| {
        (-4.0 * (since - 0.6).powi(2)).exp() * (std::f64::consts::TAU * hz * since).sin()
    };
    let own = 0.1 * k as f64;
    let x = push(t - 0.4 + 0.02 * own, 1.3) + 0.7 * push(t - 2.2, 1.3 + 0.1 * own);
    let z = push(t - 0.7, 1.1) - 0.8 * push(t - 1.6 - 0.02 * own, 1.1);
    let rest = [(own * 24.0).sin() * 0.5, (own * 17.0).cos() * 0.4, 2.0 + 0.3 * (own * 9.0).sin()];
    [rest[0] + 0.1 * x, rest[1] + 0.02 * x + 0.03 * z, rest[2] + 0.08 * z]
}

/// The right camera stands 0.5 m to the right and looks 0.2 rad to the left.
const BASELINE_M: f64 = 0.5;
const TURN_RAD: f64 = 0.2;

/// A place in the right camera's axes.
fn in_right([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = TURN_RAD.sin_cos();
    let x = x - BASELINE_M;
    [cos * x + sin * z, y, cos * z - sin * x]
}

fn pixel(side: usize, place: [f64; 3]) -> [f64; 2] {
    let [x, y, z] = if side == 0 { place } else { in_right(place) };
    [f64::from(SIZE[0]) / 2.0 + FOCAL_PX * x / z, f64::from(SIZE[1]) / 2.0 + FOCAL_PX * y / z]
}

/// The time of a frame by the left clock.
fn time_s(side: usize, frame: usize) -> f64 {
    frame as f64 / FPS[side] - if side == 0 { 0.0 } else { OFFSET_S }
}

/// A clip whose lamp, in the corner of 8 by 8 pixels at the top left, is lit at its time.
fn film(bench: &Bench, side: usize) {
    let [width, height] = SIZE;
    let mut clip = format!("YUV4MPEG2 W{width} H{height} F{}:1 Cmono\n", FPS[side]).into_bytes();
    for frame in 0..N_FRAMES[side] {
        let lit = ((time_s(side, frame) - LIT_S) * FPS[side] + 1.0).clamp(0.0, 1.0);
        // Video: limited range, and a curve.
        let lamp = 16.0 + 219.0 * (0.1 + 0.8 * lit).powf(1.0 / 2.2);
        clip.extend_from_slice(b"FRAME\n");
        let value = |k: u32| if k % width < 8 && k / width < 8 { lamp.round() as u8 } else { 90 };
        clip.extend((0..width * height).map(value));
    }
    fs::write(bench.path(["left.y4m", "right.y4m"][side]), clip).unwrap();
}

/// Two projects, left.honami and right.honami, with the same leaves; the right one numbers them the other way round.
fn filmed() -> Bench {
    let bench = Bench::new();
    for (side, name) in ["left", "right"].into_iter().enumerate() {
        film(&bench, side);
        let mut table = "track,frame,x,y\n".to_owned();
        for k in 0..N_LEAVES {
            let track = if side == 0 { k } else { N_LEAVES - 1 - k };
            for frame in 0..N_FRAMES[side] {
                let [x, y] = pixel(side, leaf(k, time_s(side, frame)));
                writeln!(table, "{track},{frame},{x},{y}").unwrap();
            }
        }
        fs::write(bench.path("tracks.csv"), table).unwrap();
        bench.json(&format!("new {name}.honami {name}.y4m"));
        bench.json(&format!("import {name}.honami tracks.csv"));
    }
    bench
}

#[test]
fn clocks_are_compared_by_a_lamp_and_by_movement() {
    let bench = filmed();
    let off = |line: &str| {
        let said = bench.json(line);
        let [offset, error] = ["offset_s", "error_s"].map(|key| said[key].as_f64().unwrap());
        assert!((offset - OFFSET_S).abs() < 4.0 * error, "{line}: {said}");
        (offset - OFFSET_S).abs()
    };
    // A lamp: of clips and of projects, to a fiftieth of a frame.
    assert!(off("sync left.y4m right.y4m --flash 0,0,8,8") < 8e-4);
    assert!(off("sync left.honami right.y4m --flash all --flash-right 1,1,6,6") < 8e-4);
    // As if pixels counted light, a frame that is lit for half of its time says something else.
    let raw = bench.json("sync left.y4m right.y4m --flash 0,0,8,8 --gamma 1");
    assert!((raw["offset_s"].as_f64().unwrap() - OFFSET_S).abs() > 2e-3, "{raw}");
    // Movement: of all leaves, and of those that have names in both.
    assert!(off("sync left.honami right.honami") < 2e-3);
    for (project, track) in [("left", 2), ("right", N_LEAVES - 3)] {
        assert_eq!(bench.edit(&format!("{project}.honami"), &format!("name {track} tip\n")).code, Some(0));
    }
    assert!(off("sync left.honami right.honami --most 1") < 2e-3);
    let said = bench.json("sync left.honami right.honami");
    assert_eq!((&said["named"], &said["tracks"]), (&true.into(), &serde_json::json!([1, 1])));
    let text = bench.text("sync left.honami right.honami");
    assert!(text.contains("+ 0.31") && text.contains("1 track of the same names"), "{text}");
    // The other way round the sign turns.
    let back = bench.json("sync right.y4m left.y4m --flash all");
    assert!((back["offset_s"].as_f64().unwrap() + OFFSET_S).abs() < 8e-4, "{back}");
}

/// The file of both cameras, in metres; `unit` is what it says of that.
fn cameras(bench: &Bench, unit: Option<&str>) {
    let camera =
        json!({ "fx": FOCAL_PX, "fy": FOCAL_PX, "cx": SIZE[0] / 2, "cy": SIZE[1] / 2, "size": SIZE });
    // What is in the right camera's axes is turned, then shifted: where the left camera stands.
    let shift = in_right([0.0; 3]);
    let mut file = camera.clone();
    file["right"] = camera;
    file["stereo"] = json!({ "turn_rad": [0.0, TURN_RAD, 0.0], "shift": shift });
    if let Some(unit) = unit {
        file["unit"] = json!(unit);
    }
    fs::write(bench.path("cameras.json"), file.to_string()).unwrap();
}

/// How far exported places are from the truth at most, metres, and how many there are.
fn off(bench: &Bench, leaf_of: impl Fn(usize) -> usize) -> (f64, usize) {
    bench.json("export left.honami space t.csv");
    let rows = rows(&bench.path("t.csv"));
    let far = |row: &honami_tests::Row| {
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let truth = leaf(leaf_of(number("track") as usize), number("time_s"));
        let place = ["x_m", "y_m", "z_m"].map(number);
        truth.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    (rows.iter().map(far).fold(0.0, f64::max), rows.len())
}

#[test]
fn tracks_of_two_views_become_tracks_in_space() {
    let bench = filmed();
    cameras(&bench, Some("m"));
    let line = format!("triangulate left.honami right.honami --cameras cameras.json --offset {OFFSET_S}");
    // By motion alone: all leaves find themselves, though the other project counts them backwards.
    let said = bench.json(&line);
    let pairs = said["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), N_LEAVES, "{said}");
    for pair in pairs {
        let [left, right] = ["left", "right"].map(|side| pair[side].as_u64().unwrap() as usize);
        assert_eq!(left + right, N_LEAVES - 1, "{pair}");
        assert_eq!(pair["by"], "motion");
    }
    let (worst, n) = off(&bench, |track| track);
    assert!(worst < 1e-3 && n == said["fixes"].as_u64().unwrap() as usize, "{worst}, {n}");
    assert!(n > N_LEAVES * 90, "{n}");
    // Without the offset leaves are elsewhere, and it is said.
    let said =
        bench.text("triangulate left.honami right.honami --cameras cameras.json --farthest 9 --match motion");
    assert!(said.contains("begin at the same moment") && said.contains("--offset"), "{said}");
    assert!(off(&bench, |track| track).0 > 0.02);
    // By the lamp, in millimetres that are said to be so: all is a thousandth.
    bench.json(&format!("{} --flash all --unit mm", line.split(" --offset").next().unwrap()));
    bench.json("export left.honami space t.csv");
    let z: f64 = rows(&bench.path("t.csv"))[0]["z_m"].parse().unwrap();
    assert!((0.001..0.003).contains(&z), "{z}");

    // A clock that is not known well makes places less certain, most of those that move fast.
    let sharp = bench.json(&line);
    let vague = bench.json(&format!("{line} --offset-error 0.01"));
    let across = |said: &serde_json::Value| said["error_across_m"].as_f64().unwrap();
    assert!(across(&vague) > 5.0 * across(&sharp), "{vague}, {sharp}");

    // Names count for more than motion; two that are named by mistake are doubtful.
    for (project, track) in [("left", 0), ("right", 0)] {
        assert_eq!(bench.edit(&format!("{project}.honami"), &format!("name {track} tip\n")).code, Some(0));
    }
    let said = bench.json(&format!("{line} --match names"));
    assert_eq!((&said["pairs"][0]["by"], &said["unmatched"]["left"]), (&json!("name"), &json!(N_LEAVES - 1)));
    assert!(bench.text(&format!("{line} --match names")).contains("doubtful: 0 and 0 have one name"));
}

#[test]
fn tracks_in_space_are_kept_and_undone_and_go_stale() {
    let bench = filmed();
    cameras(&bench, None);
    let line = format!("triangulate left.honami right.honami --cameras cameras.json --offset {OFFSET_S}");
    let ran = bench.line(&line);
    assert_eq!(ran.code, Some(2), "{ran:?}");
    assert!(ran.stderr.contains("--unit mm"), "{}", ran.stderr);
    bench.json(&format!("{line} --unit m"));
    let log = bench.log("left.honami", "space");
    let [made] = &log[..] else { panic!("{log:?}") };
    assert_eq!((&made["tracks"], &made["provenance"]["what"]), (&json!(N_LEAVES), &json!("triangulate")));
    assert_eq!(made["provenance"]["params"]["offset_s"], json!(OFFSET_S));
    assert!(bench.text("log left.honami").contains("8 tracks in space shown"));

    // Sensors that are where the tracks are: what is left is the rounding of the table.
    bench.json("export left.honami space sensors.csv");
    let beside = bench.json("compare left.honami --sensors sensors.csv --offset 0");
    assert_eq!(beside["markers"].as_array().unwrap().len(), N_LEAVES);
    let rms = beside["all"].as_array().unwrap().iter().map(|cell| cell["rms_m"].as_f64().unwrap());
    assert!(rms.fold(0.0, f64::max) < 1e-5, "{}", beside["all"]);

    let stale = || bench.json("export left.honami space t.csv")["stale"].as_array().unwrap().len();
    assert_eq!(stale(), 0);
    assert_eq!(bench.edit("left.honami", "key 3 5 10 10\n").code, Some(0));
    assert_eq!(stale(), 1);
    assert_eq!(bench.edit("right.honami", "key 3 5 10 10\n").code, Some(0));
    assert_eq!(stale(), 2);
    let said = bench.text("export left.honami space t.csv");
    assert!(said.contains("stale: 1 of its 8 tracks changed") && said.contains("right.honami"), "{said}");
    for _ in 0..2 {
        assert_eq!(bench.edit("left.honami", "undo\n").code, Some(0));
    }
    let ran = bench.line("export left.honami space t.csv");
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stderr.contains("no tracks in space") && ran.stderr.contains("honami triangulate"),
        "{}",
        ran.stderr
    );

    // Pictures that the cameras did not take, one camera alone, and tracks that are far from any line.
    let text = fs::read_to_string(bench.path("cameras.json")).unwrap();
    fs::write(bench.path("other.json"), text.replace("[160,120]", "[320,240]")).unwrap();
    fs::write(bench.path("one.json"), r#"{"fx": 9, "fy": 9, "cx": 1, "cy": 1, "size": [160, 120]}"#).unwrap();
    for (more, words) in [
        ("--cameras other.json --unit m", ["of 160x120 pixels", "took pictures of 320x240"]),
        ("--cameras one.json --unit m", ["one camera alone", "one.json"]),
        ("--cameras missing.json --unit m", ["missing.json", "No such file"]),
        (
            "--cameras cameras.json --unit m --offset 0.9 --farthest 0.01",
            ["none of 8 left tracks is", "--farthest"],
        ),
        (
            "--cameras cameras.json --unit m --match names",
            ["none of 8 left tracks", "names that are the same"],
        ),
    ] {
        let ran = bench.line(&format!("triangulate left.honami right.honami {more}"));
        assert_eq!(ran.code, Some(1), "{more}: {ran:?}");
        assert!(words.iter().all(|word| ran.stderr.contains(word)), "{more}: {}", ran.stderr);
    }
}

/// Two other programs read the same places from a C3D file, where they are installed, with frames in which a leaf is not seen.
#[test]
fn other_programs_read_the_same_places() {
    let bench = filmed();
    cameras(&bench, Some("m"));
    assert_eq!(bench.edit("left.honami", "mark lost 2 20 29\nname 4 tip of it\n").code, Some(0));
    bench.json(&format!("triangulate left.honami right.honami --cameras cameras.json --offset {OFFSET_S}"));
    let said = bench.json("export left.honami space t.c3d");
    assert_eq!((&said["tracks"], &said["not_kept"]), (&json!(N_LEAVES), &json!([])));
    let table = bench.json("export left.honami space t.csv");
    assert_eq!(said["fixes"], table["fixes"]);
    let bytes = fs::read(bench.path("t.c3d")).unwrap();
    assert_eq!(bytes[..2], [2, 0x50]);
    // Written over itself, and over nothing else.
    bench.json("export left.honami space t.c3d");
    let ran = bench.line("export left.honami space t.csv.c3d");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    fs::write(bench.path("dear.c3d"), "dear diary").unwrap();
    assert_eq!(bench.line("export left.honami space dear.c3d").code, Some(1));
    let Some(python) = python_with("ezc3d, c3d") else { return };
    let script = root().join("tests/peers/c3d_readers.py");
    let files = ["t.c3d", "t.csv"].map(|name| bench.path(name));
    let output = std::process::Command::new(python).arg(script).args(files).output().unwrap();
    assert!(output.status.success(), "{output:?}");
}
