//! A plant on its way: in the hands of a simulator plugin, what that is given and gives back; or going round by itself.

use honami_host::{
    CallContext, Host, HostError, Node, PlantInstance, PluginInfo, Simulator, Steps, Values, WindRows,
};
use std::time::Instant;

use honami_mechanics::wind::Wind;
use honami_mechanics::{Stand, Vector};
use rayon::prelude::*;

use super::Vibrating;
use super::circling::Circling;
use super::sway::Motion;
use crate::ear::Ear;
use crate::error::WorkbenchError;
use honami_scene::grove::Grove;

/// Copies whose wind is worked out at a time.
const SOME: usize = 256;
/// Nodes that a thread looks at, at a time.
const MANY: usize = 1 << 14;

/// Who moves plants.
#[derive(Clone, Copy, Debug)]
pub struct Mover<'a> {
    /// Starts plugins.
    pub host: &'a Host,
    /// The simulator.
    pub plugin: &'a PluginInfo,
    /// Its parameters; the rest take their defaults.
    pub values: &'a Values,
}

/// How plants move.
#[derive(Clone, Copy, Debug)]
pub enum Way<'a> {
    /// Step by step, from where they begin.
    Steps(Mover<'a>),
    /// Round and round by their own modes, by the spectrum of a wind that begins again after the motion.
    Spectrum,
}

impl Way<'_> {
    /// What moves them.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Steps(mover) => &mover.plugin.short_name,
            Self::Spectrum => "spectrum",
        }
    }
}

/// A plant and its copies on their way.
pub(super) struct Moving<'a> {
    by: By<'a>,
    motion: &'a Motion,
    /// Where a node of the beams is among those that are moved: coarse before fine.
    rows: Vec<u32>,
    is_by_modes: bool,
}

enum By<'a> {
    Steps(Box<Stepping<'a>>),
    Spectrum(Box<Circling>),
}

/// A simulator at work.
struct Stepping<'a> {
    simulator: Simulator,
    grove: &'a Grove,
    wind: &'a dyn Wind,
    motion: &'a Motion,
    pool: rayon::ThreadPool,
    winds: Vec<[f32; 3]>,
    times: Vec<f64>,
}

/// Displacements of all nodes of all copies, in the axes and the size of the plant.
pub(super) struct Displacements<'a> {
    rows: &'a [u32],
    /// Node after node as they were handed over, copy after copy.
    pub(super) motion: &'a [[f32; 3]],
}

/// What there is to say of a motion that is over.
pub(super) struct Played {
    /// Seconds that frames took, ascending.
    pub(super) took: Vec<f64>,
    /// How far a node of any copy was from rest at most, in the size of the plant, metres.
    pub(super) farthest: f64,
    /// Whether it was vibration modes that moved.
    pub(super) is_by_modes: bool,
}

impl Displacements<'_> {
    /// Metres.
    pub(super) fn of(&self, copy: usize, node: usize) -> Vector {
        let row = copy * self.rows.len() + self.rows[node] as usize;
        Vector::from(self.motion[row].map(f64::from))
    }

    /// Of any node, metres.
    fn farthest(&self) -> f32 {
        let most = |most: f32, [x, y, z]: &[f32; 3]| most.max(x * x + y * y + z * z);
        let some = self.motion.par_chunks(MANY).map(|some| some.iter().fold(0.0, most));
        some.reduce(|| 0.0, f32::max).sqrt()
    }
}

