//! Displacement by modes that turn segments: every length is kept exactly, whatever modes act together.
//!
//! Thesis 6.4.2 puts each mode right by itself, so that lengths are off again where several act. Here modes add up as
//! turns: a segment turns by the vector sum of what each mode turns it, and stands on the tip of the one before. So modes
//! of solids are added up by Huang, Tong, Zhou, Bao and Desbrun, IEEE Trans. Vis. Comput. Graph. 17 (2011) 983; modal
//! warping (Choi and Ko, the same 11 (2005) 91) turns each node by itself. Small turns are those of the modes themselves.

#[cfg(test)]
mod tests;

use crate::beams::Beams;
use crate::modes::Modes;
use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// What modes do to the segments of a plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turning {
    /// Of every node but the root: the node before it.
    pub(crate) parents: Vec<u32>,
    /// Of every node but the root: the way to it from there at rest, metres.
    pub(crate) segments: Vec<Vector3<f64>>,
    /// Of every mode, of every node but the root: by what its segment turns a unit of the amplitude, radians about an
    /// axis.
    pub(crate) turns: Vec<Vec<Vector3<f64>>>,
}

impl Turning {
    /// All modes of beams.
    #[must_use]
    pub fn new(beams: &Beams, modes: &Modes) -> Self {
        let rows: Vec<_> = beams.segments().collect();
        let turn = |mode: usize| {
            let of = |(base, tip, section, along): &(usize, usize, crate::element::Section, Vector3<f64>)| {
                let across = modes.displacement(mode, *tip) - modes.displacement(mode, *base);
                let [from, to] = [base, tip].map(|node| modes.rotation(mode, *node));
                // The chord turns across itself by where its ends are, about itself as they turn on average.
                along.cross(&across) / section.length + along * along.dot(&(from + to)) / 2.0
            };
            rows.iter().map(of).collect()
        };
        Self {
            parents: rows.iter().map(|(base, ..)| *base as u32).collect(),
            segments: rows.iter().map(|(_, _, section, along)| along * section.length).collect(),
            turns: (0..modes.len()).map(turn).collect(),
        }
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.turns.len()
    }

    /// Nodes, the root included.
    #[must_use]
    pub fn n_nodes(&self) -> usize {
        self.segments.len() + 1
    }

    /// Of every node but the root: the node before it.
    #[must_use]
    pub fn parents(&self) -> &[u32] {
        &self.parents
    }

    /// Of every node but the root: the way to it from there at rest, metres.
    #[must_use]
    pub fn segments(&self) -> &[Vector3<f64>] {
        &self.segments
    }

    /// Of every node but the root: by what a mode turns its segment a unit of the amplitude, radians about an axis.
    ///
    /// # Panics
    /// When there is no such mode.
    #[must_use]
    pub fn turns(&self, mode: usize) -> &[Vector3<f64>] {
        &self.turns[mode]
    }

    /// Displacements of all nodes of the beams, metres, at an amplitude of one mode.
    ///
    /// # Panics
    /// When there is no such mode.
    #[must_use]
    pub fn of_mode(&self, mode: usize, amplitude: f64) -> Vec<Vector3<f64>> {
        self.moved(|k| self.turns[mode][k] * amplitude)
    }

    /// Displacements of all nodes of the beams, metres, at amplitudes of the first so many modes.
    #[must_use]
    pub fn displacements(&self, amplitudes: &[f64]) -> Vec<Vector3<f64>> {
        self.moved(|k| self.turns.iter().zip(amplitudes).map(|(turns, q)| turns[k] * *q).sum())
    }

    fn moved(&self, turn: impl Fn(usize) -> Vector3<f64>) -> Vec<Vector3<f64>> {
        let mut moved = vec![Vector3::zeros()];
        for (k, (segment, parent)) in self.segments.iter().zip(&self.parents).enumerate() {
            // No farther than round to the other side, which is beyond what any plant does.
            let turn = turn(k).cap_magnitude(PI);
            moved.push(moved[*parent as usize] + Rotation3::new(turn) * segment - segment);
        }
        moved
    }
}
