//! Against angles measured in the picture, and what turning must not change.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Joint, Leaf};
use honami_model::track::TrackId;

use super::*;
use crate::turn::{dot, norm};

const N_FRAMES: u32 = 12;

/// A plant that forks in two `n_levels` times, every fork about 0.5 rad to both sides, swinging; `depth` bends it out of the
/// picture.
fn plant(n_levels: u32, depth: f64) -> Skeleton {
    forked(n_levels, depth, |k| 0.5 + 0.15 * (k as f64 * 1.7).sin())
}

/// The same with forks of other angles, radians.
fn forked(n_levels: u32, depth: f64, angle_of: impl Fn(usize) -> f64) -> Skeleton {
    let n = 1_usize << n_levels;
    let of_heap = |k: usize| (k > 1).then_some(k as u32 / 2);
    let joint = |k: usize| Joint {
        parent: if k == 0 { None } else { Some(of_heap(k).unwrap_or(0)) },
        length: if k == 0 { 0.0 } else { 100.0 * 0.7_f64.powi(k.ilog2() as i32) },
        ..Joint::default()
    };
    let mut directions = Vec::new();
    for t in 0..N_FRAMES {
        let mut angles = vec![0.0; n];
        directions.push(UP);
        for k in 1..n {
            let side = if k % 2 == 0 { -1.0 } else { 1.0 };
            let turn = if k == 1 { 0.1 } else { side * angle_of(k) };
            let swing = 0.05 * (f64::from(t) * 0.6 + k as f64).sin();
            angles[k] = angles[k / 2] + turn + swing;
            let y = depth * (k as f64).cos();
            let flat = (1.0 - y * y).sqrt();
            directions.push([flat * angles[k].sin(), y, flat * angles[k].cos()]);
        }
    }
    let leaf = |k: u32| Leaf {
        track: TrackId(k),
        joint: k % n as u32,
        offsets: (0..N_FRAMES).map(|t| [3.0, f64::from(k), 0.3 * f64::from(t)]).collect(),
    };
    let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
    let joints = (0..n).map(joint).collect();
    Skeleton::new([300.0, 0.0, -500.0], joints, directions, times)
        .unwrap()
        .with_leaves((0..40).map(leaf).collect())
        .unwrap()
}

/// By how much a bone turns off the one that bears it, in the picture, to the right.
fn turn_in_picture(skeleton: &Skeleton, directions: &[[f64; 3]], row: usize) -> f64 {
    let parent = skeleton.joints()[row].parent.unwrap() as usize;
    let of = |v: [f64; 3]| v[0].atan2(v[2]);
    let from = if parent == 0 { 0.0 } else { of(directions[parent]) };
    (of(directions[row]) - from).sin().asin()
}

#[test]
fn bones_turn_otherwise_and_swing_alike() {
    let source = plant(5, 0.0);
    let siblings = Siblings::of(&source, Settings { level: Some(2), threshold: None }).unwrap();
    let sibling = siblings.draw(7, 1).unwrap();
    assert_eq!(siblings.levels().iter().map(|level| level.n_bones).collect::<Vec<_>>(), [4, 8, 16]);
    let mut n_moved = 0;
    for row in 1..32_usize {
        let level = row.ilog2();
        let rest = |skeleton: &Skeleton| turn_in_picture(skeleton, skeleton.rest(), row);
        let (was, is) = (rest(&source), rest(&sibling));
        n_moved += usize::from((is - was).abs() > 1e-6);
        if level < 2 {
            assert!((is - was).abs() < 1e-9, "level {level} stays: {was} {is}");
        } else {
            let of = &siblings.levels()[level as usize - 2];
            assert!(of.angles.density(is.abs()) >= of.threshold * (1.0 - 1e-6), "{row}: {is} {of:?}");
            assert!(was * is > 0.0, "to the same side: {was} {is}");
        }
        for t in 0..N_FRAMES {
            let swing =
                |skeleton: &Skeleton| turn_in_picture(skeleton, skeleton.directions(t), row) - rest(skeleton);
            assert!((swing(&source) - swing(&sibling)).abs() < 1e-9, "bone {row}, frame {t}");
            assert!(sibling.directions(t)[row][1].abs() < 1e-15, "it stays in the picture");
        }
        assert_eq!(sibling.joints()[row], source.joints()[row]);
    }
    assert_eq!(n_moved, 28);
}

/// Where some bones go nearly straight on, the density that is fitted reaches over to the other side.
#[test]
fn bones_that_hardly_turn_off_keep_to_their_side() {
    let source = forked(5, 0.0, |k| [0.06, 0.1, 0.6, 0.7][k % 4]);
    let siblings = Siblings::of(&source, Settings { level: Some(2), threshold: None }).unwrap();
    let level = &siblings.levels()[0];
    assert!(level.angles.mu - level.drawn.half_width() < -0.05 && level.range()[0] == 0.0, "{level:?}");
    let (mut least, mut n_drawn) = (f64::INFINITY, 0);
    for number in 0..40 {
        let sibling = siblings.draw(5, number).unwrap();
        for row in 4..32_usize {
            let rest = |skeleton: &Skeleton| turn_in_picture(skeleton, skeleton.rest(), row);
            assert!(rest(&source) * rest(&sibling) > 0.0, "sibling {number}, bone {row}");
            (least, n_drawn) = (least.min(rest(&sibling).abs()), n_drawn + 1);
        }
    }
    assert!(least < 0.02, "and come near to straight on: {least} of {n_drawn}");
}

