//! What casts the shadows of wood: its pieces at rest, the thickest where there are many.

use bytemuck::{Pod, Zeroable};
use honami_scene::ForestScene;

/// So many shadows of pieces are drawn at most, of all copies together.
const MOST: usize = 1 << 20;

/// A piece of wood as shaders read it: where it begins and ends, metres from the root, each with its radius there.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Piece {
    from: [f32; 4],
    to: [f32; 4],
}

/// How pieces are read by shaders: one after the other, each for all copies.
pub(super) const LAYOUT: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Piece>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
};

/// Between rings that follow one another on a branch, of the plant as it is drawn from afar.
pub(super) fn pieces(scene: &ForestScene) -> Vec<Piece> {
    let Some(level) = scene.body.levels.last() else { return Vec::new() };
    let mut pieces = Vec::with_capacity(level.rings.len());
    let mut rest = level.rings.as_slice();
    for n in &level.branches {
        let (branch, others) = rest.split_at(*n as usize);
        rest = others;
        pieces.extend(branch.windows(2).map(|pair| {
            let [from, to] = [0, 1].map(|k| {
                let [x, y, z] = pair[k].rest;
                [x, y, z, pair[k].radius]
            });
            Piece { from, to }
        }));
    }
    pieces.sort_by(|a, b| b.from[3].total_cmp(&a.from[3]));
    pieces.truncate((MOST / scene.places.len().max(1)).max(1));
    pieces
}
