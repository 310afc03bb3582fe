//! What an eye sees: a frustum.

use nalgebra::Vector3;

/// An eye, with the upright up in its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Metres.
    pub eye: Vector3<f64>,
    /// Where it looks, not straight up or down; of any length.
    pub towards: Vector3<f64>,
    /// Between the upper and the lower edge of the picture, radians.
    pub angle: f64,
    /// Width of the picture over its height.
    pub aspect: f64,
    /// Nothing beyond is seen, metres.
    pub far: f64,
}

impl View {
    /// Whether any of a ball may be seen.
    #[must_use]
    pub fn sees(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let forward = self.towards.normalize();
        let right = forward.cross(&Vector3::z()).normalize();
        let up = right.cross(&forward);
        let at = centre - self.eye;
        let depth = at.dot(&forward);
        if depth < -radius || depth > self.far + radius {
            return false;
        }
        // Distance from the plane through the eye and an edge: its normal leans outward by half the angle.
        let half = (self.angle / 2.0).tan();
        [(up, half), (right, half * self.aspect)].into_iter().all(|(across, slope)| {
            let beyond = (at.dot(&across).abs() - depth * slope) / (1.0 + slope.powi(2)).sqrt();
            beyond <= radius
        })
    }
}
