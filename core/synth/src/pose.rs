//! The plant at one time: every branch turned by its sway, every leaf where that carries it.

use crate::geometry::{Frame, Point};
use crate::plant::{Plant, frames_of};
use crate::wind::Wind;

/// A leaf in the picture: its frame has the centre as origin and the tip on the x axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafPose {
    pub(crate) frame: Frame,
    /// Turn about its own axis; 0 faces the camera.
    pub(crate) roll_rad: f64,
}

/// Where all parts are.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    pub(crate) branches: Vec<Frame>,
    pub(crate) leaves: Vec<LeafPose>,
}

impl Pose {
    /// The plant at a time in wind of a given scale.
    pub(crate) fn at(plant: &Plant, wind: &Wind, scale: f64, t_secs: f64) -> Self {
        let branches = frames_of(&plant.branches, |branch| {
            let sway: f64 = branch.modes.iter().map(|mode| mode.at(t_secs)).sum();
            scale * wind.strength(branch.gust_x_px, t_secs) * sway
        });
        let leaves = plant
            .leaves
            .iter()
            .map(|leaf| {
                let carrier = branches[leaf.branch];
                let gust = wind.strength(plant.branches[leaf.branch].gust_x_px, t_secs);
                let flutter_rad = scale * gust * leaf.flutter.at(t_secs);
                let angle_rad = carrier.angle_rad + leaf.turn_rad + flutter_rad;
                let centre = carrier.out(leaf.base) + Point::unit(angle_rad) * leaf.reach_px();
                LeafPose { frame: Frame::new(centre, angle_rad), roll_rad: leaf.roll_rad + flutter_rad }
            })
            .collect();
        Self { branches, leaves }
    }
}
