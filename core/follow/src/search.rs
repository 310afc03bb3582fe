//! Lucas-Kanade's search as plugins offer it: its parameters, points there and back, and dense motion on a grid.

use honami_plugin::{Cx, Error, Field, Frame, Result, params};
use honami_vision::field::{Drift, Grid};
use honami_vision::klt::{self, State};
use honami_vision::pyramid::Pyramid;
use honami_vision::{Gray, Point as Place, work};

use crate::{Step, check_size, dense, picture};

params! {
    /// How a window is searched; its radius is the plugin's own.
    pub struct Search {
        /// Levels of the pyramid; each doubles the displacement that can be followed.
        levels: i64 = 4 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 6 },
        /// The most steps on each level.
        iterations: i64 = 30 => {
            label: "Iterations", group: "Tracking", min: 1, max: 1000, soft_max: 100, advanced: true,
        },
        /// A shorter step ends the search on a level.
        epsilon: f64 = 0.01 => {
            label: "Epsilon", group: "Tracking", unit: "px", min: 1e-5, max: 1, scale: "log", advanced: true,
        },
        /// A template whose gradient matrix has a smaller eigenvalue is flat, and not found (OpenCV's measure).
        min_eigenvalue: f64 = 1e-4 => {
            label: "Minimum eigenvalue", group: "Tracking", min: 0, max: 1, advanced: true,
        },
    }
}

impl Search {
    /// For windows of this radius, pixels.
    #[must_use]
    pub fn klt(&self, radius: i64) -> klt::Params {
        klt::Params {
            radius_px: radius as u32,
            levels: self.levels as u32,
            max_iterations: self.iterations as u32,
            epsilon_px: self.epsilon as f32,
            min_eigenvalue: self.min_eigenvalue as f32,
        }
    }
}

/// The pyramid of a frame, in the memory of one that nobody needs any more, if there is one; both of one size.
#[must_use]
pub fn pyramid(picture: &Gray<'_>, spare: Option<Pyramid>, params: &klt::Params) -> Pyramid {
    match spare {
        None => Pyramid::new(picture, params.levels, params.radius_px),
        Some(mut pyramid) => {
            pyramid.fill(picture);
            pyramid
        }
    }
}

/// Follows points there and back; `search` does so from one of the pictures to the other, and takes about `cost_ns`
/// nanoseconds for a point on one thread.
///
/// # Errors
/// When the user wants to stop.
pub fn there_and_back<P>(
    [before, now]: [&P; 2],
    from: &[Place],
    cost_ns: f64,
    cx: &Cx<'_>,
    search: impl Fn(&P, &P, &[Place]) -> Vec<klt::Flow>,
) -> Result<Vec<Step>> {
    let mut go_on = |share: f64| cx.progress(share, "following points").is_ok();
    work::in_looks(from, 2.0 * cost_ns, &mut go_on, |from| {
        let there = search(before, now, from);
        let ends: Vec<_> = there.iter().map(|flow| flow.to).collect();
        let back = search(now, before, &ends);
        let step = |(there, back): (&klt::Flow, &klt::Flow)| Step {
            to: match there.state {
                State::Tracked => Drift::To(there.to),
                State::Outside => Drift::Outside,
                State::Lost(_) => Drift::Unknown,
            },
            home: (back.state == State::Tracked).then_some(back.to),
        };
        there.iter().zip(&back).map(step).collect()
    })
    .ok_or_else(Error::cancelled)
}

/// Displacements between two frames; none where nothing could be measured: no texture, hidden, or out of the picture.
///
/// # Errors
/// When the frames differ in size, or the user wants to stop.
pub fn klt_field(
    params: &klt::Params,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let [from, to] = [from, to].map(|frame| pyramid(&picture(frame), None, params));
    let grid = windows(&from.picture(), params.radius_px);
    field_there_and_back(grid, [&from, &to], params.cost_ns(), cx, |prev, next, from| {
        klt::track(prev, next, from, None, params, max_threads as usize)
    })
}

/// Nodes a radius apart, so that windows overlap by half: closer ones would mostly see the same.
#[must_use]
pub fn windows(picture: &Gray<'_>, radius_px: u32) -> Grid {
    /// At least.
    const STEP_PX: u32 = 4;
    Grid::over(picture.width, picture.height, radius_px.max(STEP_PX))
}

/// Displacements of nodes as [`there_and_back`] finds them; none where the way back does not end where it began.
///
/// # Errors
/// When the user wants to stop.
pub fn field_there_and_back<P>(
    grid: Grid,
    frames: [&P; 2],
    cost_ns: f64,
    cx: &Cx<'_>,
    search: impl Fn(&P, &P, &[Place]) -> Vec<klt::Flow>,
) -> Result<Field> {
    /// No farther from there, pixels.
    const ASTRAY_PX: f32 = 1.0;
    let nodes: Vec<_> = grid.nodes().collect();
    let steps = there_and_back(frames, &nodes, cost_ns, cx, search)?;
    let moved = |(at, step): (&Place, Step)| match step {
        Step { to: Drift::To(to), home: Some(home) }
            if (home[0] - at[0]).hypot(home[1] - at[1]) <= ASTRAY_PX =>
        {
            Some([to[0] - at[0], to[1] - at[1]])
        }
        _ => None,
    };
    Ok(dense(grid, nodes.iter().zip(steps).map(moved)))
}
