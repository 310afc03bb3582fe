//! Places by hand; what is carried goes with its bone; what is drawn is as good as the best.

use honami_model::clip::FrameTimes;
use honami_model::plant::{Node, Plant};
use honami_model::skeleton::{Joint, Leaf};
use honami_model::track::TrackId;

use super::*;
use crate::blend::{Blend, blended, carries};

/// A stem of 2 that stands at (1, 2, 3) and sways, and a bone of 4 to the right, with such leaves, in the first of two frames.
fn two_bones(leaves: &[[f64; 3]]) -> Skeleton {
    let joint = |parent: u32, length: f64| Joint { parent: Some(parent), length, ..Joint::default() };
    let lean = |rad: f64| [rad.sin(), 0.0, rad.cos()];
    let quarter = std::f64::consts::FRAC_PI_2;
    let directions: Vec<[f64; 3]> = [[0.2, quarter + 0.7], [-0.2, quarter - 0.7]]
        .iter()
        .flat_map(|by| [[0.0, 0.0, 1.0], lean(by[0]), lean(by[1])])
        .collect();
    let leaf = |offset: &[f64; 3]| Leaf { track: TrackId(0), joint: 2, offsets: vec![*offset; 2] };
    let joints = vec![Joint::default(), joint(0, 2.0), joint(1, 4.0)];
    Skeleton::new([1.0, 2.0, 3.0], joints, directions, FrameTimes::constant(2, 25.0).unwrap())
        .unwrap()
        .with_leaves(leaves.iter().map(leaf).collect())
        .unwrap()
}

/// A triangle for every vertex.
fn mesh(positions: &[[f64; 3]]) -> Mesh {
    let triangles = (0..positions.len() as u32).map(|row| [row; 3]).collect();
    Mesh { positions: positions.to_vec(), triangles, ..Mesh::default() }
}

/// Upright, 2 high, four twigs of 0.5 half-way up.
const CROSS: [[f64; 3]; 6] =
    [[0.0; 3], [0.5, 0.0, 1.0], [0.0, 0.5, 1.0], [-0.5, 0.0, 1.0], [0.0, -0.5, 1.0], [0.0, 0.0, 2.0]];

fn near(found: [f64; 3], wanted: [f64; 3]) {
    assert!(norm(less(found, wanted)) < 1e-12, "{found:?}, not {wanted:?}");
}

#[test]
fn a_branch_lies_along_its_bone_from_foot_to_tip() {
    let rest = two_bones(&[]);
    // The same anywhere, leaning: its foot is its lowest vertex still.
    let lean = Turn::about([0.6, 0.8, 0.0], 0.5);
    let moved = CROSS.map(|place| {
        let there = lean.apply(place);
        [there[0] + 7.0, there[1] - 1.0, there[2] + 0.3]
    });
    for positions in [CROSS, moved] {
        let branch = Branch::of(&mesh(&positions), None).unwrap();
        assert!((branch.breadth() - 0.25).abs() < 1e-12, "{branch:?}");
        for seed in 0..9 {
            let [graft] = assemble(&rest, &[branch], seed, 0).unwrap()[..] else {
                panic!("one bone bears no other")
            };
            assert!((graft.bone, graft.branch) == (2, 0) && (graft.scale - 2.0).abs() < 1e-12, "{graft:?}");
            let at = positions.map(|place| graft.apply(place));
            near(at[0], [1.0, 2.0, 5.0]);
            near(at[5], [5.0, 2.0, 5.0]);
            // Twigs are 1 beside the middle, each a quarter turn on from the one before, as seen from the tip.
            for k in 1..5 {
                let (own, next) = (less(at[k], [3.0, 2.0, 5.0]), less(at[k % 4 + 1], [3.0, 2.0, 5.0]));
                assert!((norm(own) - 1.0).abs() < 1e-12 && own[0].abs() < 1e-12, "{own:?}");
                near(honami_model::turn::cross([1.0, 0.0, 0.0], own), next);
            }
            near(graft.turned(lean_of(&positions)), [1.0, 0.0, 0.0]);
        }
    }
}

/// Which way the cross points.
fn lean_of(positions: &[[f64; 3]; 6]) -> [f64; 3] {
    less(positions[5], positions[0]).map(|v| v / 2.0)
}

/// Ten leaves 1 to 10 from the base: nine tenths of them within 9, which is beyond the end of the bone; not so with two of three
/// before it.
#[test]
fn a_branch_reaches_as_far_as_the_leaves() {
    let branch = Branch::of(&mesh(&CROSS), None).unwrap();
    for (along, wanted) in [((1..=10).collect::<Vec<_>>(), 9.0), (vec![1, 2, 3], 4.0), (vec![1, 2, 6], 6.0)] {
        let leaves: Vec<[f64; 3]> = along.iter().map(|v| [f64::from(*v) - 4.0, 3.0, 0.0]).collect();
        let graft = assemble(&two_bones(&leaves), &[branch], 1, 0).unwrap()[0];
        near(graft.apply([0.0, 0.0, 2.0]), [1.0 + wanted, 2.0, 5.0]);
    }
}

