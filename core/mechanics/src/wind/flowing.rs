//! A layer of air over trees that was let flow beforehand, and is read at any place and time like every other wind.

#[cfg(test)]
mod tests;

use super::{Layer, Wind};
use honami_model::brief::Brief;
use nalgebra::{Vector2, Vector3};

/// Cells along each side in which what comes in takes the place of what has come round,
const SIDES: usize = 4;
/// and those between them and the trees.
const FREE: usize = 8;
/// Cells a side.
const MOST_CELLS: usize = 256;

/// What lets air flow.
#[derive(Clone, Copy)]
pub struct Inflow<'a> {
    /// Metres per second; not still.
    pub mean: Vector3<f64>,
    /// What comes in at the sides, its mean included; the level part of it.
    pub gusts: &'a dyn Wind,
    /// Where trees stand, metres, and by how much each holds back the air over a square metre, square metres per second.
    pub trees: &'a [([f64; 2], f64)],
    /// Metres of a cell.
    pub cell: f64,
    /// Square metres per second (errata E23).
    pub viscosity: f64,
    /// Seconds from 0 on that are wanted.
    pub seconds: f64,
    /// Memory that it may take, bytes.
    pub most_bytes: usize,
}

/// Air that cannot be let flow.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FlowingError {
    /// Numbers that no air has.
    #[error(
        "air flows at more than 0 m/s in cells of more than 0 m, with a viscosity of 0 m2/s or more, for a number of seconds: not at {} m/s in cells of {} m with {} m2/s for {} s",
        Brief(*speed), Brief(*cell), Brief(*viscosity), Brief(*seconds)
    )]
    Numbers {
        /// Of its mean.
        speed: f64,
        /// Metres.
        cell: f64,
        /// Square metres per second.
        viscosity: f64,
        /// Wanted.
        seconds: f64,
    },
    /// A tree that is nowhere, or pushes the air.
    #[error(
        "tree {tree} holds back {} m2/s at {}, {}: places are numbers, and nothing pushes the air on",
        Brief(*held), Brief(*x), Brief(*y)
    )]
    Tree {
        /// Which.
        tree: usize,
        /// Metres.
        x: f64,
        /// Metres.
        y: f64,
        /// Square metres per second.
        held: f64,
    },
    /// Too many cells.
    #[error(
        "air over {side:.0} m in cells of {cell} m: at most {MOST_CELLS} cells a side, so {coarser:.1} m of a cell or more"
    )]
    Cells {
        /// Metres of trees and what is around them.
        side: f64,
        /// Metres of a cell.
        cell: f64,
        /// That would do.
        coarser: f64,
    },
    /// More than it may take.
    #[error(
        "{seconds} s of air, {frames} times {n} x {n} cells, take {} MB, and {} MB are there: a larger cell, or less time",
        bytes / 1_000_000, most / 1_000_000
    )]
    Memory {
        /// Wanted.
        seconds: f64,
        /// Times at which it is kept.
        frames: f64,
        /// Cells a side.
        n: usize,
        /// Wanted.
        bytes: usize,
        /// That it may take.
        most: usize,
    },
}

/// Air as it flowed: between places and times it is read along lines; before the first time and after the last it stays,
/// and so it does beyond its sides. It is level, and the same at all heights.
#[derive(Clone, Debug)]
pub struct Flowing {
    n: usize,
    cell: f64,
    corner: Vector2<f64>,
    step: f64,
    /// `(n_frames, n, n)`, y before x.
    frames: Vec<[f32; 2]>,
}

impl Flowing {
    /// Cells around the trees, to each side.
    pub const AROUND: usize = SIDES + FREE;

