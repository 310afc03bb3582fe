//! How wind grows with height above the ground.

use super::Wind;
use nalgebra::Vector3;

/// What a wind is at a height, as a share of what it is where it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Growth {
    /// ln((z - d) / z0) / ln((at - d) / z0) over rough ground, 0 below d + z0 (Stull, An Introduction to Boundary Layer
    /// Meteorology, 1988, 9.7.5).
    Log {
        /// z0, metres: 0.03 grass, 0.1 crops, 0.5 to 1 woods.
        roughness: f64,
        /// d, metres: above what stands close together, two thirds of its height.
        displacement: f64,
    },
    /// (z / at)^exponent: 0.14 over open land, 0.2 to 0.3 over woods (Burton and others, Wind Energy Handbook, 2.6.2).
    Power {
        /// 0: the same at all heights.
        exponent: f64,
    },
}

/// A wind, mean and gusts alike, that grows with height.
pub struct Profile<W> {
    /// As it is
    pub wind: W,
    /// so many metres above the ground; by `Log` more than displacement and roughness together.
    pub at: f64,
    /// How it grows.
    pub growth: Growth,
}

impl<W> Profile<W> {
    /// Of the wind where it is known, at a height, metres.
    #[must_use]
    pub fn share(&self, height: f64) -> f64 {
        match self.growth {
            Growth::Log { roughness, displacement } => {
                let ln = |height: f64| ((height - displacement) / roughness).max(1.0).ln();
                ln(height) / ln(self.at)
            }
            Growth::Power { exponent } => (height.max(0.0) / self.at).powf(exponent),
        }
    }
}

impl<W: Wind> Wind for Profile<W> {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.wind.sample(place, time) * self.share(place.z)
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.wind.repeats(seconds)
    }
}
