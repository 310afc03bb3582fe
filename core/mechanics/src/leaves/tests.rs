//! Leaves on the ends of branches.

use super::Leaves;
use crate::{Beams, Options};

#[test]
fn leaves_are_shared_by_all_ends_of_branches() {
    let plant = honami_synth::tree(60, 1).unwrap();
    let mut beams = Beams::new(&plant, &Options::default()).unwrap();
    let drag = Leaves { mass: 3.0, drag: 2.0 }.hang(&mut beams, &plant).unwrap();
    let ends = beams.ends();
    assert_eq!(drag.leaves.len(), ends.len());
    assert!((drag.leaves.iter().map(|leaf| leaf.1).sum::<f64>() - 2.0).abs() < 1e-12);
    assert!(drag.leaves.iter().all(|leaf| ends.contains(&(leaf.0 as u32))));
    let loads: f64 = beams.nodes().iter().map(|node| node.load).sum();
    assert!((loads - 3.0).abs() < 1e-12);
    for (mass, drag) in [(-1.0, 0.0), (f64::NAN, 0.0), (0.0, -1.0)] {
        let error = Leaves { mass, drag }.hang(&mut beams, &plant).unwrap_err().to_string();
        assert!(error.starts_with("leaves weigh 0 kg or more"), "{error}");
    }
}
