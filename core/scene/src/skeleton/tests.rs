//! Bones that are shaped where they are drawn, and scenes that are not whole.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::*;

const N_FRAMES: usize = 5;

/// A trunk, a fork on it with a tip that sways, and a mirror image of both behind; the tip carries a track.
fn scene() -> SkeletonScene {
    let bone = |node| Some(Bone { node, gain: 1.0, ..Bone::default() });
    let joint = |parent, bone, copy_of| Joint { parent, bone, copy_of, ..Joint::default() };
    let joints = vec![
        Joint::default(),
        joint(Some(0), bone(4), None),
        joint(Some(1), bone(2), None),
        joint(Some(1), bone(2), Some(2)),
    ];
    let tip = |frame: usize, away: f64| {
        let angle = 0.5 + 0.2 * (frame as f64 - 2.0);
        [30.0 * angle.sin(), away, -40.0 + 30.0 * angle.cos()].map(|v| v as f32)
    };
    let frame = |frame| [[0.0, 0.0, -100.0], [0.0, 0.0, -40.0], tip(frame, -8.0), tip(frame, 8.0)];
    let beside = |frame| {
        let [x, y, z] = tip(frame, -8.0);
        [x + 3.0, y, z]
    };
    let places = (0..N_FRAMES).map(beside).collect();
    SkeletonScene {
        clip: Film { width: 200, height: 150, n_frames: 9, ..Film::default() },
        joints,
        places: (0..N_FRAMES).flat_map(frame).collect(),
        first_frame: 2,
        times: (0..N_FRAMES).map(|frame| frame as f64 / 25.0).collect(),
        leaves: vec![Carried { track: 1 << 40, joint: 2, group: None, places }],
        ..SkeletonScene::default()
    }
}

fn way(scene: &SkeletonScene, frame: u32, row: usize) -> [f64; 3] {
    let at = scene.at(frame).unwrap();
    let from = at[scene.joints[row].parent.unwrap() as usize];
    std::array::from_fn(|axis| f64::from(at[row][axis] - from[axis]))
}

#[test]
fn a_scene_has_the_frames_that_it_has() {
    let scene = scene();
    assert!(scene.is_whole());
    assert_eq!((scene.at(1), scene.at(7)), (None, None));
    assert_eq!(scene.at(6).map(|at| at[1]), Some([0.0, 0.0, -40.0]));
    assert_eq!((scene.row_of(2), scene.row_of(4), scene.row_of(3)), (Some(2), Some(1), None));
}

/// The trunk stands upright and still: leaning by a right angle, clockwise as the picture is seen, it lies to the right, and
/// all that it bears goes along.
#[test]
fn what_a_bone_bears_goes_along() {
    let (before, mut scene) = (scene(), scene());
    scene.reshape(&[(4, Shape { lean_rad: FRAC_PI_2, ..Shape::default() })]).unwrap();
    for frame in 2..7 {
        for row in 1..4 {
            let ([x, y, z], is) = (way(&before, frame, row), way(&scene, frame, row));
            for (is, wanted) in is.into_iter().zip([z, y, -x]) {
                assert!((is - wanted).abs() < 1e-4, "joint {row} in frame {frame}: {is} {wanted}");
            }
        }
        let (leaf, tip) = (scene.leaves[0].places[frame as usize - 2], scene.at(frame).unwrap()[2]);
        let off: [f32; 3] = std::array::from_fn(|axis| leaf[axis] - tip[axis]);
        assert!(off[0].abs() < 1e-4 && (off[2] + 3.0).abs() < 1e-4, "{off:?}");
    }
    assert_eq!(scene.grown.as_ref().unwrap().places, before.places);
}

/// As the library shapes it, mirror images too; and the same twice is the same.
#[test]
fn shapes_are_of_the_bone_as_it_grows() {
    let shape = Shape { plane_rad: FRAC_PI_4, lean_rad: -0.2, gain: 2.5 };
    let mut scene = scene();
    scene.reshape(&[(2, Shape { plane_rad: 1.0, ..shape })]).unwrap();
    scene.reshape(&[(2, shape), (9, shape)]).unwrap();
    let grown = scene.grown.clone().unwrap();
    let skeleton = skeleton(&scene.joints, &grown, &scene.times, &scene.leaves).unwrap();
    let own = Shaped { shape, copy_of: None };
    let by = [Shaped { shape: Shape::default(), ..own }; 2].into_iter();
    let by: Vec<Shaped> = by.chain([own, Shaped { copy_of: Some(2), ..own }]).collect();
    let wanted = shaped(&skeleton, &by).unwrap();
    for frame in 0..N_FRAMES as u32 {
        let places = wanted.places(wanted.directions(frame));
        for (is, wanted) in scene.at(frame + 2).unwrap().iter().zip(&places) {
            let is_there = (0..3).all(|axis| (f64::from(is[axis]) - wanted[axis]).abs() < 1e-4);
            assert!(is_there, "frame {frame}: {is:?} {wanted:?}");
        }
        let [own, image] = [2, 3].map(|row| way(&scene, frame + 2, row));
        assert!((own[0] - image[0]).abs() < 1e-4 && (own[1] + image[1]).abs() < 1e-4, "{own:?} {image:?}");
    }
    scene.reshape(&[(2, Shape::default())]).unwrap();
    let before = self::scene();
    let back = scene.places.as_flattened().iter().zip(before.places.as_flattened());
    assert!(back.clone().all(|(is, was)| (is - was).abs() < 1e-4), "{back:?}");
}

#[test]
fn a_scene_that_is_not_whole_is_told() {
    type Spoil = fn(&mut SkeletonScene);
    let wrong: [(&str, Spoil); 10] = [
        ("a joint without a place", |scene| scene.places.truncate(3)),
        ("a place that is none", |scene| scene.places[3][1] = f32::NAN),
        ("a parent behind its child", |scene| scene.joints[1].parent = Some(2)),
        ("two roots", |scene| scene.joints[2].parent = None),
        ("a copy of nothing", |scene| scene.joints[3].copy_of = Some(9)),
        ("a group that is none", |scene| scene.joints[2].group = Some(0)),
        ("a track on no joint", |scene| scene.leaves[0].joint = 4),
        ("a track that ends", |scene| scene.leaves[0].places.truncate(2)),
        ("no picture", |scene| scene.clip.width = 0),
        ("no time", |scene| scene.times.clear()),
    ];
    for (what, wrong) in wrong {
        let mut scene = scene();
        wrong(&mut scene);
        assert!(!scene.is_whole(), "{what}");
    }
}
