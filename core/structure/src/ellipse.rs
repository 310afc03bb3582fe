//! The ellipse in which 95 % of a group's features lie, and how deep they are when it is inflated (thesis 4.4.1).

#[cfg(test)]
mod tests;

use crate::follow::mean;

/// Semi-axes over standard deviations: the 95 % quantile of chi squared with two degrees of freedom, 5.9915, under a root
/// (errata E21).
const REACH: f64 = 2.447_746_830_680_816;
/// An ellipse that is thinner than this share of its length is a line: places are measured no better, in single precision.
const LINE: f64 = 1e-4;

/// An ellipse that encloses 95 % of a normal distribution with the mean and covariance of some places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// Its centre, pixels.
    pub centre: [f64; 2],
    /// The direction of its longer axis, unit; to the right for a circle.
    pub axis: [f64; 2],
    /// Semi-axes, pixels, the longer first: both 0 for one place, the shorter one 0 for places on a line.
    pub reach: [f64; 2],
}

impl Ellipse {
    /// The ellipse of some places; `None` of none.
    #[must_use]
    pub fn of(places: &[[f64; 2]]) -> Option<Self> {
        let centre = mean(places.iter().copied())?;
        let n = (places.len().max(2) - 1) as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for [x, y] in places {
            let (dx, dy) = (x - centre[0], y - centre[1]);
            (xx, xy, yy) = (xx + dx * dx / n, xy + dx * dy / n, yy + dy * dy / n);
        }
        let (middle, half) = (f64::midpoint(xx, yy), ((xx - yy) / 2.0).hypot(xy));
        // The second as determinant over the first: their difference would leave noise where it is 0.
        let long = middle + half;
        let short = if long > 0.0 { ((xx * yy - xy * xy) / long).max(0.0) } else { 0.0 };
        let angle = (2.0 * xy).atan2(xx - yy) / 2.0;
        let reach = [long, short].map(|variance| REACH * variance.sqrt());
        Some(Self { centre, axis: [angle.cos(), angle.sin()], reach })
    }

    /// How far from the picture's plane the ellipsoid is at a place, whose third axis is as long as the shorter of the two;
    /// pixels. Outside, where 5 % of the features are, it is 0 (errata E21), and so it is where the ellipse is a line.
    #[must_use]
    pub fn depth(&self, place: [f64; 2]) -> f64 {
        let [long, short] = self.reach;
        if short <= LINE * long {
            return 0.0;
        }
        let (dx, dy) = (place[0] - self.centre[0], place[1] - self.centre[1]);
        let [c, s] = self.axis;
        let (u, v) = ((c * dx + s * dy) / long, (c * dy - s * dx) / short);
        short * (1.0 - u * u - v * v).max(0.0).sqrt()
    }
}
