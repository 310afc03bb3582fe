//! Turns in space, and skeletons whose bones are turned, each by its own.

use honami_model::skeleton::{Joint, Leaf, Skeleton};

use crate::StructureError;

/// Shorter than this, of vectors of length 1, is no direction.
const NOTHING: f64 = 1e-12;

/// A turn: a rotation matrix, its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn([[f64; 3]; 3]);

impl Turn {
    /// The turn by nothing.
    pub(crate) const NONE: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// About an axis of length 1, counterclockwise where it points at the eye (Rodrigues).
    pub(crate) fn about(axis: [f64; 3], angle_rad: f64) -> Self {
        let (s, c) = angle_rad.sin_cos();
        let [x, y, z] = axis;
        let skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let same = if i == j { c } else { 0.0 };
                same + s * skew[i][j] + (1.0 - c) * axis[i] * axis[j]
            })
        }))
    }

    /// Where it turns a vector.
    pub(crate) fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| dot(row, v))
    }

    /// This one after another.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let column = |j: usize| first.0.map(|row| row[j]);
        Self(self.0.map(|row| std::array::from_fn(|j| dot(row, column(j)))))
    }
}

/// From one direction to another, both of length 1: 0 to π, exact also where it is small.
pub(crate) fn angle(from: [f64; 3], to: [f64; 3]) -> f64 {
    norm(cross(from, to)).atan2(dot(from, to))
}

/// What is turned about to get from one direction to another, of length 1. Where any would do, it is the line of sight; and
/// where that is the direction itself, the horizontal.
pub(crate) fn axis(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let upright = |v: [f64; 3]| {
        let along = dot(v, from);
        std::array::from_fn(|k| v[k] - along * from[k])
    };
    let choices = [cross(from, to), upright([0.0, 1.0, 0.0]), upright([1.0, 0.0, 0.0])];
    let found = choices.into_iter().find(|v| norm(*v) > NOTHING).unwrap_or([0.0, 1.0, 0.0]);
    found.map(|v| v / norm(found))
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

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
    let mut rows_of = vec![Vec::new(); skeleton.joints().len()];
    bones.iter().enumerate().for_each(|(row, bone)| rows_of[bone.of].push(row));
    let leaves = skeleton.leaves().iter().flat_map(|leaf| {
        rows_of[leaf.joint as usize].iter().map(|&row| Leaf {
            track: leaf.track,
            joint: row as u32,
            offsets: leaf.offsets.iter().map(|&by| bones[row].turn.apply(by)).collect(),
        })
    });
    let joints = bones.iter().map(joint).collect();
    let made = Skeleton::new(skeleton.root(), joints, directions.collect(), skeleton.times().clone())?;
    Ok(made.with_leaves(leaves.collect())?)
}
