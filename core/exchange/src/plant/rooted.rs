//! Nodes that name their parents by numbers of their own, in any order, as a plant.

#[cfg(test)]
mod tests;

use super::PlantFileError;
use honami_model::plant::{Node, Plant};
use std::collections::BTreeMap;

/// Radius of the ends of branches where none was measured, metres. Towards the root areas add up.
const TWIG: f64 = 0.0025;

/// A node as a file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Raw {
    pub(super) id: i64,
    /// `None` for a root.
    pub(super) parent: Option<i64>,
    /// Metres.
    pub(super) position: [f64; 3],
    /// Metres; `None` or not above 0 where it was not measured.
    pub(super) radius: Option<f64>,
    /// Where it stands in the file, from 1.
    pub(super) line: usize,
}

/// A plant of nodes, and notes of what was guessed or left out.
///
/// # Errors
/// [`PlantFileError`] for a number that two nodes have and for nodes that stand on one another in a circle.
pub(super) fn plant(raw: &[Raw], notes: &mut Vec<String>) -> Result<Plant, PlantFileError> {
    let wrong = |line: usize, what: String| Err(PlantFileError::Line { line, what });
    let mut row_of = BTreeMap::new();
    for (row, node) in raw.iter().enumerate() {
        if row_of.insert(node.id, row).is_some() {
            return wrong(node.line, format!("a second node {}", node.id));
        }
    }
    let (parents, lost) = parents(raw, &row_of);
    let mut children = vec![Vec::new(); raw.len()];
    for (row, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent].push(row);
        }
    }
    let mut best: Vec<usize> = Vec::new();
    let (mut n_roots, mut n_reached) = (0, 0);
    for root in (0..raw.len()).filter(|row| parents[*row].is_none()) {
        let (mut tree, mut open) = (Vec::new(), vec![root]);
        while let Some(row) = open.pop() {
            tree.push(row);
            open.extend(children[row].iter().rev());
        }
        n_roots += 1;
        n_reached += tree.len();
        if tree.len() > best.len() {
            best = tree;
        }
    }
    if n_reached < raw.len() {
        let circle = in_circle(&parents);
        let node = &raw[circle];
        return wrong(node.line, format!("node {} stands on itself, through its parents", node.id));
    }
    if let Some((node, parent)) = lost.first() {
        let words = format!("node {} stands on node {parent}, which is not there", node.id);
        if best.len() < 2 {
            return wrong(node.line, words);
        }
        let (n, line) = (lost.len(), node.line);
        notes.push(format!(
            "nodes whose parent is not there: {n}, each is a root of its own; the first, in line {line}: {words}"
        ));
    }
    if n_roots > 1 {
        let left = raw.len() - best.len();
        notes.push(format!(
            "further roots: {}; nodes of their trees that were left out: {left}; the largest tree is kept",
            n_roots - 1
        ));
    }
    let kept = best.iter().map(|row| &raw[*row]).collect::<Vec<_>>();
    let mut place = vec![0; raw.len()];
    for (k, row) in best.iter().enumerate() {
        place[*row] = k as u32;
    }
    let parents: Vec<Option<u32>> =
        best.iter().map(|row| parents[*row].map(|parent| place[parent])).collect();
    let radii = radii(&kept, &parents, notes);
    let nodes = kept.iter().zip(parents).zip(radii);
    Ok(Plant::new(
        nodes.map(|((raw, parent), radius)| Node { parent, position: raw.position, radius }).collect(),
    )?)
}

/// The row that every node stands on; and nodes whose parent is not there, with its number.
fn parents<'a>(raw: &'a [Raw], row_of: &BTreeMap<i64, usize>) -> (Vec<Option<usize>>, Vec<(&'a Raw, i64)>) {
    let row = |node: &Raw| row_of.get(&node.parent?).copied();
    let lost = raw.iter().filter(|node| row(node).is_none());
    (raw.iter().map(row).collect(), lost.filter_map(|node| Some((node, node.parent?))).collect())
}

/// A node of a circle of parents: any that is met twice on the way up.
fn in_circle(parents: &[Option<usize>]) -> usize {
    let reaches_root = |mut row: usize| {
        for _ in 0..parents.len() {
            match parents[row] {
                Some(parent) => row = parent,
                None => return true,
            }
        }
        false
    };
    (0..parents.len()).find(|row| !reaches_root(*row)).unwrap_or(0)
}

/// As measured; else as the node before; where nothing was measured by the pipe model.
fn radii(kept: &[&Raw], parents: &[Option<u32>], notes: &mut Vec<String>) -> Vec<f64> {
    let measured = |raw: &Raw| raw.radius.filter(|radius| *radius > 0.0);
    let first = kept.iter().find_map(|raw| measured(raw));
    let Some(first) = first else {
        notes.push(format!(
            "no radius was measured: ends of branches taken {TWIG} m thick, and every branch with the area of all that it \
             bears (pipe model)"
        ));
        return pipes(parents);
    };
    let mut n_guessed = 0;
    let mut radii: Vec<f64> = Vec::with_capacity(kept.len());
    for (raw, parent) in kept.iter().zip(parents) {
        let guess = parent.map_or(first, |parent| radii[parent as usize]);
        n_guessed += usize::from(measured(raw).is_none());
        radii.push(measured(raw).unwrap_or(guess));
    }
    if n_guessed > 0 {
        notes.push(format!("nodes without a radius: {n_guessed}; each taken as thick as the node before"));
    }
    radii
}

/// Every branch has the area of all that it bears (Shinozaki and others, 1964).
fn pipes(parents: &[Option<u32>]) -> Vec<f64> {
    let mut areas = vec![0.0; parents.len()];
    for row in (0..parents.len()).rev() {
        if areas[row] <= 0.0 {
            areas[row] = TWIG * TWIG;
        }
        if let Some(parent) = parents[row] {
            areas[parent as usize] += areas[row];
        }
    }
    areas.into_iter().map(f64::sqrt).collect()
}
