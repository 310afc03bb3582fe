//! Weights by closed forms, their symmetry, their smoothness; how plants are fitted; what cannot be bound.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Joint, Leaf};
use honami_model::track::TrackId;
use proptest::prelude::*;

use super::*;

fn skeleton(root: [f64; 3], bones: &[(u32, f64, [f64; 3])]) -> Skeleton {
    let mut joints = vec![Joint::default()];
    let mut directions = vec![[0.0, 0.0, 1.0]];
    for &(parent, length, direction) in bones {
        joints.push(Joint { parent: Some(parent), length, ..Joint::default() });
        directions.push(direction);
    }
    Skeleton::new(root, joints, directions, FrameTimes::constant(1, 25.0).unwrap()).unwrap()
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// Upright, of bones that are 1 long.
fn chain(n: u32) -> Skeleton {
    skeleton([0.0; 3], &(0..n).map(|parent| (parent, 1.0, UP)).collect::<Vec<_>>())
}

/// A triangle for every vertex.
fn mesh(positions: &[[f64; 3]]) -> Mesh {
    let triangles = (0..positions.len() as u32).map(|row| [row; 3]).collect();
    Mesh { positions: positions.to_vec(), triangles, ..Mesh::default() }
}

/// The weight of every bone of so many.
fn weights(place: [f64; 3], skeleton: &Skeleton) -> Vec<f64> {
    let mut all = vec![0.0; skeleton.joints().len()];
    for (bone, weight) in bind(&mesh(&[place]), skeleton).unwrap()[0].shares() {
        all[bone] += weight;
    }
    all
}

fn near(found: &[f64], wanted: &[f64]) {
    let is_near = found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-6);
    assert!(is_near && found.len() == wanted.len(), "{found:?}, not {wanted:?}");
}

#[test]
fn weights_are_those_of_the_formula() {
    near(&weights([0.3, 0.0, 0.4], &chain(1)), &[0.0, 1.0]);
    // Beside the middle of the first of two: 0.5 off it, and sqrt(0.5) off the second; there is no fifth.
    near(&weights([0.5, 0.0, 0.5], &chain(2)), &[0.0, 4.0 / 6.0, 2.0 / 6.0]);
    // At height 4.5 beside the last of five: 1, sqrt(1.25), sqrt(3.25), sqrt(7.25) and, the fifth, sqrt(13.25) away.
    let rim = 13.25_f64.sqrt();
    let raw = [13.25_f64, 7.25, 3.25, 1.25, 1.0].map(|square| (1.0 / square.sqrt() - 1.0 / rim).powi(2));
    let total: f64 = raw.iter().sum();
    let wanted: Vec<f64> = std::iter::once(0.0).chain(raw.map(|v| v / total)).collect();
    near(&weights([1.0, 0.0, 4.5], &chain(5)), &wanted);
    // On a bone it is that one's alone; in a joint half each one's; where five meet the first four's.
    near(&weights([0.0, 0.0, 0.5], &chain(3)), &[0.0, 1.0, 0.0, 0.0]);
    near(&weights([0.0, 0.0, 1.0], &chain(3)), &[0.0, 0.5, 0.5, 0.0]);
    let far = |x: f64| (0, 1.0, [x, 0.0, (1.0 - x * x).sqrt()]);
    let star = skeleton([0.0; 3], &[0.0, 0.2, 0.4, 0.6, 0.8].map(far));
    near(&weights([0.0; 3], &star), &[0.0, 0.25, 0.25, 0.25, 0.25, 0.0]);
    near(&weights([0.0, 0.0, -1e-3], &star), &[0.0, 0.25, 0.25, 0.25, 0.25, 0.0]);
}

#[test]
fn a_straight_chain_is_parted_evenly() {
    for n in 2..9_u32 {
        let (chain, height) = (chain(n), f64::from(n));
        for k in 0..=40 {
            let at = height * f64::from(k) / 40.0;
            let [below, above] = [at, height - at].map(|z| weights([0.3, 0.1, z], &chain));
            let mirrored: Vec<f64> = std::iter::once(0.0).chain(above[1..].iter().rev().copied()).collect();
            near(&below, &mirrored);
        }
    }
}

