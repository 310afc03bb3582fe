//! Overlay movies: the real program writes them, and what they show is what was measured.

use std::collections::BTreeMap;
use std::fs;

use honami_tests::{Bench, Row, rows, skipped};
use honami_workbench::media::{OpenOptions, open};
use honami_workbench::palette;
use serde_json::json;

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[test]
fn tracks_have_the_colours_of_their_groups() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 3");
    let movie = bench.json("export p.honami movie m.y4m --show tracks --scale 3 --frames 18..23");
    assert_eq!((&movie["shown"], &movie["frames"]), (&json!(["tracks"]), &json!(5)), "{movie}");
    assert_eq!((&movie["size"], &movie["clip_frames"]), (&json!([480, 360]), &json!([18, 23])), "{movie}");
    bench.json("export p.honami groups g.csv");
    let group_of: BTreeMap<String, u32> = rows(&bench.path("g.csv"))
        .iter()
        .map(|row| (row["track"].clone(), row["group"].parse().unwrap()))
        .collect();
    let samples = bench.samples("p.honami");
    let here: Vec<&Row> = samples.iter().filter(|row| row["frame"] == "20").collect();
    let is_alone = |row: &Row| {
        let away = |other: &Row| {
            (number(row, "x") - number(other, "x")).hypot(number(row, "y") - number(other, "y"))
        };
        here.iter().all(|other| other["track"] == row["track"] || away(other) > 5.0)
    };
    let media = open(&bench.path("m.y4m"), &OpenOptions::default()).unwrap();
    let picture = media.frame(2).unwrap();
    let mut n_seen = 0;
    for row in here.iter().filter(|row| row["status"] == "1" && is_alone(row)) {
        let [x, y] = ["x", "y"].map(|axis| (3.0 * (number(row, axis) + 0.5) - 0.5).round());
        if !(4.0..476.0).contains(&x) || !(4.0..356.0).contains(&y) {
            continue;
        }
        let got = picture.planes().rgb(x as u32, y as u32);
        let apart = |group: u32| -> i32 {
            let of = palette::group(Some(group - 1));
            (0..3).map(|c| (i32::from(got[c]) - i32::from(of[c])).pow(2)).sum()
        };
        let nearest = (1..=3).min_by_key(|group| apart(*group)).unwrap();
        assert_eq!(nearest, group_of[&row["track"]], "{row:?} is {got:?}");
        assert!(apart(nearest) < 60 * 60, "{row:?} is {got:?}");
        n_seen += 1;
    }
    assert!(n_seen > 10, "{n_seen}");
}

/// Each before anything is drawn, in one line.
#[test]
fn what_cannot_be_a_movie_is_said() {
    let bench = Bench::tracked();
    let cases = [
        ("m.gif", "movies are written as .mp4, .y4m or a folder of PNG images, not .gif: m.gif", 2),
        ("m.png", "m.png is one image: a movie is .mp4, .y4m or a folder of PNG images", 2),
        ("away/m.y4m", "away is no folder: make it first (mkdir -p), or choose another name: away/m.y4m", 1),
        (
            "p.honami/m",
            "p.honami is no folder: make it first (mkdir -p), or choose another name: p.honami/m",
            1,
        ),
        ("m.y4m --fps 0", "wanted 0.001 to 100000 frames per second, got 0", 2),
        ("m.y4m --fps 1e9", "wanted 0.001 to 100000 frames per second, got 1e9", 2),
        ("m.y4m --fps NaN", "wanted 0.001 to 100000 frames per second, got NaN", 2),
    ];
    for (line, said, code) in cases {
        let ran = bench.line(&format!("export p.honami movie {line}"));
        assert_eq!(ran.code, Some(code), "{line}: {ran:?}");
        assert!(ran.stderr.contains(said), "{line}: {}", ran.stderr);
        if code == 1 {
            assert_eq!(ran.stderr.trim_end(), format!("honami: {said}"), "{line}");
        }
    }
}

#[test]
fn movies_are_of_the_size_rate_and_kind_that_was_asked_for() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 3");
    let movie = bench.json("export p.honami movie m.y4m");
    assert_eq!(movie["shown"], json!(["trails", "skeleton", "tracks"]), "{movie}");
    assert!(movie["bones"].as_u64() > Some(2) && movie["groups"] == 3, "{movie}");
    assert_eq!(movie["bytes"], fs::metadata(bench.path("m.y4m")).unwrap().len());
    let slow = bench.json("export p.honami movie slow --show time,labels,groups,motion,arrows --frames 5..8 --fps 5 --size 320x180");
    assert_eq!((&slow["fps"], &slow["frames"], &slow["size"]), (&json!(5.0), &json!(3), &json!([320, 180])));
    assert!((slow["speed"].as_f64().unwrap() - 0.2).abs() < 1e-9, "{slow}");
    assert_eq!(fs::read_dir(bench.path("slow")).unwrap().count(), 3);
    let said = bench.line("export p.honami movie m.mp4 --frames 0..10");
    if said.code == Some(0) {
        bench.json("new q.honami m.mp4");
        let again = bench.json("export q.honami movie again.y4m --show time");
        assert_eq!((&again["frames"], &again["size"]), (&json!(10), &json!([160, 120])));
    } else {
        assert!(said.stderr.contains("unlike .y4m or a folder of images, needs ffmpeg"), "{said:?}");
        skipped("ffmpeg");
    }
}
