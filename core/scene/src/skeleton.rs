//! A skeleton as it was filmed, with what is known of its bones and of what they carry.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A skeleton, over its clip or in space. Pixels of the clip: x right, y away from the camera, z up, so that a place is seen
/// in the picture at (x, -z).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SkeletonScene {
    /// What it is of, for titles.
    pub name: String,
    /// The clip.
    pub clip: Film,
    /// Joints, each after its parent; the first is the root.
    pub joints: Vec<Joint>,
    /// Where joints are: joint after joint in frame after frame.
    pub places: Vec<[f32; 3]>,
    /// The clip's frame that the first of these is.
    pub first_frame: u32,
    /// Seconds from the first frame on, one a frame.
    pub times: Vec<f64>,
    /// Groups of tracks.
    pub groups: Vec<Group>,
    /// Tracks that joints carry.
    pub leaves: Vec<Carried>,
}

/// A clip that stands behind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Where it is; `None` where it is not to be had.
    pub path: Option<PathBuf>,
    /// Frames per second, where they were told.
    pub fps: Option<f64>,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Frames.
    pub n_frames: u32,
}

/// The end of a bone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Row of the joint that its bone begins at; `None` of the root.
    pub parent: Option<u32>,
    /// Row of the group whose centre it is; `None` of forks.
    pub group: Option<u32>,
    /// What its bone is called: `group 3 bud-left`, `fork 3,4`; empty of the root and of bones that are not known.
    pub name: String,
    /// By what the bone is known to whoever shapes it; `None` where it cannot be shaped.
    pub bone: Option<Bone>,
    /// Row of the joint that it is a copy of.
    pub copy_of: Option<u32>,
}

/// What hands know a bone by, and how they have shaped it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bone {
    /// Its number in the dendrogram.
    pub node: u32,
    /// By how much its plane is turned out of the picture, radians.
    pub plane_rad: f64,
    /// By how much it leans, radians.
    pub lean_rad: f64,
    /// How many times as far it swings.
    pub gain: f64,
}

/// A group of tracks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// As a person calls it.
    pub name: String,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Of the ellipsoid about its members at rest: the joint that it goes with,
    pub joint: Option<u32>,
    /// and its three half axes, pixels, as they lie at rest; all 0 where it has none.
    pub half_axes: [[f32; 3]; 3],
}

/// A track that a joint carries.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Carried {
    /// The track's number.
    pub track: u64,
    /// Row of its group.
    pub group: Option<u32>,
    /// Where it is, a frame each, pixels.
    pub places: Vec<[f32; 3]>,
}

impl SkeletonScene {
    /// Frames.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.times.len()
    }

    /// Where all joints are in a frame of the skeleton; none beyond the last.
    #[must_use]
    pub fn frame(&self, frame: usize) -> &[[f32; 3]] {
        let n = self.joints.len();
        self.places.get(frame * n..(frame + 1) * n).unwrap_or_default()
    }

    /// What of it cannot be drawn.
    pub(crate) fn odd(&self) -> Option<String> {
        let (n_joints, n_frames) = (self.joints.len(), self.times.len());
        if n_joints == 0 || n_frames == 0 || self.places.len() != n_joints * n_frames {
            return Some(format!("{} places of {n_joints} joints in {n_frames} frames", self.places.len()));
        }
        let is_group = |group: Option<u32>| group.is_none_or(|row| (row as usize) < self.groups.len());
        let is_before = |row: usize, other: Option<u32>| other.is_none_or(|other| (other as usize) < row);
        let mut joints = self.joints.iter().enumerate();
        let is_joint = |(row, joint): (usize, &Joint)| {
            is_group(joint.group) && is_before(row, joint.parent) && is_before(n_joints, joint.copy_of)
        };
        let is_led = joints.all(is_joint);
        let are_groups = self.groups.iter().all(|group| is_before(n_joints, group.joint));
        let are_carried =
            self.leaves.iter().all(|leaf| is_group(leaf.group) && leaf.places.len() == n_frames);
        (!(is_led && are_groups && are_carried))
            .then(|| "it names joints or groups that it has not".to_owned())
    }
}
