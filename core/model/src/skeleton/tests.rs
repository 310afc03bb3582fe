//! What is refused, where bones are, that they keep their length.

use proptest::prelude::*;

use super::*;

fn joint(parent: Option<u32>, length: f64) -> Joint {
    Joint { parent, length, ..Joint::default() }
}

fn times(n: u32) -> FrameTimes {
    FrameTimes::constant(n, 25.0).unwrap()
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const RIGHT: [f64; 3] = [1.0, 0.0, 0.0];

#[test]
fn what_is_no_skeleton_is_named() {
    let of = |joints: &[Joint], directions: &[[f64; 3]]| {
        Skeleton::new([0.0; 3], joints.to_vec(), directions.to_vec(), times(1)).unwrap_err()
    };
    let (root, bone) = (joint(None, 0.0), joint(Some(0), 1.0));
    assert_eq!(of(std::slice::from_ref(&root), &[UP]), SkeletonError::TooFew(1));
    assert_eq!(of(&[root.clone(), root.clone()], &[UP; 2]), SkeletonError::Root(1));
    let late = joint(Some(1), 1.0);
    assert_eq!(of(&[root.clone(), late], &[UP; 2]), SkeletonError::Order { joint: 1, parent: 1 });
    assert_eq!(of(&[bone.clone(), bone.clone()], &[UP; 2]), SkeletonError::Order { joint: 0, parent: 0 });
    let short = joint(Some(0), 0.0);
    assert_eq!(of(&[root.clone(), short], &[UP; 2]), SkeletonError::Length { joint: 1, length: 0.0 });
    let pair = [root, bone];
    assert_eq!(of(&pair, &[UP]), SkeletonError::Count { came: 1, wanted: 2 });
    let long = [0.0, 0.0, 2.0];
    let error = SkeletonError::Direction { joint: 1, frame: 0, direction: long };
    assert_eq!(of(&pair, &[UP, long]), error);
    assert!(matches!(of(&pair, &[UP, [f64::NAN; 3]]), SkeletonError::Direction { .. }));
    let lost = Skeleton::new([f64::NAN, 0.0, 0.0], pair.to_vec(), vec![UP; 2], times(1));
    assert!(matches!(lost, Err(SkeletonError::Place(_))));
    let lost = Skeleton::new([0.0, 0.0, -2e9], pair.to_vec(), vec![UP; 2], times(1));
    assert_eq!(lost, Err(SkeletonError::Place([0.0, 0.0, -2e9])));
    // Two of these, one on the other, would end nowhere.
    for length in [1e308, 2e9, f64::INFINITY, f64::NAN] {
        let error = of(&[pair[0].clone(), joint(Some(0), 1.0), joint(Some(1), length)], &[UP; 3]);
        assert!(matches!(error, SkeletonError::Length { joint: 2, .. }), "{length}: {error}");
    }
    let good = Skeleton::new([0.0; 3], pair.to_vec(), vec![UP; 2], times(1)).unwrap();
    for (joint, offsets) in
        [(2, vec![UP]), (1, vec![]), (1, vec![[f64::NAN; 3]]), (1, vec![[0.0, 1e308, 0.0]])]
    {
        let leaf = Leaf { track: TrackId(0), joint, offsets };
        let error = good.clone().with_leaves(vec![leaf]).unwrap_err();
        assert_eq!(error, SkeletonError::Leaf { leaf: 0, n_frames: 1 });
    }
}

#[test]
fn a_place_is_seen_where_it_was_placed() {
    assert_eq!(seen(placed([3.0, 7.0], 2.0)).map(f64::to_bits), [3.0_f64, 7.0].map(f64::to_bits));
    // Up in the picture is up of the plant.
    assert!(placed([0.0, 1.0], 0.0)[2] < placed([0.0, 0.0], 0.0)[2]);
}

#[test]
fn at_rest_a_bone_points_where_it_points_in_the_mean() {
    let joints = vec![joint(None, 0.0), joint(Some(0), 2.0), joint(Some(1), 1.0)];
    let down = [0.0, 0.0, -1.0];
    let skeleton = Skeleton::new([0.0; 3], joints, vec![UP, UP, UP, UP, RIGHT, down], times(2)).unwrap();
    let half = 0.5_f64.sqrt();
    let wanted = [half, 0.0, half];
    assert!(skeleton.rest()[1].iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-15));
    assert_eq!(
        skeleton.rest()[2].map(f64::to_bits),
        UP.map(f64::to_bits),
        "where they cancel, as in the first frame"
    );
    assert_eq!(skeleton.places(skeleton.directions(1)), [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 0.0, -1.0]]);
    assert_eq!(skeleton.are_tips(), [false, false, true]);
    assert!(skeleton.directions(2).is_empty());
}

proptest! {
    #[test]
    fn bones_keep_their_length(
        lengths in prop::collection::vec(1e-3..1e3_f64, 1..20),
        angles in prop::collection::vec((-4.0..4.0_f64, -1.5..1.5_f64), 60),
        parents in prop::collection::vec(0..1000_u32, 20),
    ) {
        let n = lengths.len() + 1;
        let mut joints = vec![joint(None, 0.0)];
        for (row, &length) in lengths.iter().enumerate() {
            joints.push(joint(Some(parents[row] % (row as u32 + 1)), length));
        }
        let direction = |k: usize| {
            let (a, b) = angles[k % angles.len()];
            [a.cos() * b.cos(), b.sin(), a.sin() * b.cos()]
        };
        let skeleton =
            Skeleton::new([5.0, 0.0, -700.0], joints, (0..3 * n).map(direction).collect(), times(3)).unwrap();
        for frame in 0..3 {
            let places = skeleton.places(skeleton.directions(frame));
            for (row, joint) in skeleton.joints().iter().enumerate().skip(1) {
                let from = places[joint.parent.unwrap() as usize];
                let length = norm(std::array::from_fn(|axis| places[row][axis] - from[axis]));
                prop_assert!((length - joint.length).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn a_skeleton_taken_apart_and_put_together_is_the_same() {
    let directions = (0..400).map(|k| {
        let (a, b) = (f64::from(k) * 0.7, f64::from(k) * 1.3);
        [a.sin() * b.cos(), a.sin() * b.sin(), a.cos()].map(|v| v * (1.0 + 1e-9 * f64::from(k % 5)))
    });
    let joints = vec![joint(None, 0.0), joint(Some(0), 2.0)];
    let once = Skeleton::new([0.0; 3], joints.clone(), directions.collect(), times(200)).unwrap();
    let again = Skeleton::again([0.0; 3], joints, once.directions.clone(), times(200)).unwrap();
    assert_eq!(once, again);
}
