//! The normalised cut of a graph in two (Zeng 2.22, 5.2; Shi and Malik 2000, eq. 2).
//!
//! ```text
//! Ncut(A, B) = cut(A, B) / assoc(A, V)  +  cut(A, B) / assoc(B, V)
//! ```
//!
//! cut(A, B) is the weight of all edges between the two, assoc(A, V) that of all edges of A's nodes. Ncut = 2 - Nassoc
//! (Zeng 2.24, errata Z3), provided that sums run over ordered pairs, so that an edge within A counts twice, and an edge of a
//! node with itself once.

use super::eigen::{Second, second};
use super::graph::Graph;
use crate::MotionError;

/// What is cut into halves that are no more alike within than between is no group of groups: all alike has an Ncut of 1.
const ALL_ALIKE: f64 = 1.0 - 1e-9;

/// A graph in two.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cut {
    /// Its Ncut, from 0 to below 1.
    pub(super) ncut: f64,
    /// The nodes of either side, ascending, the side of the first node first.
    pub(super) sides: [Vec<u32>; 2],
    /// Of the eigenvector.
    pub(super) residual: f64,
}

/// The best cut of a connected graph between nodes that lie beside each other in the second eigenvector; `None` of one
/// node, and where nothing is gained by any.
pub(super) fn best(
    graph: &Graph,
    seed: u64,
    keep_going: &mut dyn FnMut() -> bool,
) -> Result<Option<Cut>, MotionError> {
    if graph.len() < 2 {
        return Ok(None);
    }
    let Second { y, residual, .. } = second(graph, seed, keep_going)?;
    let mut order: Vec<u32> = (0..graph.len() as u32).collect();
    order.sort_by(|&a, &b| y[a as usize].total_cmp(&y[b as usize]));
    let (first, ncut) = least(graph, &order);
    if ncut >= ALL_ALIKE {
        return Ok(None);
    }
    let (a, b) = order.split_at(first);
    let mut sides = [a, b].map(|side| {
        let mut side = side.to_vec();
        side.sort_unstable();
        side
    });
    // An eigenvector has no sign.
    sides.sort_unstable();
    Ok(Some(Cut { ncut, sides, residual }))
}

/// Of all cuts of an order in two the one of least Ncut: how many nodes are before it, and its Ncut.
fn least(graph: &Graph, order: &[u32]) -> (usize, f64) {
    let degrees = graph.degrees();
    let all: f64 = degrees.iter().sum();
    let mut is_before = vec![false; graph.len()];
    let (mut cut, mut before) = (0.0, 0.0);
    let mut least = (0, f64::INFINITY);
    for (k, &node) in order[..order.len() - 1].iter().enumerate() {
        let node = node as usize;
        before += degrees[node];
        is_before[node] = true;
        for (other, weight) in graph.edges(node).filter(|(other, _)| *other != node) {
            cut += if is_before[other] { -weight } else { weight };
        }
        let ncut = (cut / before + cut / (all - before)).max(0.0);
        if ncut < least.1 {
            least = (k + 1, ncut);
        }
    }
    least
}
