//! The shapes of leaves and branches: one measure of how deep a place lies inside, for picture and truth.

use crate::plant::{Branch, Leaf};
use crate::pose::LeafPose;

/// A box in local coordinates, pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) x: [f32; 2],
    pub(crate) y: [f32; 2],
}

/// A shape in its own frame.
pub(crate) trait Outline {
    /// A box around all of it, with a margin for soft edges.
    fn bounds(&self, margin_px: f32) -> Bounds;

    /// How deep a local place lies inside, pixels; negative outside. Exact near the edge to first order.
    fn depth_px(&self, x: f32, y: f32) -> f32;
}

/// Half thickness of a petiole, pixels.
const PETIOLE_PX: f32 = 0.7;

/// A pointed oval on a petiole: half width `w (1 - u²)(1 - a u)` over its length u = -1..1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafOutline {
    pub(crate) half_length_px: f32,
    /// As seen: a leaf that turns away is narrow.
    pub(crate) half_width_px: f32,
    ovate: f32,
    petiole_px: f32,
}

impl LeafOutline {
    pub(crate) fn new(leaf: &Leaf, pose: &LeafPose) -> Self {
        Self {
            half_length_px: leaf.half_length_px as f32,
            half_width_px: (leaf.half_width_px * pose.roll_rad.cos().abs()).max(0.6) as f32,
            ovate: leaf.ovate as f32,
            petiole_px: leaf.petiole_px as f32,
        }
    }
}

impl Outline for LeafOutline {
    fn bounds(&self, margin_px: f32) -> Bounds {
        let half_width_px = self.half_width_px * 1.12 + margin_px;
        let length_px = self.half_length_px + margin_px;
        Bounds { x: [-length_px - self.petiole_px, length_px], y: [-half_width_px, half_width_px] }
    }

    #[inline]
    fn depth_px(&self, x: f32, y: f32) -> f32 {
        let u = x / self.half_length_px;
        let off_px = y.abs();
        if u < -1.0 {
            return (PETIOLE_PX - off_px).min(x + self.half_length_px + self.petiole_px);
        }
        // Far beyond the tip both factors would be negative, and their product a ghost of the leaf.
        let (round, taper) = (1.0 - u * u, (1.0 - self.ovate * u).max(0.2));
        let slope = (-2.0 * u * taper - self.ovate * round) * self.half_width_px / self.half_length_px;
        let half_px = round * taper * self.half_width_px;
        let steep = (1.0 + slope * slope).sqrt();
        // Where the blade is thinner than a pixel its far edge takes from the pixel too.
        (half_px - off_px) / steep + ((half_px + off_px) / steep - 0.5).min(0.0)
    }
}

/// A slightly bent, tapering rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BranchOutline {
    length_px: f32,
    bend_px: f32,
    radius_px: [f32; 2],
}

impl BranchOutline {
    pub(crate) fn new(branch: &Branch) -> Self {
        Self {
            length_px: branch.length_px as f32,
            bend_px: branch.bend_px as f32,
            radius_px: branch.radius_px.map(|r| r as f32),
        }
    }

    /// Half thickness at a local column, and how far a local place lies off the middle line.
    #[inline]
    pub(crate) fn section(&self, x: f32, y: f32) -> (f32, f32) {
        let share = (x / self.length_px).clamp(0.0, 1.0);
        let slope = 2.0 * self.bend_px * share / self.length_px;
        let off_px = (y - self.bend_px * share * share) / (1.0 + slope * slope).sqrt();
        (self.radius_px[0] + share * (self.radius_px[1] - self.radius_px[0]), off_px)
    }
}

impl Outline for BranchOutline {
    fn bounds(&self, margin_px: f32) -> Bounds {
        let reach_px = self.radius_px[0] + margin_px;
        Bounds {
            x: [-reach_px, self.length_px + reach_px],
            y: [self.bend_px.min(0.0) - reach_px, self.bend_px.max(0.0) + reach_px],
        }
    }

    #[inline]
    fn depth_px(&self, x: f32, y: f32) -> f32 {
        let (radius_px, off_px) = self.section(x, y);
        let past_px = (x - self.length_px).max(-x).max(0.0);
        radius_px - off_px.hypot(past_px)
    }
}
