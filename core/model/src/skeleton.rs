//! Skeletons: joints at the ends of bones of constant length, and where each bone points in every frame.
//!
//! Lengths are pixels of the clip, until a skeleton [`stands`](Skeleton::standing) elsewhere; axes are those of plants: x
//! right, y away from the camera, z up, right-handed. So a place is seen in the picture at (x, -z), see [`seen`] and
//! [`placed`].

#[cfg(test)]
mod tests;

use crate::clip::FrameTimes;
use crate::track::TrackId;
use crate::turn::{Turn, norm};

/// A direction may be so far from unit length; it is made unit exactly.
const UNIT: f64 = 1e-6;
/// One that was made unit is so near to it.
const MADE_UNIT: f64 = 4e-15;
/// Pixels. Nothing of a skeleton is longer or farther away, so that no sum of bones overflows, however many there are.
const FARTHEST: f64 = 1e9;

/// The end of a bone; the root has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// Row of the joint that its bone begins at, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Length of its bone, pixels: above 0, to 1e9; 0 for the root.
    pub length: f64,
    /// Groups that it is the centre of, numbered from 0; none for forks.
    pub groups: Vec<u32>,
    /// The tracks of these groups.
    pub tracks: Vec<TrackId>,
}

/// A feature that a joint carries.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Its track.
    pub track: TrackId,
    /// Row of the joint.
    pub joint: u32,
    /// From the joint to it, pixels, to 1e9 either way, a frame each: what the bone does not explain of its motion is in here.
    pub offsets: Vec<[f64; 3]>,
}

/// A skeleton and its motion. Its joints are one tree, each after its parent; the root stays where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    root: [f64; 3],
    joints: Vec<Joint>,
    /// Unit, a joint each.
    rest: Vec<[f64; 3]>,
    /// Unit, joint after joint in frame after frame.
    directions: Vec<[f64; 3]>,
    times: FrameTimes,
    leaves: Vec<Leaf>,
}

/// Why joints and directions are no skeleton.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SkeletonError {
    /// A root alone has no bone.
    #[error("a skeleton has two joints at least, this one has {0}")]
    TooFew(usize),
    /// Not one root, in row 0.
    #[error("joint {0} has no parent: a skeleton has one root, its first joint")]
    Root(usize),
    /// The root with a parent, or a child before its parent, which a cycle cannot avoid.
    #[error("joint {joint} has parent {parent}, which does not come before it")]
    Order {
        /// Row.
        joint: usize,
        /// Row that it names.
        parent: u32,
    },
    /// A length that is none, or too long.
    #[error(
        "the bone of joint {joint} is {length:?} px long, and one above 0, of 1e9 px at most, was wanted"
    )]
    Length {
        /// Row.
        joint: usize,
        /// Pixels.
        length: f64,
    },
    /// A root that is nowhere, or too far away.
    #[error("the root lies at {0:?} px, and a place within 1e9 px of 0 was wanted")]
    Place([f64; 3]),
    /// Not one direction for every joint and frame.
    #[error("{came} directions, and {wanted} were wanted: one for every joint in every frame")]
    Count {
        /// Directions.
        came: usize,
        /// Joints times frames.
        wanted: usize,
    },
    /// A direction that is not of length 1.
    #[error("joint {joint} has no direction in frame {frame}: {direction:?} is not of length 1")]
    Direction {
        /// Row.
        joint: usize,
        /// Frame.
        frame: usize,
        /// As given.
        direction: [f64; 3],
    },
    /// A leaf of no joint, without a place in every frame, or one that is nowhere or too far away.
    #[error(
        "leaf {leaf} wants a joint that there is and a place within 1e9 px of it in each of {n_frames} frames"
    )]
    Leaf {
        /// Row.
        leaf: usize,
        /// Frames.
        n_frames: u32,
    },
}

/// Where a place is seen in the picture, pixels (right, down).
#[must_use]
pub fn seen(place: [f64; 3]) -> [f64; 2] {
    [place[0], -place[2]]
}

