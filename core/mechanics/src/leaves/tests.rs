//! Leaves on the ends of branches.

use super::Leaves;
use crate::{Beams, Options};
use honami_model::plant::{Node, Plant};

#[test]
fn leaves_are_shared_by_all_ends_of_branches() {
    let plant = honami_synth::tree(60, 1).unwrap();
    let mut beams = Beams::new(&plant, &Options::default()).unwrap();
    let drag = Leaves { mass: 3.0, drag: 2.0 }.hang(&mut beams).unwrap();
    let ends = beams.ends();
    assert_eq!(drag.leaves.len(), ends.len());
    assert!((drag.leaves.iter().map(|leaf| leaf.1).sum::<f64>() - 2.0).abs() < 1e-12);
    assert!(drag.leaves.iter().all(|leaf| ends.contains(&(leaf.0 as u32))));
    let loads: f64 = beams.nodes().iter().map(|node| node.load).sum();
    assert!((loads - 3.0).abs() < 1e-12);
    for (mass, drag) in [(-1.0, 0.0), (f64::NAN, 0.0), (0.0, -1.0)] {
        let error = Leaves { mass, drag }.hang(&mut beams).unwrap_err().to_string();
        assert!(error.starts_with("leaves weigh 0 kg or more"), "{error}");
    }
}

/// A twig of no length bears no leaves: on a trunk it is no end, on an end it is that end.
#[test]
fn leaves_hang_where_beams_end_whatever_was_measured() {
    let node = |parent: Option<u32>, z: f64| Node { parent, position: [0.0, 0.0, z], radius: 0.02 };
    let rod = vec![node(None, 0.0), node(Some(0), 1.0), node(Some(1), 2.0)];
    let twigs = vec![node(Some(1), 1.0), node(Some(2), 2.0), node(Some(2), 2.0)];
    let beams_of = |nodes: Vec<Node>| Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap();
    let [mut bare, mut budded] = [rod.clone(), [rod, twigs].concat()].map(beams_of);
    let leaves = Leaves { mass: 3.0, drag: 2.0 };
    let [bare_drag, budded_drag] = [&mut bare, &mut budded].map(|beams| leaves.hang(beams).unwrap());
    assert_eq!((bare.nodes(), &bare_drag), (budded.nodes(), &budded_drag));
    assert_eq!((bare.nodes()[2].load, bare_drag.leaves), (3.0, vec![(2, 2.0)]));
}
