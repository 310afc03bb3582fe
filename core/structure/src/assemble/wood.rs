//! The branches of a plant of nodes.

use honami_model::plant::{Node, Plant};
use honami_model::turn::norm;

use crate::StructureError;
use crate::bind::less;

/// A branch reaches so far at least, of that which reaches farthest.
const LEAST: f64 = 0.25;
/// Nodes of all branches of a plant, each with all that it bears: as tubes a gigabyte.
const MOST_NODES: usize = 1 << 21;

/// What hangs on the forks of a plant, each with all that it bears and the fork as its root. Of a fork the thickest goes on,
/// of those as thick the one along which it is farthest to an end, then the first; the others begin branches. Those that
/// reach less than a quarter as far as the one that reaches farthest, from their forks, are left out; none are left where
/// nothing forks.
///
/// # Errors
/// [`StructureError::Wood`] for branches that have more than 2^21 nodes together, [`StructureError::Plant`].
pub fn branches(plant: &Plant) -> Result<Vec<Plant>, StructureError> {
    let nodes = plant.nodes();
    let wood = Wood::of(nodes);
    let begin: Vec<usize> = (1..nodes.len()).filter(|row| wood.begins(*row)).collect();
    let n_nodes = begin.iter().fold(0_usize, |n, row| n.saturating_add(1 + wood.sizes[*row]));
    if n_nodes > MOST_NODES {
        return Err(StructureError::Wood { n_branches: begin.len(), n_nodes, most: MOST_NODES });
    }
    let reaches: Vec<f64> = begin.iter().map(|row| wood.reach(*row)).collect();
    let farthest = reaches.iter().copied().fold(0.0, f64::max);
    let kept = begin.iter().zip(&reaches).filter(|(_, reach)| farthest > 0.0 && **reach >= LEAST * farthest);
    kept.map(|(row, _)| Plant::new(wood.branch(*row)).map_err(StructureError::from)).collect()
}

/// Nodes, and what they bear.
struct Wood<'a> {
    nodes: &'a [Node],
    children: Vec<Vec<usize>>,
    /// Which of its children each goes on in.
    next: Vec<Option<usize>>,
    /// How many each bears, and itself.
    sizes: Vec<usize>,
}

impl<'a> Wood<'a> {
    /// Of nodes of which each comes after the one that bears it.
    fn of(nodes: &'a [Node]) -> Self {
        let mut children = vec![Vec::new(); nodes.len()];
        // Along the nodes, from what bears each to the farthest end.
        let (mut sizes, mut ways) = (vec![1; nodes.len()], vec![0.0_f64; nodes.len()]);
        for (row, node) in nodes.iter().enumerate().rev() {
            let Some(parent) = node.parent.map(|parent| parent as usize) else { continue };
            sizes[parent] += sizes[row];
            ways[row] += norm(less(node.position, nodes[parent].position));
            ways[parent] = ways[parent].max(ways[row]);
        }
        let mut next: Vec<Option<usize>> = vec![None; nodes.len()];
        for (row, node) in nodes.iter().enumerate() {
            let Some(parent) = node.parent.map(|parent| parent as usize) else { continue };
            children[parent].push(row);
            let goes_on = |best: usize| {
                let thicker = node.radius.total_cmp(&nodes[best].radius);
                thicker.then(ways[row].total_cmp(&ways[best])).is_gt()
            };
            if next[parent].is_none_or(goes_on) {
                next[parent] = Some(row);
            }
        }
        Self { nodes, children, next, sizes }
    }

    /// Whether a node is where a branch leaves its fork.
    fn begins(&self, row: usize) -> bool {
        self.nodes[row].parent.is_some_and(|parent| self.next[parent as usize] != Some(row))
    }

    /// A node and all that it bears, in no order.
    fn borne(&self, first: usize) -> impl Iterator<Item = usize> {
        let mut open = vec![first];
        std::iter::from_fn(move || {
            let row = open.pop()?;
            open.extend(&self.children[row]);
            Some(row)
        })
    }

    /// From the fork of a branch to its farthest node.
    fn reach(&self, first: usize) -> f64 {
        let fork = self.nodes[self.fork(first)].position;
        self.borne(first).map(|row| norm(less(self.nodes[row].position, fork))).fold(0.0, f64::max)
    }

    fn fork(&self, first: usize) -> usize {
        self.nodes[first].parent.unwrap_or_default() as usize
    }

    /// The node that bears a node, as thick as that, the node, and all that it bears.
    fn branch(&self, first: usize) -> Vec<Node> {
        let mut rows: Vec<usize> = self.borne(first).collect();
        rows.sort_unstable();
        let fork = Node { parent: None, radius: self.nodes[first].radius, ..self.nodes[self.fork(first)] };
        let bearer = |row: usize| match row == first {
            true => 0,
            false => 1 + rows.partition_point(|other| *other < self.fork(row)) as u32,
        };
        let node = |row: &usize| Node { parent: Some(bearer(*row)), ..self.nodes[*row] };
        std::iter::once(fork).chain(rows.iter().map(node)).collect()
    }
}