/// The place that is seen at `at`, pixels (right, down), so far behind the plane of the root.
#[must_use]
pub fn placed(at: [f64; 2], depth: f64) -> [f64; 3] {
    [at[0], depth, -at[1]]
}

/// By what bones are turned that have pointed one way and point another, the shortest way; a turn a bone.
#[must_use]
pub fn turns(before: &[[f64; 3]], now: &[[f64; 3]]) -> Vec<Turn> {
    before.iter().zip(now).map(|(before, now)| Turn::between(*before, *now)).collect()
}

impl Skeleton {
    /// Checks joints and directions, these joint after joint in frame after frame; what stands for the root is not looked
    /// at. At rest a bone points where it points in the mean.
    ///
    /// # Errors
    /// [`SkeletonError`] for the first that breaks a rule.
    pub fn new(
        root: [f64; 3],
        joints: Vec<Joint>,
        directions: Vec<[f64; 3]>,
        times: FrameTimes,
    ) -> Result<Self, SkeletonError> {
        Self::made(root, joints, directions, times, 0.0)
    }

    /// The same of parts that may have been a skeleton's: directions that were made unit before stay to the last bit, so that
    /// one that is taken apart and put together again is what it was.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn again(
        root: [f64; 3],
        joints: Vec<Joint>,
        directions: Vec<[f64; 3]>,
        times: FrameTimes,
    ) -> Result<Self, SkeletonError> {
        Self::made(root, joints, directions, times, MADE_UNIT)
    }

    /// Directions that are nearer to unit length than `kept` are not touched.
    fn made(
        root: [f64; 3],
        joints: Vec<Joint>,
        mut directions: Vec<[f64; 3]>,
        times: FrameTimes,
        kept: f64,
    ) -> Result<Self, SkeletonError> {
        let n = joints.len();
        check_tree(&joints)?;
        if !is_near(root) {
            return Err(SkeletonError::Place(root));
        }
        let wanted = n * times.len() as usize;
        if directions.len() != wanted {
            return Err(SkeletonError::Count { came: directions.len(), wanted });
        }
        for (row, direction) in directions.iter_mut().enumerate() {
            let (frame, joint) = (row / n, row % n);
            if joint == 0 {
                *direction = [0.0, 0.0, 1.0];
            }
            let length = norm(*direction);
            // A direction that is no number is none, either.
            let is_unit = (length - 1.0).abs() < UNIT;
            if !is_unit {
                return Err(SkeletonError::Direction { joint, frame, direction: *direction });
            }
            if (length - 1.0).abs() > kept {
                *direction = direction.map(|v| v / length);
            }
        }
        let rest = (0..n).map(|joint| mean_direction(directions.iter().skip(joint).step_by(n))).collect();
        Ok(Self { root, joints, rest, directions, times, leaves: Vec::new() })
    }

    /// The same, carrying leaves.
    ///
    /// # Errors
    /// [`SkeletonError::Leaf`].
    pub fn with_leaves(mut self, leaves: Vec<Leaf>) -> Result<Self, SkeletonError> {
        let n_frames = self.times.len();
        let is_good = |leaf: &Leaf| {
            (leaf.joint as usize) < self.joints.len()
                && leaf.offsets.len() == n_frames as usize
                && leaf.offsets.iter().all(|offset| is_near(*offset))
        };
        if let Some(leaf) = leaves.iter().position(|leaf| !is_good(leaf)) {
            return Err(SkeletonError::Leaf { leaf, n_frames });
        }
        self.leaves = leaves;
        Ok(self)
    }

    /// The same, carrying nothing.
    #[must_use]
    pub fn without_leaves(self) -> Self {
        Self { leaves: Vec::new(), ..self }
    }

    /// The same elsewhere: its root in `foot`, so many times as large, turned about the upright, counterclockwise from above,
    /// radians. Bones turn as they did.
    ///
    /// # Errors
    /// [`SkeletonError`] where that is nowhere, or of no size.
    pub fn standing(&self, foot: [f64; 3], size: f64, turn_rad: f64) -> Result<Self, SkeletonError> {
        let turn = Turn::about([0.0, 0.0, 1.0], turn_rad);
        let joint = |joint: &Joint| Joint { length: size * joint.length, ..joint.clone() };
        let directions = self.directions.iter().map(|direction| turn.apply(*direction)).collect();
        let leaf = |leaf: &Leaf| {
            let offset = |by: &[f64; 3]| turn.apply(*by).map(|v| size * v);
            Leaf { offsets: leaf.offsets.iter().map(offset).collect(), ..leaf.clone() }
        };
        Self::new(foot, self.joints.iter().map(joint).collect(), directions, self.times.clone())?
            .with_leaves(self.leaves.iter().map(leaf).collect())
    }

    /// Its joints, each after its parent.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// What it carries.
    #[must_use]
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// What it carries, given away.
    #[must_use]
    pub fn into_leaves(self) -> Vec<Leaf> {
        self.leaves
    }

    /// Times of its frames.
    #[must_use]
    pub fn times(&self) -> &FrameTimes {
        &self.times
    }

    /// Where the root is, pixels.
    #[must_use]
    pub fn root(&self) -> [f64; 3] {
        self.root
    }

    /// Directions of all bones at rest, unit.
    #[must_use]
    pub fn rest(&self) -> &[[f64; 3]] {
        &self.rest
    }

    /// Directions of all bones in a frame, unit; none of a frame that there is not.
    #[must_use]
    pub fn directions(&self, frame: u32) -> &[[f64; 3]] {
        let n = self.joints.len();
        self.directions.chunks(n).nth(frame as usize).unwrap_or_default()
    }

    /// Where all joints are when bones point so, pixels.
    #[must_use]
    pub fn places(&self, directions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut places: Vec<[f64; 3]> = Vec::with_capacity(self.joints.len());
        for (joint, direction) in self.joints.iter().zip(directions) {
            let place = joint.parent.map_or(self.root, |parent| {
                let from = places[parent as usize];
                std::array::from_fn(|axis| from[axis] + joint.length * direction[axis])
            });
            places.push(place);
        }
        places
    }

    /// Whether a joint has no other joint on it, a joint each.
    #[must_use]
    pub fn are_tips(&self) -> Vec<bool> {
        let mut tips = vec![true; self.joints.len()];
        self.joints.iter().filter_map(|joint| joint.parent).for_each(|parent| tips[parent as usize] = false);
        tips
    }
}

