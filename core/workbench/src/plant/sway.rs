//! How a plant, or a forest of it, moves in a wind: positions of sensors over time.

use std::path::Path;
use std::time::Instant;

use honami_exchange::Writer;
use honami_exchange::plant::SwayRow;
use honami_mechanics::wind::Wind;
use honami_mechanics::{Damping, Forest, Form, Integrator, Kind, Pace, Stand, Stirring, Threads};

use super::Vibrating;
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// Metres between copies of a plant of height 1, and how far each stands from there by chance.
const APART: f64 = 0.8;
/// Memory is left to others: so much of what is free.
const SHARE_OF_FREE: f64 = 0.8;
/// Where the system does not say what is free, bytes.
const UNKNOWN_FREE: usize = 4 << 30;

/// What is wanted of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Copies of the plant.
    pub n_copies: usize,
    /// Frames, the first at time 0.
    pub n_frames: u32,
    /// Frames per second.
    pub fps: f64,
    /// Steps between two frames, one at least.
    pub n_substeps: u32,
    /// By what method.
    pub integrator: Integrator,
    /// How it is damped and how heavy it is.
    pub damping: Damping,
    /// How nodes follow their modes.
    pub form: Form,
    /// Metres by which the slowest mode is pulled out at the beginning, at the node that it moves most.
    pub pull: f64,
    /// Nodes that are followed on the first copy.
    pub n_sensors: usize,
    /// Of where copies stand and how they are turned.
    pub seed: u64,
    /// Threads.
    pub n_threads: usize,
}

impl Default for Motion {
    /// A plant alone, twenty seconds of it in steps of a frame.
    fn default() -> Self {
        Self {
            n_copies: 1,
            n_frames: 500,
            fps: 25.0,
            n_substeps: 1,
            integrator: Integrator::Exact,
            damping: Damping::default(),
            form: Form::Mode(2),
            pull: 0.0,
            n_sensors: 1,
            seed: 1,
            n_threads: 1,
        }
    }
}

/// What became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    /// Nodes of the beams that were followed.
    pub sensors: Vec<u32>,
    /// Mean deviation of the first of them from its mean place, metres, and how far it was from rest at most.
    pub deviation: f64,
    /// Metres.
    pub farthest: f64,
    /// Frames that were done.
    pub n_frames: u32,
    /// Seconds for a frame: all steps, and where all nodes of all copies are; the median.
    pub frame_s: f64,
    /// Memory, bytes.
    pub bytes: usize,
}

/// Moves a plant and writes where its sensors are, a row a sensor and frame.
///
/// # Errors
/// What [`Forest`] refuses, and what the disk says; nothing is left behind then.
pub fn sway(
    plant: &Vibrating,
    wind: &dyn Wind,
    motion: &Motion,
    out: Option<&Path>,
    progress: &dyn Progress,
) -> Result<Moved, WorkbenchError> {
    if !(motion.fps.is_finite() && motion.fps > 0.0 && motion.n_substeps > 0 && motion.n_frames > 0) {
        return Err(WorkbenchError::Pace { fps: motion.fps, n_substeps: motion.n_substeps });
    }
    let stirring = Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), motion.form);
    let pace =
        Pace { step: 1.0 / (motion.fps * f64::from(motion.n_substeps)), integrator: motion.integrator };
    let kinds = [Kind { scale: 1.0, damping: motion.damping }];
    let mut forest = Forest::new(&stirring, stands(plant, motion), &kinds, &pace, &[], free())?;
    let threads = Threads::new(motion.n_threads)?;
    if motion.pull.abs() > 0.0 {
        forest.pull(0, &pulled(plant, motion.pull));
    }
    let sensors = ends(plant, motion.n_sensors);
    let mut table = out.map(Writer::create).transpose()?;
    let mut first: Vec<[f64; 3]> = Vec::new();
    let mut times = Vec::new();
    for frame in 0..motion.n_frames {
        if progress.report(u64::from(frame), u64::from(motion.n_frames), "frame") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let begun = Instant::now();
        forest.pose(None, &threads)?;
        let mut took = begun.elapsed();
        for (sensor, &node) in (0..).zip(&sensors) {
            let at = forest.position(0, node as usize);
            if sensor == 0 {
                first.push(at.into());
            }
            if let Some(table) = &mut table {
                let time_s = f64::from(frame) / motion.fps;
                table.write(&SwayRow { sensor, node, frame, time_s, x: at.x, y: at.y, z: at.z })?;
            }
        }
        let begun = Instant::now();
        for _ in 0..motion.n_substeps {
            forest.step(wind, &threads)?;
        }
        took += begun.elapsed();
        times.push(took.as_secs_f64());
    }
    table.map(Writer::finish).transpose()?;
    times.sort_by(f64::total_cmp);
    let rest = sensors.first().map_or([0.0; 3], |node| forest.at_rest(0, *node as usize).into());
    let (deviation, farthest) = spread(&first, rest);
    let (n_frames, frame_s, bytes) = (motion.n_frames, times[times.len() / 2], forest.bytes());
    Ok(Moved { sensors, deviation, farthest, n_frames, frame_s, bytes })
}

