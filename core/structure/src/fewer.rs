//! Skeletons of fewer bones, for engines that take no more joints.

#[cfg(test)]
mod tests;

use std::cmp::Reverse;
use std::collections::BTreeSet;

use honami_model::mesh::Binding;
use honami_model::skeleton::Skeleton;

use crate::StructureError;

/// The root, a bone, and its end.
const LEAST: usize = 3;

/// Which bones of a skeleton stay, and what bears what the others carried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fewer {
    rows: Vec<usize>,
    n_joints: usize,
    /// Of every row, the row that stays and bears what it carried: its own where it stays.
    bearers: Vec<u16>,
}

impl Fewer {
    /// So many bones that a file of them has no more than `most` joints, as rigs count them: the root, one a bone, and one at
    /// the end of each that bears no other.
    ///
    /// Of the bones that bear no other that goes first whose tracks, and those of all that it bore, are fewest; of those with
    /// as many the shortest; and of those as short the last.
    ///
    /// # Errors
    /// [`StructureError::TooFewJoints`] for less than three, [`StructureError::TooManyBones`] for more than 65535 joints.
    pub fn of(skeleton: &Skeleton, most: usize) -> Result<Self, StructureError> {
        if most < LEAST {
            return Err(StructureError::TooFewJoints { wanted: most, least: LEAST });
        }
        let joints = skeleton.joints();
        if u16::try_from(joints.len()).is_err() {
            return Err(StructureError::TooManyBones(joints.len()));
        }
        let parent = |row: usize| joints[row].parent.map_or(0, |parent| parent as usize);
        let (mut n_borne, mut n_tracks) = (vec![0_usize; joints.len()], vec![0; joints.len()]);
        for (row, joint) in joints.iter().enumerate().skip(1) {
            n_borne[parent(row)] += 1;
            n_tracks[row] = joint.tracks.len();
        }
        // Lengths are above 0: in the order of their bits.
        let rank = |row: usize, n: usize| (n, joints[row].length.to_bits(), Reverse(row));
        let tips = (1..joints.len()).filter(|row| n_borne[*row] == 0);
        let mut ends: BTreeSet<(usize, u64, Reverse<usize>)> =
            tips.map(|row| rank(row, n_tracks[row])).collect();
        let mut n = joints.len() + ends.len();
        let mut are_kept = vec![true; joints.len()];
        while n > most {
            let Some((carried, _, Reverse(row))) = ends.pop_first() else { break };
            let bearer = parent(row);
            are_kept[row] = false;
            n -= 2;
            n_borne[bearer] -= 1;
            n_tracks[bearer] += carried;
            // What bore one alone is an end now, with a joint there.
            if n_borne[bearer] == 0 && bearer > 0 {
                ends.insert(rank(bearer, n_tracks[bearer]));
                n += 1;
            }
        }
        let mut bearers: Vec<u16> = Vec::with_capacity(joints.len());
        for row in 0..joints.len() {
            bearers.push(if are_kept[row] { row as u16 } else { bearers[parent(row)] });
        }
        Ok(Self { rows: (0..joints.len()).filter(|row| are_kept[*row]).collect(), n_joints: n, bearers })
    }

    /// Rows of the joints that stay, the root first.
    #[must_use]
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Joints that a rig of them has, ends of bones counted.
    #[must_use]
    pub fn n_joints(&self) -> usize {
        self.n_joints
    }

    /// How many bones were left out.
    #[must_use]
    pub fn n_left_out(&self) -> usize {
        self.bearers.len() - self.rows.len()
    }

    /// What carries a vertex once bones are left out: bones that stay, by the rows that they had.
    #[must_use]
    pub fn binding(&self, binding: &Binding) -> Binding {
        let mut shares = [(0, 0.0); 4];
        for (share, (bone, weight)) in shares.iter_mut().zip(binding.shares()) {
            *share = (self.bearers[bone], weight);
        }
        Binding::new(shares)
    }
}
