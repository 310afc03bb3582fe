//! Against plants whose branches are known, closed forms of the shift, and bad input.

use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::skeleton::seen;
use honami_model::track::TrackId;
use proptest::prelude::*;

use super::*;
use crate::bones::{Bones, distance};
use crate::tree::tree;

const N_FRAMES: u32 = 120;

fn times() -> FrameTimes {
    FrameTimes::constant(N_FRAMES, 25.0).unwrap()
}

fn merges(rows: &[(u32, u32, u32)]) -> Dendrogram {
    let merge = |(k, &(a, b, size)): (usize, &(u32, u32, u32))| Merge { a, b, height: k as f64 + 1.0, size };
    Dendrogram::new(rows.len() as u32 + 1, rows.iter().enumerate().map(merge).collect()).unwrap()
}

/// A branch: what it grows on (`None`: the ground), its length, direction and swing.
type Branch = (Option<usize>, f64, f64, [f64; 2]);

const GROUND: [f64; 2] = [300.0, 500.0];

/// Where the branches of a plant end in a frame; angles from straight up, to the right.
fn ends(branches: &[Branch], t: u32) -> Vec<[f64; 2]> {
    let mut ends: Vec<([f64; 2], f64)> = Vec::new();
    for &(parent, length, turn, [amplitude, pace]) in branches {
        let (from, angle) = parent.map_or((GROUND, 0.0), |parent| ends[parent]);
        let angle = angle + turn + amplitude * (pace * f64::from(t)).sin();
        ends.push(([from[0] + length * angle.sin(), from[1] - length * angle.cos()], angle));
    }
    ends.into_iter().map(|(end, _)| end).collect()
}

/// A path at the end of each of these branches.
fn paths(branches: &[Branch], tips: &[usize]) -> Vec<Path> {
    let path = |&tip: &usize| Path {
        track: TrackId(tip as u32),
        at: (0..N_FRAMES).map(|t| Some(ends(branches, t)[tip])).collect(),
    };
    tips.iter().map(path).collect()
}

fn still(at: &[[f64; 2]], n: usize) -> Vec<Path> {
    (0..).zip(at).map(|(k, &at)| Path { track: TrackId(k), at: vec![Some(at); n] }).collect()
}

fn flat() -> Settings {
    Settings { root: Some(GROUND), is_flat: true }
}

/// How far joints are from places in the picture, pixels, mean over frames.
fn apart(grown: &Grown, joint: usize, place: impl Fn(u32) -> [f64; 2]) -> f64 {
    let far = |t: u32| {
        let [x, y] = seen(grown.skeleton.places(grown.skeleton.directions(t))[joint]);
        let wanted = place(t);
        (x - wanted[0]).hypot(y - wanted[1])
    };
    (0..N_FRAMES).map(far).sum::<f64>() / f64::from(N_FRAMES)
}

/// Whatever forks are shifted to, tips stay where their groups are, on bones of constant length.
#[test]
fn tips_stay_where_their_groups_are() {
    let branches: [Branch; 5] = [
        (None, 120.0, 0.0, [0.08, 0.35]),
        (Some(0), 80.0, -0.7, [0.2, 0.5]),
        (Some(0), 150.0, 0.6, [0.2, 0.62]),
        (Some(1), 70.0, -0.5, [0.25, 0.83]),
        (Some(1), 70.0, 0.5, [0.25, 1.01]),
    ];
    let paths = paths(&branches, &[3, 4, 2]);
    let groups = tree(&merges(&[(0, 1, 2), (3, 2, 3)]), 3, &[true; 3]);
    let grown = grow(&paths, &groups, &times(), flat()).unwrap();
    let joints = grown.skeleton.joints();
    for (group, end) in [(0, 3), (1, 4), (2, 2)] {
        let joint = joints.iter().position(|joint| joint.groups == [group]).unwrap();
        let far = apart(&grown, joint, |t| ends(&branches, t)[end]);
        let still = (0..N_FRAMES).map(|t| ends(&branches, t)[end]).collect::<Vec<_>>();
        let mean = crate::follow::mean(still.iter().copied()).unwrap();
        let moves = still.iter().map(|at| (at[0] - mean[0]).hypot(at[1] - mean[1])).sum::<f64>()
            / f64::from(N_FRAMES);
        assert!(
            far < 0.1 * moves,
            "the end of branch {end} is {far} px from where it is, and moves by {moves}"
        );
    }
}

