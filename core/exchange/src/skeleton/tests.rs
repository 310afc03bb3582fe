//! Files read back, by readers of their own, are the skeleton.

use std::collections::BTreeMap;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Joint, Leaf};
use honami_model::track::TrackId;
use proptest::prelude::*;

use super::*;

type Matrix = [[f64; 3]; 3];

/// Joints of these parents and lengths, bones pointing as these angles say (in the picture, and behind it).
pub(super) fn skeleton(bones: &[(u32, f64)], angles: &[(f64, f64)], n_frames: u32) -> Skeleton {
    let mut joints = vec![Joint::default()];
    for (row, &(parent, length)) in bones.iter().enumerate() {
        let parent = Some(parent % (row as u32 + 1));
        joints.push(Joint { parent, length, groups: vec![row as u32], tracks: vec![TrackId(row as u32)] });
    }
    let direction = |k: usize| {
        let (turn, depth) = angles[k % angles.len()];
        [turn.sin() * depth.cos(), depth.sin(), turn.cos() * depth.cos()]
    };
    let n = joints.len() * n_frames as usize;
    let times = FrameTimes::constant(n_frames, 30.0).unwrap();
    let leaf = Leaf { track: TrackId(7), joint: 1, offsets: vec![[1.0, 2.0, 3.0]; n_frames as usize] };
    Skeleton::new([320.0, 0.0, -480.0], joints, (0..n).map(direction).collect(), times)
        .unwrap()
        .with_leaves(vec![leaf])
        .unwrap()
}

/// A turn about one of the axes, right-handed, degrees.
fn about(axis: usize, degrees: f64) -> Matrix {
    let (s, c) = degrees.to_radians().sin_cos();
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = [[0.0; 3]; 3];
    m[axis][axis] = 1.0;
    (m[a][a], m[a][b], m[b][a], m[b][b]) = (c, -s, s, c);
    m
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|r| std::array::from_fn(|c| (0..3).map(|k| a[r][k] * b[k][c]).sum()))
}

fn moved(m: &Matrix, v: [f64; 3], by: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|r| by[r] + (0..3).map(|k| m[r][k] * v[k]).sum::<f64>())
}

/// Where every bone ends in every frame, by its number, as the file says: of tips the end site, of others where the joints
/// that they bear are.
fn read(text: &str) -> Vec<BTreeMap<usize, [f64; 3]>> {
    let (hierarchy, motion) = text.split_once("MOTION\n").unwrap();
    let mut lines = motion.lines();
    let n_frames: usize = lines.next().unwrap().strip_prefix("Frames: ").unwrap().parse().unwrap();
    let step: f64 = lines.next().unwrap().strip_prefix("Frame Time: ").unwrap().parse().unwrap();
    assert!((step - 1.0 / 30.0).abs() < 1e-8 || n_frames == 1);
    let frames: Vec<Vec<f64>> =
        lines.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect();
    assert_eq!(frames.len(), n_frames);
    let mut found = Vec::new();
    for values in &frames {
        let mut values = values.iter().copied();
        let mut ends = BTreeMap::new();
        // Name, turn, place.
        let mut open: Vec<(Option<usize>, Matrix, [f64; 3])> = Vec::new();
        let mut names = Vec::new();
        for line in hierarchy.lines().map(str::trim) {
            let words: Vec<&str> = line.split(' ').collect();
            match words[0] {
                "ROOT" | "JOINT" => names.push(words[1].strip_prefix("bone_").map(|n| n.parse().unwrap())),
                "End" => names.push(None),
                "OFFSET" => {
                    let offset: Vec<f64> = words[1..].iter().map(|word| word.parse().unwrap()).collect();
                    let none = (None, about(0, 0.0), [0.0; 3]);
                    let (parent, turn, place) = *open.last().unwrap_or(&none);
                    let place = moved(&turn, [offset[0], offset[1], offset[2]], place);
                    parent.iter().for_each(|&parent| {
                        assert!(
                            ends.insert(parent, place)
                                .is_none_or(|it| it.map(f64::to_bits) == place.map(f64::to_bits))
                        )
                    });
                    open.push((names.pop().unwrap(), turn, place));
                }
                "CHANNELS" => {
                    let (_, turn, place) = open.last_mut().unwrap();
                    for channel in &words[2..] {
                        let value = values.next().unwrap();
                        match *channel {
                            "Xposition" => place[0] += value,
                            "Yposition" => place[1] += value,
                            "Zposition" => place[2] += value,
                            "Zrotation" => *turn = times(turn, &about(2, value)),
                            "Xrotation" => *turn = times(turn, &about(0, value)),
                            _ => *turn = times(turn, &about(1, value)),
                        }
                    }
                }
                "}" => drop(open.pop().unwrap()),
                _ => {}
            }
        }
        assert_eq!((values.next(), open.len()), (None, 0));
        found.push(ends);
    }
    found
}

