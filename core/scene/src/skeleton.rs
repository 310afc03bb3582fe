//! A skeleton as it was filmed, with what is known of its bones and of what they carry.

#[cfg(test)]
mod tests;

use std::path::PathBuf;

use honami_model::clip::FrameTimes;
use honami_model::shape::Shape;
use honami_model::skeleton::{self as model, Leaf, Skeleton};
use honami_model::track::TrackId;
use honami_structure::StructureError;
use honami_structure::shape::{Shaped, shaped};
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
    /// Where joints are, with what hands have done: joint after joint in frame after frame.
    pub places: Vec<[f32; 3]>,
    /// Where joints, and what they carry, would be if no bone were shaped by hand; `None` where none is.
    pub grown: Option<Grown>,
    /// The clip's frame that the first of these is.
    pub first_frame: u32,
    /// Seconds from the first frame on, one a frame.
    pub times: Vec<f64>,
    /// Groups of tracks.
    pub groups: Vec<Group>,
    /// Tracks that joints carry.
    pub leaves: Vec<Carried>,
    /// So many groups the hierarchy is cut into,
    pub n_groups: u32,
    /// and into so many it can be cut at most.
    pub most_groups: u32,
    /// Whether the root was placed by hand.
    pub is_placed: bool,
    /// Why what hands would do here is not taken; `None` where it is.
    pub shut: Option<String>,
}

/// Places as they grew.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Grown {
    /// Of joints: joint after joint in frame after frame.
    pub places: Vec<[f32; 3]>,
    /// Of tracks, a frame each, one list a track that is carried.
    pub leaves: Vec<Vec<[f32; 3]>>,
}

/// A clip that stands behind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Where it is; `None` where it is not to be had.
    pub path: Option<PathBuf>,
    /// Of its content, where that is known.
    pub sha256: Option<String>,
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
    /// Which way its bone points at rest as it grew, of length 1.
    pub rest: [f32; 3],
}

/// What hands know a bone by, and how they have shaped it; a copy has that of what it is a copy of.
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
    /// Of the ellipsoid about its members: the joint that it goes with and turns with,
    pub joint: Option<u32>,
    /// from there to its centre, pixels,
    pub centre: [f32; 3],
    /// and its three half axes, pixels; both as they lie when the joint's bone points as it grew at rest. All 0 where it has
    /// none.
    pub half_axes: [[f32; 3]; 3],
}

/// A track that a joint carries.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Carried {
    /// The track's number.
    pub track: u64,
    /// Row of the joint.
    pub joint: u32,
    /// Row of its group.
    pub group: Option<u32>,
    /// Where it is, a frame each, pixels.
    pub places: Vec<[f32; 3]>,
}

