//! A graph divided again and again, as a hierarchy.
//!
//! Zeng 5.4.1: halves, quarters and so on, each by the least normalised cut, down to a number of levels. What is not
//! connected at all falls apart first, and takes no level. Where levels end, or nothing is gained by a cut, the tracks of a
//! group are joined along its heaviest edges (single linkage), so that the hierarchy is whole.
//!
//! Halves join at 1 - Ncut / 2, which is more than 1/2, or, where that is less, at the height at which their group joins
//! another; parts that are not connected join at 1, and tracks of the last groups at (1 - weight) / 2. By
//! [`Order::Levels`] all but the last are times 2 to the power of the levels below, so that a level is cut before the next
//! begins. By [`Order::Shares`] halves join at (1 + 1 / (1 + p)) / 2, with p = Ncut / sqrt(share of all nodes).

use honami_model::hierarchy::{Dendrogram, Merge};

use super::Order;
use super::cut::{Cut, best};
use super::graph::Graph;
use crate::MotionError;

/// What came of dividing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Divided {
    pub(crate) tree: Dendrogram,
    /// Groups that were divided no further.
    pub(crate) n_groups: usize,
    /// The largest residual of an eigenvector.
    pub(crate) residual: f64,
}

/// A part of the graph that is still to be divided.
struct Open {
    /// Nodes of the whole graph, ascending.
    nodes: Vec<u32>,
    graph: Graph,
    /// How often it may be halved, and the height at which it joins another.
    n_levels: u32,
    height: f64,
}

/// Two nodes whose clusters join at a height.
type Join = (f64, u32, u32);

/// Divides a graph of two nodes or more to so many levels. `keep_going` is told the share of the work that is done; `false`
/// stops.
pub(crate) fn divide(
    graph: Graph,
    n_levels: u32,
    order: Order,
    seed: u64,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Divided, MotionError> {
    let n_nodes = graph.len();
    let all = n_nodes as f64 * f64::from(n_levels.max(1));
    let (mut n_groups, mut worst, mut done) = (0, 0.0_f64, 0.0);
    // Joins of clusters come before those of their parts.
    let mut joins: Vec<Join> = Vec::new();
    let mut open =
        vec![Open { nodes: (0..n_nodes as u32).collect(), graph, n_levels, height: f64::INFINITY }];
    while let Some(group) = open.pop() {
        let share = done / all;
        if !keep_going(share) {
            return Err(MotionError::Stopped);
        }
        let Open { nodes, graph, n_levels, .. } = &group;
        let scale = match order {
            Order::Levels => (f64::from(*n_levels) - 1.0).exp2(),
            Order::Cuts | Order::Shares => 1.0,
        };
        let parts = connected(graph);
        if parts.len() > 1 {
            let height = scale.min(group.height);
            let ends = parts.windows(2).map(|pair| [pair[0][0], pair[1][0]].map(|k| nodes[k as usize]));
            joins.extend(ends.map(|[a, b]| (height, a, b)));
            open.extend(parts.iter().map(|part| group.part(part, *n_levels, height)));
            continue;
        }
        let cut = match n_levels {
            0 => None,
            _ => best(graph, seed, &mut || keep_going(share))?,
        };
        let Some(Cut { ncut, sides, residual }) = cut else {
            n_groups += 1;
            done += (nodes.len() * *n_levels as usize) as f64;
            joins
                .extend(heaviest(graph).map(|(height, a, b)| (height, nodes[a as usize], nodes[b as usize])));
            continue;
        };
        done += nodes.len() as f64;
        worst = worst.max(residual);
        let own = match order {
            Order::Levels | Order::Cuts => scale * (1.0 - ncut / 2.0),
            Order::Shares => {
                let share = nodes.len() as f64 / n_nodes as f64;
                0.5 + 0.5 / (1.0 + ncut / share.sqrt())
            }
        };
        let height = own.min(group.height);
        let [a, b] = [0, 1].map(|side| nodes[sides[side][0] as usize]);
        joins.push((height, a, b));
        open.extend(sides.iter().map(|side| group.part(side, n_levels - 1, height)));
    }
    joins.reverse();
    Ok(Divided { tree: joined(n_nodes, joins), n_groups, residual: worst })
}

impl Open {
    fn part(&self, nodes: &[u32], n_levels: u32, height: f64) -> Self {
        let own = nodes.iter().map(|&node| self.nodes[node as usize]).collect();
        Self { nodes: own, graph: self.graph.part(nodes), n_levels, height }
    }
}

/// Connected parts, the largest first: it is the first to leave the others.
fn connected(graph: &Graph) -> Vec<Vec<u32>> {
    let mut parts = graph.components();
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    parts
}

/// The edges that join all nodes of a connected graph and weigh most, the lightest first.
fn heaviest(graph: &Graph) -> impl Iterator<Item = Join> {
    let of = |node: usize| {
        let after = graph.edges(node).filter(move |(other, _)| *other > node);
        after.map(move |(other, weight)| (weight, node as u32, other as u32))
    };
    let mut edges: Vec<Join> = (0..graph.len()).flat_map(of).collect();
    edges.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut clusters = Clusters::new(graph.len());
    let mut kept: Vec<Join> = edges.into_iter().filter(|&(_, a, b)| clusters.join(a, b).is_some()).collect();
    kept.reverse();
    kept.into_iter().map(|(weight, a, b)| ((0.5 - 0.5 * weight).max(0.0), a, b))
}

/// The hierarchy of joins, those of equal height as they come.
fn joined(n_nodes: usize, mut joins: Vec<Join>) -> Dendrogram {
    joins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut clusters = Clusters::new(n_nodes);
    let merges = joins.into_iter().filter_map(|(height, a, b)| {
        let (a, b, size) = clusters.join(a, b)?;
        Some(Merge { a: a.min(b), b: a.max(b), height, size })
    });
    let merges = merges.collect();
    // Each division joins what it has divided: n - 1 joins make one tree.
    Dendrogram::new(n_nodes as u32, merges).unwrap_or_else(|error| unreachable!("{error}"))
}

/// Clusters that nodes are in.
struct Clusters {
    /// A node of the same cluster, nearer to its root; roots are their own.
    towards: Vec<u32>,
    /// Number and size of the cluster of each root.
    of_root: Vec<(u32, u32)>,
    n_made: u32,
}

impl Clusters {
    fn new(n_nodes: usize) -> Self {
        let n = n_nodes as u32;
        Self { towards: (0..n).collect(), of_root: (0..n).map(|node| (node, 1)).collect(), n_made: n }
    }

    fn root(&mut self, mut node: u32) -> u32 {
        while self.towards[node as usize] != node {
            let nearer = self.towards[self.towards[node as usize] as usize];
            self.towards[node as usize] = nearer;
            node = nearer;
        }
        node
    }

    /// Joins the clusters of two nodes: their numbers and the size of both; `None` where they are one already.
    fn join(&mut self, a: u32, b: u32) -> Option<(u32, u32, u32)> {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return None;
        }
        let ((number_a, size_a), (number_b, size_b)) = (self.of_root[a as usize], self.of_root[b as usize]);
        let (large, small) = if size_a < size_b { (b, a) } else { (a, b) };
        self.towards[small as usize] = large;
        self.of_root[large as usize] = (self.n_made, size_a + size_b);
        self.n_made += 1;
        Some((number_a, number_b, size_a + size_b))
    }
}