fn written(format: SkeletonFormat, skeleton: &Skeleton) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out");
    write(&path, format, skeleton, 0).unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[track_caller]
fn assert_is_it(skeleton: &Skeleton) {
    let text = written(SkeletonFormat::Bvh, skeleton);
    for (frame, ends) in (0..).zip(read(&text)) {
        assert_eq!(ends.len(), skeleton.joints().len() - 1);
        let places = skeleton.places(skeleton.directions(frame));
        for (row, [x, y, z]) in ends {
            let wanted: [f64; 3] = std::array::from_fn(|axis| places[row][axis] - places[0][axis]);
            let far = (x - wanted[0]).abs() + (y - wanted[2]).abs() + (z + wanted[1]).abs();
            assert!(far < 1e-4, "bone {row}, frame {frame}: {far} px off\n{text}");
        }
    }
}

#[test]
fn motion_in_the_picture_turns_about_one_axis_alone() {
    let flat = skeleton(
        &[(0, 100.0), (1, 50.0), (1, 60.0)],
        &[(0.0, 0.0), (0.1, 0.0), (0.7, 0.0), (-0.8, 0.0), (0.3, 0.0)],
        5,
    );
    let text = written(SkeletonFormat::Bvh, &flat);
    let (_, motion) = text.split_once("Frame Time: ").unwrap();
    for line in motion.lines().skip(1) {
        let values: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let others = values.iter().enumerate().filter(|(k, _)| k % 3 != 0 || *k < 6);
        assert!(others.map(|(_, value)| value.abs()).fold(0.0, f64::max) < 1e-7, "{line}");
    }
    assert_is_it(&flat);
}

#[test]
fn a_bone_that_turns_round_ends_where_it_should() {
    let round: Vec<(f64, f64)> = (0..26).map(|k| (f64::from(k) * 0.5, 0.0)).collect();
    assert_is_it(&skeleton(&[(0, 10.0)], &round, 13));
    // Two frames that are opposite: at rest as in the first of them.
    let opposite = [(0.0, 0.0), (0.4, 0.0), (0.0, 0.0), (0.4 + std::f64::consts::PI, 0.0)];
    assert_is_it(&skeleton(&[(0, 10.0)], &opposite, 2));
    let deep = [(0.0, 0.0), (0.0, 1.5), (0.0, -1.5), (1.0, std::f64::consts::FRAC_PI_2), (0.0, 0.2)];
    assert_is_it(&skeleton(&[(0, 10.0), (1, 20.0), (2, 5.0)], &deep, 5));
    assert_is_it(&skeleton(&[(0, 10.0)], &[(0.2, 0.1)], 1));
}

