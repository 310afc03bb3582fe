//! Densities of records and of tracks through the real program: in their units, with their bands, as tables and as drawings.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

use honami_tests::{Bench, data, rows};

/// Two minutes of a sine of 3 units and 1.5 Hz at 20 a second, whose power is 4.5 units squared, on a slope.
fn sine() -> String {
    (0..2400).fold("time_s,tilt,still\n".to_owned(), |mut text, k| {
        let t = f64::from(k) / 20.0;
        writeln!(text, "{t:.3},{:.9},{:.3}", 3.0 * (TAU * 1.5 * t).sin() + 0.01 * t, 0.5).unwrap();
        text
    })
}

#[test]
fn a_record_has_its_power_in_its_density() {
    let bench = Bench::new();
    fs::write(bench.path("tilt.csv"), sine()).unwrap();
    for window in ["hann", "hamming", "blackman", "rect"] {
        let answer =
            bench.json(&format!("spectrum tilt.csv --piece 20 --window {window} --csv d.csv --svg d.svg"));
        let (welch, series) = (&answer["welch"], &answer["series"]);
        assert_eq!((&welch["pieces"], &welch["unit"]), (&11.into(), &"unit²/Hz".into()), "{welch}");
        let half = &series[0]["half_power"];
        assert!((half["hz"].as_f64().unwrap() - 1.5).abs() < 1e-3, "{half}");
        // A steady sine is as broad as the window has it.
        let ratio = half["width_hz"].as_f64().unwrap() / half["window_hz"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 0.04, "{window}: {half}");
        let found = rows(&bench.path("d.csv"));
        let sum: f64 = found
            .iter()
            .filter(|row| row["series"] == "tilt")
            .map(|row| row["density"].parse::<f64>().unwrap())
            .sum();
        let power = sum * welch["step_hz"].as_f64().unwrap();
        assert!((power / 4.5 - 1.0).abs() < 0.01, "{window}: {power}");
        for row in &found {
            let [low, density, high] =
                ["low", "density", "high"].map(|name| row[name].parse::<f64>().unwrap());
            assert!(low <= density && density <= high && row["unit"] == "unit²/Hz", "{row:?}");
        }
    }
    let drawing = fs::read_to_string(bench.path("d.svg")).unwrap();
    assert!(drawing.contains("<polygon") && drawing.contains("nothing moves"), "{}", &drawing[..400]);
    let text = bench.text("spectrum tilt.csv --piece 20");
    assert!(text.contains("pieces of 20.00 s (hann)"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn tracks_have_their_densities_in_pixels() {
    let bench = Bench::new();
    // Two tracks at 25 frames a second, 3 px across and 4 px down; one is away for ten frames.
    let table = (0..300).fold("track,frame,time_s,x,y,status\n".to_owned(), |mut text, k| {
        let swing = (TAU * 2.0 * f64::from(k) / 25.0).sin();
        for track in 1..=2 {
            let status = if track == 2 && (100..110).contains(&k) { 0 } else { 1 };
            let (x, y) = (50.0 + 3.0 * swing, 40.0 + 4.0 * swing);
            writeln!(text, "{track},{k},{:.4},{x:.5},{y:.5},{status}", f64::from(k) / 25.0).unwrap();
        }
        text
    });
    fs::write(bench.path("t.csv"), table).unwrap();
    let answer = bench.json("spectrum t.csv --piece 2 --csv d.csv");
    assert_eq!(answer["welch"]["unit"], "px²/Hz");
    assert!((answer["lines"][0]["half_power"]["hz"].as_f64().unwrap() - 2.0).abs() < 0.01, "{answer}");
    let found = rows(&bench.path("d.csv"));
    for series in ["all", "track 1", "track 2"] {
        let of = found.iter().filter(|row| row["series"] == series);
        let sum: f64 = of.map(|row| row["density"].parse::<f64>().unwrap()).sum();
        let power = sum * answer["welch"]["step_hz"].as_f64().unwrap();
        assert!((power / 12.5 - 1.0).abs() < 0.02, "{series}: {power}");
    }
}

#[test]
fn what_swings_too_fast_to_be_seen_is_named_of_records_too() {
    let bench = Bench::new();
    // 2.8 Hz, sampled 3 times a second, are seen as 0.2 Hz; 1.4 Hz may be 1.6 Hz.
    let table = (0..400).fold("time_s,x\n".to_owned(), |mut text, k| {
        let t = f64::from(k) / 3.0;
        writeln!(text, "{t:.9},{:.6}", (TAU * 1.4 * t).sin() * (-0.01 * t).exp()).unwrap();
        text
    });
    fs::write(bench.path("x.csv"), table).unwrap();
    let text = bench.text("spectrum x.csv");
    assert!(
        text.contains("1.40 Hz? may be an alias: at this rate 1.60, 4.40, 4.60 Hz look the same"),
        "{text}"
    );
    assert_eq!(bench.json("spectrum x.csv")["may_be_alias"], true);
}

/// Gusts of a real wind: no swing, most power below 0.1 Hz, and all of it that the record has.
#[test]
fn a_real_wind_has_its_variance_in_its_density() {
    let Some(wind) = data("sway/sonic_10hz_uv_cols10_11.csv") else { return };
    let bench = Bench::new();
    let answer =
        bench.run(["spectrum", wind.to_str().unwrap(), "--piece", "100", "--csv", "d.csv", "--json"]).json();
    let step_hz = answer["welch"]["step_hz"].as_f64().unwrap();
    let found = rows(&bench.path("d.csv"));
    for (name, deviation) in [("x_component_mps", 1.30), ("y_component_mps", 1.57)] {
        let of = found.iter().filter(|row| row["series"] == name);
        let (mut slow, mut all) = (0.0, 0.0);
        for row in of {
            let power = row["density"].parse::<f64>().unwrap() * step_hz;
            all += power;
            slow += if row["hz"].parse::<f64>().unwrap() < 0.1 { power } else { 0.0 };
        }
        // What is slower than the pieces is left out with their straight lines, and their windows favour some of it.
        assert!((0.8..1.15).contains(&(all / (deviation * deviation))), "{name}: {all}");
        assert!(slow / all > 0.4, "{name}: {slow} of {all}");
    }
}
