//! From tracks and their groups to the branches behind them: skeletons that move as filmed. Pure: no IO, no clock.
//!
//! Lengths are pixels of the clip; the axes are those of [`honami_model::skeleton`]. The same input gives the same bits.

pub mod diener;
pub mod ellipse;
pub mod follow;
pub mod repeat;
pub mod siblings;
pub mod tree;
mod turn;
pub mod von_mises;

use honami_model::clip::TimesError;
use honami_model::skeleton::SkeletonError;

/// Why there is no skeleton.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// No feature is seen in any frame.
    #[error("no track of any group is seen: a skeleton grows from what moves")]
    NothingSeen,
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
    #[error("a loop takes {wanted} frames at least, the clip has {came}")]
    TooBrief {
        /// Frames that there are.
        came: u32,
        /// Frames at least.
        wanted: u32,
    },
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
    /// Frames of a loop that are none.
    #[error(transparent)]
    Times(#[from] TimesError),
    /// What has grown is no skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
}