#[test]
fn what_is_carried_goes_with_its_bone() {
    let rest = two_bones(&[]);
    let branch = Branch::of(&mesh(&CROSS), None).unwrap();
    let graft = assemble(&rest, &[branch], 3, 0).unwrap()[0];
    // A tenth of its length from the foot, and half of that.
    let places: Vec<[f64; 3]> = CROSS.into_iter().chain([[0.0, 0.0, 0.2], [0.0, 0.0, 0.1]]).collect();
    let bindings: Vec<Binding> = places.iter().map(|place| graft.binding(*place)).collect();
    let shares = |row: usize| bindings[row].shares().collect::<Vec<_>>();
    assert_eq!((shares(0), shares(1), shares(6)), (vec![(2, 0.5), (1, 0.5)], vec![(2, 1.0)], vec![(2, 1.0)]));
    assert_eq!(shares(7), [(2, 0.875), (1, 0.125)]);
    let at: Vec<[f64; 3]> = places.iter().map(|place| graft.apply(*place)).collect();
    for frame in 0..2 {
        let joints = rest.places(rest.directions(frame));
        let now = blended(&at, &bindings, &carries(&rest, &rest, frame), Blend::Linear);
        assert!(
            norm(less(now[0], joints[1])) < 1e-6 && norm(less(now[5], joints[2])) < 1e-6,
            "{now:?} {joints:?}"
        );
        for (a, b) in [(1, 2), (1, 5), (3, 4), (5, 6)] {
            let [was, is] = [&at, &now].map(|places| norm(less(places[a], places[b])));
            assert!((was - is).abs() < 1e-9, "rigid: {was} {is}");
        }
    }
}

/// A star of so many bones, each with leaves as far beside it as it is long, times `breadth`.
fn star(n: u32, breadth: Option<f64>) -> Skeleton {
    let joint = Joint { parent: Some(0), length: 1.0, ..Joint::default() };
    let joints: Vec<Joint> = [Joint::default()].into_iter().chain(vec![joint; n as usize]).collect();
    let leaf = |joint: u32, y: f64| Leaf { track: TrackId(joint), joint, offsets: vec![[0.0, y, 0.0]] };
    let leaves = |joint| breadth.iter().flat_map(move |v| [leaf(joint, *v), leaf(joint, -v)]);
    let directions = (0..=n).map(|k| [f64::from(k).sin(), 0.0, f64::from(k).cos()]).collect();
    Skeleton::new([0.0; 3], joints, directions, FrameTimes::constant(1, 25.0).unwrap())
        .unwrap()
        .with_leaves((1..=n).flat_map(leaves).collect())
        .unwrap()
}

#[test]
fn branches_are_as_broad_as_leaves_are_far_and_drawn_by_the_seed() {
    let of = |breadth: f64| {
        // Twigs near the foot, so that none of them is among what is outermost.
        let wide = CROSS.map(|[x, y, z]| [4.0 * breadth * x, 4.0 * breadth * y, 0.5 * z * z]);
        Branch::of(&mesh(&wide), None).unwrap()
    };
    let library = [of(0.1), of(0.8), of(0.7), of(0.3)];
    // Within a factor of e^0.25 beyond the best: 0.75 takes 0.8 and 0.7, 0.47 0.3 as well, 0.4 that alone.
    for (breadth, wanted) in [
        (Some(0.1), vec![0]),
        (Some(0.0), vec![0]),
        (Some(0.75), vec![1, 2]),
        (Some(9.0), vec![1, 2]),
        (Some(0.47), vec![1, 2, 3]),
        (Some(0.4), vec![3]),
        (None, vec![0, 1, 2, 3]),
    ] {
        let skeleton = star(200, breadth);
        let drawn = assemble(&skeleton, &library, 7, 0).unwrap();
        let found: std::collections::BTreeSet<usize> = drawn.iter().map(|graft| graft.branch).collect();
        assert!(found.into_iter().eq(wanted.clone()), "{breadth:?}: {wanted:?}");
        assert_eq!(drawn, assemble(&skeleton, &library, 7, 0).unwrap());
        for (seed, number) in [(8, 0), (7, 1)] {
            assert_ne!(drawn, assemble(&skeleton, &library, seed, number).unwrap());
        }
    }
}

