//! A plant's rings and leaves as shaders read them: all levels, one after the other.

use bytemuck::{Pod, Zeroable};
use honami_scene::body::{self, Body};

/// A ring of vertices: [`body::Ring`] in pieces of sixteen bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Ring {
    rest: [f32; 3],
    radius: f32,
    side: [f32; 3],
    open: f32,
    other: [f32; 3],
    node: u32,
    along_before: [f32; 3],
    base_before: u32,
    along_after: [f32; 3],
    tip_before: u32,
    base_after: u32,
    tip_after: u32,
    /// To a multiple of sixteen bytes, as shaders have it.
    filler: [u32; 2],
}

/// A leaf: [`body::Leaf`] likewise.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Leaf {
    base: [f32; 3],
    length: f32,
    tip: [f32; 3],
    breadth: f32,
    up: [f32; 3],
    open: f32,
    ring: u32,
    chance: f32,
    filler: [u32; 2],
}

/// What a level has in the buffers of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) first_ring: u32,
    pub(super) first_leaf: u32,
    pub(super) first_index: u32,
    pub(super) n_indices: u32,
    pub(super) n_leaves: u32,
    pub(super) n_sides: u32,
}

/// All levels of a plant.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) rings: Vec<Ring>,
    pub(super) leaves: Vec<Leaf>,
    /// Of the wood, level after level, and then those of a card a leaf.
    pub(super) indices: Vec<u32>,
    /// Where the latter begin.
    pub(super) first_card: u32,
    pub(super) levels: Vec<Part>,
}

/// Corners of the two triangles of a leaf.
const CARD: [u32; 6] = [0, 1, 2, 2, 1, 3];

impl Parts {
    pub(super) fn new(body: &Body) -> Self {
        let (mut rings, mut leaves, mut indices, mut levels) = (vec![], vec![], vec![], vec![]);
        for level in &body.levels {
            let triangles = level.triangles();
            levels.push(Part {
                first_ring: rings.len() as u32,
                first_leaf: leaves.len() as u32,
                first_index: indices.len() as u32,
                n_indices: 3 * triangles.len() as u32,
                n_leaves: level.leaves.len() as u32,
                n_sides: level.n_sides,
            });
            rings.extend(level.rings.iter().map(ring));
            leaves.extend(level.leaves.iter().map(leaf));
            indices.extend(triangles.into_flattened());
        }
        let most = levels.iter().map(|level| level.n_leaves).max().unwrap_or_default();
        let first_card = indices.len() as u32;
        indices.extend((0..most).flat_map(|leaf| CARD.map(|corner| 4 * leaf + corner)));
        Self { rings, leaves, indices, first_card, levels }
    }
}

fn ring(ring: &body::Ring) -> Ring {
    let [[base_before, tip_before], [base_after, tip_after]] = ring.beside;
    let [along_before, along_after] = ring.along;
    Ring {
        rest: ring.rest,
        radius: ring.radius,
        side: ring.side,
        open: ring.open,
        other: ring.other,
        node: ring.node,
        along_before,
        base_before,
        along_after,
        tip_before,
        base_after,
        tip_after,
        filler: [0; 2],
    }
}

fn leaf(leaf: &body::Leaf) -> Leaf {
    Leaf {
        base: leaf.base,
        length: leaf.length,
        tip: leaf.tip,
        breadth: leaf.breadth,
        up: leaf.up,
        open: leaf.open,
        ring: leaf.ring,
        chance: leaf.chance,
        filler: [0; 2],
    }
}
