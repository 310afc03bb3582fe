//! Air that moves: what blows on plants (thesis 5.2). Metres per second; z up.

mod field;
mod flow;
mod flowing;
mod gust;
mod layer;
mod noise;
mod profile;
mod spectrum;
#[cfg(test)]
mod tests;

pub use field::{Draw, Field};
pub use flow::{Primitive, Shape};
pub use flowing::{Flowing, FlowingError, Inflow};
pub use gust::{Frozen, Mask, Series};
pub use layer::Layer;
pub use noise::Noise;
pub use profile::{Growth, Profile};
pub use spectrum::{Kaimal, Power, Spectrum, series};

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Air that moves, everywhere and at any time.
pub trait Wind: Send + Sync {
    /// Velocity at a place, metres, and a time, seconds.
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64>;

    /// Whether so many seconds later it is everywhere and always what it was: as good as never, but where a wind says so.
    fn repeats(&self, _seconds: f64) -> bool {
        false
    }
}

impl Wind for Box<dyn Wind> {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        (**self).sample(place, time)
    }

    fn repeats(&self, seconds: f64) -> bool {
        (**self).repeats(seconds)
    }
}

/// The same wind everywhere and for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant(pub Vector3<f64>);

impl Wind for Constant {
    fn sample(&self, _place: &Vector3<f64>, _time: f64) -> Vector3<f64> {
        self.0
    }

    fn repeats(&self, _seconds: f64) -> bool {
        true
    }
}

/// Whether there are so many of something, but for rounding, that none is left over.
fn is_whole(n: f64) -> bool {
    (n - n.round()).abs() < 1e-9 * n.abs().max(1.0)
}

/// Several winds at once: solutions of the simplified equations of Wejchert and Haumann (1991) add up.
#[derive(Default)]
pub struct Sum(pub Vec<Box<dyn Wind>>);

impl Wind for Sum {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.0.iter().map(|wind| wind.sample(place, time)).sum()
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.0.iter().all(|wind| wind.repeats(seconds))
    }
}

/// A wave of wind: amplitude times sin(2 pi (f t - k x) + phase), as games have them (thesis 5.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Metres per second.
    pub amplitude: Vector3<f64>,
    /// Hertz.
    pub hz: f64,
    /// Waves per metre, in the direction that they travel.
    pub waves: Vector3<f64>,
    /// Radians.
    pub phase: f64,
}

impl Wind for Sine {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.amplitude * (TAU * (self.hz * time - self.waves.dot(place)) + self.phase).sin()
    }

    fn repeats(&self, seconds: f64) -> bool {
        is_whole(self.hz * seconds)
    }
}
