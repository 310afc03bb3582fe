//! Points of the picture plane and rigid motions in it; angles turn from x (right) to y (down).

use std::ops::{Add, Mul, Sub};

/// A point or an offset, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) x: f64,
    pub(crate) y: f64,
}

impl Point {
    pub(crate) const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// The unit vector at an angle.
    pub(crate) fn unit(angle_rad: f64) -> Self {
        Self::new(angle_rad.cos(), angle_rad.sin())
    }

    pub(crate) fn norm(self) -> f64 {
        self.x.hypot(self.y)
    }
}

impl Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}

/// A frame that lies in the picture: its origin and the direction of its x axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: Point,
    pub(crate) angle_rad: f64,
    axis: Point,
}

impl Frame {
    pub(crate) fn new(origin: Point, angle_rad: f64) -> Self {
        Self { origin, angle_rad, axis: Point::unit(angle_rad) }
    }

    /// Unit vector of the x axis, in the picture.
    pub(crate) fn axis(&self) -> Point {
        self.axis
    }

    /// A local point, in the picture.
    pub(crate) fn out(&self, local: Point) -> Point {
        self.origin
            + Point::new(
                self.axis.x * local.x - self.axis.y * local.y,
                self.axis.y * local.x + self.axis.x * local.y,
            )
    }

    /// A point of the picture, local.
    pub(crate) fn into_local(self, point: Point) -> Point {
        let d = point - self.origin;
        Point::new(self.axis.x * d.x + self.axis.y * d.y, self.axis.x * d.y - self.axis.y * d.x)
    }
}