#[test]
fn what_is_no_branch_says_why() {
    let ring = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    for (mesh, wanted) in [
        (Mesh::default(), "a triangle at least"),
        (mesh(&[[1.0, 2.0, 3.0]; 3]), "in this one both are one place, 0 from the farthest"),
        (mesh(&ring), "in this one both are one place, 1 from the farthest"),
        (mesh(&[[0.0, 0.0, f64::NAN]; 3]), "vertex 0 lies at"),
    ] {
        let error = Branch::of(&mesh, None).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    // Evenly about its foot it has no way to go, but its root may lie elsewhere.
    assert!(Branch::of(&mesh(&ring), Some([0.0, 0.0, -1.0])).is_ok());
    assert_eq!(assemble(&two_bones(&[]), &[], 1, 0), Err(StructureError::NoBranches));
}

/// A trunk of four nodes, a branch of two at the second with a twig of its own, and a stub.
#[test]
fn branches_of_a_plant_begin_at_its_forks() {
    let node =
        |parent: Option<u32>, x: f64, z: f64, radius: f64| Node { parent, position: [x, 0.0, z], radius };
    let trunk = [node(None, 0.0, 0.0, 4.0), node(Some(0), 0.0, 1.0, 4.0), node(Some(1), 0.0, 2.0, 3.0)];
    let more = [
        node(Some(1), 2.0, 1.0, 2.0),
        node(Some(2), 0.0, 3.0, 2.0),
        node(Some(2), 0.2, 2.0, 1.0),
        node(Some(3), 4.0, 1.0, 1.5),
        node(Some(3), 2.0, 2.0, 1.0),
    ];
    let plant = Plant::new(trunk.into_iter().chain(more).collect()).unwrap();
    let found = branches(&plant).unwrap();
    let places = |branch: &Plant| {
        branch.nodes().iter().map(|node| (node.parent, node.position[0])).collect::<Vec<_>>()
    };
    assert_eq!(found.len(), 2, "the stub reaches 0.2 of 4, the twig 1");
    assert_eq!(places(&found[0]), [(None, 0.0), (Some(0), 2.0), (Some(1), 4.0), (Some(1), 2.0)]);
    assert_eq!(places(&found[1]), [(None, 2.0), (Some(0), 2.0)]);
    assert!((found[0].nodes()[0].radius - 2.0).abs() < 1e-12, "as thick as the branch, not as the trunk");
    assert_eq!(branches(&Plant::new(trunk.to_vec()).unwrap()).unwrap(), []);
}

/// A comb of equal radii, a twig first at every node of its back: the back goes on, and is no branch.
#[test]
fn of_equals_the_one_that_goes_farthest_goes_on() {
    let comb = |n: u32, twig: f64| {
        let mut nodes = vec![Node { parent: None, position: [0.0; 3], radius: 1.0 }];
        for k in 0..n {
            let (parent, z) = (Some(nodes.len() as u32 - 1), f64::from(k));
            nodes.push(Node { parent, position: [2.0, 0.0, z], radius: twig });
            nodes.push(Node { parent, position: [0.0, 0.0, z + 1.0], radius: 1.0 });
        }
        Plant::new(nodes).unwrap()
    };
    let found = branches(&comb(10_000, 1.0)).unwrap();
    // At the last fork the twig goes farther, 2 instead of 1: what is left of the back there is a branch.
    assert_eq!(found.len(), 10_000);
    assert!(found.iter().all(|branch| branch.nodes().len() == 2));
    // Where twigs are thicker the rest of the back is a branch at each: 76 of them reach 25 of 100 or more.
    let found = branches(&comb(100, 1.5)).unwrap();
    assert_eq!((found.len(), found[0].nodes().len()), (76, 200));
    let error = branches(&comb(10_000, 1.5)).unwrap_err();
    assert_eq!(error, StructureError::Wood { n_branches: 10_000, n_nodes: 100_010_000, most: 1 << 21 });
}

#[test]
fn meshes_begin_at_their_pivots_where_these_are_of_them() {
    // Along x, a leaf hanging down at its end: that is lowest.
    let twig = mesh(&[[0.0, 0.0, 1.0], [1.0, 0.05, 0.9], [2.0, 0.0, 0.0]]);
    for (pivot, may) in [
        ([0.0, 0.0, 1.0], true),
        ([0.0, 0.0, 1.11], true),
        ([0.0, 0.0, 1.12], false),
        ([-5.0, 0.0, 1.0], false),
        ([1.0, 0.02, 0.5], false),
        ([1.2, 0.02, 0.5], true),
        ([0.0; 3], true),
        ([f64::NAN; 3], false),
    ] {
        assert_eq!(Branch::may_begin(&twig, pivot), may, "{pivot:?}");
    }
    assert!(!Branch::may_begin(&Mesh::default(), [0.0; 3]));
    // Held by its beginning it lies along the bone from there, and from its leaf otherwise.
    let rest = two_bones(&[]);
    let [stem, leaf] = [[0.0, 0.0, 1.0], [2.0, 0.0, 0.0]];
    for (begin, foot, tip) in [(Some(stem), stem, leaf), (None, leaf, stem)] {
        let branch = Branch::of(&twig, begin).unwrap();
        let graft = assemble(&rest, &[branch], 1, 0).unwrap()[0];
        near(graft.apply(foot), [1.0, 2.0, 5.0]);
        near(graft.apply(tip), [5.0, 2.0, 5.0]);
    }
}