#[test]
fn angles_are_those_between_bones_in_the_picture() {
    let up_then_right = [(0.0, 0.0), (0.0, 0.0), (1.5, 0.2), (-1.7, 0.0)];
    let skeleton = skeleton(&[(0, 10.0), (1, 20.0), (2, 5.0)], &up_then_right, 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("angles.csv");
    write(&path, SkeletonFormat::of(&path).unwrap(), &skeleton, 0).unwrap();
    let rows: Vec<AngleRow> = crate::read(&path).unwrap().collect::<Result<_, _>>().unwrap();
    assert_eq!(rows.len(), 4);
    assert_eq!((rows[0].parent, rows[0].length_px, rows[0].angle_rad), (None, None, None));
    assert_eq!((rows[0].x_px, rows[0].y_px), (320.0, 480.0));
    let wrapped = 2.0 * std::f64::consts::PI - 3.2;
    for (row, wanted) in rows[1..].iter().zip([(0.0, 0.0), (1.5, 0.2), (wrapped, 0.0)]) {
        assert!(
            (row.angle_rad.unwrap() - wanted.0).abs() < 1e-12
                && (row.depth_rad.unwrap() - wanted.1).abs() < 1e-12
        );
    }
    assert!((rows[2].x_px - rows[1].x_px - 20.0 * 1.5_f64.sin() * 0.2_f64.cos()).abs() < 1e-9);
    assert!((rows[2].depth_px - 20.0 * 0.2_f64.sin()).abs() < 1e-9);
    assert_eq!(rows[3].groups, "3");
    let leaves = folder.path().join("leaves.csv");
    assert_eq!(write_leaves(&leaves, &skeleton, 0).unwrap(), 1);
    let leaf = crate::read::<LeafRow>(&leaves).unwrap().next().unwrap().unwrap();
    assert_eq!(
        (leaf.track, leaf.joint, leaf.x_px, leaf.y_px, leaf.depth_px),
        (TrackId(7), 1, 321.0, 467.0, 2.0)
    );
}

#[test]
fn at_rest_it_is_a_plant_that_can_be_read() {
    let skeleton =
        skeleton(&[(0, 100.0), (1, 50.0), (1, 60.0)], &[(0.0, 0.0), (0.1, 0.0), (0.7, 0.1), (-0.8, 0.0)], 1);
    let plant = crate::plant::swc::parse(&written(SkeletonFormat::Swc, &skeleton), 0.01).unwrap().plant;
    let places = skeleton.places(skeleton.rest());
    for ((node, joint), place) in plant.nodes().iter().zip(skeleton.joints()).zip(places) {
        assert_eq!(node.parent, joint.parent);
        for ((found, place), root) in node.position.into_iter().zip(place).zip(skeleton.root()) {
            assert!((found * 100.0 - (place - root)).abs() < 1e-5);
        }
    }
}

#[test]
fn endings_name_formats() {
    for (name, format) in [
        ("a.bvh", Some(SkeletonFormat::Bvh)),
        ("a.CSV", Some(SkeletonFormat::Angles)),
        ("a.swc", Some(SkeletonFormat::Swc)),
        ("a.glb", None),
        ("bvh", None),
    ] {
        assert_eq!(SkeletonFormat::of(Path::new(name)), format, "{name}");
    }
}

proptest! {
    #[test]
    fn any_motion_is_read_back(
        bones in prop::collection::vec((0..100_u32, 1.0..200.0_f64), 1..12),
        angles in prop::collection::vec((-3.5..3.5_f64, -1.57..1.57_f64), 40),
    ) {
        assert_is_it(&skeleton(&bones, &angles, 4));
    }
}

/// Motion and nerves of others begin alike, and are not written over; what was written here is.
#[test]
fn files_take_the_place_of_their_own_kind_alone() {
    let folder = tempfile::tempdir().unwrap();
    let skeleton = skeleton(&[(0, 10.0), (1, 5.0)], &[(0.2, 0.1)], 2);
    for (name, format, theirs) in [
        (
            "a.bvh",
            SkeletonFormat::Bvh,
            "HIERARCHY\nROOT root\n{\n\tOFFSET 0 0 0\n\tCHANNELS 3 Zrotation Xrotation Yrotation\n",
        ),
        ("b.bvh", SkeletonFormat::Bvh, "HIERARCHY\nROOT Hips\n{\n"),
        ("a.swc", SkeletonFormat::Swc, "# number type x y z radius parent\n1 1 0 0 0 1 -1\n"),
        ("b.csv", SkeletonFormat::Angles, "joint,parent,groups,frame\n"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, theirs).unwrap();
        let error = write(&path, format, &skeleton, 0).unwrap_err();
        assert!(matches!(error, TableError::Unlike { .. }), "{name}: {error}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), theirs);
        std::fs::remove_file(&path).unwrap();
        for _again in 0..2 {
            write(&path, format, &skeleton, 0).unwrap();
        }
    }
}
