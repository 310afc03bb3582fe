//! The branches of a plant of nodes.

use honami_model::plant::{Node, Plant, PlantError};
use honami_model::turn::norm;

use crate::bind::less;

/// A branch reaches so far at least, of that which reaches farthest.
const LEAST: f64 = 0.25;

/// What hangs on the forks of a plant, each with all that it bears and the fork as its root. Of a fork the thickest goes on,
/// of those as thick the first; the others begin branches. Those that reach less than a quarter as far as the one that reaches
/// farthest, from their forks, are left out; none are left where nothing forks.
///
/// # Errors
/// [`PlantError`], which rules of plants forbid.
pub fn branches(plant: &Plant) -> Result<Vec<Plant>, PlantError> {
    let nodes = plant.nodes();
    let mut next: Vec<Option<usize>> = vec![None; nodes.len()];
    for (row, node) in nodes.iter().enumerate() {
        let Some(parent) = node.parent else { continue };
        let best = &mut next[parent as usize];
        if best.is_none_or(|best| node.radius > nodes[best].radius) {
            *best = Some(row);
        }
    }
    let begin = |row: &usize| nodes[*row].parent.is_some_and(|parent| next[parent as usize] != Some(*row));
    let begun: Vec<Vec<Node>> = (1..nodes.len()).filter(begin).map(|row| borne(nodes, row)).collect();
    let farthest = begun.iter().map(|branch| reach(branch)).fold(0.0, f64::max);
    begun
        .into_iter()
        .filter(|branch| farthest > 0.0 && reach(branch) >= LEAST * farthest)
        .map(Plant::new)
        .collect()
}

/// The node that bears a node, as thick as that, the node, and all that it bears.
fn borne(nodes: &[Node], first: usize) -> Vec<Node> {
    let mut rows = vec![None; nodes.len()];
    let fork = nodes[first].parent.unwrap_or_default() as usize;
    rows[fork] = Some(0);
    let mut branch = vec![Node { parent: None, radius: nodes[first].radius, ..nodes[fork] }];
    for (row, node) in nodes.iter().enumerate().skip(first) {
        // Of the fork nothing else is taken.
        let Some(parent) = node.parent.filter(|parent| *parent as usize != fork || row == first) else {
            continue;
        };
        if let Some(there) = rows[parent as usize] {
            rows[row] = Some(branch.len() as u32);
            branch.push(Node { parent: Some(there), ..*node });
        }
    }
    branch
}

/// From the first node to the farthest.
fn reach(branch: &[Node]) -> f64 {
    let far = |node: &Node| norm(less(node.position, branch[0].position));
    branch.iter().map(far).fold(0.0, f64::max)
}
