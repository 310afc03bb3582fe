//! `honami components`: swings that are known, as a table, as numbers and drawn.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

use honami_tests::{Bench, rows};
use serde_json::Value;

const FRAMES: u32 = 200;

/// Writes a table of tracks, 25 frames a second, that begins with this frame at 0 s.
fn table_from(
    first: u32,
    bench: &Bench,
    name: &str,
    tracks: u32,
    frames: u32,
    at: impl Fn(u32, f64) -> [f64; 2],
) {
    let mut text = "track,frame,time_s,x,y\n".to_owned();
    for (track, frame) in (0..tracks).flat_map(|track| (0..frames).map(move |frame| (track, frame))) {
        let time_s = f64::from(frame) / 25.0;
        let [x, y] = at(track, time_s);
        writeln!(text, "{track},{},{time_s},{x},{y}", first + frame).unwrap();
    }
    fs::write(bench.path(name), text).unwrap();
}

fn table(bench: &Bench, name: &str, tracks: u32, frames: u32, at: impl Fn(u32, f64) -> [f64; 2]) {
    table_from(0, bench, name, tracks, frames, at);
}

/// Twelve tracks swing up and down by 4 px at 1.5 Hz, twelve across by 2 px at 4 Hz.
fn two_swings(track: u32, time_s: f64) -> [f64; 2] {
    let (x, y) = (30.0 * f64::from(track % 12), 50.0 + 100.0 * f64::from(track / 12));
    // Noise, small: between -0.05 and 0.05 px.
    let noise = |axis: f64| {
        0.1 * ((997.0 * f64::from(track) + 31.7 * time_s + axis).sin() * 43_758.5).rem_euclid(1.0) - 0.05
    };
    let (x, y) = (x + noise(0.0), y + noise(0.4));
    match track {
        0..12 => [x, y + 4.0 * (TAU * 1.5 * time_s).sin()],
        _ => [x + 2.0 * (TAU * 4.0 * time_s).sin(), y],
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn two_swings_are_told_written_and_drawn() {
    let bench = Bench::new();
    table(&bench, "two.csv", 24, FRAMES, two_swings);
    let said = bench.json("components two.csv maps.svg maps.csv");
    assert_eq!((&said["above"], &said["below"]), (&2.into(), &46.into()));
    let components = said["components"].as_array().unwrap();
    assert_eq!(components.len(), 2);
    for (component, [hz, degrees, share]) in components.iter().zip([[1.5, 90.0, 0.8], [4.0, 0.0, 0.2]]) {
        assert!((number(&component["hz"]) - hz).abs() < 0.01, "{}", component["hz"]);
        let off = number(&component["direction_deg"]) - degrees;
        assert!(((off + 90.0).rem_euclid(180.0) - 90.0).abs() < 1.0, "{off}");
        assert!((number(&component["share"]) - share).abs() < 0.01, "{}", component["share"]);
        assert_eq!(component["half_in_tracks"], 6);
    }
    // Topos times chronos, summed, is the motion.
    let (topos, chronos) = (rows(&bench.path("maps.csv")), rows(&bench.path("maps.chronos.csv")));
    assert_eq!((topos.len(), chronos.len()), (2 * 24, 2 * FRAMES as usize));
    let value = |row: &honami_tests::Row, column: &str| row[column].parse::<f64>().unwrap();
    for (track, frame) in [(0, 7), (5, 100), (14, 33), (23, 199)] {
        let wanted = two_swings(track, f64::from(frame) / 25.0);
        for (axis, [place, way]) in [["x_px", "dx_px"], ["y_px", "dy_px"]].into_iter().enumerate() {
            let component = |k: usize| {
                let (topos, chronos) =
                    (&topos[24 * k + track as usize], &chronos[(FRAMES * k as u32 + frame) as usize]);
                assert_eq!((&topos["track"], &chronos["frame"]), (&track.to_string(), &frame.to_string()));
                value(topos, way) * value(chronos, "chronos")
            };
            let got = value(&topos[track as usize], place) + component(0) + component(1);
            assert!((got - wanted[axis]).abs() < 0.12, "track {track}: {got}, wanted {}", wanted[axis]);
        }
    }
    let svg = fs::read_to_string(bench.path("maps.svg")).unwrap();
    assert!(
        svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("two.csv: 24 tracks"),
        "{svg}"
    );
    assert!(svg.matches("<line").count() > 2 * 24 && !svg.contains("NaN"), "{svg}");
    let text = bench.text("components two.csv");
    assert!(text.contains("1.500") && text.contains("4.000") && text.contains('█'), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

/// A table of tracks that were followed from frame 100 on: its frames keep their numbers.
#[test]
fn frames_are_numbered_as_in_the_table() {
    let bench = Bench::new();
    table_from(100, &bench, "late.csv", 24, FRAMES, two_swings);
    let said = bench.json("components late.csv maps.csv");
    assert_eq!(said["first_frame"], 100);
    let chronos = rows(&bench.path("maps.chronos.csv"));
    let frames: Vec<u32> = chronos.iter().map(|row| row["frame"].parse().unwrap()).collect();
    assert_eq!(frames, (100..100 + FRAMES).chain(100..100 + FRAMES).collect::<Vec<_>>());
    table(&bench, "first.csv", 24, FRAMES, two_swings);
    assert_eq!(bench.json("components first.csv")["first_frame"], 0);
}

#[test]
fn a_tracked_clip_has_components_and_what_has_none_says_why() {
    let bench = Bench::tracked();
    let said = bench.json("components p.honami");
    assert!(number(&said["above"]) > 0.0, "{}", said["above"]);
    let still = |track: u32, _: f64| [f64::from(track), 5.0];
    for (name, tracks, frames, why) in [
        ("one.csv", 1, 50, "at least 4 tracks in 8 frames"),
        ("two.csv", 2, 50, "came 2 tracks in 50 frames"),
        ("brief.csv", 9, 2, "came 9 tracks in 2 frames"),
        ("still.csv", 9, 50, "nothing moves"),
    ] {
        table(&bench, name, tracks, frames, still);
        let ran = bench.line(&format!("components {name} out.svg"));
        assert!(ran.code == Some(1) && ran.stderr.contains(why), "{name}: {}", ran.stderr);
        assert!(!bench.path("out.svg").exists());
    }
}
