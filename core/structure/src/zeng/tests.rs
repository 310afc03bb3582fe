//! Against plants worked out by hand, and against the formulas summed up anew.

use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::skeleton::seen;
use honami_model::track::TrackId;

use super::*;
use crate::bones::distance;
use crate::tree::tree;
use crate::turn::angle;

const N_FRAMES: u32 = 8;

fn times() -> FrameTimes {
    FrameTimes::constant(N_FRAMES, 25.0).unwrap()
}

/// Features that sway, each with a group of its own in a hierarchy of pairs: 2, 4, 8 … of them, fanned out over a trunk.
fn fan(n: u32) -> (Vec<Path>, Vec<Group>) {
    let path = |k: u32| {
        let angle = (f64::from(k) + 0.5) / f64::from(n) * 2.4 - 1.2;
        let far = 200.0 + 30.0 * (f64::from(k) * 2.3).sin();
        let sway = |t: u32| 0.03 * (f64::from(t) * 0.7 + f64::from(k)).sin();
        let at = |t: u32| {
            let angle = angle + sway(t);
            Some([300.0 + far * angle.sin(), 400.0 - far * angle.cos()])
        };
        Path { track: TrackId(k), at: (0..N_FRAMES).map(at).collect() }
    };
    ((0..n).map(path).collect(), tree(&pairs(n), n, &vec![true; n as usize]))
}

/// Neighbours merged, pairs of them, and so on.
fn pairs(n: u32) -> Dendrogram {
    let (mut merges, mut row) = (Vec::new(), 0);
    for level in 1..=n.ilog2() {
        for _ in 0..n >> level {
            merges.push(Merge { a: row, b: row + 1, height: f64::from(level), size: 1 << level });
            row += 2;
        }
    }
    Dendrogram::new(n, merges).unwrap()
}

fn rooted(settings: Settings) -> Settings {
    Settings { root: Some([300.0, 500.0]), ..settings }
}

fn flat() -> Settings {
    rooted(Settings { is_flat: true, ..Settings::default() })
}

fn rest(skeleton: &Skeleton) -> Vec<[f64; 3]> {
    skeleton.places(skeleton.rest())
}

/// One feature on the left and three on the right: the centroid of all is nearer to the three.
#[test]
fn joints_are_centroids_shifted_towards_what_bears_them() {
    let at = [[200.0, 300.0], [390.0, 200.0], [400.0, 190.0], [410.0, 210.0]];
    let path = |(k, &at): (u32, &[f64; 2])| Path { track: TrackId(k), at: vec![Some(at); N_FRAMES as usize] };
    let paths: Vec<Path> = (0..).zip(&at).map(path).collect();
    let merge = |a, b, height, size| Merge { a, b, height, size };
    let rows = vec![merge(1, 2, 1.0, 2), merge(4, 3, 2.0, 3), merge(0, 5, 3.0, 4)];
    let groups = tree(&Dendrogram::new(4, rows).unwrap(), 2, &[true; 4]);
    for (shift, wanted) in [
        (0.0, [[300.0, 500.0], [350.0, 225.0], [200.0, 300.0], [400.0, 200.0]]),
        (0.2, [[300.0, 500.0], [340.0, 280.0], [228.0, 296.0], [388.0, 216.0]]),
    ] {
        let grown = grow(&paths, &groups, &times(), &Settings { shift, ..flat() }).unwrap();
        let found: Vec<[f64; 2]> = rest(&grown.skeleton).into_iter().map(seen).collect();
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(
                (found[0] - wanted[0]).hypot(found[1] - wanted[1]) < 1e-9,
                "{shift}: {found:?} {wanted:?}"
            );
        }
        assert_eq!((found.len(), grown.alphas), (4, vec![1.0 - shift]));
    }
}

