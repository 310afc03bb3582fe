//! The skin of a plant: tubes along its branches, each from where it leaves what bears it to its tip.
//!
//! Tubes are rings of vertices, a ring a node, upright on the branch. A ring moves as its node does and turns with the
//! segments beside it, to the first order of how far these turn; so the middle of a ring is where its node is.

#[cfg(test)]
mod tests;

use honami_mechanics::{Beams, Vector};

/// Vertices of a ring.
pub const SIDES: usize = 6;

/// A ring of vertices about a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Of the beams.
    pub node: u32,
    /// Metres.
    pub radius: f64,
    /// At right angles to the branch and to each other, of length 1.
    pub(crate) across: [Vector; 2],
    /// Segments before and after it: from node to node, and which way by metres of their length.
    pub(crate) beside: [([u32; 2], Vector); 2],
}

/// Rings of all branches, branch after branch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tubes {
    rings: Vec<Ring>,
    /// How many rings each branch has.
    lengths: Vec<usize>,
}

impl Tubes {
    /// Of a fork the thickest goes on; the others begin in its middle.
    #[must_use]
    pub fn new(beams: &Beams) -> Self {
        Self::of(beams, |_all| true)
    }

    /// Only of nodes that are kept: each with the one that bears it.
    #[must_use]
    pub fn of(beams: &Beams, is_kept: impl Fn(u32) -> bool) -> Self {
        let mut next: Vec<Option<u32>> = vec![None; beams.len()];
        let kept = || (1..beams.len() as u32).filter(|node| is_kept(*node));
        for node in kept() {
            let Some(parent) = beams.parent(node as usize) else { continue };
            let best = &mut next[parent as usize];
            if best.is_none_or(|best| beams.radius(node as usize) > beams.radius(best as usize)) {
                *best = Some(node);
            }
        }
        let mut tubes = Self::default();
        for first in kept() {
            let Some(parent) = beams.parent(first as usize) else { continue };
            // The root is at the foot of the branch that goes on there.
            if parent != 0 && next[parent as usize] == Some(first) {
                continue;
            }
            let mut nodes = vec![parent, first];
            while let Some(node) = nodes.last().and_then(|last| next[*last as usize]) {
                nodes.push(node);
            }
            tubes.add(beams, &nodes);
        }
        tubes
    }

    /// A branch by its nodes, the first of which bears it.
    fn add(&mut self, beams: &Beams, nodes: &[u32]) {
        let segments: Vec<(Vector, f64, ([u32; 2], Vector))> = nodes
            .windows(2)
            .map(|pair| {
                let [base, tip] = [0, 1].map(|k| pair[k] as usize);
                let way = beams.position(tip) - beams.position(base);
                (way.normalize(), beams.radius(tip), ([pair[0], pair[1]], way / way.norm_squared()))
            })
            .collect();
        let mut side = beside(&segments[0].0);
        for (k, &node) in nodes.iter().enumerate() {
            let (before, after) = (segments[k.saturating_sub(1)], segments[k.min(segments.len() - 1)]);
            // Where a branch turns back on itself there is no middle way.
            let along = (before.0 + after.0).try_normalize(1e-6).unwrap_or(after.0);
            // The ring before, turned as little as can be: tubes do not twist.
            side = (side - along * side.dot(&along)).try_normalize(1e-6).unwrap_or_else(|| beside(&along));
            let radius = f64::midpoint(before.1, after.1);
            let (across, beside) = ([side, along.cross(&side)], [before.2, after.2]);
            self.rings.push(Ring { node, radius, across, beside });
        }
        self.lengths.push(nodes.len());
    }

    /// How many rings each branch has.
    #[must_use]
    pub fn lengths(&self) -> &[usize] {
        &self.lengths
    }

    /// All rings.
    #[must_use]
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// Vertices, [`SIDES`] a ring.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        SIDES * self.rings.len()
    }

    /// Triangles, anticlockwise as seen from outside: two a side, and a lid on every tip.
    #[must_use]
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let lengths: Vec<u32> = self.lengths.iter().map(|n| *n as u32).collect();
        triangles(&lengths, SIDES as u32)
    }
}

/// Triangles of branches of so many rings, each of so many vertices: anticlockwise as seen from outside, two a side, and a lid
/// on every tip.
pub(crate) fn triangles(lengths: &[u32], n_sides: u32) -> Vec<[u32; 3]> {
    let (mut triangles, mut first) = (Vec::new(), 0);
    for n_rings in lengths {
        for _ in 1..*n_rings {
            for k in 0..n_sides {
                let [a, b] = [k, (k + 1) % n_sides].map(|k| first + k);
                let [c, d] = [a, b].map(|below| below + n_sides);
                triangles.extend([[a, b, d], [a, d, c]]);
            }
            first += n_sides;
        }
        triangles.extend((2..n_sides).map(|k| [first, first + k - 1, first + k]));
        first += n_sides;
    }
    triangles
}

impl Ring {
    /// By what it turns when nodes are moved so, radians about an axis.
    pub fn turn(&self, moved: impl Fn(u32) -> Vector) -> Vector {
        let turn = |([base, tip], along): &([u32; 2], Vector)| along.cross(&(moved(*tip) - moved(*base)));
        self.beside.iter().map(turn).sum::<Vector>() / 2.0
    }

    /// Nodes at the tips of the segments before and after it.
    pub fn tips(&self) -> [u32; 2] {
        self.beside.map(|([_, tip], _)| tip)
    }

    /// From the node to each vertex, of length 1.
    pub fn outward(&self) -> impl Iterator<Item = Vector> {
        let [side, other] = self.across;
        (0..SIDES).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / SIDES as f64).sin_cos();
            side * cos + other * sin
        })
    }
}

/// Any direction at right angles to one.
pub(crate) fn beside(along: &Vector) -> Vector {
    let least = along.iamin();
    let axis = Vector::from_fn(|row, _| if row == least { 1.0 } else { 0.0 });
    (axis - along * axis.dot(along)).normalize()
}
