//! Flow primitives about an upright axis (Wejchert and Haumann, 1991): free of divergence and of turning but for the axis.

use super::Wind;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;

/// What the air does about the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// It leaves it.
    Source,
    /// It goes into it.
    Sink,
    /// It turns about it, anticlockwise from above.
    Vortex,
}

/// A source, a sink or a vortex about an upright axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// What it does.
    pub shape: Shape,
    /// Where its axis meets the ground, metres.
    pub centre: [f64; 2],
    /// What flows out of a metre of the axis, or round it: square metres per second, 2 pi r times the speed at r.
    pub strength: f64,
    /// Within this distance of the axis the speed falls to 0 as a straight line, metres; more than 0.
    pub core: f64,
}

impl Wind for Primitive {
    fn sample(&self, place: &Vector3<f64>, _time: f64) -> Vector3<f64> {
        let from = place.xy() - Vector2::from(self.centre);
        let reach = from.norm_squared().max(self.core.powi(2));
        let out = from * (self.strength / (TAU * reach));
        match self.shape {
            Shape::Source => Vector3::new(out.x, out.y, 0.0),
            Shape::Sink => Vector3::new(-out.x, -out.y, 0.0),
            Shape::Vortex => Vector3::new(-out.y, out.x, 0.0),
        }
    }

    fn repeats(&self, _seconds: f64) -> bool {
        true
    }
}
