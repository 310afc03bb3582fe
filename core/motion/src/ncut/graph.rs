//! Graphs whose edges have weights: sparse, symmetric, every node joined to itself.

use rayon::prelude::*;

/// Rows that a thread takes at least: fewer are not worth the way.
const ROWS: usize = 512;

/// A graph of n nodes; the weight of an edge says how alike two are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Graph {
    /// Where each node's edges begin, and the end of the last: n + 1 numbers.
    starts: Vec<usize>,
    /// The other ends of each node's edges, ascending; the node itself is among them.
    others: Vec<u32>,
    /// Weights of the edges, more than 0.
    weights: Vec<f64>,
}

impl Graph {
    /// A graph of rows (other node, weight), ascending, each edge in the rows of both its ends; edges of weight 0 are none.
    pub(super) fn of_rows(rows: impl Iterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut graph = Self { starts: vec![0], others: Vec::new(), weights: Vec::new() };
        for row in rows {
            graph.push(row.into_iter());
        }
        graph
    }

    fn push(&mut self, row: impl Iterator<Item = (u32, f64)>) {
        for (other, weight) in row.filter(|(_, weight)| *weight > 0.0) {
            self.others.push(other);
            self.weights.push(weight);
        }
        self.starts.push(self.others.len());
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The edges of a node: other end and weight.
    pub(super) fn edges(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let row = self.starts[node]..self.starts[node + 1];
        self.others[row.clone()].iter().map(|&other| other as usize).zip(self.weights[row].iter().copied())
    }

    /// Sum of the weights of each node's edges, assoc({u}, V).
    pub(super) fn degrees(&self) -> Vec<f64> {
        (0..self.len()).map(|node| self.edges(node).map(|(_, weight)| weight).sum()).collect()
    }

    /// The matrix of weights times a vector. Every sum has one order, whatever the threads.
    pub(super) fn times(&self, vector: &[f64], out: &mut [f64]) {
        out.par_iter_mut().enumerate().with_min_len(ROWS).for_each(|(node, out)| {
            *out = self.edges(node).map(|(other, weight)| weight * vector[other]).sum();
        });
    }

    /// The nodes that can be reached from each other, ascending, in the order of their first.
    pub(super) fn components(&self) -> Vec<Vec<u32>> {
        let mut is_seen = vec![false; self.len()];
        let mut components = Vec::new();
        for first in 0..self.len() {
            if std::mem::replace(&mut is_seen[first], true) {
                continue;
            }
            let (mut open, mut reached) = (vec![first], Vec::new());
            while let Some(node) = open.pop() {
                reached.push(node as u32);
                open.extend(
                    self.edges(node)
                        .map(|(other, _)| other)
                        .filter(|&other| !std::mem::replace(&mut is_seen[other], true)),
                );
            }
            reached.sort_unstable();
            components.push(reached);
        }
        components
    }

    /// The graph of some of the nodes, ascending, with the edges between them; node k is `nodes[k]` here.
    pub(super) fn part(&self, nodes: &[u32]) -> Self {
        let mut number = vec![None; self.len()];
        (0_u32..).zip(nodes).for_each(|(k, &node)| number[node as usize] = Some(k));
        let mut part = Self { starts: vec![0], others: Vec::new(), weights: Vec::new() };
        for &node in nodes {
            part.push(self.edges(node as usize).filter_map(|(other, weight)| Some((number[other]?, weight))));
        }
        part
    }
}