impl Bone {
    /// As hands have shaped it.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape { plane_rad: self.plane_rad, lean_rad: self.lean_rad, gain: self.gain }
    }
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

    /// Where joints are in a frame of the clip; `None` of one in which there is no skeleton.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<&[[f32; 3]]> {
        let row = frame.checked_sub(self.first_frame)? as usize;
        (row < self.n_frames()).then(|| self.frame(row))
    }

    /// The row of the bone with a number in the dendrogram, copies apart.
    #[must_use]
    pub fn row_of(&self, node: u32) -> Option<usize> {
        let is_it =
            |joint: &Joint| joint.copy_of.is_none() && joint.bone.is_some_and(|bone| bone.node == node);
        self.joints.iter().position(is_it)
    }

    /// Shapes bones, by their nodes, as hands would: joints and what they carry are from now on where honami would have them.
    /// Copies go along, and others stay as they are shaped.
    ///
    /// # Errors
    /// [`StructureError`] where joints and places are no skeleton, which stays as it was.
    pub fn reshape(&mut self, shapes: &[(u32, Shape)]) -> Result<(), StructureError> {
        let mut joints = self.joints.clone();
        for bone in joints.iter_mut().filter_map(|joint| joint.bone.as_mut()) {
            if let Some((_, shape)) = shapes.iter().find(|(node, _)| *node == bone.node) {
                (bone.plane_rad, bone.lean_rad, bone.gain) = (shape.plane_rad, shape.lean_rad, shape.gain);
            }
        }
        let fresh = self.grown.is_none().then(|| Grown {
            places: self.places.clone(),
            leaves: self.leaves.iter().map(|leaf| leaf.places.clone()).collect(),
        });
        let Some(grown) = self.grown.as_ref().or(fresh.as_ref()) else { return Ok(()) };
        let skeleton = skeleton(&joints, grown, &self.times, &self.leaves)?;
        let by = joints.iter().map(|joint| Shaped {
            shape: joint.bone.map_or_else(Shape::default, |bone| bone.shape()),
            copy_of: joint.copy_of,
        });
        let made = shaped(&skeleton, &by.collect::<Vec<_>>())?;
        let frames = 0..made.times().len();
        let places: Vec<[f64; 3]> =
            frames.clone().flat_map(|frame| made.places(made.directions(frame))).collect();
        for (carried, leaf) in self.leaves.iter_mut().zip(made.leaves()) {
            let joints = places.iter().skip(leaf.joint as usize).step_by(self.joints.len());
            carried.places = joints.zip(&leaf.offsets).map(|(at, by)| single(add(*at, *by))).collect();
        }
        self.places = places.into_iter().map(single).collect();
        self.joints = joints;
        self.grown = self.grown.take().or(fresh);
        Ok(())
    }

    /// What of it cannot be drawn.
    pub(crate) fn odd(&self) -> Option<String> {
        let (n_joints, n_frames) = (self.joints.len(), self.times.len());
        if n_joints == 1 {
            return Some("a root alone has no bone".to_owned());
        }
        if n_joints == 0 || n_frames == 0 || self.places.len() != n_joints * n_frames {
            return Some(format!("{} places of {n_joints} joints in {n_frames} frames", self.places.len()));
        }
        (!self.is_whole())
            .then(|| "it names joints or groups that it has not, or places that are none".to_owned())
    }

    /// Whether it says of everything where it is, of nothing that there is not, and all in numbers.
    fn is_whole(&self) -> bool {
        let (n_joints, n_frames) = (self.joints.len(), self.times.len());
        let is_joint = |row: u32| (row as usize) < n_joints;
        let is_group = |row: Option<u32>| row.is_none_or(|row| (row as usize) < self.groups.len());
        let are_places = |places: &[[f32; 3]], n: usize| {
            places.len() == n && places.iter().flatten().all(|v| v.is_finite())
        };
        let is_good = |(row, joint): (usize, &Joint)| {
            joint.parent.map_or(row == 0, |parent| (parent as usize) < row)
                && joint.copy_of.is_none_or(|of| (of as usize) < row)
                && is_group(joint.group)
        };
        let is_grown = |grown: &Grown| {
            are_places(&grown.places, n_joints * n_frames)
                && grown.leaves.len() == self.leaves.len()
                && grown.leaves.iter().all(|places| are_places(places, n_frames))
        };
        let ellipsoid = |group: &Group| {
            let numbers = group.half_axes.as_flattened().iter().chain(&group.centre);
            group.joint.is_none_or(is_joint) && numbers.copied().all(f32::is_finite)
        };
        let is_carried = |leaf: &Carried| {
            is_joint(leaf.joint) && is_group(leaf.group) && are_places(&leaf.places, n_frames)
        };
        n_joints > 1
            && n_frames > 0
            && self.clip.width > 0
            && self.clip.height > 0
            && self.joints.iter().enumerate().all(is_good)
            && are_places(&self.places, n_joints * n_frames)
            && self.grown.as_ref().is_none_or(is_grown)
            && self.groups.iter().all(ellipsoid)
            && self.leaves.iter().all(is_carried)
    }
}

/// The skeleton that places are of.
fn skeleton(
    joints: &[Joint],
    grown: &Grown,
    times: &[f64],
    leaves: &[Carried],
) -> Result<Skeleton, StructureError> {
    let frames: Vec<&[[f32; 3]]> = grown.places.chunks_exact(joints.len().max(1)).collect();
    let way = |row: usize, frame: &[[f32; 3]]| {
        let from = joints[row].parent.map_or(frame[row], |parent| frame[parent as usize]);
        std::array::from_fn(|axis| f64::from(frame[row][axis]) - f64::from(from[axis]))
    };
    let directions = frames.iter().flat_map(|frame| {
        (0..joints.len()).map(|row| {
            let along: [f64; 3] = way(row, frame);
            let length = honami_model::turn::norm(along);
            along.map(|v| v / length)
        })
    });
    let bone = |(row, joint): (usize, &Joint)| model::Joint {
        parent: joint.parent,
        length: frames.first().map_or(0.0, |frame| honami_model::turn::norm(way(row, frame))),
        ..model::Joint::default()
    };
    let root = frames.first().map_or([0.0; 3], |frame| frame[0].map(f64::from));
    let bones: Vec<model::Joint> = joints.iter().enumerate().map(bone).collect();
    let times = FrameTimes::new(times.to_vec())?;
    let carried = leaves.iter().zip(&grown.leaves).map(|(leaf, places)| {
        let offset = |(frame, place): (&&[[f32; 3]], &[f32; 3])| {
            let from = frame[leaf.joint as usize];
            std::array::from_fn(|axis| f64::from(place[axis]) - f64::from(from[axis]))
        };
        // Tracks are numbered in 32 bits; which one it is plays no part.
        let track = TrackId(u32::try_from(leaf.track).unwrap_or_default());
        Leaf { track, joint: leaf.joint, offsets: frames.iter().zip(places).map(offset).collect() }
    });
    let carried = carried.collect();
    Ok(Skeleton::new(root, bones, directions.collect(), times)?.with_leaves(carried)?)
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

fn single(place: [f64; 3]) -> [f32; 3] {
    place.map(|v| v as f32)
}
