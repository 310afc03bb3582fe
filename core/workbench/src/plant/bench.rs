//! The tables 6.1 and 6.2 of the thesis, cell by cell, on this machine.

use std::time::Instant;

use honami_mechanics::wind::Wind;
use honami_mechanics::{Direction, Forest, Form, Integrator, Kind, Pace, Roof, Stand, Stirring, Threads};

use super::{Wish, sway, vibrate};
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// A cell: copies, nodes, modes, and the frames per second that the thesis has (GeForce 8800 GTS; table 6.2 with
/// rendering).
pub type Cell = (usize, usize, usize, Option<f64>);

/// Table 6.1: 25 modes, without rendering.
pub const TABLE_6_1: [Cell; 13] = [
    (100, 1000, 25, Some(712.0)),
    (100, 2000, 25, Some(385.0)),
    (100, 8000, 25, Some(103.0)),
    (1000, 100, 25, Some(690.0)),
    (1000, 500, 25, Some(169.0)),
    (1000, 1000, 25, Some(87.0)),
    (1000, 2000, 25, Some(43.0)),
    (1000, 8000, 25, Some(11.0)),
    (8000, 20, 25, Some(426.0)),
    (8000, 100, 25, Some(102.0)),
    (8000, 500, 25, Some(21.0)),
    (8000, 1000, 25, Some(11.0)),
    (10_000, 3437, 25, None),
];

/// Table 6.2: 3437 nodes.
pub const TABLE_6_2: [Cell; 12] = [
    (500, 3437, 5, Some(73.0)),
    (1000, 3437, 5, Some(39.0)),
    (2000, 3437, 5, Some(19.0)),
    (4000, 3437, 5, Some(10.0)),
    (500, 3437, 15, Some(57.0)),
    (1000, 3437, 15, Some(29.0)),
    (2000, 3437, 15, Some(14.0)),
    (4000, 3437, 15, Some(7.0)),
    (500, 3437, 25, Some(43.0)),
    (1000, 3437, 25, Some(22.0)),
    (2000, 3437, 25, Some(11.0)),
    (4000, 3437, 25, Some(6.0)),
];

/// How fast a cell is here, frames per second; the median of the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// Copies.
    pub n_copies: usize,
    /// Nodes of each.
    pub n_nodes: usize,
    /// Modes of each.
    pub n_modes: usize,
    /// The thesis's.
    pub thesis_fps: Option<f64>,
    /// Nodes by straight lines.
    pub linear: Rate,
    /// By one arc tangent a mode and its square.
    pub squared: Rate,
    /// And its cube.
    pub cubed: Rate,
}

/// A forest that moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// Frames per second: wind, modes and all nodes.
    pub fps: f64,
    /// Share of the frame that winds and modes take.
    pub state_share: f64,
    /// Positions written, bytes per second.
    pub written: f64,
    /// Multiplications with addition, twice their number per second.
    pub flops: f64,
}

/// How it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Runs {
    /// Runs of which the median counts.
    pub n_runs: usize,
    /// Each lasts so long or two frames, seconds.
    pub seconds: f64,
    /// Threads.
    pub n_threads: usize,
}

/// The most that this machine can do, on so many threads.
///
/// # Errors
/// [`WorkbenchError::Threads`].
pub fn roof(n_threads: usize) -> Result<Roof, WorkbenchError> {
    Ok(Roof::measured(&Threads::new(n_threads)?, n_threads))
}

/// Measures cells one after the other.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the system refuses.
pub fn speeds(cells: &[Cell], runs: &Runs, progress: &dyn Progress) -> Result<Vec<Speed>, WorkbenchError> {
    let threads = Threads::new(runs.n_threads)?;
    let mut speeds = Vec::new();
    for (k, &(n_copies, n_nodes, n_modes, thesis_fps)) in cells.iter().enumerate() {
        if progress.report(k as u64, cells.len() as u64, "cell") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let plant = vibrate(&Wish::of(&format!("synth::tree:{n_nodes},1"), n_modes))?;
        let rate = |form: Form| {
            let stirring = Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), form);
            rate(&stirring, n_copies, runs, &threads)
        };
        let (linear, squared, cubed) = (rate(Form::Linear)?, rate(Form::Mode(2))?, rate(Form::Mode(3))?);
        speeds.push(Speed { n_copies, n_nodes, n_modes, thesis_fps, linear, squared, cubed });
    }
    Ok(speeds)
}

fn rate(plant: &Stirring, n_copies: usize, runs: &Runs, threads: &Threads) -> Result<Rate, WorkbenchError> {
    let stand = |k: usize| Stand { place: [k as f32, 0.0, 0.0], turn: k as f32, kind: 0 };
    let stands = (0..n_copies).map(stand).collect();
    let pace = Pace { step: 1.0 / 30.0, integrator: Integrator::Exact };
    let mut forest = Forest::new(plant, stands, &[Kind::default()], &pace, &[], sway::free())?;
    let wind = Ramp(Direction::new(5.0, 2.0, 0.3));
    // The memory is touched, and threads are awake.
    frame(&mut forest, &wind, threads)?;
    let mut fps = Vec::new();
    let mut share = Vec::new();
    for _ in 0..runs.n_runs {
        let (begun, mut n, mut state_s) = (Instant::now(), 0, 0.0);
        while n < 2 || begun.elapsed().as_secs_f64() < runs.seconds {
            state_s += frame(&mut forest, &wind, threads)?;
            n += 1;
        }
        let seconds = begun.elapsed().as_secs_f64();
        fps.push(f64::from(n) / seconds);
        share.push(state_s / seconds);
    }
    let [fps, state_share] = [fps, share].map(median);
    let numbers = (3 * n_copies * plant.n_nodes()) as f64;
    let rows = (plant.n_modes() * plant.n_powers()) as f64;
    Ok(Rate { fps, state_share, written: 4.0 * numbers * fps, flops: 2.0 * rows * numbers * fps })
}

/// A wind that is another at every place and time and costs next to nothing: what a wind costs is no part of a cell.
struct Ramp(Direction);

impl Wind for Ramp {
    fn sample(&self, place: &Direction, time: f64) -> Direction {
        self.0 * (1.0 + 0.3 * (time * 7.0 + place.x).fract())
    }
}

/// A frame; the seconds of winds and modes.
fn frame(forest: &mut Forest<'_>, wind: &dyn Wind, threads: &Threads) -> Result<f64, WorkbenchError> {
    let begun = Instant::now();
    forest.step(wind, threads)?;
    let state_s = begun.elapsed().as_secs_f64();
    forest.pose(None, threads)?;
    Ok(state_s)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