/// In its own plane a copy is what it was; out of it joints are pushed, a fifth of the width at most beside what bears them.
#[test]
fn copies_stand_round_the_trunk_and_move_as_the_plant_does() {
    let (paths, groups) = fan(8);
    let source = grow(&paths, &groups, &times(), &flat()).unwrap().skeleton;
    let n = source.joints().len();
    let places = source.places(source.directions(0));
    for copies in [1, 2, 3, 5] {
        let grown = grow(&paths, &groups, &times(), &rooted(Settings { copies, ..Settings::default() }));
        let skeleton = grown.unwrap().skeleton;
        let n_copies = copies as usize;
        assert_eq!(skeleton.joints().len(), 2 + n_copies * (n - 2), "they share root and trunk");
        assert_eq!(skeleton.leaves().len(), 8 * n_copies);
        let at = skeleton.places(skeleton.directions(0));
        let mut pushed = vec![0.0; at.len()];
        for (row, joint) in skeleton.joints().iter().enumerate().skip(2) {
            let (copy, of) = ((row - 2) / (n - 2), (row - 2) % (n - 2) + 2);
            let turn = std::f64::consts::PI / n_copies as f64 * copy as f64;
            let (dx, dy) = (at[row][0] - places[1][0], at[row][1]);
            let along = dx * turn.cos() + dy * turn.sin();
            pushed[row] = dy * turn.cos() - dx * turn.sin();
            assert!((along - (places[of][0] - places[1][0])).abs() < 1e-6, "copy {copy}, joint {of}");
            assert!((at[row][2] - places[of][2]).abs() < 1e-6);
            let beside = pushed[row] - pushed[joint.parent.unwrap() as usize];
            let width = 2.0 * 230.0 * 1.2_f64.sin();
            assert!(beside.abs() <= 0.2 * width, "{beside}");
            assert_eq!(joint.groups, source.joints()[of].groups);
            for t in 0..N_FRAMES {
                let place = |skeleton: &Skeleton, row: usize| {
                    let at = skeleton.places(skeleton.directions(t));
                    [at[row][0] - at[1][0], at[row][1], at[row][2]]
                };
                let ([dx, dy, z], [wanted_x, _, wanted_z]) = (place(&skeleton, row), place(&source, of));
                let along = dx * turn.cos() + dy * turn.sin();
                assert!((along - wanted_x).abs() < 1e-6 && (z - wanted_z).abs() < 1e-6, "frame {t}");
                assert!((dy * turn.cos() - dx * turn.sin() - pushed[row]).abs() < 1e-6, "frame {t}");
            }
        }
        let farthest = pushed.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
        assert!(farthest > 10.0, "branches leave their planes: {farthest}");
        for leaf in skeleton.leaves() {
            let was = &source.leaves()[leaf.track.0 as usize];
            let far = |by: [f64; 3]| distance(by, [0.0; 3]);
            assert!((far(leaf.offsets[3]) - far(was.offsets[3])).abs() < 1e-9);
        }
    }
}

/// The sum of the distances from all attractors to the nearest joint (5.9).
fn total(omega: &[[f64; 3]], x: &[[f64; 3]]) -> f64 {
    let nearest = |w: &[f64; 3]| x.iter().map(|at| distance(*w, *at)).fold(f64::INFINITY, f64::min);
    omega.iter().map(nearest).sum()
}

/// By how much a bone turns off the one before, at these places and with its joint at another.
fn bend(x: &[[f64; 3]], joint: &push::Pushed, place: [f64; 3]) -> f64 {
    let bone = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    angle(bone(x[joint.parent], x[joint.before.unwrap()]), bone(place, x[joint.parent]))
}