/// Two forks less than a tenth of what they bear apart are one with three branches; farther apart they are two.
#[test]
fn forks_that_are_one_have_more_than_two_branches() {
    let groups = tree(&merges(&[(0, 1, 2), (3, 2, 3)]), 3, &[true; 3]);
    let of = |inner: f64| {
        let place = |k: usize, t: u32| {
            let swing = 0.2 * (f64::from(t) * (0.3 + 0.1 * k as f64)).sin();
            let fork = [0.0, 100.0 + if k < 2 { inner } else { 0.0 }];
            [
                fork[0] + 100.0 * (swing + k as f64 - 1.0).sin(),
                0.0,
                fork[1] + 100.0 * (swing + k as f64 - 1.0).cos(),
            ]
        };
        let at = groups.iter().map(|group| match (group.children.is_empty(), group.parent) {
            (true, _) => (0..N_FRAMES).map(|t| place(group.number as usize, t)).collect(),
            (_, None) => vec![[0.0, 0.0, 100.0]; N_FRAMES as usize],
            _ => vec![[0.0, 0.0, 100.0 + inner]; N_FRAMES as usize],
        });
        Bones::along(&groups, [0.0; 3], &at.collect::<Vec<Track>>())
    };
    for (inner, n_collapsed) in [(0.0, 1), (9.9, 1), (10.1, 0), (40.0, 0)] {
        let bones = of(inner);
        let n_on_fork = bones.joints.iter().filter(|joint| joint.parent == Some(1)).count();
        assert_eq!((bones.n_collapsed, n_on_fork), (n_collapsed, 2 + n_collapsed), "{inner} px apart");
        for (row, joint) in bones.joints.iter().enumerate().skip(1) {
            let from = &bones.at[joint.parent.unwrap() as usize];
            let lengths = from.iter().zip(&bones.at[row]).map(|(a, b)| distance(*a, *b));
            assert!(lengths.map(|length| (length - joint.length).abs()).fold(0.0, f64::max) < 1e-9);
        }
    }
}

/// On a line, with one end that moves by s and one that does not: the standard deviations of thesis 4.11 are
/// (1 - α/2) s and α/2 s, in sum the same for any α; that of the fork's own bone, α/2 s, decides (errata E22).
#[test]
fn the_bone_that_a_fork_ends_decides_where_the_others_do_not() {
    let s = |t: u32| (f64::from(t) * std::f64::consts::TAU / 30.0).sin();
    let line = |x: &dyn Fn(u32) -> f64| (0..N_FRAMES).map(|t| [x(t), 0.0, 0.0]).collect::<Vec<_>>();
    let (origin, moving, fixed) = (line(&|_| 0.0), line(&|t| 10.0 + s(t)), line(&|_| -20.0));
    let mean = line(&|t| f64::midpoint(10.0 + s(t), -20.0));
    let sigma = 0.5_f64.sqrt();
    for alpha in [0.0, 0.2, 0.5, 0.9, 1.0] {
        let unrest = shift::unrest(&origin, &mean, &[&moving, &fixed], alpha);
        assert!((unrest - sigma * (1.0 + alpha / 2.0)).abs() < 1e-9, "{alpha}: {unrest}");
    }
    let at = |x: f64, y: f64| Some([x, y]);
    let two: Vec<Path> = vec![
        Path { track: TrackId(0), at: (0..N_FRAMES).map(|t| at(10.0 + s(t), 0.0)).collect() },
        Path { track: TrackId(1), at: (0..N_FRAMES).map(|_| at(-20.0, 0.0)).collect() },
    ];
    let groups = tree(&merges(&[(0, 1, 2)]), 2, &[true; 2]);
    let settings = Settings { root: Some([0.0, 0.0]), is_flat: true };
    let grown = grow(&two, &groups, &times(), settings).unwrap();
    assert!(grown.alphas[0] < 1e-6, "{:?}", grown.alphas);
    assert_eq!((grown.n_collapsed, grown.skeleton.joints().len()), (1, 3));
}