/// No weight jumps on a walk past nine bones, though the four that carry change.
#[test]
fn weights_change_smoothly() {
    let chain = chain(9);
    let (mut before, mut carriers) = (None, std::collections::BTreeSet::new());
    for k in 0..=9000 {
        let now = weights([0.4, 0.0, f64::from(k) / 1000.0], &chain);
        carriers.insert(now.iter().map(|weight| *weight > 0.0).collect::<Vec<_>>());
        if let Some(before) = before.replace(now.clone()) {
            let jump = now.iter().zip(&before).map(|(a, b): (&f64, &f64)| (a - b).abs()).fold(0.0, f64::max);
            assert!(jump < 4e-3, "{jump} at {k}");
        }
    }
    assert!(carriers.len() > 5, "{carriers:?}");
}

#[test]
fn a_skeleton_is_fitted_to_a_plant_root_on_foot_and_as_high() {
    let trunk = mesh(&[[9.0, 4.0, 2.0], [11.0, 6.0, 2.0], [30.0, 5.0, 4.0], [10.0, 5.0, 8.0]]);
    let foot = foot(&trunk).unwrap();
    assert!(norm(less(foot, [10.0, 5.0, 2.0])) < 1e-12, "{foot:?}");
    let right = [1.0, 0.0, 0.0];
    let bent = skeleton([300.0, 0.0, -400.0], &[(0, 90.0, UP), (1, 50.0, right)]);
    let fit = |skeleton: &Skeleton, unit, turn| fitted(skeleton, &trunk, foot, unit, turn).unwrap();
    let ends = |skeleton: &Skeleton| skeleton.places(skeleton.rest());
    let far = |a: [f64; 3], b: [f64; 3]| norm(less(a, b));
    let high = ends(&fit(&bent, None, 0.0));
    assert!(far(high[0], foot) < 1e-12 && far(high[1], [10.0, 5.0, 8.0]) < 1e-12, "{high:?}");
    assert!(far(high[2], [10.0 + 50.0 / 15.0, 5.0, 8.0]) < 1e-12, "{high:?}");
    // A leaf, 30 px above the highest joint in the mean, makes it 120 px high.
    let leaf = Leaf { track: TrackId(0), joint: 2, offsets: vec![[5.0, 0.0, 30.0]] };
    let leafy = fit(&bent.clone().with_leaves(vec![leaf]).unwrap(), None, 0.0);
    assert!((ends(&leafy)[1][2] - (2.0 + 90.0 / 20.0)).abs() < 1e-12);
    assert!(far(leafy.leaves()[0].offsets[0], [0.25, 0.0, 1.5]) < 1e-12);
    let turned = ends(&fit(&bent, Some(0.1), std::f64::consts::FRAC_PI_2));
    assert!(far(turned[1], [10.0, 5.0, 11.0]) < 1e-12 && far(turned[2], [10.0, 10.0, 11.0]) < 1e-12);
    let lying = skeleton([0.0; 3], &[(0, 90.0, right)]);
    assert!(matches!(fitted(&lying, &trunk, foot, None, 0.0), Err(StructureError::NoHeight { .. })));
    assert!(fitted(&lying, &trunk, foot, Some(1.0), 0.0).is_ok());
    for unit in [0.0, -1.0, 1e-320, 1e10, f64::NAN, f64::INFINITY] {
        let error = fitted(&bent, &trunk, foot, Some(unit), 0.0).unwrap_err();
        assert!(matches!(error, StructureError::Unit(_)), "{unit}");
    }
    let tiny = skeleton([0.0; 3], &[(0, 1e-200, UP), (1, 1.0, UP)]);
    near(&weights([0.0, 0.0, -1.0], &tiny), &[0.0, 0.5, 0.5]);
    let flat = mesh(&[[0.0; 3], [1.0, 0.0, 0.0]]);
    assert!(matches!(fitted(&bent, &flat, [0.0; 3], None, 0.0), Err(StructureError::NoHeight { .. })));
}

