//! Bad input and plants that hardly are any, for every method: a named error, or a skeleton with nothing in it that is no
//! number, on bones of constant length.

use honami_model::clip::FrameTimes;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::track::TrackId;

use super::*;
use crate::follow::Path;
use crate::tree::tree;

/// Grows by every method, in the picture and in depth.
fn grown(paths: &[Path], k: u32, n_frames: u32) -> Vec<(String, Result<Grown, StructureError>)> {
    let n = paths.len() as u32;
    let merge = |row: u32| Merge {
        a: if row == 0 { 0 } else { n + row - 1 },
        b: row + 1,
        height: f64::from(row) + 1.0,
        size: row + 2,
    };
    let merges = (0..n.saturating_sub(1)).map(merge).collect();
    let is_seen: Vec<bool> = paths.iter().map(Path::is_seen).collect();
    let groups = Dendrogram::new(n, merges).map(|dendrogram| tree(&dendrogram, k, &is_seen)).unwrap();
    let times = FrameTimes::constant(n_frames, 25.0).unwrap();
    let mut found = Vec::new();
    for is_flat in [true, false] {
        let settings = diener::Settings { root: None, is_flat };
        found.push((format!("diener {is_flat}"), diener::grow(paths, &groups, &times, settings)));
        let settings = zeng::Settings { is_flat, ..zeng::Settings::default() };
        found.push((format!("zeng {is_flat}"), zeng::grow(paths, &groups, &times, &settings)));
    }
    found
}

fn paths(n: u32, n_frames: u32, at: impl Fn(u32, u32) -> Option<[f64; 2]>) -> Vec<Path> {
    let path = |k: u32| Path { track: TrackId(k), at: (0..n_frames).map(|t| at(k, t)).collect() };
    (0..n).map(path).collect()
}

/// In every frame every bone is as long as it is said to be.
fn assert_rigid(skeleton: &Skeleton, what: &str) {
    for t in 0..skeleton.times().len() {
        let at = skeleton.places(skeleton.directions(t));
        for (row, joint) in skeleton.joints().iter().enumerate().skip(1) {
            let far = bones::distance(at[row], at[joint.parent.unwrap() as usize]);
            assert!((far - joint.length).abs() < 1e-6, "{what}, frame {t}, joint {row}: {far}");
        }
    }
}

#[test]
fn what_can_grow_has_bones_of_constant_length_and_no_nan() {
    let sway = |k: u32, t: u32| 4.0 * (f64::from(t) * 0.5 + f64::from(k)).sin();
    let spread =
        |k: u32, t: u32| Some([100.0 + 37.0 * f64::from(k % 5) + sway(k, t), 80.0 + 31.0 * f64::from(k % 7)]);
    let cases: [(&str, Vec<Path>, u32, u32); 10] = [
        ("two tracks", paths(2, 20, spread), 2, 20),
        ("all static", paths(12, 20, |k, _| spread(k, 0)), 4, 20),
        ("one point a group", paths(12, 20, spread), 12, 20),
        ("on an upright line", paths(8, 20, |k, t| Some([50.0, 10.0 * f64::from(k) + sway(k, t)])), 4, 20),
        ("on a level line", paths(8, 20, |k, t| Some([10.0 * f64::from(k) + sway(k, t), 50.0])), 4, 20),
        ("on a sloping line", sloping(), 4, 100),
        ("two frames", paths(12, 2, spread), 5, 2),
        ("one frame", paths(12, 1, spread), 5, 1),
        ("with gaps", paths(12, 20, |k, t| spread(k, t).filter(|_| (k + t) % 3 > 0)), 5, 20),
        ("one seen, one never", paths(12, 20, |k, t| spread(k, t).filter(|_| k != 3)), 5, 20),
    ];
    for (what, paths, k, n_frames) in cases {
        for (how, grown) in grown(&paths, k, n_frames) {
            let grown = grown.unwrap_or_else(|error| panic!("{what}, {how}: {error}"));
            let skeleton = &grown.skeleton;
            assert!(
                skeleton.leaves().len() >= paths.iter().filter(|path| path.is_seen()).count(),
                "{what}, {how}"
            );
            assert_rigid(skeleton, &format!("{what}, {how}"));
            // Siblings of all of these are skeletons, or say why they are none.
            match siblings::Siblings::of(skeleton, siblings::Settings { level: Some(0), threshold: None }) {
                Ok(siblings) => {
                    siblings.draw(1, 1).unwrap();
                }
                Err(error) => {
                    assert!(matches!(error, StructureError::NoLevel { .. }), "{what}, {how}: {error}")
                }
            }
        }
    }
}

/// Tracks along a line that goes up by a third, in places of single precision, which lie beside it.
fn sloping() -> Vec<Path> {
    paths(20, 100, |k, t| {
        let along = 500.0 + 9.7 * f64::from(k) + 0.3 * (f64::from(t) * 0.5 + f64::from(k)).sin();
        Some([along, 40.0 + along / 3.0].map(|v| f64::from(v as f32)))
    })
}

#[test]
fn what_is_on_a_line_has_no_mirror_image() {
    let found: Vec<usize> = grown(&sloping(), 4, 100)
        .into_iter()
        .filter(|(how, _)| how.starts_with("diener"))
        .map(|(_, grown)| grown.unwrap().skeleton.joints().len())
        .collect();
    assert_eq!(found[0], found[1], "flat and in depth");
}

#[test]
fn what_cannot_grow_is_named() {
    let point = |k: u32, _| Some([f64::from(k), 5.0]);
    let short = || {
        let mut short = paths(3, 4, point);
        short[1].at.pop();
        short
    };
    let cases: [(&str, Vec<Path>, &str); 7] = [
        ("no tracks", paths(0, 4, point), "no track of any group is seen"),
        ("none seen", paths(3, 4, |_, _| None), "no track of any group is seen"),
        ("all in one place", paths(5, 4, |_, _| Some([7.0, 9.0])), "lies where the root is, at (7.0, 9.0)"),
        ("one track", paths(1, 4, |_, _| Some([7.0, 9.0])), "lies where the root is, at (7.0, 9.0)"),
        (
            "NaN",
            paths(3, 4, |k, t| Some([f64::from(k), if t == 2 { f64::NAN } else { 1.0 }])),
            "track 0 has 4 samples",
        ),
        (
            "infinite",
            paths(3, 4, |k, _| Some([if k == 1 { f64::INFINITY } else { 1.0 }, 2.0])),
            "track 1 has 4 samples",
        ),
        ("too short", short(), "track 1 has 3 samples; one for each of 4 frames was wanted"),
    ];
    for (what, paths, wanted) in cases {
        for (how, grown) in grown(&paths, 3, 4) {
            let error = grown.map(|_| ()).unwrap_err().to_string();
            assert!(error.contains(wanted), "{what}, {how}: {error}");
        }
    }
}