/// The best of the places tried, by Zeng's 5.6 to 5.10 written out: distances to all joints so far summed anew.
#[test]
fn a_joint_takes_the_place_of_the_highest_probability() {
    let crown = [[300.0, -500.0], [100.0, -250.0], [300.0, -50.0], [480.0, -260.0]];
    let envelope = Envelope::around(&crown, 300.0);
    let omega = envelope.attractors();
    let flat = |x, z| [x, 0.0, z];
    let before = [
        flat(300.0, -500.0),
        flat(300.0, -300.0),
        flat(220.0, -220.0),
        flat(390.0, -230.0),
        flat(304.0, -285.0),
        flat(232.0, -208.0),
    ];
    let along = [0.0, 1.0, 0.0];
    let joint = |row, parent, before, level| push::Pushed { row, parent, before: Some(before), level, along };
    let joints = [joint(2, 1, 0, 1), joint(3, 1, 0, 1), joint(4, 1, 0, 20), joint(5, 2, 1, 20)];
    let mut at = before.to_vec();
    push::push(&joints, &mut at, &[0, 1], &envelope, 380.0);
    let angles = joints.iter().map(|j| bend(&before, j, before[j.row]));
    let (s, c) = angles.fold((0.0, 0.0), |(s, c), a| (s + a.sin(), c + a.cos()));
    let mut x = at[..2].to_vec();
    for j in &joints {
        let [left, _, up] = before[j.row];
        let y = before[j.row][1] + at[j.parent][1];
        let tried: Vec<[f64; 3]> = (-20..=20).map(|k| [left, y + 3.8 * f64::from(k), up]).collect();
        let gain = |place: &[f64; 3]| {
            let with: Vec<[f64; 3]> = x.iter().copied().chain([*place]).collect();
            if envelope.holds(*place) { total(&omega, &x) - total(&omega, &with) } else { 0.0 }
        };
        let gains: Vec<f64> = tried.iter().map(gain).collect();
        let sigma = std::f64::consts::PI * f64::from(20 - j.level + 1) / 21.0;
        let probability = |k: usize| {
            let local = (-(bend(&at, j, tried[k]) - f64::atan2(s, c)).powi(2) / (2.0 * sigma * sigma)).exp();
            local * gains[k] / gains.iter().sum::<f64>()
        };
        let most = (0..41).map(probability).fold(0.0, f64::max);
        let k = tried.iter().position(|place| (place[1] - at[j.row][1]).abs() < 1e-9).unwrap();
        assert!(probability(k) > most * (1.0 - 1e-6) && most > 0.0, "joint {}", j.row);
        x.push(at[j.row]);
    }
}

/// Beside every attractor is a joint that stays, so that no place is nearer to any: errata Z9.
#[test]
fn where_nothing_is_gained_angles_decide() {
    let envelope = Envelope::around(&[[-60.0, -60.0], [60.0, -60.0], [60.0, 60.0], [-60.0, 60.0]], 0.0);
    // One bone goes straight on, one turns off by a right angle: half of that is expected of either.
    let mut at = vec![[0.0; 3], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0]];
    let first = at.len();
    at.extend(envelope.attractors().iter().map(|[x, y, z]| [*x, *y, z + 0.1]));
    let still: Vec<usize> = (first..at.len()).collect();
    let joint = |row| push::Pushed { row, parent: 0, before: None, level: 0, along: [0.0, 1.0, 0.0] };
    let by = push::push(&[joint(1), joint(2)], &mut at, &still, &envelope, 100.0);
    // Whatever the second is pushed by, its angle stays; of equals the nearest is taken.
    assert_eq!((by[1], by[2], at[1]), (10.0, 0.0, [0.0, 10.0, 10.0]));
}

#[test]
fn a_joint_where_all_attractors_are_stays() {
    let envelope = Envelope::around(&[[0.0, 0.0]], 0.0);
    let joint = push::Pushed { row: 1, parent: 0, before: None, level: 0, along: [0.0, 1.0, 0.0] };
    let mut at = vec![[0.0; 3], [0.0; 3]];
    let by = push::push(&[joint], &mut at, &[0], &envelope, 100.0);
    assert_eq!((by, at), (vec![0.0; 2], vec![[0.0; 3]; 2]));
}

#[test]
fn an_envelope_is_as_wide_all_round_as_on_its_wider_side() {
    // A triangle on its tip: 10 to the left of the axis and 30 to the right, 40 high.
    let envelope = Envelope::around(&[[100.0, 0.0], [90.0, 40.0], [130.0, 40.0], [101.0, 30.0]], 100.0);
    for (place, is_in) in [
        ([115.0, 0.0, 20.1], true),
        ([85.0, 0.0, 20.1], true),
        ([100.0, -15.0, 20.1], true),
        ([84.8, 0.0, 20.0], false),
        ([111.0, 11.0, 20.0], false),
        ([100.0, 0.0, 0.0], true),
        ([100.0, 0.0, 40.1], false),
        ([100.0, 0.0, -0.1], false),
    ] {
        assert_eq!(envelope.holds(place), is_in, "{place:?}");
    }
    let attractors = envelope.attractors();
    assert_eq!(attractors.len(), 256);
    let mut n_on_top = 0;
    for [x, y, z] in attractors {
        let far = (x - 100.0).hypot(y);
        n_on_top += usize::from(z > 39.9);
        assert!((far - 0.75 * z).abs() < 0.2 || z > 39.8, "{far} at {z}");
    }
    // Evenly along 50 px of the wall, and 30 px of the lid.
    assert_eq!(n_on_top, 6 * 16);
}

