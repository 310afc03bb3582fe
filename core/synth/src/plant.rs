//! The plant at rest: branches on branches, leaves on the outer ones, each in its parent's frame.

mod grow;

use crate::geometry::{Frame, Point};
use crate::texture::Texture;
use crate::wind::Mode;

/// A branch, rigid, that turns about its base.
#[derive(Clone, Debug)]
pub(crate) struct Branch {
    pub(crate) parent: Option<usize>,
    pub(crate) order: u32,
    /// Where it grows: in the parent's frame, or in the picture for the stem.
    pub(crate) base: Point,
    /// Direction at the base relative to the parent's frame.
    pub(crate) turn_rad: f64,
    pub(crate) length_px: f64,
    /// How far the tip lies off the straight line.
    pub(crate) bend_px: f64,
    /// Half thickness at the base and at the tip.
    pub(crate) radius_px: [f64; 2],
    /// Column of the base at rest: when a gust arrives.
    pub(crate) gust_x_px: f64,
    pub(crate) modes: Vec<Mode>,
    /// Colour in full light, RGB 0..255.
    pub(crate) colour: [f32; 3],
}

impl Branch {
    /// Its frame on that of the parent, turned by a sway.
    fn frame(&self, parent: Option<&Frame>, sway_rad: f64) -> Frame {
        let turn_rad = self.turn_rad + sway_rad;
        match parent {
            None => Frame::new(self.base, turn_rad),
            Some(parent) => Frame::new(parent.out(self.base), parent.angle_rad + turn_rad),
        }
    }

    /// The middle line at a share of the length, local.
    pub(crate) fn along(&self, share: f64) -> Point {
        Point::new(self.length_px * share, self.bend_px * share * share)
    }

    /// Direction of the middle line at a share of the length, local.
    fn direction_rad(&self, share: f64) -> f64 {
        (2.0 * self.bend_px * share).atan2(self.length_px)
    }

    /// Half thickness at a share of the length.
    fn radius_at(&self, share: f64) -> f64 {
        self.radius_px[0] + share * (self.radius_px[1] - self.radius_px[0])
    }
}

/// A leaf that flutters about the foot of its petiole and rides on its branch.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub(crate) branch: usize,
    /// Where the petiole starts, in the branch's frame.
    pub(crate) base: Point,
    /// Direction relative to the branch's frame.
    pub(crate) turn_rad: f64,
    pub(crate) petiole_px: f64,
    pub(crate) half_length_px: f64,
    pub(crate) half_width_px: f64,
    /// How far the widest place lies towards the base, 0 (middle) to 0.5.
    pub(crate) ovate: f64,
    /// Turn about its own axis at rest; 0 faces the camera.
    pub(crate) roll_rad: f64,
    pub(crate) flutter: Mode,
    /// Colour in the light that reaches it, RGB 0..255.
    pub(crate) colour: [f32; 3],
    pub(crate) texture: Texture,
}

impl Leaf {
    /// Distance of the centre from where the petiole starts.
    pub(crate) fn reach_px(&self) -> f64 {
        self.petiole_px + self.half_length_px
    }
}

/// Something to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Item {
    Branch(usize),
    Leaf(usize),
}

/// The plant at rest, with all that decides how it moves.
#[derive(Clone, Debug)]
pub(crate) struct Plant {
    /// A parent comes before its children.
    pub(crate) branches: Vec<Branch>,
    /// Leaves of one branch lie together.
    pub(crate) leaves: Vec<Leaf>,
    /// All of it from far to near.
    pub(crate) order: Vec<Item>,
}

/// Frames of the branches when each turns by `sway(branch)`, radians.
pub(crate) fn frames_of(branches: &[Branch], sway: impl Fn(&Branch) -> f64) -> Vec<Frame> {
    let mut frames: Vec<Frame> = Vec::with_capacity(branches.len());
    for branch in branches {
        frames.push(branch.frame(branch.parent.map(|p| &frames[p]), sway(branch)));
    }
    frames
}