/// What a rigid turn keeps: how far a bone is from its rest, and how leaves lie beside it.
#[test]
fn in_depth_bones_are_turned_with_what_they_carry() {
    let source = plant(5, 0.4);
    let siblings = Siblings::of(&source, Settings { level: Some(0), threshold: Some(0.2) }).unwrap();
    let sibling = siblings.draw(3, 9).unwrap();
    for row in 1..32_usize {
        let from = |skeleton: &Skeleton| {
            let (from, to) = ends(skeleton, row);
            angle(from, to)
        };
        if let Some(of) = siblings.levels().iter().find(|level| level.level == row.ilog2()) {
            assert!(of.angles.density(from(&sibling)) >= of.threshold * (1.0 - 1e-6));
            assert!((from(&sibling) - from(&source)).abs() > 1e-9);
        } else {
            assert!((from(&sibling) - from(&source)).abs() < 1e-9, "one bone alone keeps its angle");
        }
        for t in 0..N_FRAMES {
            let swing = |skeleton: &Skeleton| angle(skeleton.rest()[row], skeleton.directions(t)[row]);
            assert!((swing(&source) - swing(&sibling)).abs() < 1e-7);
        }
    }
    for (was, is) in source.leaves().iter().zip(sibling.leaves()) {
        assert_eq!((was.track, was.joint), (is.track, is.joint));
        for t in 0..N_FRAMES {
            let along = |skeleton: &Skeleton, leaf: &Leaf| {
                let by = leaf.offsets[t as usize];
                [norm(by), dot(by, skeleton.directions(t)[leaf.joint as usize])]
            };
            let (was, is) = (along(&source, was), along(&sibling, is));
            assert!((was[0] - is[0]).abs() < 1e-9 && (was[1] - is[1]).abs() < 1e-9, "{was:?} {is:?}");
        }
    }
}

/// Angles of many siblings, with nothing cut off, are fitted by the distribution that they were drawn from.
#[test]
fn angles_are_drawn_from_what_was_fitted() {
    let source = plant(5, 0.0);
    let siblings = Siblings::of(&source, Settings { level: Some(4), threshold: Some(0.0) }).unwrap();
    let of = &siblings.levels()[0];
    let mut drawn = Vec::new();
    for number in 0..60 {
        let sibling = siblings.draw(11, number).unwrap();
        drawn.extend((16..32).map(|row| {
            turn_in_picture(&sibling, sibling.rest(), row) * if row % 2 == 0 { -1.0 } else { 1.0 }
        }));
    }
    let found = VonMises::fit(&drawn).unwrap();
    let sigma = (1.0 / (of.angles.kappa * 960.0)).sqrt();
    assert!((found.mu - of.angles.mu).abs() < 4.0 * sigma, "{found:?} {of:?}");
    assert!((found.kappa / of.angles.kappa - 1.0).abs() < 4.0 * (2.0 / 960.0_f64).sqrt(), "{found:?} {of:?}");
}

#[test]
fn a_sibling_is_known_by_seed_and_number() {
    let source = plant(4, 0.2);
    let siblings = Siblings::of(&source, Settings::default()).unwrap();
    let same = siblings.draw(1, 2).unwrap();
    assert_eq!(same, siblings.draw(1, 2).unwrap());
    for (seed, number) in [(1, 1), (2, 2), (2, 1)] {
        assert_ne!(same.rest(), siblings.draw(seed, number).unwrap().rest(), "{seed} {number}");
    }
    assert_eq!(siblings.levels().len(), 1, "of four levels, the last from level 3 on");
}

#[test]
fn what_cannot_differ_says_why() {
    let source = plant(4, 0.0);
    let none = |level| Siblings::of(&source, Settings { level: Some(level), threshold: None }).unwrap_err();
    assert_eq!(none(4), StructureError::NoLevel { wanted: 4, deepest: 3 });
    let trunk = plant(1, 0.0);
    let alone = Siblings::of(&trunk, Settings::default()).unwrap_err();
    assert_eq!(alone, StructureError::NoLevel { wanted: 0, deepest: 0 });
    let with = |threshold| Siblings::of(&source, Settings { level: Some(1), threshold: Some(threshold) });
    let Err(StructureError::Threshold { level, most, least, .. }) = with(1e9) else { panic!() };
    assert!(level == 1 && least <= most, "{level} {least} {most}");
    assert!(with(least).is_ok() && with(least + 1e-3).is_err(), "{least}");
    assert!(with(f64::NAN).is_err());
}
