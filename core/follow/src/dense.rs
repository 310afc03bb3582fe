//! Dense motion by Lucas-Kanade's search from the nodes of a grid, there and back.

use honami_plugin::{Cx, Field, Frame, Result};
use honami_vision::field::Grid;
use honami_vision::klt::{self, State};
use honami_vision::pyramid::Pyramid;

use crate::{dense, picture};

/// Nodes are a radius apart, so that windows overlap by half: closer ones would mostly see the same. At least, pixels:
const STEP_PX: u32 = 4;
/// A node whose way there and back ends farther than this from its start has no known motion, pixels.
const ASTRAY_PX: f32 = 1.0;
/// Nodes that are followed between two looks at whether to go on.
const NODES_A_LOOK: usize = 2048;

/// Displacements between two frames; none where nothing could be measured: no texture, hidden, or out of the picture.
///
/// # Errors
/// When the user wants to stop.
pub fn klt_field(
    params: &klt::Params,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<Field> {
    let [from, to] = [from, to].map(picture);
    let step = params.radius_px.max(STEP_PX);
    let grid = Grid::over(from.width, from.height, step);
    let nodes: Vec<_> = grid.nodes().collect();

    let [from, to] = [from, to].map(|gray| Pyramid::new(&gray, params.levels, params.radius_px));
    let moved = |((at, there), back): ((&[f32; 2], &klt::Flow), &klt::Flow)| {
        let is_found = there.state == State::Tracked && back.state == State::Tracked;
        let is_back = (back.to[0] - at[0]).hypot(back.to[1] - at[1]) <= ASTRAY_PX;
        (is_found && is_back).then(|| [there.to[0] - at[0], there.to[1] - at[1]])
    };
    let mut vectors = Vec::with_capacity(nodes.len());
    for part in nodes.chunks(NODES_A_LOOK) {
        cx.progress(vectors.len() as f64 / nodes.len() as f64, "following a grid")?;
        let there = klt::track(&from, &to, part, None, params, max_threads as usize);
        let ends: Vec<_> = there.iter().map(|flow| flow.to).collect();
        let back = klt::track(&to, &from, &ends, None, params, max_threads as usize);
        vectors.extend(part.iter().zip(&there).zip(&back).map(moved));
    }
    Ok(dense(grid, vectors))
}
