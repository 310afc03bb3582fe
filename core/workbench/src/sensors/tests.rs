//! A swaying plant, its markers by another clock and in other axes: found again, and what is wrong with tables.

use std::f64::consts::TAU;
use std::fs;

use super::*;

/// Where a part of a plant is: each has tones and directions of its own, and one that all have.
fn sway(part: usize, t: f64) -> Place {
    let k = part as f64;
    let push = (-0.15 * t).exp() * (TAU * (0.9 + 0.2 * k) * t).sin() + 0.3 * (TAU * 0.31 * t + k).sin();
    let rest = Place::new(0.8 * (2.1 * k).cos(), 0.8 * (2.1 * k).sin(), 1.5 + 0.9 * k);
    rest + 0.1 * push * Place::new((0.7 * k).cos(), (0.7 * k).sin(), 0.2)
        + 0.03 * (TAU * 0.6 * t).cos() * Place::new(-0.3, 0.8, 0.1)
}

/// Somewhere within ±1, by a number.
fn drawn(k: usize) -> f64 {
    ((k * 7919 + 13) as f64 * 0.618_033_988_749_895).fract() * 2.0 - 1.0
}

/// Four parts as cameras see them, 25 times a second with 1 mm of noise, and by sensors, 40 times, whose clock is ahead by
/// 0.4137 s and whose axes are turned a quarter and lie elsewhere.
fn seen() -> (Vec<Record>, Vec<Record>) {
    let record =
        |name: String, n: usize, fps: f64, place: &dyn Fn(usize, f64) -> Place, clock_s: f64| Record {
            name,
            times_s: (0..n).map(|k| k as f64 / fps + clock_s).collect(),
            places: (0..n).map(|k| place(k, k as f64 / fps)).collect(),
        };
    let tracked = |part: usize| {
        let noise =
            move |k: usize| Place::new(drawn(3 * k + part), drawn(3 * k + 1 + part), drawn(3 * k + 2 + part));
        record(format!("{}", part + 1), 500, 25.0, &|k, t| sway(part, t) + 0.001 * noise(k), 0.0)
    };
    let turned = |p: Place| Place::new(-p.y + 3.0, p.x - 1.0, p.z + 0.5);
    let sensed = |part: usize| record(format!("S{part}"), 800, 40.0, &|_, t| turned(sway(part, t)), 0.4137);
    ((0..4).map(tracked).collect(), [2, 0, 3, 1].map(sensed).to_vec())
}

fn wish() -> Wish {
    Wish { offset_s: None, most_s: 3.0, height_m: Some(5.0), pieces: Pieces::default() }
}

#[test]
fn another_clock_and_other_axes_are_found() {
    let (tracks, sensors) = seen();
    let found = compare(&tracks, &sensors, &wish()).unwrap();
    let offset = found.found.unwrap();
    assert!((offset.seconds - 0.4137).abs() < 0.002 && offset.error_s < 0.002, "{offset:?}");
    let partners: Vec<_> = found.markers.iter().map(|m| (m.name.as_str(), m.track.as_str())).collect();
    assert_eq!(partners, [("S2", "3"), ("S0", "1"), ("S3", "4"), ("S1", "2")]);
    assert!((found.scale - 1.0).abs() < 1e-3, "{}", found.scale);
    // A uniform millimetre to either side is 0.58 mm.
    for cell in found.all {
        assert!((0.0004..0.0008).contains(&cell.rms), "{cell:?}");
        assert!((cell.mean.hypot(cell.std) - cell.rms).abs() < 1e-12);
    }
    let axis = &found.markers[1].axes.as_ref().unwrap()[1];
    let strongest = axis.strongest.unwrap();
    assert!((strongest.hz - 0.9).abs() < 0.15 && strongest.coherence > 0.95, "{strongest:?}");
    assert!(strongest.phase_rad.abs() < 0.1, "{strongest:?}");
    assert!(found.alone.iter().all(Vec::is_empty), "{:?}", found.alone);
}

