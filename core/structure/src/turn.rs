//! Skeletons whose bones are turned, each by its own.

use honami_model::skeleton::{Joint, Leaf, Skeleton};
pub(crate) use honami_model::turn::{Turn, angle, axis, dot, norm};
use rayon::prelude::*;

use crate::StructureError;

/// A bone of a skeleton that is made of another's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Made {
    /// Row of the joint whose bone it was.
    pub(crate) of: usize,
    /// Row, in the new skeleton, of the joint that it begins at; `None` for the root.
    pub(crate) parent: Option<u32>,
    /// Its length, pixels; 0 for the root.
    pub(crate) length: f64,
    /// By which it is turned, in all frames alike.
    pub(crate) turn: Turn,
    /// What is added to it then, across all of its directions, pixels: length is what both make.
    pub(crate) push: Option<[f64; 3]>,
}

/// A skeleton made of another's bones, with the leaves that these carry: beside how it is at rest, a bone moves as it did.
pub(crate) fn made(skeleton: &Skeleton, bones: &[Made]) -> Result<Skeleton, StructureError> {
    let carried = carried(skeleton, bones);
    posed(skeleton, bones, skeleton.leaves().iter().flat_map(carried).collect())
}

/// The same on all cores, for whoever may take them: thousands of leaves over thousands of frames are most of the work.
pub(crate) fn made_by_all(skeleton: &Skeleton, bones: &[Made]) -> Result<Skeleton, StructureError> {
    let carried = carried(skeleton, bones);
    posed(skeleton, bones, skeleton.leaves().par_iter().flat_map_iter(carried).collect())
}

/// What becomes of a leaf: one on every bone that is made of its own.
fn carried(skeleton: &Skeleton, bones: &[Made]) -> impl Fn(&Leaf) -> Vec<Leaf> + Sync {
    let mut turns_of = vec![Vec::new(); skeleton.joints().len()];
    (0..).zip(bones).for_each(|(row, bone)| turns_of[bone.of].push((row, bone.turn)));
    move |leaf| {
        let on = |&(joint, turn): &(u32, Turn)| Leaf {
            track: leaf.track,
            joint,
            offsets: leaf.offsets.iter().map(|&by| turn.apply(by)).collect(),
        };
        turns_of[leaf.joint as usize].iter().map(on).collect()
    }
}

fn posed(skeleton: &Skeleton, bones: &[Made], leaves: Vec<Leaf>) -> Result<Skeleton, StructureError> {
    let frames = 0..skeleton.times().len();
    let directions = frames.flat_map(|frame| {
        let directions = skeleton.directions(frame);
        bones.iter().map(|bone| {
            let direction = bone.turn.apply(directions[bone.of]);
            let length = skeleton.joints()[bone.of].length;
            match bone.push {
                None => direction,
                Some(push) => std::array::from_fn(|k| (length * direction[k] + push[k]) / bone.length),
            }
        })
    });
    let joint = |bone: &Made| Joint {
        parent: bone.parent,
        length: bone.length,
        ..skeleton.joints()[bone.of].clone()
    };
    let joints = bones.iter().map(joint).collect();
    let made = Skeleton::new(skeleton.root(), joints, directions.collect(), skeleton.times().clone())?;
    Ok(made.with_leaves(leaves)?)
}
