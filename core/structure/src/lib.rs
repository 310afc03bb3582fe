//! From tracks and their groups to the branches behind them: skeletons that move as filmed. Pure: no IO, no clock.
//!
//! Lengths are pixels of the clip; the axes are those of [`honami_model::skeleton`]. The same input gives the same bits.

pub mod assemble;
pub mod bind;
pub mod blend;
mod bones;
pub mod diener;
pub mod ellipse;
pub mod fewer;
mod filmed;
pub mod follow;
pub mod repeat;
pub mod shape;
pub mod siblings;
pub mod tree;
mod turn;
pub mod von_mises;
pub mod zeng;

#[cfg(test)]
mod tests;

use honami_model::brief::Brief;
use honami_model::clip::TimesError;
use honami_model::plant::PlantError;
use honami_model::skeleton::{Skeleton, SkeletonError};
use honami_model::track::TrackId;

/// A skeleton, and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The skeleton, with a leaf for every feature.
    pub skeleton: Skeleton,
    /// From the centre of its group to where each path usually is, pixels (right, down); `None` for those in no group.
    pub places: Vec<Option<[f64; 2]>>,
    /// The joint that each group has become, that of the copy in the picture; `None` of those that were cut off.
    pub joint_of: Vec<Option<u32>>,
    /// How far each fork stayed from what bears it, 0 to 1 of the way to the mean of what it bears.
    pub alphas: Vec<f64>,
    /// Forks that were one with what bears them, so that more than two bones begin there.
    pub n_collapsed: usize,
    /// Joints that were cut off, for they lay outside the envelope.
    pub n_cut: usize,
}

/// Why there is no skeleton.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// No feature is seen in any frame.
    #[error("no track of any group is seen: a skeleton grows from what moves")]
    NothingSeen,
    /// A path that is not of the clip, or nowhere.
    #[error(
        "track {track} has {came} samples; one for each of {n_frames} frames was wanted, at two finite numbers of pixels or \
         not seen"
    )]
    Path {
        /// The track.
        track: TrackId,
        /// Its samples.
        came: usize,
        /// Frames of the clip.
        n_frames: u32,
    },
    /// Root and features are one point.
    #[error("all that is tracked lies where the root is, at ({x:.1}, {y:.1}): place the root elsewhere")]
    NoExtent {
        /// Pixels, right.
        x: f64,
        /// Pixels, down.
        y: f64,
    },
    /// A root that is nowhere.
    #[error("a root lies at two finite numbers of pixels, not at ({x}, {y})")]
    Root {
        /// Pixels, right.
        x: f64,
        /// Pixels, down.
        y: f64,
    },
    /// Too few frames to come round in.
    #[error(
        "a loop takes {wanted} frames at least, one after the other, in which anything is seen: there are {came}"
    )]
    TooBrief {
        /// Frames that there are.
        came: u32,
        /// Frames at least.
        wanted: u32,
    },
    /// A shift that is none.
    #[error("joints are shifted by 0 to less than 1 of the way to what bears them, not by {0}")]
    Shift(f64),
    /// No copy at all.
    #[error("one copy at least: 0 were asked for")]
    Copies,
    /// Copies whose leaves fill the memory.
    #[error(
        "where the leaves of {copies} copies are in every frame takes {gigabytes} GB, and 6 GB is the most: fewer copies, \
         tracks or frames are wanted"
    )]
    TooManyLeaves {
        /// As many as asked for.
        copies: u32,
        /// What it would take.
        gigabytes: u64,
    },
    /// An envelope without a place to be in.
    #[error("nothing in the image of the envelope is white: paint white where branches may be")]
    NoWhite,
    /// An envelope that no branch is in.
    #[error(
        "no branch is within what is white in the image of the envelope: paint white where branches are to stay"
    )]
    AllCut,
    /// No angle that siblings could differ in.
    #[error(
        "no two bones are of one level from {wanted} on, and siblings differ in their angles: the levels of this skeleton \
         are 0 to {deepest}"
    )]
    NoLevel {
        /// The first level whose angles were to be drawn.
        wanted: u32,
        /// The last there is.
        deepest: u32,
    },
    /// A threshold that no angle reaches.
    #[error(
        "no angle of level {level} is as dense as {wanted} per radian: the densest are {most:.3} (κ = {kappa:.3}), and all \
         levels have angles above a threshold of {least:.3} or less"
    )]
    Threshold {
        /// Per radian, as asked for.
        wanted: f64,
        /// The first level that has none.
        level: u32,
        /// The highest density there.
        most: f64,
        /// How close together its angles are.
        kappa: f64,
        /// What is dense enough in all levels, cut off after three digits.
        least: f64,
    },
    /// Nothing to carry.
    #[error(
        "a plant to carry has a triangle at least, this one has none: export its surface, not points alone"
    )]
    NoMesh,
    /// A library without a branch.
    #[error("a plant is put together of one branch at least, and the library has none")]
    NoBranches,
    /// A mesh that goes nowhere from its foot.
    #[error(
        "a branch goes from its foot (its pivot, or the mean of what of it is lowest) to its tip (the mean of what is farthest \
         from there): in this one both are one place, {} from the farthest of it", Brief(*farthest)
    )]
    NoBranch {
        /// From the foot to the farthest vertex.
        farthest: f64,
    },
    /// Branches of a plant of nodes for which there is no room.
    #[error(
        "the plant has {n_branches} branches, which have {n_nodes} nodes together, each with all that it bears, and {most} are \
         taken at most: is what goes on thinner than what it bears? A plant of fewer forks is wanted, or a part of it"
    )]
    Wood {
        /// That begin at its forks.
        n_branches: usize,
        /// Of all of them.
        n_nodes: usize,
        /// At most.
        most: usize,
    },
    /// A branch that is no plant.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A vertex that is nowhere.
    #[error("vertex {vertex} lies at {place:?}: three numbers from -1e9 to 1e9 were wanted")]
    Vertex {
        /// Row.
        vertex: usize,
        /// As it came.
        place: [f64; 3],
    },
    /// What stands on the foot does not rise above it.
    #[error(
        "heights do not tell how large a pixel is: the plant rises by {of_mesh} above its foot, the skeleton by \
         {of_skeleton} px above its root; --unit says how much of the plant's length a pixel is"
    )]
    NoHeight {
        /// Lengths of the mesh.
        of_mesh: f64,
        /// Pixels.
        of_skeleton: f64,
    },
    /// A pixel that is nothing, or all.
    #[error("a pixel is 1e-9 to 1e9 of the plant's length, not {0:e}")]
    Unit(f64),
    /// Fewer joints than a rig has.
    #[error(
        "a rig has {least} joints at least, the root, a bone and its end, not {wanted}: --joints takes {least} or more"
    )]
    TooFewJoints {
        /// As asked for.
        wanted: usize,
        /// Of any rig.
        least: usize,
    },
    /// More bones than bindings count.
    #[error("a plant is bound to 65535 joints at most, not {0}: fewer groups or copies are wanted")]
    TooManyBones(usize),
    /// Frames of a loop that are none.
    #[error(transparent)]
    Times(#[from] TimesError),
    /// What has grown is no skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
}