#[test]
fn what_stands_still_is_shifted_half_way() {
    let paths = still(&[[100.0, 100.0], [200.0, 100.0]], 10);
    let groups = tree(&merges(&[(0, 1, 2)]), 2, &[true; 2]);
    let times = FrameTimes::constant(10, 25.0).unwrap();
    let grown =
        grow(&paths, &groups, &times, Settings { root: Some([150.0, 300.0]), is_flat: true }).unwrap();
    assert_eq!(grown.alphas, [0.5]);
    let places = grown.skeleton.places(grown.skeleton.rest());
    let wanted = [[150.0, 300.0], [150.0, 200.0], [100.0, 100.0], [200.0, 100.0]];
    for (place, wanted) in places.into_iter().zip(wanted) {
        let [x, y] = seen(place);
        assert!((x - wanted[0]).hypot(y - wanted[1]) < 1e-9, "{x} {y}");
    }
}

/// Groups lie on the front of the ellipsoid about all, their images behind, and both are seen where they were.
#[test]
fn in_depth_a_plant_is_an_ellipsoid_and_its_mirror_image() {
    let ring = |k: u32| {
        let (a, r) = (f64::from(k) * 0.7, if k < 9 { 60.0 } else { 25.0 });
        [300.0 + 1.5 * r * a.cos(), 200.0 + r * a.sin()]
    };
    let places: Vec<[f64; 2]> = (0..18).map(ring).collect();
    let paths = still(&places, 3);
    let rows: Vec<(u32, u32, u32)> =
        (0..17).map(|k| (if k == 0 { 0 } else { 17 + k }, k + 1, k + 2)).collect();
    let groups = tree(&merges(&rows), 18, &[true; 18]);
    let times = FrameTimes::constant(3, 25.0).unwrap();
    let grown = grow(&paths, &groups, &times, Settings { root: None, is_flat: false }).unwrap();
    let skeleton = &grown.skeleton;
    let at = skeleton.places(skeleton.directions(1));
    let n = at.len() / 2;
    assert_eq!(at.len(), 2 * n + 1, "one root, and every bone twice");
    let whole = Ellipse::of(&places).unwrap();
    let mut deep = 0;
    for k in 1..=n {
        let ([x, y, z], image) = (at[k], at[k + n]);
        assert!((image[0] - x).abs() + (image[1] + y).abs() + (image[2] - z).abs() < 1e-9);
        for &group in &skeleton.joints()[k].groups {
            let place = places[group as usize];
            assert!((x - place[0]).hypot(-z - place[1]) < 1e-6 && (y + whole.depth(place)).abs() < 1e-6);
            deep += usize::from(y < -1.0);
        }
    }
    assert_eq!(deep, 18, "all of them are within the 95 %");
    assert_eq!(skeleton.leaves().len(), 36);
    let lowest = places.iter().map(|place| place[1]).fold(0.0, f64::max);
    assert!((seen(skeleton.root())[1] - lowest).abs() < 1e-9 && skeleton.root()[1].abs() < 1e-12);
}

/// A leaf is where its feature is seen, whatever its bone does not follow.
#[test]
fn leaves_are_where_their_features_are_seen() {
    let mut paths = still(&[[10.0, 0.0], [20.0, 0.0], [15.0, 9.0], [90.0, 5.0]], 6);
    paths[1].at = (0..6).map(|t| (t != 3).then(|| [20.0 + f64::from(t * t), 0.3])).collect();
    let groups = tree(&merges(&[(0, 1, 2), (4, 2, 3), (5, 3, 4)]), 2, &[true; 4]);
    let times = FrameTimes::constant(6, 25.0).unwrap();
    let grown = grow(&paths, &groups, &times, Settings { root: Some([40.0, 90.0]), is_flat: true }).unwrap();
    let leaves = grown.skeleton.leaves();
    let depths = leaves.iter().map(|leaf| leaf.offsets[0][1].abs()).fold(0.0, f64::max);
    assert!(depths > 0.1, "three features of one group have depth: {depths}");
    assert_eq!(
        leaves.iter().map(|leaf| leaf.track.0).collect::<Vec<_>>(),
        [0, 1, 2, 3, 0, 1, 2, 3][..leaves.len()]
    );
    for t in 0..6 {
        let at = grown.skeleton.places(grown.skeleton.directions(t));
        for leaf in leaves {
            let Some(wanted) = paths[leaf.track.0 as usize].at[t as usize] else {
                continue;
            };
            let (from, by) = (at[leaf.joint as usize], leaf.offsets[t as usize]);
            let [x, y] = seen(std::array::from_fn(|axis| from[axis] + by[axis]));
            assert!((x - wanted[0]).hypot(y - wanted[1]) < 1e-9, "leaf {}, frame {t}", leaf.track);
        }
    }
}