impl<'a> Moving<'a> {
    /// Hands the plant over to a simulator, or works out how it goes round.
    pub(super) fn new(
        plant: &Vibrating,
        way: &Way<'_>,
        grove: &'a Grove,
        wind: &'a dyn Wind,
        motion: &'a Motion,
        ear: &Ear<'_>,
    ) -> Result<Self, WorkbenchError> {
        let (by, is_by_modes) = match way {
            Way::Steps(mover) => {
                motion.bears(plant, &grove.stands)?;
                let pool = rayon::ThreadPoolBuilder::new().num_threads(motion.n_threads).build();
                let pool = pool.map_err(|source| WorkbenchError::Pool { n: motion.n_threads, source })?;
                let start = |cx: &CallContext<'_>| {
                    start(plant, mover, &grove.stands, motion.n_threads, motion.seed, cx)
                };
                let (simulator, is_by_modes) = ear.whole("modes", start).map_err(stopped)?;
                let (winds, times) = (Vec::new(), Vec::new());
                let stepping = Stepping { simulator, grove, wind, motion, pool, winds, times };
                (By::Steps(Box::new(stepping)), is_by_modes)
            }
            Way::Spectrum => (By::Spectrum(Box::new(Circling::new(plant, grove, wind, motion)?)), true),
        };
        Ok(Self { by, motion, rows: rows(&plant.beams.coarse_to_fine()), is_by_modes })
    }

    /// Goes through all frames and shows each: the only way in which plants move, whatever is made of it. What goes round
    /// shows the first once more, after the last.
    pub(super) fn play(
        mut self,
        ear: &Ear<'_>,
        mut see: impl FnMut(u32, &Displacements<'_>) -> Result<(), WorkbenchError>,
    ) -> Result<Played, WorkbenchError> {
        let (mut took, mut farthest) = (Vec::new(), 0.0_f32);
        for frame in 0..self.motion.n_frames {
            if ear.is_told_to_stop(u64::from(frame), u64::from(self.motion.n_frames)) {
                return Err(WorkbenchError::Stopped);
            }
            let begun = Instant::now();
            let moved = self.frame(frame, ear)?;
            took.push(begun.elapsed().as_secs_f64());
            farthest = farthest.max(moved.farthest());
            see(frame, &moved)?;
        }
        if let By::Spectrum(circling) = &mut self.by {
            see(self.motion.n_frames, &Displacements { rows: &self.rows, motion: circling.frame(0) })?;
        }
        took.sort_by(f64::total_cmp);
        Ok(Played { took, farthest: f64::from(farthest), is_by_modes: self.is_by_modes })
    }

    fn frame(&mut self, frame: u32, ear: &Ear<'_>) -> Result<Displacements<'_>, WorkbenchError> {
        let motion = match &mut self.by {
            By::Steps(stepping) => stepping.frame(frame, ear)?,
            By::Spectrum(circling) => circling.frame(frame),
        };
        Ok(Displacements { rows: &self.rows, motion })
    }
}

impl Stepping<'_> {
    /// Goes on to a frame, from the one before; the first is where it begins.
    fn frame(&mut self, frame: u32, ear: &Ear<'_>) -> Result<&[[f32; 3]], WorkbenchError> {
        let (dt, each) = (self.motion.step(), self.motion.n_substeps);
        let n = if frame == 0 { 0 } else { each };
        self.times.clear();
        let first = u64::from(frame.saturating_sub(1)) * u64::from(each);
        self.times.extend((0..u64::from(n)).map(|k| (first + k) as f64 * dt));
        let (grove, wind, times) = (self.grove, self.wind, &self.times);
        let n_copies = grove.stands.len();
        self.pool.install(|| {
            let blowing = |k: usize| grove.blowing(wind, k % n_copies, times[k / n_copies]);
            let places = (0..times.len() * n_copies).into_par_iter().with_min_len(SOME);
            places.map(|k| blowing(k).cast::<f32>().into()).collect_into_vec(&mut self.winds);
        });
        let wind = WindRows { times_s: &self.times, velocities: &self.winds };
        let steps = Steps { dt, n, wind, detail: None };
        let (done, total) = (u64::from(frame), u64::from(self.motion.n_frames));
        let simulator = &mut self.simulator;
        ear.call(done, total, move |cx| simulator.step(&steps, cx)).map_err(stopped)
    }
}

/// Where each node of the beams is in an order of them.
pub(super) fn rows(order: &[u32]) -> Vec<u32> {
    let mut rows = vec![0; order.len()];
    (0..).zip(order).for_each(|(row, node)| rows[*node as usize] = row);
    rows
}

/// Starts a simulator and hands a plant over, with the root at 0 and coarse nodes before fine ones; whether it moves by
/// vibration modes.
pub(super) fn start(
    plant: &Vibrating,
    mover: &Mover<'_>,
    stands: &[Stand],
    n_threads: usize,
    seed: u64,
    cx: &CallContext<'_>,
) -> Result<(Simulator, bool), HostError> {
    let order = plant.beams.coarse_to_fine();
    let rows = rows(&order);
    let root = plant.beams.position(0);
    let node = |&node: &u32| Node {
        parent: plant.beams.parent(node as usize).map(|parent| rows[parent as usize]),
        // From the root: what is far from everything has few digits left for itself.
        position: (plant.beams.position(node as usize) - root).cast::<f32>().into(),
        radius: plant.beams.radius(node as usize) as f32,
        track: None,
    };
    let nodes: Vec<Node> = order.iter().map(node).collect();
    let instance = |stand: &Stand| PlantInstance { yaw: stand.turn, scale: stand.scale, mass: stand.mass };
    let instances: Vec<PlantInstance> = stands.iter().map(instance).collect();
    let (mut simulator, _) = mover.host.simulator(mover.plugin, mover.values, cx)?;
    let modes = simulator.prepare(&nodes, &instances, n_threads as u32, seed, cx)?;
    Ok((simulator, !modes.is_empty()))
}

/// One who was stopped is no failure of the simulator.
fn stopped(error: HostError) -> WorkbenchError {
    match error {
        HostError::Cancelled { .. } => WorkbenchError::Stopped,
        error => error.into(),
    }
}
