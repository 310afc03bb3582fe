//! What a forest goes on by, for whoever goes on with it elsewhere, such as on a graphics card.

use super::{Forest, air, in_own_axes, pressed};
use nalgebra::Vector3;

/// Numbers of the modes and of the kinds of copies; all of a row belong to one mode after the other.
#[derive(Debug)]
pub struct Numbers<'a> {
    /// Modes.
    pub n_modes: usize,
    /// p of every mode, three rows: x, y, z.
    pub basis: &'a [f32],
    /// T of every mode, six rows: xx, yy, zz, xy, xz, yz.
    pub tensors: &'a [f32],
    /// Of each kind of copies, six rows: what a step makes of the amplitude, the speed and the force for the amplitude, and
    /// then of these for the speed.
    pub steps: Vec<&'a [f32]>,
    /// Of which kind each copy is.
    pub kinds: Vec<u32>,
}

/// What a copy feels in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Felt {
    /// |v| v in its own axes: the force on a mode is the product with its p.
    pub pressed: [f32; 3],
    /// What the numbers of T are to be multiplied by for what the air takes from a mode's speed in half a step: e^-x of it
    /// is left.
    pub held: [f32; air::SIX],
}

impl Forest {
    /// What it goes on by until it is [tuned](Self::retune) anew.
    #[must_use]
    pub fn numbers(&self) -> Numbers<'_> {
        Numbers {
            n_modes: self.omegas.len(),
            basis: &self.basis,
            tensors: &self.tensors,
            steps: self.kinds.iter().map(|kind| kind.steps.as_slice()).collect(),
            kinds: self.copies.iter().map(|(_, kind)| *kind).collect(),
        }
    }

    /// What a copy feels of a wind, metres per second in the world.
    ///
    /// # Panics
    /// When there is no such copy.
    #[must_use]
    pub fn felt(&self, copy: usize, wind: &Vector3<f64>) -> Felt {
        let (turn, kind) = &self.copies[copy];
        let own = in_own_axes(turn, wind);
        Felt { pressed: pressed(&own), held: air::weights(&own, self.kinds[*kind as usize].air) }
    }
}
