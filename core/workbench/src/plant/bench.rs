//! The tables 6.1 and 6.2 of the thesis, cell by cell, on this machine.

pub mod cells;
mod crowd;

use std::time::Instant;

use honami_host::{CallContext, Host, PluginInfo, Steps, WindRows};
use honami_mechanics::{
    Damping, Detail, Forest, Form, Integrator, Pace, Pose, Roof, Stand, Stirring, Threads, Vector,
};
use honami_motion::accuracy;

use self::cells::Cell;
use self::crowd::Crowd;
use super::mover::{Mover, start};
use super::sway::Motion;
use super::told::{Chosen, told};
use super::{Wish, sway, vibrate};
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// The thesis's forest with less of what is farther away: more than 4000 trees at 30 frames per second at least, with
/// rendering (6.6).
pub const IN_VIEW: [Cell; 1] = [(4000, 3437, 25, Some(30.0))];

/// Copies, nodes and modes with what the thesis has of them in some table.
#[must_use]
pub fn of_thesis(table: &[Cell], [copies, nodes, modes]: [usize; 3]) -> Cell {
    let known = table.iter().find(|cell| (cell.0, cell.1, cell.2) == (copies, nodes, modes));
    known.copied().unwrap_or((copies, nodes, modes, None))
}

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
    /// By turns of segments.
    pub turned: Rate,
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
    /// Copies of which any node is moved.
    pub n_in_view: usize,
    /// Nodes that are moved in a frame, of all copies.
    pub n_moved: usize,
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

/// Measures cells one after the other, with all nodes of all copies moved.
///
/// # Errors
/// [`WorkbenchError::Stopped`], and what the system refuses.
pub fn speeds(cells: &[Cell], runs: &Runs, progress: &dyn Progress) -> Result<Vec<Speed>, WorkbenchError> {
    measured(cells, runs, progress, |_, n_copies| Ok(Crowd::whole(n_copies)))
}

/// The same, with as much of every copy moved as an eye at the edge of the forest makes out.
///
/// # Errors
/// As [`speeds`].
pub fn seen(cells: &[Cell], runs: &Runs, progress: &dyn Progress) -> Result<Vec<Speed>, WorkbenchError> {
    measured(cells, runs, progress, |plant, n_copies| Ok(Crowd::seen(plant, n_copies)?))
}

fn measured(
    cells: &[Cell],
    runs: &Runs,
    progress: &dyn Progress,
    crowd: impl Fn(&Stirring, usize) -> Result<Crowd, WorkbenchError>,
) -> Result<Vec<Speed>, WorkbenchError> {
    let threads = Threads::new(runs.n_threads)?;
    let mut speeds = Vec::new();
    for (k, &(n_copies, n_nodes, n_modes, thesis_fps)) in cells.iter().enumerate() {
        if progress.report(k as u64, cells.len() as u64, "cell") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let plant = vibrate(&Wish::of(&format!("synth::tree:{n_nodes},1"), Some(n_modes)), &())?;
        let nodes = plant.beams.coarse_to_fine();
        let rate = |form: Form| {
            let stirring = Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), form);
            let crowd = crowd(&stirring, n_copies)?;
            rate(&stirring, &nodes, &crowd, runs, &threads)
        };
        let (linear, squared, cubed) = (rate(Form::Linear)?, rate(Form::Mode(2))?, rate(Form::Mode(3))?);
        let turned = rate(Form::Turn)?;
        speeds.push(Speed { n_copies, n_nodes, n_modes, thesis_fps, linear, squared, cubed, turned });
    }
    Ok(speeds)
}

fn rate(
    plant: &Stirring,
    nodes: &[u32],
    crowd: &Crowd,
    runs: &Runs,
    threads: &Threads,
) -> Result<Rate, WorkbenchError> {
    let n_copies = crowd.stands.len();
    sway::room(n_copies, nodes.len(), plant.n_modes())?;
    let damping = Damping::default();
    let pace = Pace { step: 1.0 / 30.0, integrator: Integrator::Exact, damping };
    let mut forest = Forest::new(plant, nodes, &crowd.stands, &pace)?;
    let whole = Detail { n_nodes: nodes.len() as u32, n_modes: plant.n_modes() as u32 };
    let details = crowd.details(plant).unwrap_or_else(|| vec![whole; n_copies]);
    let n_moved: usize = details.iter().map(|detail| detail.n_nodes as usize).sum();
    let n_terms: f64 =
        details.iter().map(|detail| f64::from(detail.n_nodes) * f64::from(detail.n_modes)).sum();
    let n_in_view = details.iter().filter(|detail| detail.n_nodes > 0).count();
    let mut motion = vec![[0.0; 3]; n_moved];
    let mut frame = |motion: Option<&mut [[f32; 3]]>| {
        let begun = Instant::now();
        // Whoever looks has moved: what it sees is asked in every frame.
        let details = motion.is_some().then(|| crowd.details(plant)).flatten();
        step(&mut forest, motion.map(|motion| Pose { details: details.as_deref(), motion }), threads)?;
        Ok::<_, WorkbenchError>(begun.elapsed().as_secs_f64())
    };
    // The memory is touched, and threads are awake.
    frame(Some(&mut motion))?;
    let (mut fps, mut share) = (Vec::new(), Vec::new());
    for _ in 0..runs.n_runs {
        let (mut n, mut whole_s, mut state_s) = (0, 0.0, 0.0);
        while n < 2 || whole_s < runs.seconds {
            whole_s += frame(Some(&mut motion))?;
            // Beside a frame, what takes no part in it: the same step without positions.
            state_s += frame(None)?;
            n += 1;
        }
        fps.push(f64::from(n) / whole_s);
        share.push(state_s / whole_s);
    }
    let [fps, state_share] = [fps, share].map(median);
    let written = 12.0 * n_moved as f64 * fps;
    let flops = 6.0 * n_terms * plant.following().n_powers() as f64 * fps;
    Ok(Rate { fps, state_share, written, flops, n_in_view, n_moved })
}

