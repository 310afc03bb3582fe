//! What a plant looks like: rings of vertices along its branches and leaves on these, in levels of detail.

mod foliage;
mod light;
#[cfg(test)]
mod tests;

pub use foliage::Foliage;

use honami_mechanics::{Beams, Detail, DetailError, Details};
use serde::{Deserialize, Serialize};

use crate::tubes::{self, Tubes};
use light::Light;
pub(crate) use light::SHADE;

/// From how many heights of the plant on: the shares of its nodes and of its modes that are moved, vertices of a ring, and the
/// share of its leaves, which are larger by as much.
const LEVELS: [(f64, f64, f64, u32, f64); 4] =
    [(0.0, 1.0, 1.0, 6, 1.0), (5.0, 0.3, 1.0, 5, 0.6), (12.0, 0.1, 0.6, 4, 0.25), (30.0, 0.03, 0.2, 3, 0.08)];

/// A plant as it is drawn. Rows are those of [`Body::order`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Nodes of the beams, coarse before fine: every level has the first so many of them, and every node comes after the one
    /// that bears it.
    pub order: Vec<u32>,
    /// From the whole plant to what is left of it from afar.
    pub levels: Vec<Level>,
}

/// As much of a plant as is drawn from some distance on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// From so many metres on, of a copy of the plant's own size; the first from 0.
    pub from: f64,
    /// Its first so many nodes are moved,
    pub n_nodes: u32,
    /// by so many of its slowest modes.
    pub n_modes: u32,
    /// Vertices of a ring.
    pub n_sides: u32,
    /// Rings, branch after branch.
    pub rings: Vec<Ring>,
    /// How many rings each branch has, two at least.
    pub branches: Vec<u32>,
    /// Leaves.
    pub leaves: Vec<Leaf>,
}

/// A ring of vertices about a node. It moves as its node does, and turns by half of what each of the segments beside it
/// turns: the cross product of `along` with how much further its tip is moved than its base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ring {
    /// Row of its node.
    pub node: u32,
    /// Of the wood, metres.
    pub radius: f32,
    /// Where its node is at rest, metres from the root.
    pub rest: [f32; 3],
    /// Across the branch, of length 1; the other way across is `along` x `side`.
    pub side: [f32; 3],
    /// At right angles to both, of length 1.
    pub other: [f32; 3],
    /// How much of the sky it sees through the leaves: 0 none, 1 all.
    pub open: f32,
    /// The segments before and after it: rows of their bases and tips,
    pub beside: [[u32; 2]; 2],
    /// and which way they go, over the square of their length, per metre.
    pub along: [[f32; 3]; 2],
}

/// A leaf, which goes where a ring goes and turns as it does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leaf {
    /// Row of its ring in the level.
    pub ring: u32,
    /// From the ring's node to where it hangs, metres.
    pub base: [f32; 3],
    /// Which way it points, of length 1,
    pub tip: [f32; 3],
    /// and which way its upper side looks, of length 1, at right angles to that.
    pub up: [f32; 3],
    /// Metres.
    pub length: f32,
    /// Of its length.
    pub breadth: f32,
    /// Of what chance made of it, 0 to 1: its hue, and when it flutters.
    pub chance: f32,
    /// How much of the sky it sees from where it hangs in the crown: 0 none, 1 all.
    pub open: f32,
}

/// No level has fewer nodes, where a plant has so many: without them its shape would be another, and little is won.
const FEWEST: u32 = 300;

