//! What wind does to each mode: the wind projection basis of the thesis (6.3), and the damping by the air.
//!
//! Uniform wind v presses on a branch with C D(p) |v| v a metre, D its diameter; a mode feels |v| v . p_i (6.30). While
//! the branch moves itself, at u' much slower than the wind, it feels less by C D (|v| u' + v (v . u') / |v|), which
//! damps the mode by what the tensor T_i says.

#[cfg(test)]
mod tests;

use crate::beams::Beams;
use crate::modes::Modes;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Of air at 20 degrees, kilograms per cubic metre (errata E43: not the density of the wood).
pub const AIR: f64 = 1.2;

/// Points and weights of Gauss on 0..1: exact for the squares of cubic shapes.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// How hard air presses on a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// Of the air, kilograms per cubic metre.
    pub density: f64,
    /// Drag coefficient of branches: 1 to 1.2 for cylinders across winds in which their diameters have Reynolds numbers of
    /// 1e3 to 2e5 (Hoerner, Fluid-Dynamic Drag, 1965, 3-9): 1 mm in 15 m/s to 20 cm in 15 m/s.
    pub branches: f64,
    /// Area times drag coefficient of what hangs on nodes, such as leaves: (node of the beams, square metres).
    pub leaves: Vec<(usize, f64)>,
}

impl Default for Drag {
    fn default() -> Self {
        Self { density: AIR, branches: 1.0, leaves: Vec::new() }
    }
}

/// What wind does to each mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindBasis {
    /// p_i of every mode: modal force by the square of the wind, f_i = |v| v . p_i.
    pub forces: Vec<Vector3<f64>>,
    /// T_i of every mode: damping by the wind.
    pub dampings: Vec<Matrix3<f64>>,
}

impl WindBasis {
    /// Integrates over all branches at rest.
    #[must_use]
    pub fn new(beams: &Beams, modes: &Modes, drag: &Drag) -> Self {
        let (forces, dampings) = (0..modes.len()).map(|mode| of_mode(beams, modes, mode, drag)).unzip();
        Self { forces, dampings }
    }

    /// The force on a mode in a wind, metres per second.
    #[must_use]
    pub fn force(&self, mode: usize, wind: &Vector3<f64>) -> f64 {
        wind.norm() * wind.dot(&self.forces[mode])
    }

    /// By how much a wind adds to the damping gamma of a mode of mass 1, per second.
    #[must_use]
    pub fn damping(&self, mode: usize, wind: &Vector3<f64>) -> f64 {
        let (speed, tensor) = (wind.norm(), &self.dampings[mode]);
        if speed == 0.0 { 0.0 } else { speed * tensor.trace() + wind.dot(&(tensor * wind)) / speed }
    }
}

fn of_mode(beams: &Beams, modes: &Modes, mode: usize, drag: &Drag) -> (Vector3<f64>, Matrix3<f64>) {
    let (mut force, mut damping) = (Vector3::zeros(), Matrix3::zeros());
    for (base, tip, section, direction) in beams.segments() {
        let per_metre = 0.5 * drag.density * drag.branches * 2.0 * section.radius;
        for (share, weight) in GAUSS {
            let ends = [base, tip].map(|node| (modes.displacement(mode, node), modes.rotation(mode, node)));
            let moved = between(share, section.length, &direction, ends);
            let scale = weight * section.length * per_metre;
            force += scale * moved;
            damping += scale * moved * moved.transpose();
        }
    }
    for &(node, area) in &drag.leaves {
        let moved = modes.displacement(mode, node);
        force += 0.5 * drag.density * area * moved;
        damping += 0.5 * drag.density * area * moved * moved.transpose();
    }
    (force, damping)
}

/// Displacement at a share of a segment's length, from displacements and rotations of its ends (6.3, the first three
/// rows of 6.4; errata E37, E38, E43), in the frame of the plant.
fn between(
    share: f64,
    length: f64,
    direction: &Vector3<f64>,
    [(u0, psi0), (u1, psi1)]: [(Vector3<f64>, Vector3<f64>); 2],
) -> Vector3<f64> {
    let p = share;
    let (h1, h3) = (1.0 - 3.0 * p.powi(2) + 2.0 * p.powi(3), p.powi(2) * (3.0 - 2.0 * p));
    let (h2, h4) = (length * p * (1.0 - p).powi(2), length * p.powi(2) * (p - 1.0));
    // Along the segment linear, across it Hermite's cubic.
    let along = ((1.0 - p - h1) * u0 + (p - h3) * u1).dot(direction);
    h1 * u0 + h3 * u1 + direction * along + h2 * psi0.cross(direction) + h4 * psi1.cross(direction)
}