    /// Lets air flow over trees: from a uniform wind, for as long as it takes to cross them, and then for what is wanted.
    ///
    /// # Errors
    /// [`FlowingError`].
    pub fn new(inflow: &Inflow<'_>) -> Result<Self, FlowingError> {
        let &Inflow { mean, cell, viscosity, seconds, most_bytes, .. } = inflow;
        let speed = mean.xy().norm();
        let is_more = |v: f64| v.is_finite() && v > 0.0;
        let is_air = is_more(speed) && is_more(cell) && viscosity.is_finite() && viscosity >= 0.0;
        if !is_air || !seconds.is_finite() || seconds < 0.0 {
            return Err(FlowingError::Numbers { speed, cell, viscosity, seconds });
        }
        let (corner, n) = ground(inflow)?;
        // Air goes on by a cell a step.
        let step = cell / speed;
        let frames = (seconds / step).ceil() + 1.0;
        let bytes = frames * (n * n * size_of::<[f32; 2]>()) as f64;
        let refused = FlowingError::Memory { seconds, frames, n, bytes: bytes as usize, most: most_bytes };
        if bytes > most_bytes as f64 {
            return Err(refused);
        }
        let mut kept: Vec<[f32; 2]> = Vec::new();
        kept.try_reserve_exact(frames as usize * n * n).map_err(|_full| refused)?;
        let mut layer = Layer::new(n, cell, viscosity);
        for ([x, y], held) in inflow.trees {
            layer.hold(&(Vector2::new(*x, *y) - corner), *held);
        }
        layer.blow(|_, _| mean.xy());
        let before = n as i32;
        for frame in -before..frames as i32 {
            let time = f64::from(frame) * step;
            layer.blow(|at, now| came_in(inflow, &corner, n, at, now, time));
            layer.settle(0.0);
            if frame >= 0 {
                kept.extend(layer.velocities().map(|v| v.map(|v| v as f32)));
            }
            layer.step(step);
        }
        Ok(Self { n, cell, corner, step, frames: kept })
    }

    /// What it takes, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.frames.as_slice())
    }
}

/// Where the first cell is, and cells a side: trees in the middle, and around them what they need.
fn ground(inflow: &Inflow<'_>) -> Result<(Vector2<f64>, usize), FlowingError> {
    let (mut low, mut high) = (Vector2::repeat(f64::INFINITY), Vector2::repeat(f64::NEG_INFINITY));
    for (tree, &([x, y], held)) in inflow.trees.iter().enumerate() {
        let is_tree = [x, y, held].iter().all(|v| v.is_finite()) && held >= 0.0;
        if !is_tree {
            return Err(FlowingError::Tree { tree, x, y, held });
        }
        (low, high) = (low.inf(&Vector2::new(x, y)), high.sup(&Vector2::new(x, y)));
    }
    if inflow.trees.is_empty() {
        (low, high) = (Vector2::zeros(), Vector2::zeros());
    }
    let (cell, around) = (inflow.cell, 2 * Flowing::AROUND);
    let wide = (high - low).amax();
    let n = (wide / cell).ceil() + around as f64;
    if n > MOST_CELLS as f64 {
        // Rounded up to what is printed.
        let coarser = (wide / (MOST_CELLS - around) as f64 * 10.0).ceil() / 10.0;
        return Err(FlowingError::Cells { side: n * cell, cell, coarser });
    }
    let n = (n as usize).next_multiple_of(2);
    let middle = (low + high) / 2.0;
    Ok((middle - Vector2::repeat((n - 1) as f64 / 2.0 * cell), n))
}

/// Along the sides what comes in, in the middle what was there, and between them some of both.
fn came_in(
    inflow: &Inflow<'_>,
    corner: &Vector2<f64>,
    n: usize,
    at: Vector2<f64>,
    now: Vector2<f64>,
    time: f64,
) -> Vector2<f64> {
    let inside = at.map(|v| v / inflow.cell).map(|v| v.min((n - 1) as f64 - v)).min();
    let share = 1.0 - inside / SIDES as f64;
    if share <= 0.0 {
        return now;
    }
    let place = corner + at;
    let gust = inflow.gusts.sample(&Vector3::new(place.x, place.y, 0.0), time).xy();
    now + (gust - now) * share
}

impl Wind for Flowing {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let per_frame = self.n * self.n;
        let last = [(self.n - 1) as f64, (self.frames.len() / per_frame - 1) as f64];
        let at = (place.xy() - self.corner) / self.cell;
        let [x, y] = [at.x, at.y].map(|v| v.clamp(0.0, last[0]));
        let time = (time / self.step).clamp(0.0, last[1]);
        let mut sum = Vector2::zeros();
        for (frame, wt) in ends(time, last[1]) {
            for (row, wy) in ends(y, last[0]) {
                for (column, wx) in ends(x, last[0]) {
                    let v = self.frames[frame * per_frame + row * self.n + column].map(f64::from);
                    sum += Vector2::from(v) * (wt * wy * wx);
                }
            }
        }
        sum.push(0.0)
    }
}

/// The two whole numbers about a number, and how near each is.
fn ends(v: f64, last: f64) -> [(usize, f64); 2] {
    let (first, share) = (v.floor(), v.fract());
    [(first as usize, 1.0 - share), ((first + 1.0).min(last) as usize, share)]
}