/// Goes on in a wind that is another at every copy and time and costs next to nothing: what a wind costs is no part of a
/// cell.
fn step(forest: &mut Forest, pose: Option<Pose<'_>>, threads: &Threads) -> Result<(), WorkbenchError> {
    let phase = forest.time() * 7.0;
    let wind = |copy: usize| Vector::new(5.0, 2.0, 0.3) * (1.0 + 0.3 * (phase + copy as f64 * 0.37).fract());
    Ok(forest.step(&wind, pose, threads)?)
}

/// A frame of a forest through a simulator plugin beside the same frame without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Seconds without, the median of the runs.
    pub direct_s: f64,
    /// And through the plugin.
    pub plugin_s: f64,
    /// How many times as long through the plugin: the least of the runs, their median, the most.
    pub ratio: [f64; 3],
}

/// Measures what a plugin costs: two forests of a cell, frames in turns, segments turning.
///
/// # Errors
/// What the simulator or the system refuses.
pub fn boundary(
    &(n_copies, n_nodes, n_modes, _): &Cell,
    runs: &Runs,
    host: &Host,
    plugin: &PluginInfo,
) -> Result<Boundary, WorkbenchError> {
    let wish = Wish::of(&format!("synth::tree:{n_nodes},1"), Some(n_modes));
    let plant = vibrate(&wish, &())?;
    sway::room(n_copies, 2 * n_nodes, 2 * n_modes)?;
    let stands: Vec<Stand> = (0..n_copies).map(|k| Stand { turn: k as f32, ..Stand::default() }).collect();
    let stirring = Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), Form::Turn);
    let pace = Pace { step: 1.0 / 30.0, integrator: Integrator::Exact, damping: Damping::default() };
    let mut forest = Forest::new(&stirring, &plant.beams.coarse_to_fine(), &stands, &pace)?;
    let (mut motion, threads) = (vec![[0.0; 3]; n_copies * n_nodes], Threads::new(runs.n_threads)?);
    let told = told(&wish, &Motion::default(), plugin, Chosen::All, &[])?;
    let (cx, mover) = (CallContext::silent(), Mover { host, plugin, values: &told.values });
    let (mut simulator, _) = start(&plant, &mover, &stands, runs.n_threads, 1, &cx)?;
    let winds: Vec<[f32; 3]> = (0..n_copies).map(|k| [5.0 + (k % 7) as f32, 2.0, 0.3]).collect();
    let steps =
        Steps { dt: pace.step, n: 1, wind: WindRows { times_s: &[0.0], velocities: &winds }, detail: None };
    let mut frames = |n: usize| -> Result<[f64; 2], WorkbenchError> {
        let mut took = [0.0; 2];
        for _ in 0..n {
            let begun = Instant::now();
            let pose = Some(Pose { details: None, motion: &mut motion });
            forest.step(&|copy| Vector::from(winds[copy].map(f64::from)), pose, &threads)?;
            took[0] += begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            simulator.step(&steps, &cx)?;
            took[1] += begun.elapsed().as_secs_f64();
        }
        Ok(took.map(|seconds| seconds / n as f64))
    };
    // The memory is touched, and threads are awake.
    let [once, _] = frames(2)?;
    let n = ((runs.seconds / once) as usize).max(2);
    let found = (0..runs.n_runs).map(|_| frames(n)).collect::<Result<Vec<_>, _>>()?;
    let mut ratios: Vec<f64> = found.iter().map(|[direct, plugin]| plugin / direct).collect();
    ratios.sort_by(f64::total_cmp);
    let (least, most) = (ratios[0], ratios[ratios.len() - 1]);
    let [direct_s, plugin_s] = [0, 1].map(|k| median(found.iter().map(|took| took[k]).collect()));
    let ratio = [least, median(ratios), most];
    Ok(Boundary { direct_s, plugin_s, ratio })
}

fn median(values: Vec<f64>) -> f64 {
    accuracy::median(values).unwrap_or_default()
}
