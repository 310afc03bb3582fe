//! Dense motion: the picture as a set of overlapping squares, each looked for by itself, there and back.

use honami_follow::{check_size, dense, picture};
use honami_plugin::{Cx, Field, Frame, Result};
use honami_vision::boxes::{self, Boxes};
use honami_vision::field::Grid;
use honami_vision::klt::State;

use crate::points_a_look;
use crate::settings::Settings;

/// Nodes are a radius apart, so that windows overlap by half: closer ones would mostly see the same. At least, pixels:
const STEP_PX: u32 = 4;
/// A node whose way there and back ends farther than this from its start has no known motion, pixels.
const ASTRAY_PX: f32 = 1.0;

/// Displacements between two frames; none where nothing could be measured: no texture, hidden, or out of the picture.
pub(crate) fn field(
    settings: &Settings,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let params = settings.matching();
    let [from, to] = [from, to].map(picture);
    let grid = Grid::over(from.width, from.height, params.radius_px.max(STEP_PX));
    let [from, to] = [from, to].map(|gray| Boxes::new(&gray, params.levels(), params.radius_px));
    let nodes: Vec<_> = grid.nodes().collect();
    let mut vectors = Vec::new();
    for nodes in nodes.chunks(points_a_look(&params)) {
        cx.progress(vectors.len() as f64 / grid.len() as f64, "measuring motion")?;
        let there = boxes::track(&from, &to, nodes, None, &params, max_threads as usize);
        let ends: Vec<_> = there.iter().map(|found| found.to).collect();
        let back = boxes::track(&to, &from, &ends, None, &params, max_threads as usize);
        for ((at, there), back) in nodes.iter().zip(&there).zip(&back) {
            let is_found = there.state == State::Tracked && back.state == State::Tracked;
            let is_back = (back.to[0] - at[0]).hypot(back.to[1] - at[1]) <= ASTRAY_PX;
            vectors.push((is_found && is_back).then(|| [there.to[0] - at[0], there.to[1] - at[1]]));
        }
    }
    Ok(dense(grid, vectors))
}
