//! What bones do to the vertices that they carry: linear blending, and that of dual quaternions, which keeps volume.

#[cfg(test)]
mod tests;

use honami_model::mesh::Binding;
use honami_model::skeleton::{Skeleton, turns};
use honami_model::turn::{Turn, cross};

/// How the motions of several bones become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// The mean of where each would have the vertex: what glTF and engines do. What is twisted gets thin.
    #[default]
    Linear,
    /// The mean of their dual quaternions (Kavan and others, I3D 2007): rigid for every vertex, so that what is twisted keeps
    /// its thickness.
    Dual,
}

/// What a bone does to what it carries: it is turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carry {
    /// About the origin.
    pub turn: Turn,
    /// Then by so much.
    pub by: [f64; 3],
}

impl Carry {
    /// Where it has what was at a place.
    #[must_use]
    pub fn apply(&self, place: [f64; 3]) -> [f64; 3] {
        let turned = self.turn.apply(place);
        std::array::from_fn(|axis| turned[axis] + self.by[axis])
    }
}

/// What bones that rest as those of `rest` do in a frame of `motion`, a bone each; the root keeps what it carries.
#[must_use]
pub fn carries(rest: &Skeleton, motion: &Skeleton, frame: u32) -> Vec<Carry> {
    let directions = motion.directions(frame);
    let (before, now) = (rest.places(rest.rest()), motion.places(directions));
    let turns = turns(rest.rest(), directions);
    let carry = |(row, turn): (usize, &Turn)| {
        let (base, turn) = match rest.joints()[row].parent {
            Some(parent) => (parent as usize, *turn),
            None => (row, Turn::NONE),
        };
        let turned = turn.apply(before[base]);
        Carry { turn, by: std::array::from_fn(|axis| now[base][axis] - turned[axis]) }
    };
    turns.iter().enumerate().map(carry).collect()
}

/// Where vertices are that were at `positions`, and are bound so, under what bones do.
///
/// # Panics
/// Where a binding names a bone that there is not.
#[must_use]
pub fn blended(
    positions: &[[f64; 3]],
    bindings: &[Binding],
    carries: &[Carry],
    blend: Blend,
) -> Vec<[f64; 3]> {
    let vertices = positions.iter().zip(bindings);
    match blend {
        Blend::Linear => vertices.map(|(place, binding)| linear(*place, binding, carries)).collect(),
        Blend::Dual => {
            let duals: Vec<Dual> = carries.iter().map(Dual::of).collect();
            vertices.map(|(place, binding)| dual(*place, binding, &duals)).collect()
        }
    }
}

fn linear(place: [f64; 3], binding: &Binding, carries: &[Carry]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (bone, weight) in binding.shares() {
        let there = carries[bone].apply(place);
        (0..3).for_each(|axis| sum[axis] += weight * there[axis]);
    }
    sum
}

/// A dual quaternion: x, y, z and what is real of its turn, and of its dual part.
#[derive(Clone, Copy, Debug, Default)]
struct Dual {
    real: [f64; 4],
    dual: [f64; 4],
}

impl Dual {
    /// The dual part is half of what it is moved by, times the turn.
    fn of(carry: &Carry) -> Self {
        let real = carry.turn.quaternion();
        let [x, y, z, w] = real;
        let crossed = cross(carry.by, [x, y, z]);
        let along: f64 = (0..3).map(|axis| carry.by[axis] * real[axis]).sum();
        let vector: [f64; 3] = std::array::from_fn(|axis| (w * carry.by[axis] + crossed[axis]) / 2.0);
        Self { real, dual: [vector[0], vector[1], vector[2], -along / 2.0] }
    }
}

fn dual(place: [f64; 3], binding: &Binding, duals: &[Dual]) -> [f64; 3] {
    let mut sum = Dual::default();
    let mut first: Option<[f64; 4]> = None;
    for (bone, weight) in binding.shares() {
        let Dual { real, dual } = duals[bone];
        // A turn is two quaternions: those are blended that lie on one side of the bone that carries most.
        let pivot = *first.get_or_insert(real);
        let is_across = (0..4).map(|k| pivot[k] * real[k]).sum::<f64>() < 0.0;
        let weight = if is_across { -weight } else { weight };
        for k in 0..4 {
            sum.real[k] += weight * real[k];
            sum.dual[k] += weight * dual[k];
        }
    }
    // Never 0: along the first it is at least that one's weight.
    let length = sum.real.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [[x, y, z, w], [dx, dy, dz, dw]] = [sum.real, sum.dual].map(|part| part.map(|v| v / length));
    let (axis, moved) = ([x, y, z], [dx, dy, dz]);
    let once = cross(axis, place);
    let twice = cross(axis, std::array::from_fn(|k| once[k] + w * place[k]));
    let aside = cross(axis, moved);
    std::array::from_fn(|k| place[k] + 2.0 * (twice[k] + w * moved[k] - dw * axis[k] + aside[k]))
}
