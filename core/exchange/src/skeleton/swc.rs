//! A skeleton at rest as SWC, which `honami simulate` reads, too.

use std::fmt::Write as _;

use honami_model::skeleton::Skeleton;

/// What files that are written begin with.
pub(super) const BEGIN: &str = "# number type x y z radius parent; pixels, z up; radius 0: not measured\n";

/// The file: pixels, x right, y away from the camera, z up, the root in the origin. Numbers count from 1.
pub(super) fn text(skeleton: &Skeleton) -> String {
    let root = skeleton.root();
    let mut text = BEGIN.to_owned();
    for (row, (joint, place)) in skeleton.joints().iter().zip(skeleton.places(skeleton.rest())).enumerate() {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|axis| place[axis] - root[axis]);
        let parent = joint.parent.map_or(-1, |parent| i64::from(parent) + 1);
        // Writing to a string cannot fail.
        writeln!(text, "{} 0 {x:.6} {y:.6} {z:.6} 0 {parent}", row + 1).unwrap_or_default();
    }
    text
}
