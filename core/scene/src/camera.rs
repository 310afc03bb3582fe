//! Who looks, and from where.

use serde::{Deserialize, Serialize};

use crate::vector::{cross, dot, unit};

/// Of how far the target is from 0, so near an eye may come.
const NEAREST: f32 = 1e-4;
/// So high above the ground an eye stays, of how far it is from what it looks at.
const ABOVE: f32 = 0.01;
/// Nearer to straight up or down than so many radians no camera looks: it would have no upright.
const POLE: f32 = 0.01;

/// An eye that looks at a place, with the upright up in its picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Where it is, in the lengths of the scene.
    pub eye: [f32; 3],
    /// Where it looks: another place, not straight above or below.
    pub target: [f32; 3],
    /// Between the upper and the lower edge of the picture, radians.
    pub angle: f32,
}

/// A camera on a sphere about what it looks at: what keys and a mouse move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// Where it looks.
    pub target: [f32; 3],
    /// From there to the eye, in the lengths of the scene.
    pub distance: f32,
    /// Of the eye about the upright, counterclockwise from above, radians; 0 is the side of negative y, from where x points
    /// right.
    pub azimuth: f32,
    /// Of the eye above the level of the target, radians.
    pub elevation: f32,
    /// Between the upper and the lower edge of the picture, radians.
    pub angle: f32,
}

impl Orbit {
    /// The camera where it is now.
    #[must_use]
    pub fn camera(&self) -> Camera {
        let steepest = std::f32::consts::FRAC_PI_2 - POLE;
        let (up, level) = self.elevation.clamp(-steepest, steepest).sin_cos();
        let (sin, cos) = self.azimuth.sin_cos();
        let way = [sin * level, -cos * level, up];
        let eye = std::array::from_fn(|axis| self.target[axis] + self.distance * way[axis]);
        Camera { eye, target: self.target, angle: self.angle }
    }

    /// Stays above the ground, where the upright is 0: what it looks at is not below it, and it looks up from no deeper than
    /// just above it.
    pub fn stay_above(&mut self) {
        self.target[2] = self.target[2].max(0.0);
        let lowest = ABOVE - self.target[2] / self.distance;
        self.elevation = self.elevation.max(lowest.clamp(-1.0, 1.0).asin());
    }

    /// So many times as far away: to a million of the lengths of the scene, and not so near that places about the target are
    /// one in single precision.
    pub fn zoom(&mut self, times: f32) {
        let least = NEAREST * dot(self.target, self.target).sqrt().max(1.0);
        self.distance = (self.distance * times).clamp(least, 1e6);
    }
}

impl Camera {
    /// Right, up and forward, each of length 1.
    #[must_use]
    pub fn axes(&self) -> [[f32; 3]; 3] {
        let forward = unit(std::array::from_fn(|axis| self.target[axis] - self.eye[axis]));
        let right = unit([forward[1], -forward[0], 0.0]);
        [right, cross(right, forward), forward]
    }

    /// Where a place is seen: right and up from the middle of the picture, in halves of its height, and how far before the
    /// eye it is. Behind the eye the first two mean nothing.
    #[must_use]
    pub fn seen(&self, place: [f32; 3]) -> ([f32; 2], f32) {
        let way: [f32; 3] = std::array::from_fn(|axis| place[axis] - self.eye[axis]);
        let [right, up, depth] = self.axes().map(|axis| dot(axis, way));
        let half = (self.angle / 2.0).tan() * depth;
        ([right / half, up / half], depth)
    }
}

#[cfg(test)]
mod tests;
