//! A plant that goes round and round by its own modes, by the spectrum of the wind.

use honami_mechanics::wind::Wind;
use honami_mechanics::{Forest, Integrator, Pace, Pose, Round, Stirring, Threads};

use super::Vibrating;
use super::sway::{Motion, free};
use crate::error::WorkbenchError;
use honami_scene::grove::Grove;

/// All that it does, and where it is.
pub(super) struct Circling {
    forest: Forest,
    round: Round,
    threads: Threads,
    moved: Vec<[f32; 3]>,
}

impl Circling {
    /// Works out all of it, in a wind that begins again after as many frames.
    pub(super) fn new(
        plant: &Vibrating,
        grove: &Grove,
        wind: &dyn Wind,
        motion: &Motion,
    ) -> Result<Self, WorkbenchError> {
        let stirring = Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), motion.form);
        let nodes = plant.beams.coarse_to_fine();
        // No step is taken: whatever a method bears.
        let pace = Pace { step: motion.step(), integrator: Integrator::Exact, damping: motion.damping };
        let forest = Forest::new(&stirring, &nodes, &grove.stands, &pace)?;
        let (n_frames, n_substeps) = (motion.n_frames as usize, motion.n_substeps as usize);
        let (bytes, there) = (forest.round_bytes(n_frames, n_substeps, motion.n_threads), free());
        if bytes > there {
            let (copies, nodes) = (forest.len(), nodes.len());
            return Err(WorkbenchError::Memory { copies, nodes, bytes, there });
        }
        let threads = Threads::new(motion.n_threads)?;
        let blowing = |copy: usize, time: f64| grove.blowing(wind, copy, time);
        let round = forest.round(n_frames, n_substeps, &blowing, &threads)?;
        let moved = vec![[0.0; 3]; nodes.len() * forest.len()];
        Ok(Self { forest, round, threads, moved })
    }

    /// Displacements in a frame, node after node, coarse before fine, copy after copy.
    pub(super) fn frame(&mut self, frame: u32) -> &[[f32; 3]] {
        self.forest.put(&self.round, frame as usize);
        self.forest.pose(Pose { details: None, motion: &mut self.moved }, &self.threads);
        &self.moved
    }
}
