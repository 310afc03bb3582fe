//! Tubes of small plants: where rings are, how thick, which way their triangles look.

use super::{SIDES, Tubes};
use honami_mechanics::{Beams, Options, Vector};
use honami_model::plant::{Node, Plant};

/// A stem of two segments, a thin branch from its middle.
fn fork() -> Beams {
    let node = |parent, position, radius| Node { parent, position, radius };
    let nodes = vec![
        node(None, [0.0, 0.0, 0.0], 0.03),
        node(Some(0), [0.0, 0.0, 1.0], 0.03),
        node(Some(1), [0.5, 0.0, 1.0], 0.01),
        node(Some(1), [0.0, 0.0, 2.0], 0.02),
    ];
    Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap()
}

#[test]
fn the_thickest_goes_on_and_the_other_begins_in_its_middle() {
    let beams = fork();
    let tubes = Tubes::new(&beams);
    let places: Vec<[f64; 3]> =
        tubes.rings().iter().map(|ring| beams.position(ring.node as usize).into()).collect();
    let (stem, branch) =
        ([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0]], [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0]]);
    let mut branches = [places[..3].to_vec(), places[3..].to_vec()];
    if places.len() == 5 && places[1][0] > 0.0 {
        branches = [places[2..].to_vec(), places[..2].to_vec()];
    }
    assert_eq!(branches, [stem.to_vec(), branch.to_vec()]);
    assert_eq!(tubes.n_vertices(), 5 * SIDES);
    for pair in tubes.rings()[..3].windows(2) {
        assert!(pair[0].radius >= pair[1].radius, "{pair:?}");
    }
}

/// The volume that the triangles enclose, each tube open at its foot where it stands in what bears it: of prisms of six
/// sides, by the theorem of Gauss. It is positive only where all look outward.
#[test]
fn triangles_look_outward_and_hold_the_wood() {
    let node = |parent, position| Node { parent, position, radius: 0.1 };
    let nodes = vec![node(None, [0.0; 3]), node(Some(0), [0.0, 0.0, 1.0]), node(Some(1), [0.0, 0.0, 3.0])];
    let beams = Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap();
    let tubes = Tubes::new(&beams);
    let vertices: Vec<Vector> = tubes
        .rings()
        .iter()
        .flat_map(|ring| {
            let centre = beams.position(ring.node as usize);
            ring.outward().map(move |out| centre + out * ring.radius).collect::<Vec<_>>()
        })
        .collect();
    // The foot lies in z = 0 and adds nothing.
    let volume: f64 = tubes
        .triangles()
        .iter()
        .map(|corners| {
            let [a, b, c] = corners.map(|k| vertices[k as usize]);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum();
    let hexagon = 1.5 * 3.0_f64.sqrt() * 0.1 * 0.1;
    assert!((volume - 3.0 * hexagon).abs() < 1e-12, "{volume}");
    for out in tubes.rings().iter().flat_map(|ring| ring.outward().collect::<Vec<_>>()) {
        assert!((out.norm() - 1.0).abs() < 1e-12);
    }
}

/// A branch that turns back on itself, and one along each axis, have rings all the same.
#[test]
fn rings_are_numbers_whichever_way_a_branch_goes() {
    let node = |parent, position| Node { parent, position, radius: 0.1 };
    let nodes = vec![
        node(None, [0.0; 3]),
        node(Some(0), [0.0, 0.0, 1.0]),
        node(Some(1), [0.0, 0.0, 0.5]),
        node(Some(2), [1.0, 0.0, 0.5]),
        node(Some(3), [1.0, -2.0, 0.5]),
    ];
    let beams = Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap();
    for ring in Tubes::new(&beams).rings() {
        for out in ring.outward() {
            assert!((out.norm() - 1.0).abs() < 1e-12 && ring.radius > 0.0, "{ring:?}");
        }
    }
}
