//! Dense motion: that of new particles, on a grid.

use honami_follow::{check_size, dense, picture};
use honami_plugin::{Cx, Error, Field, Frame, Result};
use honami_vision::field::Grid;
use honami_vision::particles::Swarm;
use honami_vision::pyramid::Pyramid;
use honami_vision::work;

use crate::settings::Settings;

/// Nodes that are as close as this see no more, pixels at least.
const STEP_PX: u32 = 4;

/// Displacements between two frames; none where no particle reaches.
pub(crate) fn field(
    settings: &Settings,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let params = settings.swarm();
    let mut swarm = Swarm::new(&params, &picture(from));
    let [from, to] =
        [from, to].map(|frame| Pyramid::new(&picture(frame), params.klt.levels, params.klt.radius_px));
    let mut go_on = |share: f64| cx.progress(0.5 * share, "following particles").is_ok();
    let spots = swarm.step([&from, &to], max_threads as usize, &mut go_on).ok_or_else(Error::cancelled)?;
    let size = from.picture();
    let grid = Grid::over(size.width, size.height, STEP_PX.max(settings.reach as u32 / 4));
    let nodes: Vec<_> = grid.nodes().collect();
    let mut go_on = |share: f64| cx.progress(0.5 + 0.5 * share, "measuring motion").is_ok();
    let at = |part: &[honami_vision::Point]| part.iter().map(|&node| spots.at(node)).collect();
    let vectors = work::in_looks(&nodes, spots.cost_ns(), &mut go_on, at).ok_or_else(Error::cancelled)?;
    Ok(dense(grid, vectors))
}