#[test]
fn what_cannot_be_bound_is_named() {
    let chain = chain(2);
    let error = |mesh: &Mesh| bind(mesh, &chain).unwrap_err().to_string();
    assert!(error(&Mesh::default()).contains("a triangle at least"));
    assert!(error(&Mesh { triangles: Vec::new(), ..mesh(&[UP]) }).contains("a triangle at least"));
    assert!(error(&mesh(&[UP, [0.0, f64::NAN, 0.0]])).contains("vertex 1 lies at [0.0, NaN, 0.0]"));
    assert!(error(&mesh(&[[1e10, 0.0, 0.0]])).contains("vertex 0"));
    let broom = skeleton([0.0; 3], &vec![(0, 1.0, UP); 65_535]);
    assert_eq!(bind(&mesh(&[UP]), &broom).unwrap_err(), StructureError::TooManyBones(65_536));
}

proptest! {
    /// Against the weights of every bone, sorted out one by one.
    #[test]
    fn weights_are_those_of_the_four_nearest(
        place in prop::array::uniform3(-2.0..5.0_f64),
        bones in prop::collection::vec((0..40_u32, 0.2..2.0_f64, 0.0..6.2_f64, -1.5..1.5_f64), 1..12),
    ) {
        let bones: Vec<(u32, f64, [f64; 3])> = (1..).zip(&bones).map(|(n, &(parent, length, turn, up))| {
            (parent % n, length, [turn.cos() * up.cos(), turn.sin() * up.cos(), up.sin()])
        }).collect();
        let skeleton = skeleton([0.0; 3], &bones);
        let ends = skeleton.places(skeleton.rest());
        // By the nearest of many points along each bone.
        let far = |row: usize| {
            let base = ends[skeleton.joints()[row].parent.unwrap() as usize];
            (0..=4000).map(|k| {
                let share = f64::from(k) / 4000.0;
                norm(std::array::from_fn(|axis| place[axis] - base[axis] - share * (ends[row][axis] - base[axis])))
            }).fold(f64::INFINITY, f64::min)
        };
        let mut distances: Vec<(f64, usize)> = (1..=bones.len()).map(|row| (far(row), row)).collect();
        distances.sort_by(|a, b| a.0.total_cmp(&b.0));
        prop_assume!(distances[0].0 > 0.05);
        let rim = distances.get(4).map_or(0.0, |(fifth, _)| 1.0 / fifth);
        let mut wanted = vec![0.0; bones.len() + 1];
        distances.iter().take(4).for_each(|(far, row)| wanted[*row] = (1.0 / far - rim).powi(2));
        let total: f64 = wanted.iter().sum();
        prop_assume!(total > 1e-3);
        for (found, wanted) in weights(place, &skeleton).iter().zip(&wanted) {
            prop_assert!((found - wanted / total).abs() < 1e-2, "{} {}", found, wanted / total);
        }
    }
}

/// A scan has points that are of no surface: they say neither where it stands nor how large it is.
#[test]
fn vertices_of_no_triangle_do_not_count() {
    let of_surface = [[0.0, 0.0, 0.0], [1.0, 0.0, 4.0], [-2.0, 0.5, 2.0]];
    let clean = mesh(&of_surface);
    let mut scan = clean.clone();
    scan.positions.extend([[900.0, 0.0, 500.0], [0.0, -70.0, -800.0]]);
    near(&size(&clean), &[4.0, 3.0]);
    near(&size(&scan), &size(&clean));
    let [foot, of_scan] = [foot(&clean).unwrap(), foot(&scan).unwrap()];
    near(&foot, &of_scan);
    let chain = chain(2);
    let fit = |mesh: &Mesh| fitted(&chain, mesh, foot, None, 0.0).unwrap();
    assert_eq!(fit(&scan), fit(&clean));
    assert!((fit(&scan).joints()[1].length - 2.0).abs() < 1e-12, "two bones of 1 are as high as 4");
}
