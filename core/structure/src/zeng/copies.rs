//! Copies of a skeleton in planes through its trunk (Zeng 5.5.1), which carry its motion and its leaves.

use std::f64::consts::PI;

use honami_model::skeleton::Skeleton;

use super::envelope::Envelope;
use super::push::{Pushed, push};
use crate::StructureError;
use crate::siblings::levels;
use crate::turn::{Made, Turn, dot, made, norm};

/// Across the picture.
const ACROSS: [f64; 3] = [0.0, 1.0, 0.0];

/// A joint of a copy.
#[derive(Clone, Copy, Debug)]
struct Copy {
    /// Row of what it is a copy of.
    of: usize,
    /// Row that its bone begins at.
    parent: Option<usize>,
    /// How its plane is turned.
    turn: Turn,
    is_trunk: bool,
}

/// Copies on one trunk.
#[derive(Debug)]
pub(super) struct Copies<'a> {
    flat: &'a Skeleton,
    joints: Vec<Copy>,
    /// Where joints are at rest.
    at: Vec<[f64; 3]>,
}

impl<'a> Copies<'a> {
    /// `n` copies of the joints that are kept, all on one trunk, whose top is at `axis`: pixels, right. One is the skeleton
    /// itself; each is turned by half a turn over n from the one before, as a flat skeleton has two sides (errata Z10).
    pub(super) fn of(flat: &'a Skeleton, trunk: &[bool], kept: &[bool], axis: f64, n: u32) -> Self {
        let places = flat.places(flat.rest());
        let (mut joints, mut at) = (Vec::new(), Vec::new());
        let mut row_of = vec![0; kept.len()];
        for copy in 0..n {
            let turn = match copy {
                0 => Turn::NONE,
                _ => Turn::about([0.0, 0.0, 1.0], PI * f64::from(copy) / f64::from(n)),
            };
            for (of, joint) in flat.joints().iter().enumerate() {
                if !kept[of] || (trunk[of] && copy > 0) {
                    continue;
                }
                row_of[of] = joints.len();
                let parent = joint.parent.map(|parent| row_of[parent as usize]);
                joints.push(Copy { of, parent, turn, is_trunk: trunk[of] });
                let [x, y, z] = turn.apply([places[of][0] - axis, places[of][1], places[of][2]]);
                at.push([x + axis, y, z]);
            }
        }
        Self { flat, joints, at }
    }

    /// Pushes branches out of the planes of their copies, from the root to the tips.
    pub(super) fn push(&mut self, envelope: &Envelope, width: f64) {
        let level_of = levels(self.flat);
        let is_trunk = |row: &usize| self.joints[*row].is_trunk;
        let (still, mut free): (Vec<usize>, Vec<usize>) = (0..self.joints.len()).partition(is_trunk);
        free.sort_by_key(|&row| (level_of[self.joints[row].of], row));
        let pushed = |&row: &usize| {
            let Copy { of, parent, turn, .. } = self.joints[row];
            let parent = parent.unwrap_or_default();
            let along = turn.apply(ACROSS);
            Pushed { row, parent, before: self.joints[parent].parent, level: level_of[of], along }
        };
        let free: Vec<Pushed> = free.iter().map(pushed).collect();
        push(&free, &mut self.at, &still, envelope, width);
    }

    /// The skeleton. Seen across its plane a copy moves as what it is a copy of: what a bone has been pushed by stays, and is
    /// at right angles to all that it does, so that its length stays, too.
    pub(super) fn skeleton(&self) -> Result<Skeleton, StructureError> {
        let bone = |(row, joint): (usize, &Copy)| {
            let length = self.flat.joints()[joint.of].length;
            let was = joint.turn.apply(self.flat.rest()[joint.of]);
            let base = joint.parent.filter(|_| !joint.is_trunk).map(|parent| self.at[parent]);
            let push = base.map(|base| {
                let along = joint.turn.apply(ACROSS);
                let by = dot(along, std::array::from_fn(|k| self.at[row][k] - base[k] - length * was[k]));
                along.map(|v| v * by)
            });
            let parent = joint.parent.map(|parent| parent as u32);
            let length = length.hypot(norm(push.unwrap_or_default()));
            Made { of: joint.of, parent, length, turn: joint.turn, push }
        };
        made(self.flat, &self.joints.iter().enumerate().map(bone).collect::<Vec<_>>())
    }
}