#[test]
fn bad_input_is_named_or_defined() {
    let times = |n: u32| FrameTimes::constant(n, 25.0).unwrap();
    let pair = tree(&merges(&[(0, 1, 2)]), 2, &[true; 2]);
    let never = Path { track: TrackId(0), at: vec![None; 2] };
    assert_eq!(grow(&[], &[], &times(2), flat()).unwrap_err(), StructureError::NothingSeen);
    let unseen = [never.clone(), never];
    let automatic = Settings::default();
    assert_eq!(grow(&unseen, &pair, &times(2), automatic).unwrap_err(), StructureError::NothingSeen);
    assert_eq!(grow(&unseen, &pair, &times(2), flat()).unwrap_err(), StructureError::NothingSeen);
    let lost = Settings { root: Some([f64::NAN, 0.0]), is_flat: true };
    let apart = still(&[[1.0, 2.0], [3.0, 4.0]], 2);
    assert!(matches!(grow(&apart, &pair, &times(2), lost), Err(StructureError::Root { .. })));
    // All of them one point: on the root there is no bone, elsewhere there are as many as groups.
    let same = still(&[[5.0, 5.0]; 2], 2);
    let here = Settings { root: Some([5.0, 5.0]), is_flat: false };
    assert_eq!(grow(&same, &pair, &times(2), here).unwrap_err(), StructureError::NoExtent { x: 5.0, y: 5.0 });
    let grown = grow(&same, &pair, &times(2), Settings { root: Some([5.0, 45.0]), is_flat: false }).unwrap();
    let at = grown.skeleton.places(grown.skeleton.directions(1));
    assert!(
        at.len() == 4 && at[2..].iter().all(|at| distance(*at, placed([5.0, 5.0], 0.0)) < 1e-9),
        "{at:?}"
    );
    // One track, of one frame.
    let one = tree(&Dendrogram::new(1, vec![]).unwrap(), 1, &[true]);
    let grown = grow(&still(&[[5.0, 5.0]], 1), &one, &times(1), flat()).unwrap();
    assert_eq!(grown.skeleton.joints().len(), 2);
}

proptest! {
    /// No other shift changes bones less by more than one hundredth.
    #[test]
    fn no_other_shift_is_better(values in prop::collection::vec(-50.0..50.0_f64, 60)) {
        let path = |k: usize| Path {
            track: TrackId(k as u32),
            at: (0..10).map(|t| Some([values[k * 20 + 2 * t], 100.0 + values[k * 20 + 2 * t + 1]])).collect(),
        };
        let paths = [path(0), path(1), path(2)];
        let groups = tree(&merges(&[(0, 1, 2), (3, 2, 3)]), 3, &[true; 3]);
        let at = |k: usize| paths[k].at.iter().map(|at| placed(at.unwrap(), 0.0)).collect::<Vec<_>>();
        let mean = |a: &[[f64; 3]], b: &[[f64; 3]]| {
            a.iter().zip(b).map(|(a, b)| std::array::from_fn(|k| f64::midpoint(a[k], b[k]))).collect::<Vec<_>>()
        };
        let inner = mean(&at(0), &at(1));
        let (origin, whole) = (vec![placed(GROUND, 0.0); 10], mean(&inner, &at(2)));
        let times = FrameTimes::constant(10, 25.0).unwrap();
        let grown = grow(&paths, &groups, &times, flat()).unwrap();
        let unrest = |alpha: f64| shift::unrest(&origin, &whole, &[&inner, &at(2)], alpha);
        prop_assert!((0.0..=1.0).contains(&grown.alphas[0]));
        let found = unrest(grown.alphas[0]);
        let least = (0..=1000).map(|k| unrest(f64::from(k) / 1000.0)).fold(f64::INFINITY, f64::min);
        prop_assert!(found <= least * 1.01 + 1e-5, "{found} at {}, {least} elsewhere", grown.alphas[0]);
    }
}
