//! The tree to calculate with.

use super::tree;

#[test]
fn it_has_as_many_nodes_as_were_asked_for_and_is_eight_metres_high() {
    for (n, seed) in [(2, 1), (3, 2), (300, 3), (3437, 1), (20_000, 4)] {
        let plant = tree(n, seed).unwrap();
        assert_eq!(plant.nodes().len(), n);
        assert!((plant.height() - 8.0).abs() < 1e-9, "{n}: {} m", plant.height());
    }
    assert!(tree(1, 1).is_err());
}

#[test]
fn the_same_seed_gives_the_same_tree_and_another_another() {
    assert_eq!(tree(500, 9), tree(500, 9));
    assert_ne!(tree(500, 9), tree(500, 10));
}

#[test]
fn areas_add_up_towards_the_root() {
    let plant = tree(1000, 5).unwrap();
    let nodes = plant.nodes();
    for (row, node) in nodes.iter().enumerate() {
        let borne: f64 = nodes
            .iter()
            .filter(|child| child.parent == Some(row as u32))
            .map(|child| child.radius.powi(2))
            .sum();
        assert!(borne == 0.0 || (node.radius.powi(2) / borne - 1.0).abs() < 1e-12, "node {row}");
    }
}