/// White as far as `reach` from the trunk, in rows of a clip of 600 x 520.
fn painted(rows: std::ops::Range<usize>, reach: i64) -> Alpha {
    let pixel = |k: usize| {
        let (x, y) = ((k % 600) as i64, k / 600);
        if rows.contains(&y) && (x - 300).abs() <= reach { 255 } else { 0 }
    };
    Alpha { width: 600, pixels: (0..600 * 520).map(pixel).collect() }
}

#[test]
fn white_on_one_side_is_turned_about_to_the_other() {
    // Two rows of eight; white are pixels 1 and 2 of the lower one.
    let mut pixels = vec![0; 16];
    pixels[9..11].fill(128);
    let envelope = Envelope::painted(&Alpha { width: 8, pixels }, 4.0).unwrap();
    for (x, z, is_in) in
        [(0.5, -1.0, true), (7.5, -1.4, true), (7.6, -1.0, false), (4.0, 0.0, false), (4.0, -2.0, false)]
    {
        assert_eq!(envelope.holds([x, 0.0, z]), is_in, "{x} {z}");
    }
}

#[test]
fn branches_outside_a_painted_envelope_are_cut_and_those_inside_fill_it() {
    let (paths, groups) = fan(8);
    let with = |envelope: Alpha| {
        grow(&paths, &groups, &times(), &rooted(Settings { envelope: Some(envelope), ..Settings::default() }))
    };
    let whole = with(painted(0..520, 290)).unwrap();
    assert_eq!((whole.n_cut, whole.skeleton.leaves().len()), (0, 24));
    let narrow = with(painted(0..520, 80)).unwrap();
    assert!((1..14).contains(&narrow.n_cut), "{}", narrow.n_cut);
    let n_tips = narrow.skeleton.joints().iter().filter(|joint| !joint.groups.is_empty()).count();
    assert!(n_tips < 24 && narrow.skeleton.leaves().len() == n_tips, "cut branches have no leaves");
    let axis = rest(&narrow.skeleton)[1][0];
    for [x, y, _] in rest(&narrow.skeleton) {
        let reach = 80.5 + (axis - 300.0).abs();
        assert!((x - axis).hypot(y) <= reach + 1e-6, "{x} {y}");
    }
    assert_eq!(with(painted(0..520, -1)).unwrap_err(), StructureError::NoWhite);
    assert_eq!(with(Alpha { width: 0, pixels: Vec::new() }).unwrap_err(), StructureError::NoWhite);
    assert_eq!(with(painted(0..2, 200)).unwrap_err(), StructureError::AllCut);
}

#[test]
fn what_is_out_of_range_says_so() {
    let (paths, groups) = fan(4);
    let with = |settings: Settings| grow(&paths, &groups, &times(), &settings).unwrap_err();
    for shift in [-0.1, 1.0, 3.0] {
        assert_eq!(with(Settings { shift, ..flat() }), StructureError::Shift(shift));
    }
    assert!(matches!(with(Settings { shift: f64::NAN, ..flat() }), StructureError::Shift(_)));
    assert_eq!(with(Settings { copies: 0, ..flat() }), StructureError::Copies);
    let copies = u32::MAX;
    let error = with(Settings { copies, is_flat: false, ..flat() });
    let bytes = 24 * paths.len() as u64 * u64::from(times().len()) * u64::from(copies);
    let gigabytes = bytes.div_ceil(1_000_000_000);
    assert_eq!(error, StructureError::TooManyLeaves { copies, gigabytes });
}
