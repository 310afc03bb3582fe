//! Multiscale tree graphs (MTG) of digitised plants (Godin and Caraglio, J. Theor. Biol. 191, 1998).
//!
//! A line begins with what grows on what. Its column is the axis; `^` continues from what stood last in the same column,
//! else from what stood last in the column to the left. `/` goes into parts, `<` goes on, `+` branches off, `<<` goes on
//! by a series of parts of which the last is named. Then come the features: `XX YY ZZ` where the part ends, `TopDia` its
//! diameter there.

mod graph;
#[cfg(test)]
mod tests;

use super::{Measured, PlantFileError};
use graph::{Graph, Vertex};
use honami_model::plant::{Node, Plant};
use std::collections::BTreeMap;

/// What a file of this format leaves open.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Metres of a unit of length.
    pub unit: f64,
    /// So many units of diameter are one of length.
    pub diameters: f64,
    /// Classes of parts that are wood, such as `S`; empty: all of the finest scale.
    pub classes: Vec<String>,
}

impl Default for Options {
    /// Centimetres, and tenths of them for diameters, as in the walnut of Sinoquet and others (1997).
    fn default() -> Self {
        Self { unit: 0.01, diameters: 10.0, classes: Vec::new() }
    }
}

/// Reads a plant from the text of a file.
///
/// # Errors
/// [`PlantFileError`] with the line.
pub fn parse(text: &str, options: &Options) -> Result<Measured, PlantFileError> {
    let graph = Graph::parse(text)?;
    check_classes(&graph, &options.classes)?;
    let mut notes = Vec::new();
    let is_wood = |vertex: &Vertex| options.classes.is_empty() || options.classes.contains(&vertex.class);
    // What every part becomes: a node, or what the part before it is.
    let mut nodes: Vec<Node> = Vec::new();
    let mut of_vertex: Vec<Option<u32>> = vec![None; graph.vertices.len()];
    let mut trees: Vec<u32> = Vec::new();
    let (mut n_other, mut n_nowhere, mut n_thin) = (0, 0, 0);
    for (k, vertex) in graph.vertices.iter().enumerate() {
        if !vertex.is_finest {
            continue;
        }
        let before = vertex.before.and_then(|before| of_vertex[before]);
        if !is_wood(vertex) {
            n_other += 1;
            of_vertex[k] = before;
            continue;
        }
        let Some(position) = vertex.position else {
            n_nowhere += 1;
            of_vertex[k] = before;
            continue;
        };
        let scaled = |vertex: &Vertex| vertex.diameter.map(|d| d / options.diameters / 2.0 * options.unit);
        let measured = scaled(vertex).filter(|radius| *radius > 0.0);
        n_thin += usize::from(measured.is_none());
        let radius = measured.or_else(|| before.map(|before: u32| nodes[before as usize].radius));
        let Some(radius) = radius else {
            let what = format!("the first part of an axis has a diameter, {} has none", vertex.name());
            return Err(PlantFileError::Line { line: vertex.line, what });
        };
        let position = position.map(|v: f64| v * options.unit);
        let parent = before.or_else(|| base(&graph, vertex, options, radius, &mut nodes, &mut trees));
        if parent.is_none() {
            trees.push(nodes.len() as u32);
        }
        of_vertex[k] = Some(nodes.len() as u32);
        nodes.push(Node { parent, position, radius });
    }
    let plant = largest(nodes, &mut notes)?;
    let mut note = |n: usize, what: &str| match n {
        0 => {}
        1 => notes.push(format!("1 part {what}")),
        n => notes.push(format!("{n} parts {what}")),
    };
    note(n_other, "of other classes left out");
    note(n_nowhere, "without a position left out: what they bear stands on what bears them");
    note(n_thin, "without a diameter taken as thick as the part before");
    Ok(Measured { plant, notes })
}

/// A class that no part is of is a slip of the pen: a plant without it would be another.
fn check_classes(graph: &Graph, wanted: &[String]) -> Result<(), PlantFileError> {
    let mut there = BTreeMap::<&str, usize>::new();
    for vertex in graph.vertices.iter().filter(|vertex| vertex.is_finest) {
        *there.entry(&vertex.class).or_default() += 1;
    }
    match wanted.iter().find(|class| !there.contains_key(class.as_str())) {
        Some(class) => {
            let there = there.iter().map(|(class, n)| format!("{class} ({n})")).collect();
            Err(PlantFileError::Classes { wanted: class.clone(), there })
        }
        None => Ok(()),
    }
}

/// Where the first part of a plant begins: the place of what it is a part of, if that is known.
fn base(
    graph: &Graph,
    vertex: &Vertex,
    options: &Options,
    radius: f64,
    nodes: &mut Vec<Node>,
    trees: &mut Vec<u32>,
) -> Option<u32> {
    let whole = &graph.vertices[vertex.whole?];
    let position = whole.position?.map(|v| v * options.unit);
    let radius = whole.diameter.map_or(radius, |d| d / options.diameters / 2.0 * options.unit).max(radius);
    trees.push(nodes.len() as u32);
    nodes.push(Node { parent: None, position, radius });
    Some(nodes.len() as u32 - 1)
}

/// The tree with the most nodes; others are orphans.
fn largest(nodes: Vec<Node>, notes: &mut Vec<String>) -> Result<Plant, PlantFileError> {
    let mut tree_of: Vec<usize> = Vec::with_capacity(nodes.len());
    let mut sizes: Vec<usize> = Vec::new();
    for node in &nodes {
        let tree = node.parent.map_or(sizes.len(), |parent| tree_of[parent as usize]);
        if tree == sizes.len() {
            sizes.push(0);
        }
        sizes[tree] += 1;
        tree_of.push(tree);
    }
    // The first of those that are largest.
    let best = (0..sizes.len()).rev().max_by_key(|tree| sizes[*tree]).unwrap_or(0);
    let n_orphans = nodes.len() - sizes.get(best).copied().unwrap_or(0);
    if n_orphans > 0 {
        let trees = if sizes.len() == 2 {
            "1 more tree".to_owned()
        } else {
            format!("{} more trees", sizes.len() - 1)
        };
        let nodes = if n_orphans == 1 { "1 node".to_owned() } else { format!("{n_orphans} nodes in all") };
        notes.push(format!("{trees} of {nodes} left out: on nothing that the largest stands on"));
    }
    let mut moved = vec![0; nodes.len()];
    let mut kept = Vec::with_capacity(nodes.len() - n_orphans);
    for (row, node) in nodes.into_iter().enumerate().filter(|(row, _)| tree_of[*row] == best) {
        moved[row] = kept.len() as u32;
        kept.push(Node { parent: node.parent.map(|parent| moved[parent as usize]), ..node });
    }
    Ok(Plant::new(kept)?)
}