impl Body {
    /// What beams with these leaves look like.
    #[must_use]
    pub fn new(beams: &Beams, n_modes: usize, foliage: &Foliage) -> Self {
        let order = beams.coarse_to_fine();
        let mut rows = vec![0; beams.len()];
        (0..).zip(&order).for_each(|(row, node)| rows[*node as usize] = row);
        let hung = foliage.hang(beams);
        let light = Light::through(&hung);
        let root = beams.position(0);
        let top = (0..beams.len()).map(|node| (beams.position(node) - root).norm()).fold(0.0, f64::max);
        let share = |n: usize, share: f64| (n as f64 * share).ceil() as u32;
        let levels = LEVELS.iter().map(|&(from, nodes, modes, n_sides, leaves)| {
            let n_nodes = share(beams.len(), nodes).max(FEWEST).min(beams.len() as u32);
            let tubes = Tubes::of(beams, |node| rows[node as usize] < n_nodes);
            let rings: Vec<Ring> =
                tubes.rings().iter().map(|ring| seen(beams, &rows, ring, &light)).collect();
            let branches: Vec<u32> = tubes.lengths().iter().map(|n| *n as u32).collect();
            let leaves = foliage::of_level(&hung, beams, &rows, (&rings, &branches), leaves, &light);
            Level {
                from: from * top,
                n_nodes,
                n_modes: share(n_modes, modes),
                n_sides,
                rings,
                branches,
                leaves,
            }
        });
        Self { levels: levels.collect(), order }
    }

    /// From how far on how much of a copy is moved, in a picture so many times as high as usual.
    ///
    /// # Errors
    /// [`DetailError`] of levels that do not follow one another.
    pub fn details(&self, sharper: f64) -> Result<Details, DetailError> {
        let farther = self.levels.iter().skip(1).map(|level| (level.from * sharper, level.detail()));
        Details::new(&farther.collect::<Vec<_>>())
    }
}

impl Level {
    /// As much as it moves.
    #[must_use]
    pub fn detail(&self) -> Detail {
        Detail { n_nodes: self.n_nodes, n_modes: self.n_modes }
    }

    /// Whether all that it names is there.
    pub(crate) fn is_drawn(&self, n_nodes: usize, n_modes: usize) -> bool {
        let (nodes, rings) = (self.n_nodes as usize, self.rings.len());
        let is_there = |node: &u32| (*node as usize) < nodes;
        let named =
            || self.rings.iter().flat_map(|ring| ring.beside.as_flattened().iter().chain([&ring.node]));
        let n_of_branches = self.branches.iter().map(|n| *n as usize).sum::<usize>();
        (1..=n_nodes).contains(&nodes)
            && (1..=n_modes).contains(&(self.n_modes as usize))
            && (3..=64).contains(&self.n_sides)
            && n_of_branches == rings
            && named().all(is_there)
            && self.leaves.iter().all(|leaf| (leaf.ring as usize) < rings)
    }

    /// Vertices of its wood: those of a ring follow one another.
    #[must_use]
    pub fn n_vertices(&self) -> u32 {
        self.n_sides * self.rings.len() as u32
    }

    /// Triangles of its wood, anticlockwise as seen from outside: two a side, and a lid on every tip.
    #[must_use]
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        tubes::triangles(&self.branches, self.n_sides)
    }
}

impl Ring {
    /// By what it turns when nodes are moved so, rows of the order: radians about an axis.
    #[must_use]
    pub fn turn(&self, moved: impl Fn(u32) -> [f32; 3]) -> [f32; 3] {
        let mut turn = [0.0; 3];
        for ([base, tip], [x, y, z]) in self.beside.iter().zip(self.along) {
            let (from, to) = (moved(*base), moved(*tip));
            let by: [f32; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
            let own = [y * by[2] - z * by[1], z * by[0] - x * by[2], x * by[1] - y * by[0]];
            turn = std::array::from_fn(|axis| turn[axis] + own[axis] / 2.0);
        }
        turn
    }
}

/// A ring as it is drawn.
fn seen(beams: &Beams, rows: &[u32], ring: &tubes::Ring, light: &Light) -> Ring {
    let rest = beams.position(ring.node as usize) - beams.position(0);
    let row = |node: u32| rows[node as usize];
    Ring {
        node: row(ring.node),
        radius: ring.radius as f32,
        rest: rest.cast::<f32>().into(),
        side: ring.across[0].cast::<f32>().into(),
        other: ring.across[1].cast::<f32>().into(),
        open: light.at(&rest),
        beside: ring.beside.map(|(ends, _)| ends.map(row)),
        along: ring.beside.map(|(_, along)| along.cast::<f32>().into()),
    }
}
