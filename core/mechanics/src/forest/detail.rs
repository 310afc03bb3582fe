//! How much of a plant is worth moving from how far: fewer nodes, fewer modes.

use super::View;
use crate::stirring::Stirring;
use nalgebra::Vector3;

/// How much of a copy is moved: nothing where it has no nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// Its first so many nodes,
    pub n_nodes: u32,
    /// by its so many slowest modes.
    pub n_modes: u32,
}

/// Details that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "detail {detail} begins at {from} m with {n_nodes} nodes and {n_modes} modes: details begin farther and farther away, with one node and one mode at least"
)]
pub struct DetailError {
    detail: usize,
    from: f64,
    n_nodes: u32,
    n_modes: u32,
}

/// The whole plant, and what is left of it from each distance on.
#[derive(Clone, Debug)]
pub struct Details(Vec<(f64, Detail)>);

impl Details {
    /// What is moved of a copy of the plant's own size from how many metres on; a larger one keeps its nodes for longer.
    ///
    /// # Errors
    /// [`DetailError`].
    pub fn new(farther: &[(f64, Detail)]) -> Result<Self, DetailError> {
        let whole = Detail { n_nodes: u32::MAX, n_modes: u32::MAX };
        let mut made = vec![(0.0, whole)];
        for (detail, &(from, Detail { n_nodes, n_modes })) in (1..).zip(farther) {
            let is_farther = made.last().is_none_or(|(last, _)| from > *last);
            if !is_farther || n_nodes == 0 || n_modes == 0 {
                return Err(DetailError { detail, from, n_nodes, n_modes });
            }
            made.push((from, Detail { n_nodes, n_modes }));
        }
        Ok(Self(made))
    }

    /// That of a copy at a place, metres, so many times as large as the plant: nothing of what is out of view.
    #[must_use]
    pub fn of(&self, plant: &Stirring, view: &View, place: &Vector3<f64>, scale: f64) -> Detail {
        self.level(plant, view, place, scale).map_or_else(Detail::default, |level| self.0[level].1)
    }

    /// Which it is, from the whole plant on; `None` out of view.
    #[must_use]
    pub fn level(&self, plant: &Stirring, view: &View, place: &Vector3<f64>, scale: f64) -> Option<usize> {
        let centre = place + Vector3::z() * (plant.height / 2.0 * scale);
        if !view.sees(&centre, plant.reach * scale) {
            return None;
        }
        let distance = (view.eye - centre).norm() / scale;
        self.0.iter().rposition(|(from, _)| distance >= *from)
    }
}

impl Detail {
    /// No more than there is.
    #[must_use]
    pub fn at_most(self, whole: Self) -> Self {
        Self { n_nodes: self.n_nodes.min(whole.n_nodes), n_modes: self.n_modes.min(whole.n_modes) }
    }
}
