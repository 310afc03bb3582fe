//! Scenes of what has grown.

use honami_model::clip::FrameTimes;
use honami_model::document::ClusteringId;
use honami_model::shape;
use honami_model::skeleton as model;
use honami_model::track::TrackId;

use super::*;

/// A trunk, and a tip of group 2 that points to the right and then half-way up, with a mirror image; the tip carries four tracks.
fn grown() -> (Skeleton, Bones) {
    let joint = |parent, length, groups: &[u32]| model::Joint {
        parent,
        length,
        groups: groups.to_vec(),
        ..model::Joint::default()
    };
    let joints = vec![
        joint(None, 0.0, &[]),
        joint(Some(0), 50.0, &[]),
        joint(Some(1), 10.0, &[1]),
        joint(Some(1), 10.0, &[1]),
    ];
    let (up, right, half) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()]);
    let times = FrameTimes::new(vec![0.4, 0.5]).unwrap();
    let skeleton = model::Skeleton::new(
        [20.0, 0.0, -90.0],
        joints,
        [up, up, right, right, up, up, half, half].to_vec(),
        times,
    );
    let leaf =
        |(track, offset): (u32, [f64; 3])| Leaf { track: TrackId(track), joint: 2, offsets: vec![offset; 2] };
    let offsets = [[8.0, -1.0, 0.0], [-4.0, -1.0, 0.0], [2.0, -1.0, 3.0], [2.0, -1.0, -3.0]];
    let skeleton = skeleton.unwrap().with_leaves((5..).zip(offsets).map(leaf).collect()).unwrap();
    let bone = |node, name: &str| {
        Some(shape::Bone { clustering: ClusteringId(1), node, name: name.to_owned(), groups: vec![1] })
    };
    let known = vec![None, bone(9, "fork 1,2"), bone(3, "group 2 bud"), bone(3, "group 2 bud")];
    (skeleton, Bones { known, copy_of: vec![None, None, None, Some(2)] })
}

#[test]
fn a_scene_says_where_everything_is_and_what_it_is_called() {
    let (skeleton, bones) = grown();
    let scene = scene(&skeleton, &bones, 7);
    assert_eq!((scene.first_frame, scene.times.len()), (7, 2));
    assert!((scene.times[0].abs() + (scene.times[1] - 0.1).abs()) < 1e-12);
    let diagonal = 10.0 * 0.5_f32.sqrt();
    assert_eq!(scene.at(7).unwrap()[1..3], [[20.0, 0.0, -40.0], [30.0, 0.0, -40.0]]);
    let (is, wanted) = (scene.at(8).unwrap()[2], [20.0 + diagonal, 0.0, -40.0 + diagonal]);
    assert!((0..3).all(|axis| (is[axis] - wanted[axis]).abs() < 1e-4), "{is:?}");
    let names: Vec<&str> = scene.joints.iter().map(|joint| &*joint.name).collect();
    assert_eq!(names, ["", "fork 1,2", "group 2 bud", "group 2 bud"]);
    assert_eq!((scene.row_of(3), scene.joints[3].copy_of), (Some(2), Some(2)));
    let leaf = &scene.leaves[2];
    assert_eq!((leaf.track, leaf.joint, leaf.group), (7, 2, Some(1)));
    assert_eq!(leaf.places[0].map(f32::to_bits), [32.0_f32, -1.0, -37.0].map(f32::to_bits));
}

/// Of four places 6 px to either side and 3 px up and down of their mean the variances are 24 and 6 px², n less one; 95 % of a
/// normal distribution are within 2.4477 standard deviations (the root of 5.9915, from tables).
#[test]
fn an_ellipsoid_holds_most_of_a_group() {
    let (skeleton, bones) = grown();
    let scene = scene(&skeleton, &bones, 7);
    assert_eq!(scene.groups.len(), 2);
    assert_eq!((&*scene.groups[0].name, scene.groups[0].joint), ("group 1", None), "it has no joint");
    let group = &scene.groups[1];
    assert_eq!((&*group.name, group.joint, group.centre), ("group 2 bud", Some(2), [2.0, 0.0, 0.0]));
    let (long, short) = ((5.9915 * 24.0_f64).sqrt() as f32, (5.9915 * 6.0_f64).sqrt() as f32);
    let wanted = [[long, 0.0, 0.0], [0.0, 0.0, short], [0.0, short, 0.0]];
    for (is, wanted) in group.half_axes.as_flattened().iter().zip(wanted.as_flattened()) {
        assert!((is.abs() - wanted).abs() < 1e-3, "{:?}", group.half_axes);
    }
    assert_eq!(ellipsoid(&[[1.0, 2.0]]), None);
    assert_eq!(ellipsoid(&[[0.0, 0.0], [1.0, 2.0], [2.0, 4.0]]), None, "a line");
    assert_eq!(ellipsoid(&[]), None);
}