/// What is no number is not near, either.
fn is_near(place: [f64; 3]) -> bool {
    place.iter().all(|v| v.abs() <= FARTHEST)
}

fn check_tree(joints: &[Joint]) -> Result<(), SkeletonError> {
    if joints.len() < 2 || u32::try_from(joints.len()).is_err() {
        return Err(SkeletonError::TooFew(joints.len()));
    }
    for (row, joint) in joints.iter().enumerate() {
        match joint.parent {
            None if row > 0 => return Err(SkeletonError::Root(row)),
            Some(parent) if parent as usize >= row => {
                return Err(SkeletonError::Order { joint: row, parent });
            }
            _ => {}
        }
        let is_length = joint.length.abs() <= FARTHEST && (joint.length > 0.0 || row == 0);
        if !is_length {
            return Err(SkeletonError::Length { joint: row, length: joint.length });
        }
    }
    Ok(())
}

/// The mean of unit vectors, made unit; the first of them where they cancel.
fn mean_direction<'a>(directions: impl Iterator<Item = &'a [f64; 3]> + Clone) -> [f64; 3] {
    let add = |sum: [f64; 3], v: &[f64; 3]| std::array::from_fn(|axis| sum[axis] + v[axis]);
    let sum = directions.clone().fold([0.0; 3], add);
    let length = norm(sum);
    if length > UNIT {
        return sum.map(|v| v / length);
    }
    directions.clone().next().copied().unwrap_or([0.0, 0.0, 1.0])
}
