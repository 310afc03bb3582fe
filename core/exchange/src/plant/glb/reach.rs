//! Weights from 0 to 1: the standard takes any, but tools cut off what lies outside (shape keys of Blender, sliders of
//! engines).
//!
//! A target that goes by w from a to b is written as the way between its ends, (b − a) m, by the weight (w − a) / (b − a),
//! and the mesh is moved by the sum of all a m. What is seen is the same: p + Σ w m = (p + Σ a m) + Σ (w − a) m.

use super::{Body, Placed};

/// Of every target, from which to which of its weights it goes.
#[derive(Debug)]
pub(super) struct Reach(Vec<[f64; 2]>);

impl Reach {
    /// Of all that copies do, and rest, which is where a mesh stands that nothing plays.
    pub(super) fn new(n_targets: usize, copies: &[Placed]) -> Self {
        let mut reach = vec![[0.0_f64; 2]; n_targets];
        for frame in copies.iter().flat_map(|copy| copy.weights.chunks_exact(n_targets.max(1))) {
            for ([low, high], weight) in reach.iter_mut().zip(frame) {
                (*low, *high) = (low.min(f64::from(*weight)), high.max(f64::from(*weight)));
            }
        }
        // One that never moves stays as it is.
        reach.iter_mut().filter(|[low, high]| high - low <= 0.0).for_each(|[_, high]| *high = 1.0);
        Self(reach)
    }

    /// The mesh where all weights are 0.
    pub(super) fn least(&self, body: &Body) -> Vec<[f32; 3]> {
        let mut moved: Vec<[f64; 3]> = body.positions.iter().map(|place| place.map(f64::from)).collect();
        for ([low, _], target) in self.0.iter().zip(&body.targets) {
            for (place, way) in moved.iter_mut().zip(&target.moved) {
                *place = [0, 1, 2].map(|axis| place[axis] + low * f64::from(way[axis]));
            }
        }
        moved.into_iter().map(|place| place.map(|v| v as f32)).collect()
    }

    /// How far a vertex goes with a target's weight from 0 to 1.
    pub(super) fn way(&self, target: usize, moved: [f32; 3]) -> [f32; 3] {
        let [low, high] = self.0[target];
        moved.map(|v| ((high - low) * f64::from(v)) as f32)
    }

    /// The weight to be written, 0 to 1.
    pub(super) fn weight(&self, target: usize, weight: f32) -> f32 {
        let [low, high] = self.0[target];
        ((f64::from(weight) - low) / (high - low)) as f32
    }

    /// The weights of the mesh at rest.
    pub(super) fn rest(&self) -> Vec<f32> {
        (0..self.0.len()).map(|target| self.weight(target, 0.0)).collect()
    }
}
