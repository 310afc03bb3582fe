//! A tree to calculate with: branches on branches in three dimensions, as thick as what they bear asks for.

#[cfg(test)]
mod tests;

use honami_model::plant::{Node, Plant, PlantError};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// Metres.
const HEIGHT: f64 = 8.0;
/// Radius of the outermost twigs, metres. Towards the root areas add up (the pipe model of Shinozaki, 1964).
const TWIG: f64 = 0.0025;
/// Length of a segment by the order of its branch, relative; further orders are like the last.
const STEP: [f64; 5] = [1.0, 0.8, 0.6, 0.5, 0.4];
/// Chance of a side branch at a node, by order.
const FORK: [f64; 5] = [0.8, 0.5, 0.35, 0.25, 0.1];
/// Nodes of the stem below the first branch.
const BARE: u32 = 4;
/// Nodes after which a branch ends, by order.
const END: [u32; 5] = [60, 40, 25, 15, 8];
/// By how much a branch turns from node to node, radians, and how much of that is upward.
const TURN: f64 = 0.15;
const UPWARD: f64 = 0.06;

/// The end of a branch that grows.
struct Bud {
    node: u32,
    direction: [f64; 3],
    order: usize,
    age: u32,
}

/// A tree 8 m high of so many nodes, the root included; the same for the same seed.
///
/// # Errors
/// [`PlantError::TooFew`] for less than two nodes.
pub fn tree(n_nodes: usize, seed: u64) -> Result<Plant, PlantError> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut nodes = vec![Node { parent: None, position: [0.0; 3], radius: TWIG }];
    let mut buds = vec![Bud { node: 0, direction: [0.0, 0.0, 1.0], order: 0, age: 0 }];
    // What grows next: by time, then by bud, so that the order is one.
    let mut due = BinaryHeap::from([Reverse((0_u64, 0_usize))]);
    while nodes.len() < n_nodes {
        let Some(Reverse((time, k))) = due.pop() else { break };
        let Bud { node, direction, order, age } = buds[k];
        let order_at = order.min(STEP.len() - 1);
        let turned = turn(&mut rng, direction);
        let step = STEP[order_at] * rng.random_range(0.8..1.2);
        let from = nodes[node as usize].position;
        let position = std::array::from_fn(|axis| from[axis] + step * turned[axis]);
        nodes.push(Node { parent: Some(node), position, radius: TWIG });
        let tip = nodes.len() as u32 - 1;
        let is_bare = order == 0 && age < BARE;
        if !is_bare && rng.random_bool(FORK[order_at]) {
            let direction = aside(&mut rng, turned);
            buds.push(Bud { node: tip, direction, order: order + 1, age: 0 });
            due.push(Reverse((time + 3, buds.len() - 1)));
        }
        // The last bud goes on, however old: the tree has as many nodes as were asked for.
        if age + 1 < END[order_at] || due.is_empty() {
            buds[k] = Bud { node: tip, direction: turned, order, age: age + 1 };
            due.push(Reverse((time + 1, k)));
        }
    }
    thicken(&mut nodes);
    let top = nodes.iter().map(|node| node.position[2]).fold(f64::MIN_POSITIVE, f64::max);
    nodes.iter_mut().flat_map(|node| &mut node.position).for_each(|v| *v *= HEIGHT / top);
    Plant::new(nodes)
}

/// A little aside by chance, and upward.
fn turn(rng: &mut Pcg64Mcg, direction: [f64; 3]) -> [f64; 3] {
    let mut turned = direction.map(|v| v + rng.random_range(-TURN..TURN));
    turned[2] += UPWARD;
    unit(turned)
}

/// Somewhere about a direction, at 30 to 70 degrees.
fn aside(rng: &mut Pcg64Mcg, direction: [f64; 3]) -> [f64; 3] {
    let helper = if direction[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let across = unit(cross(direction, helper));
    let other = cross(direction, across);
    let (about, angle) = (rng.random_range(0.0..TAU), rng.random_range(0.5..1.2_f64));
    let out = |axis: usize| across[axis] * about.cos() + other[axis] * about.sin();
    unit(std::array::from_fn(|axis| direction[axis] * angle.cos() + out(axis) * angle.sin()))
}

/// Every branch has the area of all that it bears.
fn thicken(nodes: &mut [Node]) {
    let mut areas = vec![0.0; nodes.len()];
    for row in (0..nodes.len()).rev() {
        let area = if areas[row] > 0.0 { areas[row] } else { TWIG * TWIG };
        nodes[row].radius = f64::sqrt(area);
        if let Some(parent) = nodes[row].parent {
            areas[parent as usize] += area;
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    v.map(|v| v / length)
}
