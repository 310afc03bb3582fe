//! Wind that was drawn or recorded once and is carried over the land.

use super::{Wind, is_whole};
use nalgebra::Vector3;

/// A wind at one place over time, evenly sampled, read between samples along a line; it begins again after its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Seconds between samples.
    pub step: f64,
    /// Metres per second.
    pub samples: Vec<Vector3<f64>>,
}

impl Series {
    /// At a time; 0 where there are no samples.
    #[must_use]
    pub fn at(&self, time: f64) -> Vector3<f64> {
        let n = self.samples.len();
        if n == 0 {
            return Vector3::zeros();
        }
        let place = (time / self.step).rem_euclid(n as f64);
        let (first, share) = (place.floor(), place.fract());
        let at = |k: usize| self.samples[k % n];
        at(first as usize).lerp(&at(first as usize + 1), share)
    }

    /// Seconds after which it begins again.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.step * self.samples.len() as f64
    }
}

impl Wind for Series {
    fn sample(&self, _place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.at(time)
    }

    fn repeats(&self, seconds: f64) -> bool {
        is_whole(seconds / self.period())
    }
}

/// Turbulence that was there at one time and is carried by the mean wind without changing (Taylor's frozen flow, 5.5):
/// w(x, t) = mean + w(x - mean (t - t*), t*). Errata E25: the text leaves out t*.
pub struct Frozen<W> {
    /// What carries it, metres per second.
    pub mean: Vector3<f64>,
    /// The turbulence,
    pub turbulence: W,
    /// as it is at this time, seconds.
    pub time: f64,
}

impl<W: Wind> Wind for Frozen<W> {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let carried = place - self.mean * (time - self.time);
        self.mean + self.turbulence.sample(&carried, self.time)
    }
}

/// A wind within a round mask that travels over the land (Perbet and Cani, 2001): a squall.
pub struct Mask<W> {
    /// What blows in it.
    pub wind: W,
    /// Where its centre is at time 0, metres,
    pub centre: [f64; 2],
    /// and where it goes, metres per second.
    pub velocity: [f64; 2],
    /// At this distance it has fallen to 1/e, metres.
    pub radius: f64,
}

impl<W: Wind> Wind for Mask<W> {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let away = |axis: usize| place[axis] - self.centre[axis] - self.velocity[axis] * time;
        let square = (away(0).powi(2) + away(1).powi(2)) / self.radius.powi(2);
        self.wind.sample(place, time) * (-square).exp()
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.velocity.iter().all(|v| *v == 0.0) && self.wind.repeats(seconds)
    }
}
