//! What a plant looks like: rings of vertices along its branches and leaves on these, in levels of detail.

use serde::{Deserialize, Serialize};

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
