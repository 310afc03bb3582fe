//! A plant as beams: which of its nodes are nodes of the mechanics, and how thick each segment is.

#[cfg(test)]
mod tests;

use crate::element::Section;
use crate::material::{Material, MaterialError};
use crate::tree_matrix::TreeMatrix;
use honami_model::brief::Brief;
use honami_model::plant::{Plant, RadiusRule};
use nalgebra::{Matrix6, Vector3};
use std::ops::RangeInclusive;

/// Nodes closer than so many metres are one.
const SAME_PLACE: f64 = 1e-6;

/// Radii that are worked with, and how long a segment is at most, metres: far beyond plants, and nothing overflows.
const RADII: RangeInclusive<f64> = 1e-9..=1e6;
const LONGEST: f64 = 1e6;

/// More nodes than that a plant does not have: their matrices alone take thousands of bytes a node.
pub const MOST_NODES: usize = 4_000_000;

/// How a plant becomes beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// How thick a segment is between two nodes.
    pub rule: RadiusRule,
    /// What it is made of.
    pub material: Material,
    /// Longer segments are divided, metres; `None`: none.
    pub longest: Option<f64>,
}

/// Beams that make a plant, clamped at its root.
#[derive(Clone, Debug)]
pub struct Beams {
    /// Node 0 is the root; each comes after its parent, and a branch's nodes follow one another.
    nodes: Vec<Beam>,
    material: Material,
    of_plant: Vec<u32>,
    n_merged: usize,
    n_stubby: usize,
}

/// A node, and the segment that leads to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beam {
    /// `None` for the root.
    pub(crate) parent: Option<u32>,
    pub(crate) position: Vector3<f64>,
    /// Of the segment, metres.
    pub(crate) radius: f64,
    /// Of what is fixed here and does not stiffen, kilograms.
    pub(crate) load: f64,
}

/// Why a plant cannot become beams.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BeamsError {
    /// No wood is like that.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// All nodes of the plant lie in one place.
    #[error("all nodes of the plant lie in one place: it has no segment that could bend")]
    Point,
    /// More nodes than can be worked with.
    #[error(
        "the plant becomes {} nodes of beams, and {MOST_NODES} are the most: fewer nodes, or longer segments, are wanted",
        Brief(*nodes)
    )]
    TooMany {
        /// Nodes of the plant, or parts of its segments.
        nodes: f64,
    },
    /// A segment that no plant has.
    #[error(
        "node {node} of the plant has a radius of {radius:e} m and a segment of {length:e} m: radii of 1e-9 to 1e6 m and \
         segments of up to 1e6 m are wanted; is it the unit?"
    )]
    Segment {
        /// Row.
        node: usize,
        /// Metres.
        radius: f64,
        /// From its parent, metres.
        length: f64,
    },
    /// A length of segments that is none.
    #[error("the longest segment is more than 0 m long, not {} m", Brief(*.0))]
    Longest(f64),
}

impl Beams {
    /// A node a node of the plant; those that lie in one place with their parent are merged, long segments divided.
    ///
    /// # Errors
    /// [`BeamsError`].
    pub fn new(plant: &Plant, options: &Options) -> Result<Self, BeamsError> {
        options.material.check()?;
        if let Some(longest) = options.longest.filter(|longest| !(longest.is_finite() && *longest > 0.0)) {
            return Err(BeamsError::Longest(longest));
        }
        check(plant)?;
        let nodes = n_nodes(plant, options.longest);
        if nodes > MOST_NODES as f64 {
            return Err(BeamsError::TooMany { nodes });
        }
        let mut made = Self {
            nodes: Vec::with_capacity(plant.nodes().len()),
            material: options.material,
            of_plant: vec![0; plant.nodes().len()],
            n_merged: 0,
            n_stubby: 0,
        };
        for row in branch_by_branch(plant) {
            made.add(plant, row, options);
        }
        if made.nodes.len() < 2 { Err(BeamsError::Point) } else { Ok(made) }
    }

    fn add(&mut self, plant: &Plant, row: usize, options: &Options) {
        let node = &plant.nodes()[row];
        let position = Vector3::from(node.position);
        let Some(parent) = node.parent.map(|parent| parent as usize) else {
            self.nodes.push(Beam { parent: None, position, radius: node.radius, load: 0.0 });
            return;
        };
        let mut before = self.of_plant[parent];
        let from = self.nodes[before as usize].position;
        let length = (position - from).norm();
        if length < SAME_PLACE {
            self.n_merged += 1;
            self.of_plant[row] = before;
            return;
        }
        let [base, tip] = options.rule.ends(plant.nodes()[parent].radius, node.radius);
        if length < f64::midpoint(base, tip) {
            self.n_stubby += 1;
        }
        let n_parts = n_parts(length, options.longest);
        for part in 1..=n_parts as u32 {
            let middle = (f64::from(part) - 0.5) / n_parts;
            let radius = base + middle * (tip - base);
            let position = from.lerp(&position, f64::from(part) / n_parts);
            self.nodes.push(Beam { parent: Some(before), position, radius, load: 0.0 });
            before = self.nodes.len() as u32 - 1;
        }
        self.of_plant[row] = before;
    }

    /// Hangs masses, such as leaves, on nodes: (node, kilograms).
    ///
    /// # Panics
    /// When there is no such node.
    pub fn load(&mut self, masses: impl IntoIterator<Item = (usize, f64)>) {
        for (node, mass) in masses {
            self.nodes[node].load += mass;
        }
    }

