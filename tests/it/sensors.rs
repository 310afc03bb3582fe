//! Table 2.1 and figure 2.11 of the thesis through the real program: a tree that sways, seen by two cameras, beside its own nodes
//! as sensors with another clock and in other axes.

use std::fmt::Write as _;
use std::fs;

use honami_cameras::{Camera, Pixel, Place, Pose, triangulate};
use honami_tests::{Bench, rows};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

/// How far the sensors' clock is ahead, seconds.
const AHEAD_S: f64 = 0.3712;
/// Error of what a tracker finds, pixels, to either side.
const ERROR_PX: f64 = 0.5;
/// Nodes that are followed.
const N: usize = 4;

/// Where the nodes are, a hundred times a second.
fn swayed(bench: &Bench) -> Vec<Vec<Place>> {
    bench.json("simulate synth::tree:80,1 --modes 8 --wind wind:seed=1 --seconds 30 --fps 100 --sensors 4 --out sway.csv");
    let mut places = vec![Vec::new(); N];
    for row in rows(&bench.path("sway.csv")) {
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        places[number("sensor") as usize].push(Place::new(number("x"), number("y"), number("z")));
    }
    places
}

/// What two cameras 4 m apart and 12 m away make of them, 25 times a second, in the axes of the left one.
fn tracked(places: &[Vec<Place>]) -> String {
    let camera = Camera::pinhole(1600.0, Pixel::new(960.0, 540.0));
    let poses = [Pose::identity(), Pose::new(Place::zeros(), Place::new(-4.0, 0.0, 0.0))];
    let mut random = Pcg64Mcg::seed_from_u64(9);
    let mut table = "track,frame,time_s,x_m,y_m,z_m\n".to_owned();
    for (track, places) in places.iter().enumerate() {
        for (frame, place) in places.iter().step_by(4).enumerate() {
            let before = Place::new(place.x + 2.0, 4.0 - place.z, place.y + 12.0);
            let sights = poses.map(|pose| {
                let mut off = || random.random_range(-ERROR_PX..ERROR_PX);
                let at = camera.project(&pose.of(&before)).unwrap() + Pixel::new(off(), off());
                (camera, pose, at)
            });
            let fix = triangulate(&sights, 0.3).unwrap().place;
            let t = frame as f64 / 25.0;
            writeln!(table, "{},{frame},{t:.4},{:.6},{:.6},{:.6}", track + 1, fix.x, fix.y, fix.z).unwrap();
        }
    }
    table
}

/// What sensors make of them, 33.3 times a second by their own clock, in axes that are turned and lie elsewhere.
fn sensed(places: &[Vec<Place>]) -> String {
    let names = ["stem", "left", "right", "low"];
    let heads = names.map(|name| format!("{name}_x,{name}_y,{name}_z")).join(",");
    let mut table = format!("time_s,{heads}\n");
    for k in (1..places[0].len()).step_by(3) {
        write!(table, "{:.5}", k as f64 / 100.0 + AHEAD_S).unwrap();
        // Not in the order of the tracks.
        for sensor in [2, 0, 3, 1] {
            let at = places[sensor][k];
            write!(table, ",{:.6},{:.6},{:.6}", 5.0 - at.y, at.x + 1.0, at.z - 2.0).unwrap();
        }
        table.push('\n');
    }
    table
}

#[test]
fn a_tree_by_two_cameras_is_where_its_sensors_are() {
    let bench = Bench::new();
    let places = swayed(&bench);
    fs::write(bench.path("space.csv"), tracked(&places)).unwrap();
    fs::write(bench.path("markers.csv"), sensed(&places)).unwrap();
    let wind = (0..400).fold("time_s,speed\n".to_owned(), |mut text, k| {
        writeln!(text, "{:.2},{:.3}", f64::from(k) / 10.0, f64::from(k % 37)).unwrap();
        text
    });
    fs::write(bench.path("wind.csv"), wind).unwrap();
    let line =
        "compare space.csv --sensors markers.csv --wind wind.csv --height 8 --svg fig.svg --csv both.csv";
    let found = bench.json(line);
    let offset = found["offset_s"].as_f64().unwrap();
    let error = found["offset_error_s"].as_f64().unwrap();
    assert!((offset - AHEAD_S).abs() < (4.0 * error).min(0.02), "{offset} ± {error}");
    assert!((found["scale"].as_f64().unwrap() - 1.0).abs() < 0.003, "{}", found["scale"]);
    let partners = [("stem", "3"), ("left", "1"), ("right", "4"), ("low", "2")];
    for (marker, (name, track)) in found["markers"].as_array().unwrap().iter().zip(partners) {
        assert_eq!((&marker["marker"], &marker["track"]), (&name.into(), &track.into()));
        // Far below 1 % of 8 m: 12²/(1600·4) m a pixel along the view, 12/1600 m across it, by uniform errors.
        for (axis, most) in [(0, 0.016), (1, 0.004), (2, 0.004)] {
            let rms = marker["axes"][axis]["rms_m"].as_f64().unwrap();
            assert!(rms < most, "{name} {axis}: {rms}");
        }
        // The stem sways as one: along the axis in which it moves, cameras and sensors say the same.
        let coherence = (0..3).filter_map(|axis| marker["strongest"][axis]["coherence"].as_f64());
        assert!(coherence.fold(0.0, f64::max) > 0.9, "{marker}");
    }
    let both = rows(&bench.path("both.csv"));
    assert!(both.len() > 4 * 700 && both[0]["marker"] == "stem", "{}", both.len());
    let figure = fs::read_to_string(bench.path("fig.svg")).unwrap();
    assert!(
        ["stem x, m: RMS", "low z, m: RMS", "speed", "coherence"].iter().all(|word| figure.contains(word))
    );
    let text = bench.text("compare space.csv --sensors markers.csv --height 8");
    assert!(text.contains("of the height") && text.contains("phase: how far"), "{text}");
    // The wrong clock, given, is kept to and told by its distances.
    let off = bench.json("compare space.csv --sensors markers.csv --offset 1.5");
    assert_eq!((&off["offset_s"], &off["offset_error_s"]), (&1.5.into(), &serde_json::Value::Null));
}
