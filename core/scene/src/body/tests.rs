//! Bodies of small plants: levels, rings that turn with their segments, and leaves that hang where they should.

use super::{Body, Foliage};
use honami_mechanics::{Beams, Options, Vector};
use honami_model::plant::{Node, Plant};

/// A stem of so many segments of 10 cm, with a twig to alternate sides from each node.
fn plant(n: u32) -> Beams {
    let node = |parent, position, radius| Node { parent, position, radius };
    let mut nodes = vec![node(None, [2.0, 3.0, 1.0], 0.03)];
    let mut stem = 0;
    for k in 1..=n {
        let (z, side) = (1.0 + 0.1 * f64::from(k), if k % 2 == 0 { 1.0 } else { -1.0 });
        nodes.push(node(Some(stem), [2.0, 3.0, z], 0.02));
        stem = nodes.len() as u32 - 1;
        nodes.push(node(Some(stem), [2.0 + 0.2 * side, 3.0, z + 0.1], 0.002));
    }
    Beams::new(&Plant::new(nodes).unwrap(), &Options::default()).unwrap()
}

fn length(v: [f32; 3]) -> f32 {
    v.iter().map(|v| v * v).sum::<f32>().sqrt()
}

#[test]
fn levels_have_less_and_less_of_the_same_plant() {
    let small = plant(40);
    let levels = Body::new(&small, 10, &Foliage::usual(&small)).levels;
    assert!(levels.iter().all(|level| level.n_nodes == 81), "a small plant is whole from everywhere");
    let beams = plant(2000);
    let body = Body::new(&beams, 10, &Foliage::usual(&beams));
    let whole = &body.levels[0];
    assert_eq!((whole.from, whole.n_nodes, whole.n_modes), (0.0, 4001, 10));
    assert_eq!(whole.rings.len() as u32, whole.branches.iter().sum::<u32>());
    for (near, far) in body.levels.iter().zip(&body.levels[1..]) {
        assert!(near.from < far.from && near.n_nodes > far.n_nodes && near.n_modes >= far.n_modes);
        assert!(far.n_nodes >= 300);
        assert!(near.leaves.len() > far.leaves.len() && near.triangles().len() > far.triangles().len());
        let area = |leaves: &[super::Leaf]| leaves.iter().map(|leaf| leaf.length.powi(2)).sum::<f32>();
        let kept = area(&far.leaves) / area(&near.leaves);
        assert!((0.8..1.25).contains(&kept), "{kept}");
    }
    for level in &body.levels {
        assert!(level.rings.iter().all(|ring| ring.node < level.n_nodes));
        assert!(level.rings.iter().all(|ring| ring.beside.as_flattened().iter().all(|n| *n < level.n_nodes)));
        assert!(level.triangles().as_flattened().iter().all(|v| *v < level.n_vertices()));
        for leaf in &level.leaves {
            let ring = &level.rings[leaf.ring as usize];
            let at: [f32; 3] = std::array::from_fn(|axis| ring.rest[axis] + leaf.base[axis]);
            // On its twig: no higher than the top, no farther out than its tip.
            assert!((-0.01..200.2).contains(&at[2]) && at[0].abs() < 0.21 && at[1].abs() < 0.01, "{at:?}");
            let square = leaf.tip.iter().zip(leaf.up).map(|(a, b)| a * b).sum::<f32>();
            assert!((length(leaf.tip) - 1.0).abs() < 1e-5 && (length(leaf.up) - 1.0).abs() < 1e-5);
            assert!(square.abs() < 1e-5 && (0.0..=1.0).contains(&leaf.open));
        }
    }
    assert!(body.details(1.0).is_ok());
}

/// Where all nodes are turned about the root by a small angle, every ring turns by it.
#[test]
fn rings_turn_as_the_plant_does() {
    let beams = plant(6);
    let body = Body::new(&beams, 3, &Foliage { per_end: 0, length: 0.1, seed: 1 });
    let by = Vector::new(2e-4, -1e-4, 3e-4);
    let moved = |row: u32| -> [f32; 3] {
        let rest = beams.position(body.order[row as usize] as usize) - beams.position(0);
        by.cross(&rest).cast::<f32>().into()
    };
    for ring in &body.levels[0].rings {
        let turn = ring.turn(moved);
        // What is turned about the branch itself moves no node: the rest is seen across it.
        for across in [ring.side, ring.other] {
            let of = |v: [f32; 3]| v.iter().zip(across).map(|(a, b)| a * b).sum::<f32>();
            let (wanted, came) = (of(by.cast::<f32>().into()), of(turn));
            let is_bent = (ring.along[0].iter().zip(ring.along[1])).any(|(a, b)| (a - b).abs() > 1e-3);
            assert!(is_bent || (wanted - came).abs() < 1e-6, "{wanted} {came}");
        }
    }
    assert!(body.levels.iter().all(|level| level.leaves.is_empty()));
}

#[test]
fn the_middle_of_a_crown_is_darker_than_its_top() {
    let beams = plant(60);
    let body = Body::new(&beams, 3, &Foliage { per_end: 12, length: 0.3, seed: 3 });
    let leaves = &body.levels[0].leaves;
    let mean = |from: f32, to: f32| {
        let height = |leaf: &super::Leaf| body.levels[0].rings[leaf.ring as usize].rest[2] + leaf.base[2];
        let there: Vec<f32> =
            leaves.iter().filter(|leaf| (from..to).contains(&height(leaf))).map(|leaf| leaf.open).collect();
        there.iter().sum::<f32>() / there.len() as f32
    };
    assert!(mean(0.5, 2.0) < 0.7 * mean(5.8, 6.2), "{} {}", mean(0.5, 2.0), mean(5.8, 6.2));
}