    /// Nodes, the root included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none, which cannot be.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The node of each of the plant's nodes.
    #[must_use]
    pub fn of_plant(&self) -> &[u32] {
        &self.of_plant
    }

    /// How many of the plant's nodes lay where their parent lies.
    #[must_use]
    pub fn n_merged(&self) -> usize {
        self.n_merged
    }

    /// How many segments are thicker than long, for which beams are a rough model.
    #[must_use]
    pub fn n_stubby(&self) -> usize {
        self.n_stubby
    }

    /// Where a node is at rest, metres.
    ///
    /// # Panics
    /// When there is no such node.
    #[must_use]
    pub fn position(&self, node: usize) -> Vector3<f64> {
        self.nodes[node].position
    }

    /// The node that bears a node; `None` for the root.
    ///
    /// # Panics
    /// When there is no such node.
    #[must_use]
    pub fn parent(&self, node: usize) -> Option<u32> {
        self.nodes[node].parent
    }

    /// Radius of the segment that leads to a node, metres.
    ///
    /// # Panics
    /// When there is no such node.
    #[must_use]
    pub fn radius(&self, node: usize) -> f64 {
        self.nodes[node].radius
    }

    /// Nodes that bear no other.
    #[must_use]
    pub fn ends(&self) -> Vec<u32> {
        let mut is_end = vec![true; self.nodes.len()];
        for parent in self.nodes.iter().filter_map(|node| node.parent) {
            is_end[parent as usize] = false;
        }
        (0..self.nodes.len() as u32).filter(|node| is_end[*node as usize]).collect()
    }

    /// Nodes by how much wood they bear, that of their own segment included, most first: each comes after its parent, and
    /// the first so many are the plant in so much detail.
    #[must_use]
    pub fn coarse_to_fine(&self) -> Vec<u32> {
        let mut wood = vec![0.0; self.nodes.len()];
        for (base, tip, section, _) in self.segments().collect::<Vec<_>>().into_iter().rev() {
            wood[tip] += section.area() * section.length;
            wood[base] += wood[tip];
        }
        let mut order: Vec<u32> = (0..self.nodes.len() as u32).collect();
        order.sort_by(|a, b| wood[*b as usize].total_cmp(&wood[*a as usize]).then(a.cmp(b)));
        order
    }

    /// All of its wood, and what hangs on it.
    #[must_use]
    pub fn kilograms(&self) -> f64 {
        let wood: f64 = self.segments().map(|(_, _, own, _)| own.area() * own.length * own.density).sum();
        wood + self.nodes.iter().map(|node| node.load).sum::<f64>()
    }

    pub(crate) fn nodes(&self) -> &[Beam] {
        &self.nodes
    }

    /// Every segment: node at its base, node at its tip, its section and direction.
    pub(crate) fn segments(&self) -> impl Iterator<Item = (usize, usize, Section, Vector3<f64>)> {
        self.nodes.iter().enumerate().filter_map(|(tip, node)| {
            let base = node.parent? as usize;
            let along = node.position - self.nodes[base].position;
            let length = along.norm();
            let Material { young, density, .. } = self.material;
            let section =
                Section { length, radius: node.radius, young, shear: self.material.shear(), density };
            Some((base, tip, section, along / length))
        })
    }

    /// Stiffness of all nodes but the root.
    #[must_use]
    pub fn stiffness(&self) -> TreeMatrix {
        TreeMatrix::of_segments(self, Section::stiffness)
    }

    /// Mass of all nodes but the root.
    #[must_use]
    pub fn mass(&self) -> TreeMatrix {
        let mut mass = TreeMatrix::of_segments(self, Section::mass);
        for (row, node) in self.nodes.iter().enumerate().skip(1) {
            let load = [node.load, node.load, node.load, 0.0, 0.0, 0.0];
            mass.add(row - 1, &Matrix6::from_diagonal(&load.into()));
        }
        mass
    }
}

/// Whether all radii and segments are of a size.
fn check(plant: &Plant) -> Result<(), BeamsError> {
    for (node, length) in lengths(plant).enumerate() {
        let radius = plant.nodes()[node].radius;
        if !(RADII.contains(&radius) && length <= LONGEST) {
            return Err(BeamsError::Segment { node, radius, length });
        }
    }
    Ok(())
}

/// From every node to its parent, metres; of the root 0.
fn lengths(plant: &Plant) -> impl Iterator<Item = f64> {
    let nodes = plant.nodes();
    nodes.iter().map(|node| {
        let parent = node.parent.map_or(node, |parent| &nodes[parent as usize]);
        (Vector3::from(node.position) - Vector3::from(parent.position)).norm()
    })
}

/// Into so many parts a segment is divided.
fn n_parts(length: f64, longest: Option<f64>) -> f64 {
    longest.map_or(1.0, |longest| (length / longest).ceil().max(1.0))
}

/// Nodes of the plant, those between parts of its segments included.
fn n_nodes(plant: &Plant, longest: Option<f64>) -> f64 {
    lengths(plant).map(|length| n_parts(length, longest)).sum()
}

/// Rows of the plant so that each comes after its parent and a branch's nodes follow one another.
fn branch_by_branch(plant: &Plant) -> Vec<usize> {
    let nodes = plant.nodes();
    let mut children = vec![Vec::new(); nodes.len()];
    for (row, node) in nodes.iter().enumerate() {
        if let Some(parent) = node.parent {
            children[parent as usize].push(row);
        }
    }
    let (mut order, mut open) = (Vec::with_capacity(nodes.len()), vec![0]);
    while let Some(row) = open.pop() {
        order.push(row);
        open.extend(children[row].iter().rev());
    }
    order
}
