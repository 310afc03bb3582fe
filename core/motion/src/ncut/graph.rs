//! Graphs whose edges have weights: sparse, symmetric, every node joined to itself.

use std::ops::Range;

use rayon::prelude::*;

use crate::MotionError;
use crate::pool::blocks;

/// Rows that a thread takes at least: fewer are not worth the way.
const ROWS: usize = 512;

/// A graph of n nodes; the weight of an edge says how alike two are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Graph {
    /// Where each node's edges begin, and the end of the last: n + 1 numbers.
    starts: Vec<usize>,
    /// The other ends of each node's edges, ascending; the node itself is among them.
    others: Vec<u32>,
    /// Weights of the edges, more than 0.
    weights: Vec<f64>,
}

impl Graph {
    /// A graph of rows (other node, weight), ascending, each edge in the rows of both its ends; edges of weight 0 are none.
    pub(crate) fn of_rows(rows: impl Iterator<Item = Vec<(u32, f64)>>) -> Self {
        let mut graph = Self { starts: vec![0], others: Vec::new(), weights: Vec::new() };
        for row in rows {
            graph.push(row.into_iter());
        }
        graph
    }

    /// The graph of n nodes in which each is joined to those with the largest weights of all, so many at the most, and to
    /// those that it is among the largest of. `weights` has the rows of weights of some nodes to all n; a node keeps the one to
    /// itself. `keep_going` is told the share of the work that is done; `false` stops.
    pub(crate) fn of_largest(
        n: usize,
        n_neighbours: usize,
        weights: &(impl Fn(Range<usize>) -> Vec<f64> + Sync),
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, MotionError> {
        let n_kept = n_neighbours.min(n - 1);
        let bytes = 2 * n * (n_kept + 1) * size_of::<(u32, f64)>();
        if Vec::<u8>::new().try_reserve_exact(bytes).is_err() {
            return Err(MotionError::Memory { n_tracks: n, bytes });
        }
        let of = |nodes: Range<usize>| -> Vec<Vec<(u32, f64)>> {
            let all = weights(nodes.clone());
            nodes.zip(all.chunks(n)).map(|(node, row)| largest(row, node, n_kept)).collect()
        };
        let mut rows = blocks(n, &of, keep_going)?;
        mirror(&mut rows);
        Ok(Self::of_rows(rows.into_iter()))
    }

    fn push(&mut self, row: impl Iterator<Item = (u32, f64)>) {
        for (other, weight) in row.filter(|(_, weight)| *weight > 0.0) {
            self.others.push(other);
            self.weights.push(weight);
        }
        self.starts.push(self.others.len());
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The edges of a node: other end and weight.
    pub(crate) fn edges(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        let row = self.starts[node]..self.starts[node + 1];
        self.others[row.clone()].iter().map(|&other| other as usize).zip(self.weights[row].iter().copied())
    }

    /// Sum of the weights of each node's edges, assoc({u}, V).
    pub(crate) fn degrees(&self) -> Vec<f64> {
        (0..self.len()).map(|node| self.edges(node).map(|(_, weight)| weight).sum()).collect()
    }

    /// The matrix of weights times a vector. Every sum has one order, whatever the threads.
    pub(crate) fn times(&self, vector: &[f64], out: &mut [f64]) {
        out.par_iter_mut().enumerate().with_min_len(ROWS).for_each(|(node, out)| {
            *out = self.edges(node).map(|(other, weight)| weight * vector[other]).sum();
        });
    }

    /// The nodes that can be reached from each other, ascending, in the order of their first.
    pub(crate) fn components(&self) -> Vec<Vec<u32>> {
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
    pub(crate) fn part(&self, nodes: &[u32]) -> Self {
        let mut number = vec![None; self.len()];
        (0_u32..).zip(nodes).for_each(|(k, &node)| number[node as usize] = Some(k));
        let mut part = Self { starts: vec![0], others: Vec::new(), weights: Vec::new() };
        for &node in nodes {
            part.push(self.edges(node as usize).filter_map(|(other, weight)| Some((number[other]?, weight))));
        }
        part
    }
}

/// A node's own entry of a row of weights and its largest others, ascending by node.
fn largest(row: &[f64], node: usize, n_kept: usize) -> Vec<(u32, f64)> {
    let mut entries: Vec<(u32, f64)> = (0..).zip(row.iter().copied()).collect();
    entries.swap(0, node);
    if n_kept < entries.len() - 1 {
        let by = |a: &(u32, f64), b: &(u32, f64)| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0));
        entries[1..].select_nth_unstable_by(n_kept - 1, by);
        entries.truncate(n_kept + 1);
    }
    entries.sort_unstable_by_key(|(other, _)| *other);
    // With no room left for those that were not kept.
    entries.as_slice().to_vec()
}

/// Puts every edge into the rows of both its ends.
fn mirror(rows: &mut [Vec<(u32, f64)>]) {
    let has = |row: &[(u32, f64)], node: u32| row.binary_search_by_key(&node, |(other, _)| *other).is_ok();
    let mut lacking: Vec<Vec<(u32, f64)>> = vec![Vec::new(); rows.len()];
    for (node, row) in (0_u32..).zip(rows.iter()) {
        for &(other, weight) in row.iter().filter(|(other, _)| !has(&rows[*other as usize], node)) {
            lacking[other as usize].push((node, weight));
        }
    }
    for (row, more) in rows.iter_mut().zip(lacking).filter(|(_, more)| !more.is_empty()) {
        row.extend(more);
        row.sort_unstable_by_key(|(other, _)| *other);
    }
}
