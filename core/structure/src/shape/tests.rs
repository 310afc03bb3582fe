//! Against places and angles worked out by hand, and what no turn may change.

use std::f64::consts::{FRAC_PI_2, PI};

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Joint, seen};
use honami_model::track::TrackId;
use honami_model::turn::cross;

use super::*;
use crate::turn::{dot, norm};

const N_FRAMES: u32 = 16;

/// Bones in the picture, each by what bears it, its length, and its angle off straight up, clockwise, in every frame.
type Bones<'a> = &'a [(u32, f64, &'a dyn Fn(f64) -> f64)];

fn joints(bones: Bones) -> Vec<Joint> {
    let joint =
        |&(parent, length, _): &(u32, f64, _)| Joint { parent: Some(parent), length, ..Joint::default() };
    [Joint::default()].into_iter().chain(bones.iter().map(joint)).collect()
}

/// A leaf half-way along every bone, and one beside it.
fn leaves(skeleton: Skeleton) -> Skeleton {
    let leaf = |(row, beside): (usize, f64)| Leaf {
        track: TrackId(row as u32),
        joint: row as u32,
        offsets: (0..skeleton.times().len())
            .map(|frame| {
                let along = skeleton.directions(frame)[row];
                let across = cross(along, AWAY);
                std::array::from_fn(|k| 8.0 * along[k] + beside * across[k])
            })
            .collect(),
    };
    let all: Vec<Leaf> =
        (0..skeleton.joints().len()).flat_map(|row| [(row, 0.0), (row, 3.0)]).map(leaf).collect();
    skeleton.with_leaves(all).unwrap()
}

fn in_picture(bones: Bones) -> Skeleton {
    let way = |angle: f64| [angle.sin(), 0.0, angle.cos()];
    let of_frame = |t: u32| {
        let bones = bones.iter().map(move |(_, _, angle)| way(angle(f64::from(t))));
        [UP].into_iter().chain(bones)
    };
    let directions = (0..N_FRAMES).flat_map(of_frame).collect();
    let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
    leaves(Skeleton::new([300.0, 0.0, -500.0], joints(bones), directions, times).unwrap())
}

/// A bone that swings evenly to both sides of an angle, so that it is at rest there.
fn swinging(at: f64, by: f64) -> impl Fn(f64) -> f64 {
    move |t| at + by * (2.0 * PI * t / f64::from(N_FRAMES)).sin()
}

fn still(at: f64) -> impl Fn(f64) -> f64 {
    move |_| at
}

fn degrees(plane: f64, lean: f64, gain: f64) -> Shape {
    Shape { plane_rad: plane.to_radians(), lean_rad: lean.to_radians(), gain }
}

/// The skeleton with the bones of these rows shaped.
fn with(skeleton: &Skeleton, shapes: &[(usize, Shape)]) -> Skeleton {
    let mut by = vec![Shaped { shape: Shape::default(), copy_of: None }; skeleton.joints().len()];
    shapes.iter().for_each(|(row, shape)| by[*row].shape = *shape);
    shaped(skeleton, &by).unwrap()
}

fn near(a: [f64; 3], b: [f64; 3], within: f64) -> bool {
    norm(std::array::from_fn(|k| a[k] - b[k])) < within
}

/// A trunk, two branches on it, one of which bears another, all swinging.
fn plant() -> Skeleton {
    in_picture(&[
        (0, 100.0, &swinging(0.1, 0.2)),
        (1, 80.0, &swinging(0.7, -0.3)),
        (1, 60.0, &swinging(-0.6, 0.4)),
        (2, 40.0, &swinging(1.2, 0.5)),
    ])
}

#[test]
fn a_still_bone_points_where_it_is_worked_out_to_point() {
    for (angle, plane, lean) in [
        (0.0, 90.0, 0.0),
        (30.0, 90.0, 0.0),
        (30.0, 30.0, 0.0),
        (-70.0, -60.0, 0.0),
        (20.0, 0.0, 35.0),
        (20.0, 50.0, 35.0),
    ] {
        let bone = still(f64::to_radians(angle));
        let skeleton = in_picture(&[(0, 100.0, &bone)]);
        let made = with(&skeleton, &[(1, degrees(plane, lean, 1.0))]);
        // Seen in the picture it leans, foreshortened, and what is missing is behind it.
        let (s, c) = f64::to_radians(angle + lean).sin_cos();
        let (depth, short) = f64::to_radians(plane).sin_cos();
        let wanted = [100.0 * short * s, 100.0 * depth, 100.0 * short * c];
        let from_root = |place: [f64; 3]| std::array::from_fn(|k| place[k] - skeleton.root()[k]);
        let place = made.places(made.directions(3))[1];
        assert!(near(from_root(place), wanted, 1e-12 * 100.0), "{angle} {plane} {lean}: {place:?}");
        let [x, y] = seen(place);
        let length = (x - 300.0).hypot(y - 500.0);
        assert!((length - 100.0 * short.abs()).abs() < 1e-10, "as cos of the plane: {length}");
    }
}

#[test]
fn motion_stays_in_the_plane_that_was_turned() {
    let (at, by, plane) = (0.4, 0.3, 0.9);
    let curve = swinging(at, by);
    let skeleton = in_picture(&[(0, 100.0, &curve)]);
    let made = with(&skeleton, &[(1, Shape { plane_rad: plane, ..Shape::default() })]);
    // At right angles to the plane: what was so to the picture, turned along with the bone.
    let normal = [-plane.sin() * at.sin(), plane.cos(), -plane.sin() * at.cos()];
    let rest = [plane.cos() * at.sin(), plane.sin(), plane.cos() * at.cos()];
    for t in 0..N_FRAMES {
        let direction = made.directions(t)[1];
        assert!(dot(normal, direction).abs() < 1e-14, "frame {t}: {direction:?}");
        let swung = dot(cross(rest, direction), normal).atan2(dot(rest, direction));
        assert!(
            (swung - (curve(f64::from(t)) - at)).abs() < 1e-14,
            "frame {t}: as far, the same way: {swung}"
        );
    }
}

#[test]
fn what_a_bone_bears_goes_along() {
    let (up, right) = (still(0.0), still(PI / 6.0));
    let chain = in_picture(&[(0, 100.0, &up), (1, 50.0, &right)]);
    let (s, c) = (0.5, 0.75_f64.sqrt());
    for (shapes, bearer, borne) in [
        // The bearer falls back, and the other with it, to the same side of it.
        (vec![(1, degrees(90.0, 0.0, 1.0))], [0.0, 1.0, 0.0], [s, c, 0.0]),
        // The other was turned into the depth before: it now points down.
        (vec![(1, degrees(90.0, 0.0, 1.0)), (2, degrees(90.0, 0.0, 1.0))], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]),
        (vec![(1, degrees(0.0, 90.0, 1.0))], [1.0, 0.0, 0.0], [c, 0.0, -s]),
        (vec![(2, degrees(0.0, -30.0, 1.0))], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
    ] {
        let made = with(&chain, &shapes);
        let directions = made.directions(0);
        assert!(near(directions[1], bearer, 1e-15), "{shapes:?}: {directions:?}");
        assert!(near(directions[2], borne, 1e-15), "{shapes:?}: {directions:?}");
    }
    // Leaves hang on their bones as they hung.
    let made = with(&plant(), &[(1, degrees(40.0, 20.0, 1.0)), (2, degrees(-70.0, 0.0, 0.5))]);
    for leaf in made.leaves().iter().filter(|leaf| leaf.joint > 0) {
        let is_beside = leaf.offsets[0].iter().map(|v| v * v).sum::<f64>() > 64.5;
        for (t, offset) in (0..).zip(&leaf.offsets) {
            let along = made.directions(t)[leaf.joint as usize];
            assert!((dot(*offset, along) - 8.0).abs() < 1e-12, "{leaf:?}");
            let aside = norm(std::array::from_fn(|k| offset[k] - 8.0 * along[k]));
            assert!((aside - if is_beside { 3.0 } else { 0.0 }).abs() < 1e-12, "{aside}");
        }
    }
}

#[test]
fn gain_is_of_the_turn_beside_what_bears_it() {
    let skeleton = plant();
    let between = |skeleton: &Skeleton, t: u32| {
        let directions = skeleton.directions(t);
        angle(directions[1], directions[2])
    };
    // It stands 0.6 off the trunk, and swings by half a radian about that.
    for (plane, lean) in [(0.0, 0.0), (50.0, 0.0), (-20.0, 25.0)] {
        let stiff = with(&skeleton, &[(2, degrees(plane, lean, 0.0))]);
        let first = between(&stiff, 0);
        assert!((1..N_FRAMES).all(|t| (between(&stiff, t) - first).abs() < 1e-14), "stiff: {plane} {lean}");
    }
    for gain in [0.5, 1.0, 2.0, 3.0] {
        let made = with(&skeleton, &[(2, degrees(0.0, 0.0, gain))]);
        for t in 0..N_FRAMES {
            let swing = -0.5 * (2.0 * PI * f64::from(t) / f64::from(N_FRAMES)).sin();
            let wanted = (0.6 + gain * swing).abs();
            assert!((between(&made, t) - wanted).abs() < 1e-14, "gain {gain}, frame {t}");
            let trunk = |skeleton: &Skeleton| skeleton.directions(t)[1].map(f64::to_bits);
            assert_eq!(trunk(&made), trunk(&skeleton), "what bears it moves as it did");
        }
    }
}

#[test]
fn gain_is_of_spherical_angles_in_depth() {
    // It goes round a cone, 0.2 about its axis, which lies in the depth.
    let (axis, u, v) = ([0.6, 0.0, 0.8], [0.8, 0.0, -0.6], [0.0, 1.0, 0.0]);
    let direction = |t: u32, by: f64| {
        let turn = 2.0 * PI * f64::from(t) / f64::from(N_FRAMES);
        let ((s, c), (b, a)) = (turn.sin_cos(), by.sin_cos());
        std::array::from_fn(|k| a * axis[k] + b * (c * u[k] + s * v[k]))
    };
    let bone: &dyn Fn(f64) -> f64 = &still(0.0);
    let directions = (0..N_FRAMES).flat_map(|t| [UP, direction(t, 0.2)]).collect();
    let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
    let skeleton = Skeleton::new([0.0; 3], joints(&[(0, 10.0, bone)]), directions, times).unwrap();
    let made = with(&skeleton, &[(1, degrees(0.0, 0.0, 2.5))]);
    for t in 0..N_FRAMES {
        assert!(near(made.directions(t)[1], direction(t, 0.5), 1e-14), "frame {t}");
    }
}

#[test]
fn nothing_else_changes() {
    let skeleton = plant();
    assert_eq!(with(&skeleton, &[]), skeleton, "to the last bit");
    assert_eq!(shaped(&skeleton, &[]).unwrap(), skeleton);
    let made = with(&skeleton, &[(2, degrees(33.0, 12.0, 1.7))]);
    assert_eq!(made.joints(), skeleton.joints(), "lengths stay");
    for t in 0..N_FRAMES {
        for row in [1, 3] {
            let bits = |skeleton: &Skeleton| skeleton.directions(t)[row].map(f64::to_bits);
            assert_eq!(bits(&made), bits(&skeleton), "not borne by it");
        }
        assert!(angle(made.directions(t)[4], skeleton.directions(t)[4]) > 0.1, "borne by it");
    }
    for (is, was) in made.leaves().iter().zip(skeleton.leaves()) {
        assert_eq!(is == was, ![2, 4].contains(&was.joint), "{was:?}");
    }
    // Undone by its own contrary, where nothing else is done to it.
    let back = with(&with(&skeleton, &[(1, degrees(0.0, 25.0, 1.0))]), &[(1, degrees(0.0, -25.0, 1.0))]);
    for t in 0..N_FRAMES {
        let pairs = back.directions(t).iter().zip(skeleton.directions(t));
        pairs.for_each(|(is, was)| assert!(near(*is, *was, 1e-14), "frame {t}: {is:?} {was:?}"));
    }
}

/// From a direction in the picture to that of a copy.
type Carry<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// A skeleton in depth and its copies, on one root: each joint's directions brought to the others by `carries`.
fn copied(carries: &[Carry]) -> (Skeleton, Vec<Option<u32>>) {
    let one = plant();
    let (n, base) = (one.joints().len() - 1, one.joints());
    // Out of the picture, so that a copy is not the same.
    let deep = |row: usize, [x, _, z]: [f64; 3]| {
        let depth: f64 = 0.1 * row as f64;
        let flat = (1.0 - depth * depth).sqrt();
        [flat * x, depth, flat * z]
    };
    let mut joints = base.to_vec();
    let mut copy_of = vec![None; n + 1];
    for number in 1..=carries.len() as u32 {
        for (row, joint) in (0..).zip(base).skip(1) {
            let parent = joint.parent.map(|parent| if parent == 0 { 0 } else { parent + number * n as u32 });
            joints.push(Joint { parent, ..joint.clone() });
            copy_of.push(Some(row));
        }
    }
    let mut directions = Vec::new();
    for t in 0..N_FRAMES {
        let now: Vec<[f64; 3]> = (0..).zip(one.directions(t)).map(|(row, d)| deep(row, *d)).collect();
        directions.extend(&now);
        carries.iter().for_each(|carry| directions.extend(now[1..].iter().map(|d| carry(*d))));
    }
    directions.iter_mut().step_by(1 + n * (carries.len() + 1)).for_each(|of_root| *of_root = UP);
    (Skeleton::new(one.root(), joints, directions, one.times().clone()).unwrap(), copy_of)
}

#[test]
fn copies_are_turned_as_they_look_to_themselves() {
    let about_upright = |by: f64| {
        let (s, c) = by.sin_cos();
        move |[x, y, z]: [f64; 3]| [c * x - s * y, s * x + c * y, z]
    };
    let mirrored = |[x, y, z]: [f64; 3]| [x, -y, z];
    let (third, two_thirds, half) =
        (about_upright(PI / 3.0), about_upright(2.0 * PI / 3.0), about_upright(FRAC_PI_2));
    let cases: [&[Carry]; 3] = [&[&mirrored], &[&third, &two_thirds], &[&half]];
    for carries in cases {
        let (skeleton, copy_of) = copied(carries);
        let shape = |row: usize| match row {
            1 => degrees(25.0, -15.0, 1.0),
            2 => degrees(-70.0, 30.0, 2.0),
            _ => Shape::default(),
        };
        let by: Vec<Shaped> = (0..)
            .zip(&copy_of)
            .map(|(row, copy_of)| Shaped {
                shape: shape(copy_of.map_or(row, |of: u32| of as usize)),
                copy_of: *copy_of,
            })
            .collect();
        let made = shaped(&skeleton, &by).unwrap();
        let n = plant().joints().len() - 1;
        for t in 0..N_FRAMES {
            let directions = made.directions(t);
            assert!(angle(directions[2], skeleton.directions(t)[2]) > 0.3);
            for (number, carry) in (1..).zip(carries) {
                for row in 1..=n {
                    let (is, wanted) = (directions[row + number * n], carry(directions[row]));
                    assert!(
                        near(is, wanted, 1e-12),
                        "copy {number}, bone {row}, frame {t}: {is:?} {wanted:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_copy_that_was_pushed_or_does_not_move_is_turned_as_it_stands() {
    let angle_of = |by: f64, pushed: f64, curve: &dyn Fn(f64) -> f64| {
        let (s, c) = by.sin_cos();
        let copy = |[x, _, z]: [f64; 3]| {
            let flat = (1.0 - pushed * pushed).sqrt();
            [flat * c * x - s * pushed, flat * s * x + c * pushed, flat * z]
        };
        let flat = |t: u32| [curve(f64::from(t)).sin(), 0.0, curve(f64::from(t)).cos()];
        let directions = (0..N_FRAMES).flat_map(|t| [UP, flat(t), copy(flat(t))]).collect();
        let joints = joints(&[(0, 10.0, curve), (0, 10.0, curve)]);
        let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
        let skeleton = Skeleton::new([0.0; 3], joints, directions, times).unwrap();
        let [x, y, z] = side(&skeleton, &[[1, 2]]).away;
        assert!(z.abs() < 1e-15);
        (-x).atan2(y)
    };
    for by in [0.5, FRAC_PI_2, 2.5, -1.0] {
        let moving = angle_of(by, 0.4, &swinging(0.3, 0.2));
        assert!((moving - by).abs() < 1e-9, "{by}: {moving}");
        let is_still = angle_of(by, 0.0, &still(0.3));
        assert!((is_still - by).abs() < 1e-12, "{by}: {is_still}");
    }
}
