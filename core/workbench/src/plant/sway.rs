//! How a plant, or a forest of it, moves in a wind: positions of sensors over time.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use honami_exchange::plant::SwayRow;
use honami_mechanics::wind::Wind;
use honami_mechanics::{Damping, ForestError, Form, Integrator, LimitError, Oscillator, Pace, Stand};

use super::Vibrating;
use super::glb::{Gathering, Made};
use super::mover::{Moving, Played, Way};
use super::outs::{Files, Outs, check_room, free_in};
use super::told::{METHODS, word};
use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::Progress;
use honami_scene::grove::{Grove, Planting};

/// Steps a second: in shorter ones a state in single precision changes by too few of its last digits.
const MOST_STEPS: f64 = 1e5;
/// Frames per second: of anything slower numbers overflow or no frame ever comes.
const FPS: RangeInclusive<f64> = 1e-3..=MOST_STEPS;
/// A method may swing a mode too fast or too slowly by so much without a word.
const OFF_PACE: f64 = 0.01;
/// Copies are up to five times as large or heavy.
const SPREADS: RangeInclusive<f64> = 0.0..=4.0;
/// Metres between copies.
const SPACINGS: RangeInclusive<f64> = 1e-3..=1e5;
/// Metres by which a plant may be pulled.
const FARTHEST_PULL: f64 = 1000.0;
/// Vibration modes are of small motion: of the height, so far may a node be moved without a word.
const FAR: f64 = 0.3;
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
    /// Ends of branches that are followed on the first copy, where no nodes are named.
    pub n_sensors: usize,
    /// Nodes of the beams that are followed on the first copy.
    pub sensors: Vec<u32>,
    /// Copies are up to 1 + so much times larger or smaller than the plant; the first is as it was measured.
    pub size_spread: f64,
    /// And heavier or lighter than one of their size.
    pub mass_spread: f64,
    /// Metres between copies; `None`: 0.8 times the plant's height.
    pub spacing: Option<f64>,
    /// Of where copies stand, how they are turned, and their sizes and masses.
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
            form: Form::Turn,
            pull: 0.0,
            n_sensors: 1,
            sensors: Vec::new(),
            size_spread: 0.0,
            mass_spread: 0.0,
            spacing: None,
            seed: 1,
            n_threads: 1,
        }
    }
}

impl Motion {
    /// Whether it can be.
    ///
    /// # Errors
    /// [`WorkbenchError::Pace`], [`WorkbenchError::Spread`], [`WorkbenchError::Spacing`], [`WorkbenchError::Pull`],
    /// [`ForestError::Damping`].
    pub fn check(&self) -> Result<(), WorkbenchError> {
        let Self { fps, n_substeps, n_frames, pull, size_spread: size, mass_spread: mass, .. } = *self;
        if ![size, mass].iter().all(|spread| SPREADS.contains(spread)) {
            return Err(WorkbenchError::Spread { size, mass });
        }
        if let Some(metres) = self.spacing.filter(|metres| !SPACINGS.contains(metres)) {
            return Err(WorkbenchError::Spacing { metres });
        }
        let Damping { alpha, beta, mass: heavier, air } = self.damping;
        let is_damped = [alpha, beta, air].iter().all(|v| v.is_finite() && *v >= 0.0);
        if !(is_damped && heavier.is_finite() && heavier > 0.0) {
            return Err(ForestError::Damping { mass: heavier, alpha, beta, air }.into());
        }
        let is_long = n_substeps > 0 && fps * f64::from(n_substeps) <= MOST_STEPS;
        if !(FPS.contains(&fps) && is_long && n_frames > 0) {
            return Err(WorkbenchError::Pace { fps, n_substeps });
        }
        // Further than any plant bends, and nothing overflows.
        if pull.abs() <= FARTHEST_PULL { Ok(()) } else { Err(WorkbenchError::Pull { pull }) }
    }

    /// Where copies of a plant stand, and how.
    pub(super) fn grove(&self, plant: &Vibrating) -> Grove {
        let Self { n_copies, size_spread, mass_spread, spacing, seed, .. } = *self;
        Grove::new(plant.height, &Planting { n_copies, size_spread, mass_spread, spacing, seed })
    }

    /// Seconds of a step.
    pub(super) fn step(&self) -> f64 {
        1.0 / (self.fps * f64::from(self.n_substeps))
    }

    /// Whether its method bears its steps.
    pub(super) fn bears(&self, plant: &Vibrating, stands: &[Stand]) -> Result<(), WorkbenchError> {
        let pace = Pace { step: self.step(), integrator: self.integrator, damping: self.damping };
        let refused = pace.bears(&plant.modes.omegas, stands);
        refused.map_err(|source| match source {
            LimitError::Limit { limit, .. } if 1.0 / limit < MOST_STEPS - self.fps => {
                let n_substeps = (1.0 / (limit * self.fps)).floor() as u32 + 1;
                WorkbenchError::Substeps { source, n_substeps }
            }
            source => ForestError::Limit(source).into(),
        })
    }