#[test]
fn names_and_a_given_offset_are_kept_to() {
    let (tracks, mut sensors) = seen();
    // Called as the tracks are, one of them as no track is.
    for (sensor, name) in sensors.iter_mut().zip(["marker 3", "Track 1", "4", "other"]) {
        sensor.name = name.to_owned();
    }
    let found = compare(&tracks, &sensors, &Wish { offset_s: Some(0.4137), ..wish() }).unwrap();
    assert!(found.found.is_none() && found.markers.len() == 3 && found.all[0].rms < 0.001, "{:?}", found.all);
    assert_eq!(found.alone, [vec!["2".to_owned()], vec!["other".to_owned()]]);
    // A wrong clock is told by its distances: 0.1 s of a swing of 0.1 m at 1 Hz.
    let off = compare(&tracks, &sensors, &Wish { offset_s: Some(0.5137), ..wish() }).unwrap();
    assert!(off.all[1].rms > 0.008, "{:?}", off.all);
}

#[test]
fn what_cannot_be_brought_together_is_named() {
    let (tracks, sensors) = seen();
    let said = |tracks: &[Record], sensors: &[Record], wish: Wish| {
        compare(tracks, sensors, &wish).unwrap_err().to_string()
    };
    let late = Wish { offset_s: Some(100.0), ..wish() };
    assert!(said(&tracks, &sensors, late).contains("never seen at the same time"));
    assert!(said(&tracks, &sensors, Wish { height_m: Some(0.0), ..wish() }).contains("above 0, not 0"));
    let still =
        |record: &Record| Record { places: vec![record.places[0]; record.places.len()], ..record.clone() };
    let still: Vec<_> = sensors.iter().map(still).collect();
    assert!(said(&tracks, &still, wish()).contains("--offset SECONDS gives it"));
    let line = |record: &Record| {
        let place = |t: &f64| Place::new(1.0, 2.0, 3.0) * t.sin();
        Record { places: record.times_s.iter().map(place).collect(), ..record.clone() }
    };
    let (a, b) = (line(&tracks[0]), line(&tracks[0]));
    let told = said(&[a], &[b], Wish { offset_s: Some(0.0), ..wish() });
    assert!(told.contains("axes of tracks and sensors") && told.contains("do not lie on a line"), "{told}");
}

#[test]
fn tables_are_read_in_both_forms_and_told_by_their_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.csv");
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        records(&path).map_err(|error| error.to_string())
    };
    let long =
        "marker,time_s,x,y,z\na,0,1,2,3\nb,0,4,5,6\na,1,1,2,3\nb,1,,,\na,2,1,2,4\nb,2,4,5,6\nb,3,4,5,7\n";
    let wide =
        "time_s;a_x;a_y;a_z;b_x;b_y;b_z\n0;1;2;3;4;5;6\n1;1;2;3;nan;5;6\n2;1;2;4;4;5;6\n3;;2;3;4;5;7\n";
    let [long, wide] = [long, wide].map(|text| read(text).unwrap());
    assert_eq!(long, wide);
    assert_eq!(
        (long[1].times_s.clone(), long[0].places[2]),
        (vec![0.0, 2.0, 3.0], Place::new(1.0, 2.0, 4.0))
    );
    for (text, wanted) in [
        ("track,frame,x_m,y_m,z_m\n1,0,1,1,1\n", "wanted a column time_s"),
        ("marker,time_s,x,y\na,0,1,1\n", "wanted columns x, y and z"),
        ("time_s,a_x,a_y\n0,1,1\n", "a_x has no a_y and a_z"),
        ("time_s,q\n0,1\n", "wanted marker,time_s,x,y,z"),
        ("marker,time_s,x,y,z\na,0,1,one,1\n", "line 2, column 4: wanted a number, came \"one\""),
        ("marker,time_s,x,y,z\na,0,1\n", "line 2: wanted 5 cells as in the head, came 3"),
        ("marker,time_s,x,y,z\na,0,1,1,1\na,0,1,1,1\na,1,1,1,1\n", "is not after the one before"),
        ("marker,time_s,x,y,z\na,0,1,1,1\n", "wanted 3 samples or more, came 1"),
    ] {
        let said = read(text).unwrap_err();
        assert!(said.contains(wanted), "{said}");
    }
}