/// Root of the mean square about the mean, and the farthest from rest.
fn spread(path: &[[f64; 3]], rest: [f64; 3]) -> (f64, f64) {
    let n = path.len().max(1) as f64;
    let mean: [f64; 3] = std::array::from_fn(|axis| path.iter().map(|at| at[axis]).sum::<f64>() / n);
    let square = |at: &[f64; 3], from: &[f64; 3]| (0..3).map(|k| (at[k] - from[k]).powi(2)).sum::<f64>();
    let deviation = (path.iter().map(|at| square(at, &mean)).sum::<f64>() / n).sqrt();
    (deviation, path.iter().map(|at| square(at, &rest)).fold(0.0, f64::max).sqrt())
}

/// Amplitudes with the slowest mode pulled out.
pub(super) fn pulled(plant: &Vibrating, metres: f64) -> Vec<f32> {
    let most =
        (0..plant.beams.len()).map(|node| plant.modes.displacement(0, node).norm()).fold(0.0, f64::max);
    let mut amplitudes = vec![0.0; plant.modes.len()];
    amplitudes[0] = (metres / most.max(f64::MIN_POSITIVE)) as f32;
    amplitudes
}

/// Ends of branches all over the plant, the highest first.
fn ends(plant: &Vibrating, n: usize) -> Vec<u32> {
    let mut ends = plant.beams.ends();
    let height = |node: &u32| plant.beams.position(*node as usize)[2];
    ends.sort_by(|a, b| height(b).total_cmp(&height(a)).then(a.cmp(b)));
    let n = n.clamp(1, ends.len());
    (0..n).map(|k| ends[k * ends.len() / n]).collect()
}

/// Where copies stand: in rows, each a little off and turned by chance; the first as it was measured.
fn stands(plant: &Vibrating, motion: &Motion) -> Vec<Stand> {
    use rand::{RngExt as _, SeedableRng as _};
    let mut chance = rand_pcg::Pcg64Mcg::seed_from_u64(motion.seed);
    let (side, apart) = ((motion.n_copies as f64).sqrt().ceil() as usize, APART * plant.height);
    let mut stand = |k: usize| {
        let mut off = || chance.random_range(-0.25..0.25);
        let (row, column) = (k / side, k % side);
        let place = [(column as f64 + off()) * apart, (row as f64 + off()) * apart, 0.0].map(|v| v as f32);
        let turn = chance.random_range(0.0..std::f32::consts::TAU);
        if k == 0 { Stand::default() } else { Stand { place, turn, kind: 0 } }
    };
    (0..motion.n_copies).map(&mut stand).collect()
}

/// Memory that may be taken, bytes.
pub(crate) fn free() -> usize {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(UNKNOWN_FREE, |kilobytes| (kilobytes * 1024.0 * SHARE_OF_FREE) as usize)
}