    /// What there is to say of a method that swings modes too fast or too slowly.
    fn off_pace(&self, plant: &Vibrating) -> Option<String> {
        let modes =
            || plant.modes.omegas.iter().map(|omega| Oscillator::new(*omega, &self.damping)).enumerate();
        let off = |mode: &Oscillator, step: f64| {
            mode.swings(self.integrator, step).map_or(0.0, |share| share - 1.0)
        };
        let apart = |a: &f64, b: &f64| a.abs().total_cmp(&b.abs());
        let offs = modes().map(|(mode, own)| (mode, own.omega, off(&own, self.step())));
        let (mode, omega, most) =
            offs.max_by(|a, b| apart(&a.2, &b.2)).filter(|most| most.2.abs() > OFF_PACE)?;
        let most_substeps = (MOST_STEPS / self.fps) as u32;
        let is_near = |n: &u32| {
            let step = 1.0 / (self.fps * f64::from(*n));
            modes().all(|(_, own)| off(&own, step).abs() <= OFF_PACE)
        };
        let enough = (self.n_substeps..=most_substeps).find(is_near);
        Some(format!(
            "in steps of {} s --method {} swings modes too {}, mode {} of {:.3} Hz by {:.1} %{}",
            self.step(),
            word(&METHODS, self.integrator),
            if most > 0.0 { "fast" } else { "slowly" },
            mode + 1,
            omega / TAU,
            100.0 * most.abs(),
            enough.map_or_else(String::new, |n| format!(": --substeps {n} leaves 1 %")),
        ))
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
    /// How far any node of any copy was from rest at most, as a share of the plant's height.
    pub share: f64,
    /// What there is to warn of that.
    pub too_far: Option<String>,
    /// Frames that were done.
    pub n_frames: u32,
    /// Seconds for a frame: all steps, and where all nodes of all copies are; the median.
    pub frame_s: f64,
    /// Memory, bytes.
    pub bytes: usize,
    /// What the simulator warned of.
    pub warnings: Vec<String>,
    /// What became of the plant in a file with its motion.
    pub glb: Option<Made>,
}

/// Moves a plant and writes what is wanted of it, where nothing of that is refused.
///
/// # Errors
/// What the simulator refuses, [`WorkbenchError::Memory`], and what the disk says; nothing is left behind then.
pub fn sway(
    plant: &Vibrating,
    way: &Way<'_>,
    wind: &dyn Wind,
    motion: &Motion,
    outs: Outs<'_>,
    progress: &dyn Progress,
) -> Result<Moved, WorkbenchError> {
    motion.check()?;
    let (n_copies, n_nodes) = (motion.n_copies, plant.beams.len());
    let sensors = sensors(plant, motion)?;
    let bytes = room(n_copies, n_nodes, plant.modes.len())?;
    let sizes = [n_copies.saturating_mul(n_nodes), sensors.len()];
    if matches!(way, Way::Steps(_)) {
        room_of_winds(motion)?;
    }
    check_room(&outs, sizes, motion.n_frames, free_in, progress)?;
    // What goes round ends where it begins, in a file that is played from key to key.
    let n_keys = motion.n_frames.saturating_add(u32::from(matches!(way, Way::Spectrum)));
    let mut gathering = outs.glb.map(|_path| Gathering::new(plant, motion, n_keys)).transpose()?;
    let mut files = Files::create(plant, motion, outs)?;
    let grove = motion.grove(plant);
    let ear = Ear::new(way.name(), progress);
    let root = plant.beams.position(0);
    let rest = |node: usize| plant.beams.position(node) - root;
    let mut first: Vec<[f64; 3]> = Vec::new();
    let played = Moving::new(plant, way, &grove, wind, motion, &ear)?.play(&ear, |frame, moved| {
        if let Some(gathering) = &mut gathering {
            gathering.take(moved)?;
        }
        if frame == motion.n_frames {
            return Ok(());
        }
        let place = |copy: usize, node: usize| grove.shown(copy, &(rest(node) + moved.of(copy, node)));
        for (sensor, &node) in (0..).zip(&sensors) {
            let at = place(0, node as usize);
            if sensor == 0 {
                first.push(at.into());
            }
            if let Some(table) = &mut files.table {
                let time_s = f64::from(frame) / motion.fps;
                table.write(&SwayRow { sensor, node, frame, time_s, x: at.x, y: at.y, z: at.z })?;
            }
        }
        if let Some(cache) = &mut files.cache {
            for (copy, node) in (0..n_copies).flat_map(|copy| (0..n_nodes).map(move |node| (copy, node))) {
                cache.push(place(copy, node).cast::<f32>().into())?;
            }
        }
        Ok(())
    })?;
    let scene = gathering.map(|gathering| gathering.scene(plant, &grove, motion.fps));
    let glb = files.finish(scene.as_ref())?;
    let rest = sensors.first().map_or([0.0; 3], |node| rest(*node as usize).into());
    let (deviation, farthest) = spread(&first, rest);
    let (share, too_far) = (played.farthest / plant.size(), played.too_far(plant));
    let (n_frames, frame_s) = (motion.n_frames, played.took[played.took.len() / 2]);
    let off_pace = if matches!(way, Way::Steps(_)) { motion.off_pace(plant) } else { None };
    let warnings = off_pace.into_iter().chain(ear.warnings()).collect();
    Ok(Moved { sensors, deviation, farthest, share, too_far, n_frames, frame_s, bytes, warnings, glb })
}

impl Played {
    /// What there is to warn of where modes have moved a plant farther than they know of.
    pub(super) fn too_far(&self, plant: &Vibrating) -> Option<String> {
        let share = self.farthest / plant.size();
        (self.is_by_modes && share > FAR).then(|| {
            format!(
                "nodes are moved by up to {:.0} % of the plant's height, and vibration modes are right for little motion: at \
                 {:.0} % a rod's tip is off by a twentieth of its way, beyond it by more. Less wind or pull, stiffer wood or \
                 more damping keeps to what they can say",
                100.0 * share,
                100.0 * FAR
            )
        })
    }
}

/// Root of the mean square about the mean, and the farthest from rest.
fn spread(path: &[[f64; 3]], rest: [f64; 3]) -> (f64, f64) {
    let n = path.len().max(1) as f64;
    let mean: [f64; 3] = std::array::from_fn(|axis| path.iter().map(|at| at[axis]).sum::<f64>() / n);
    let square = |at: &[f64; 3], from: &[f64; 3]| (0..3).map(|k| (at[k] - from[k]).powi(2)).sum::<f64>();
    let deviation = (path.iter().map(|at| square(at, &mean)).sum::<f64>() / n).sqrt();
    (deviation, path.iter().map(|at| square(at, &rest)).fold(0.0, f64::max).sqrt())
}

/// Nodes that are followed: those that are named, or ends of branches.
fn sensors(plant: &Vibrating, motion: &Motion) -> Result<Vec<u32>, WorkbenchError> {
    if motion.sensors.is_empty() {
        return Ok(ends(plant, motion.n_sensors));
    }
    let there = plant.beams.len();
    match motion.sensors.iter().find(|node| **node as usize >= there) {
        Some(&node) => Err(WorkbenchError::Sensor { node, there }),
        None => Ok(motion.sensors.clone()),
    }
}

/// Ends of branches all over the plant, the highest first.
fn ends(plant: &Vibrating, n: usize) -> Vec<u32> {
    let mut ends = plant.beams.ends();
    let height = |node: &u32| plant.beams.position(*node as usize)[2];
    ends.sort_by(|a, b| height(b).total_cmp(&height(a)).then(a.cmp(b)));
    let n = n.clamp(1, ends.len());
    (0..n).map(|k| ends[k * ends.len() / n]).collect()
}

/// What a forest takes, bytes: two numbers a mode, three a node of every copy.
///
/// # Errors
/// [`WorkbenchError::Memory`] where there is less.
pub(crate) fn room(copies: usize, nodes: usize, modes: usize) -> Result<usize, WorkbenchError> {
    let numbers = nodes.saturating_mul(3).saturating_add(modes.saturating_mul(2));
    let bytes = copies.saturating_mul(numbers).saturating_mul(size_of::<f32>());
    let there = free();
    if bytes > there { Err(WorkbenchError::Memory { copies, nodes, bytes, there }) } else { Ok(bytes) }
}

/// Whether there is room for the wind of a frame.
///
/// # Errors
/// [`WorkbenchError::WindMemory`].
pub(super) fn room_of_winds(motion: &Motion) -> Result<(), WorkbenchError> {
    let (copies, steps, there) = (motion.n_copies, motion.n_substeps, free());
    let bytes = bytes_of_winds(copies, steps as usize);
    if bytes > there { Err(WorkbenchError::WindMemory { copies, steps, bytes, there }) } else { Ok(()) }
}

/// Of a frame: a time a step, and three numbers a copy and step.
pub(super) fn bytes_of_winds(copies: usize, steps: usize) -> usize {
    let of_step = copies.saturating_mul(size_of::<[f32; 3]>()).saturating_add(size_of::<f64>());
    steps.saturating_mul(of_step)
}

/// Memory that may be taken, bytes.
#[must_use]
pub fn free() -> usize {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map_or(UNKNOWN_FREE, |kilobytes| (kilobytes * 1024.0 * SHARE_OF_FREE) as usize)
}
