//! Two cameras before one plant: `honami sync`.

use std::fmt::Write as _;
use std::fs;

use honami_tests::Bench;

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
    let push = |since: f64, hz: f64| match since {
        _ if since < 0.0 => 0.0,
        _ => (-0.5 * since).exp() * (std::f64::consts::TAU * hz * since).sin(),
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
