//! Cameras that measure: their numbers, how they stand, and where in space something is that two of them see. Pure: no IO, no clock.
//!
//! Pixels: x right, y down, `(0, 0)` is the centre of the top-left pixel, as everywhere in honami and in OpenCV. A camera's own axes are
//! x right, y down, z forward. Lengths have the unit of the target that the cameras were calibrated with. Poses are named
//! `b_from_a`. Angles are radians. The same input gives the same bits.

pub mod align;
pub mod assign;
mod bundle;
pub mod calibrate;
pub mod camera;
pub mod clock;
pub mod epipolar;
pub mod homography;
mod least;
pub mod matching;
pub mod planar;
mod pose;
pub mod stereo;
mod target;
pub mod together;
pub mod triangulate;
mod zhang;

#[cfg(test)]
mod staged;

pub use bundle::{Focal, Model};
pub use calibrate::{Calibration, Options, calibrate};
pub use camera::Camera;
pub use epipolar::Pair;
pub use least::Loss;
pub use pose::Pose;
pub use stereo::{Stereo, stereo};
pub use target::{Sighting, Target};
pub use triangulate::{Fix, triangulate};

/// A position in a picture, pixels.
pub type Pixel = nalgebra::Vector2<f64>;
/// A position in space, in the unit of the target.
pub type Place = nalgebra::Vector3<f64>;

/// Why cameras say nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// The distortion has no way back from there.
    #[error(
        "pixel ({x:.1}, {y:.1}) lies beyond what the camera's distortion can describe; it holds where the target was seen: \
         calibrate with views that reach there, or with k3 held"
    )]
    Reach {
        /// Right.
        x: f64,
        /// Down.
        y: f64,
    },
    /// A board has no squares.
    #[error(
        "a board has at least 2 by 2 inner corners and squares of some size, came {columns} by {rows} of {square}"
    )]
    Board {
        /// Corners in a row.
        columns: usize,
        /// Rows of corners.
        rows: usize,
        /// Side of a square.
        square: f64,
    },
    /// A plane is known by four points.
    #[error("a plane needs at least {wanted} points, came {came}")]
    TooFewPoints {
        /// The fewest.
        wanted: usize,
        /// Those there were.
        came: usize,
    },
    /// Points do not span a plane.
    #[error(
        "all points, or all but one, lie on a line; at least four are needed of which no three do, or two lines of them"
    )]
    Collinear,
    /// A target has no such point.
    #[error("there is no point {point} on a target of {n_points} points, numbered from 0")]
    NoSuchPoint {
        /// The number.
        point: usize,
        /// Points of the target.
        n_points: usize,
    },
    /// A point is seen at one place in a view.
    #[error("point {point} is given twice")]
    SeenTwice {
        /// Its number.
        point: usize,
    },
    /// Not a place in a picture.
    #[error("the pixel of point {point} is not a finite number")]
    NotFinite {
        /// Its number.
        point: usize,
    },
    /// A board seen from behind.
    #[error(
        "the points are in mirrored order; wanted is x along a row and y down, as one sees it who looks at the target's face"
    )]
    Mirrored,
    /// Nothing fits.
    #[error(
        "no pose before the camera shows the target as it was seen; check the numbers and places of its points"
    )]
    Behind,
    /// One of the views.
    #[error("view {view}: {source}")]
    View {
        /// Its number, from 0.
        view: usize,
        /// What is wrong with it.
        source: Box<CameraError>,
    },
    /// Not enough views.
    #[error("calibration needs at least {wanted} views, came {came}, or some of its numbers held")]
    TooFewViews {
        /// The fewest.
        wanted: usize,
        /// Those there were.
        came: usize,
    },
    /// Views that say the same.
    #[error(
        "the views are too much alike to tell the camera's {number} {}; tilt the target by 20 to 50 degrees, each time another way",
        well(*share)
    )]
    Alike {
        /// The number.
        number: &'static str,
        /// Its standard error, of the focal length or the picture's size; infinite where nothing is told.
        share: f64,
    },
    /// A view that was given twice tells nothing new, and would be counted as if it did.
    #[error("views {first} and {second} are one: every point is at the same place in both; give it once")]
    SameView {
        /// The first of both, from 0.
        first: usize,
        /// The second.
        second: usize,
    },
    /// Fewer points than numbers.
    #[error(
        "{n_points} points in {n_views} views tell {told} numbers of a camera, {wanted} are looked for; wanted are more views, \
         a target of more points, or some of the numbers held"
    )]
    TooLittle {
        /// Points that were seen.
        n_points: usize,
        /// Views there were.
        n_views: usize,
        /// Numbers that so many tell, beside how the target stands.
        told: usize,
        /// Numbers that are looked for.
        wanted: usize,
    },
    /// One of two cameras.
    #[error("the {camera} camera: {source}")]
    One {
        /// Left or right.
        camera: &'static str,
        /// What is wrong with what it saw.
        source: Box<CameraError>,
    },
    /// Cameras have nothing in common.
    #[error("no view of the target was seen by both cameras; wanted is at least one")]
    NeverTogether,
    /// One ray meets nothing.
    #[error("a place is found by at least 2 cameras that see it, came {came}")]
    TooFewSights {
        /// Those there were.
        came: usize,
    },
    /// Rays that do not tell where they meet.
    #[error("the rays are parallel: the cameras stand too close together, or what they see is too far away")]
    Parallel,
    /// Rays that meet behind.
    #[error(
        "the rays meet behind a camera: what was seen is not one place, or the cameras do not stand as was said"
    )]
    BehindBoth,
    /// Too little to turn by.
    #[error("an alignment needs at least 3 finite places that do not lie on a line, came {came}")]
    Unaligned {
        /// Those there were.
        came: usize,
    },
    /// Not a value over time.
    #[error(
        "a signal has at least {fewest} finite values at times that grow, came {values} at {times} times"
    )]
    Signal {
        /// The fewest.
        fewest: usize,
        /// Times there were.
        times: usize,
        /// Values there were.
        values: usize,
    },
    /// Two that do not move alike.
    #[error(
        "the signals are not alike at any offset; compare what moves together, and allow a larger offset"
    )]
    Strangers,
    /// Likeness still grows at the end of the search.
    #[error("the signals are most alike at the end of the search, {:.3} s: allow a larger offset", offset.seconds)]
    AtTheEnd {
        /// The offset there, and how alike they are.
        offset: clock::Offset,
    },
    /// No light.
    #[error("no flash: brightness has no step up that stands out of its noise; give the region of the lamp")]
    NoFlash,
    /// No end.
    #[error(
        "the fit did not come to rest; check the order of the points, or have some of the camera's numbers held"
    )]
    Restless,
}

/// How well a number is known whose standard error is such a share of its size.
fn well(share: f64) -> String {
    if share < 1.0 { format!("better than to {:.0} %", 100.0 * share) } else { "at all".to_owned() }
}
