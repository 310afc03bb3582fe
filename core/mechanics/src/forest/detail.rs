//! How much of a plant is worth moving from how far: fewer nodes, fewer modes.

use super::View;
use crate::rig::Rig;
use crate::stirring::Stirring;
use nalgebra::Vector3;

/// What is moved of a copy from a distance on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Metres from the eye for a copy of the plant's own size; a larger one keeps its nodes for longer.
    pub from: f64,
    /// Nodes: those that bear the most wood.
    pub n_nodes: usize,
    /// Modes: the slowest.
    pub n_modes: usize,
}

/// Details that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "detail {detail} begins at {from} m with {n_nodes} nodes and {n_modes} modes: details begin farther and farther away, with one node and one mode at least and no more than the plant has ({nodes} nodes, {modes} modes)"
)]
pub struct DetailError {
    detail: usize,
    from: f64,
    n_nodes: usize,
    n_modes: usize,
    nodes: usize,
    modes: usize,
}

/// The whole plant, and what is left of it from each distance on.
#[derive(Clone, Debug)]
pub(super) struct Details {
    from: Vec<f64>,
    pub(super) nodes: Vec<Vec<u32>>,
    pub(super) rigs: Vec<Rig>,
}

impl Details {
    pub(super) fn new(plant: &Stirring, details: &[Detail]) -> Result<Self, DetailError> {
        let (nodes, modes) = (plant.rest.len(), plant.omegas.len());
        let whole = Detail { from: 0.0, n_nodes: nodes, n_modes: modes };
        let mut made = Self { from: Vec::new(), nodes: Vec::new(), rigs: Vec::new() };
        for (detail, &Detail { from, n_nodes, n_modes }) in [whole].iter().chain(details).enumerate() {
            let farther = made.from.last().is_none_or(|last| from > *last);
            if !farther || !(1..=nodes).contains(&n_nodes) || !(1..=modes).contains(&n_modes) {
                return Err(DetailError { detail, from, n_nodes, n_modes, nodes, modes });
            }
            let mut kept = plant.by_wood[..n_nodes].to_vec();
            kept.sort_unstable();
            made.rigs.push(Rig::new(&plant.bendings[..n_modes], &kept));
            made.nodes.push(kept);
            made.from.push(from);
        }
        Ok(made)
    }

    /// The detail of a copy; `None` where it is out of view.
    pub(super) fn of(&self, plant: &Stirring, view: &View, place: &Vector3<f64>, scale: f64) -> Option<u32> {
        let centre = place + Vector3::z() * (plant.height / 2.0 * scale);
        if !view.sees(&centre, plant.reach * scale) {
            return None;
        }
        let distance = (view.eye - centre).norm() / scale;
        Some(self.from.iter().rposition(|from| distance >= *from).unwrap_or(0) as u32)
    }

    pub(super) fn bytes(&self) -> usize {
        let nodes: usize = self.nodes.iter().map(|nodes| size_of_val(nodes.as_slice())).sum();
        nodes + self.rigs.iter().map(Rig::bytes).sum::<usize>()
    }
}
