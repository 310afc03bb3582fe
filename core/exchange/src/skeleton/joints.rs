//! Joints of rigs, as glTF and USD have them: every bone has a joint of its own at its base, those of one fork in one place;
//! the ends of tips are joints that carry nothing, so that programs know how long the last bones are. At rest none is
//! turned. Up is y.

use honami_model::mesh::{Binding, MOST_BONES};
use honami_model::skeleton::{Skeleton, turns};

use super::rig::RigError;
use crate::glb::upright;

/// Numbers of joints have 16 bits.
pub(super) const MOST_JOINTS: usize = u16::MAX as usize;

/// Joints: the root, bones in the order of their rows, ends of tips; each after its parent.
pub(super) struct Joints {
    pub(super) names: Vec<String>,
    /// What each hangs on: the bone that it begins at the end of, or the root.
    pub(super) parents: Vec<Option<usize>>,
    /// Where each is at rest.
    pub(super) places: Vec<[f64; 3]>,
    /// Rows of the root and the bones that there are; their joints are the first ones, in this order.
    pub(super) rows: Vec<usize>,
}

impl Joints {
    /// Of a skeleton at rest; of some of its rows, the root and what bears them among them, if not of all.
    pub(super) fn of(rest: &Skeleton, kept: Option<&[usize]>) -> Result<Self, RigError> {
        let n = rest.joints().len();
        let rows = kept.map_or_else(|| (0..n).collect(), <[usize]>::to_vec);
        let mut are_tips = vec![true; n];
        rows.iter()
            .filter_map(|row| rest.joints()[*row].parent)
            .for_each(|parent| are_tips[parent as usize] = false);
        let tips: Vec<usize> = rows.iter().copied().skip(1).filter(|row| are_tips[*row]).collect();
        if rows.len() + tips.len() > MOST_JOINTS {
            return Err(RigError::TooMany(rows.len() + tips.len()));
        }
        let ends: Vec<[f64; 3]> = rest.places(rest.rest()).into_iter().map(upright).collect();
        let base = |row: usize| rest.joints()[row].parent.map(|parent| parent as usize);
        let (names, parents, places) = (vec!["root".to_owned()], vec![None], vec![ends[0]]);
        let mut made = Self { names, parents, places, rows };
        for at in 1..made.rows.len() {
            let row = made.rows[at];
            made.names.push(format!("bone_{row}"));
            made.parents.push(base(row).and_then(|base| made.joint(base)));
            made.places.push(ends[base(row).unwrap_or(0)]);
        }
        for tip in tips {
            made.names.push(format!("tip_{tip}"));
            made.parents.push(made.joint(tip));
            made.places.push(ends[tip]);
        }
        Ok(made)
    }

    /// The joint of a bone, by its row; `None` of one that there is not.
    pub(super) fn joint(&self, row: usize) -> Option<usize> {
        self.rows.binary_search(&row).ok()
    }

    /// The joints that carry a vertex.
    pub(super) fn bones(&self, binding: &Binding) -> [u16; MOST_BONES] {
        binding.bones().map(|row| self.joint(row.into()).unwrap_or(0) as u16)
    }

    /// From what a joint hangs on to it, at rest; of the root, where it is.
    pub(super) fn offset(&self, joint: usize) -> [f64; 3] {
        let from = self.parents[joint].map_or([0.0; 3], |parent| self.places[parent]);
        std::array::from_fn(|axis| self.places[joint][axis] - from[axis])
    }
}

/// How bones that rest as those of `rest` turn off those that bear them, as quaternions (x, y, z and what is real), a row each,
/// frame by frame; the root does not.
pub(super) fn rotations(rest: &Skeleton, motion: &Skeleton) -> impl Iterator<Item = Vec<[f64; 4]>> {
    let mut before = vec![[0.0, 0.0, 0.0, 1.0]; rest.joints().len()];
    (0..motion.times().len()).map(move |frame| {
        let turns = turns(rest.rest(), motion.directions(frame));
        for (row, joint) in rest.joints().iter().enumerate().skip(1) {
            let own = joint.parent.filter(|parent| *parent > 0);
            let off = own.map_or(turns[row], |parent| turns[parent as usize].back().after(&turns[row]));
            let [x, y, z, w] = off.quaternion();
            let [x, y, z] = upright([x, y, z]);
            let now = [x, y, z, w];
            // A turn is two quaternions: that which is nearer to the frame before does not go the long way round.
            let along: f64 = now.iter().zip(before[row]).map(|(now, last)| now * last).sum();
            before[row] = if along < 0.0 { now.map(|v| -v) } else { now };
        }
        before.clone()
    })
}
