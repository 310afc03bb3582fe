//! Which nodes are a plant.

use super::{Node, Plant, PlantError, RadiusRule};

fn node(parent: Option<u32>, z: f64, radius: f64) -> Node {
    Node { parent, position: [0.0, 0.0, z], radius }
}

#[test]
fn nodes_that_are_no_tree_are_refused_by_row() {
    let root = node(None, 0.0, 0.1);
    let cases = [
        (vec![], "a plant has two nodes at least, this one has 0"),
        (vec![root], "a plant has two nodes at least, this one has 1"),
        (vec![root, node(None, 1.0, 0.1)], "node 1 has no parent: a plant has one root, its first node"),
        (vec![root, node(Some(1), 1.0, 0.1)], "node 1 has parent 1, which does not come before it"),
        (vec![node(Some(1), 0.0, 0.1), root], "node 0 has parent 1, which does not come before it"),
        (vec![root, node(Some(0), f64::NAN, 0.1)], "node 1 lies at [0.0, 0.0, NaN] m with radius 0.1 m"),
        (vec![root, node(Some(0), 1.0, 0.0)], "node 1 lies at [0.0, 0.0, 1.0] m with radius 0 m"),
    ];
    for (nodes, wanted) in cases {
        assert_eq!(Plant::new(nodes).map_err(|error: PlantError| error.to_string()), Err(wanted.to_owned()));
    }
}

#[test]
fn a_twig_does_not_begin_as_thick_as_its_trunk() {
    let cases = [(0.10, 0.08, 0.09), (0.10, 0.01, 0.0125), (0.01, 0.02, 0.015)];
    for (base, tip, wanted) in cases {
        assert!((RadiusRule::Mean.radius(base, tip) - wanted).abs() < 1e-15, "{base} {tip}");
        assert!((RadiusRule::Tip.radius(base, tip) - tip).abs() < 1e-15);
    }
}

#[test]
fn height_is_measured_from_the_root() {
    let plant = Plant::new(vec![node(None, 2.0, 0.1), node(Some(0), 5.0, 0.1), node(Some(1), 4.0, 0.1)]);
    assert!((plant.unwrap().height() - 3.0).abs() < 1e-15);
}
