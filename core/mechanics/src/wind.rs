//! Air that moves: what blows on plants (thesis 5.2). Metres per second; z up.

mod field;
mod flow;
mod flowing;
mod gust;
mod layer;
mod noise;
mod spectrum;
#[cfg(test)]
mod tests;

pub use field::{Draw, Field};
pub use flow::{Primitive, Shape};
pub use flowing::{Flowing, FlowingError, Inflow};
pub use gust::{Frozen, Mask, Series};
pub use layer::Layer;
pub use noise::Noise;
pub use spectrum::{Kaimal, Power, Spectrum, series};

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Air that moves, everywhere and at any time.
pub trait Wind: Send + Sync {
    /// Velocity at a place, metres, and a time, seconds.
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64>;
}

impl Wind for Box<dyn Wind> {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        (**self).sample(place, time)
    }
}

/// The same wind everywhere and for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant(pub Vector3<f64>);

impl Wind for Constant {
    fn sample(&self, _place: &Vector3<f64>, _time: f64) -> Vector3<f64> {
        self.0
    }
}

/// Several winds at once: solutions of the simplified equations of Wejchert and Haumann (1991) add up.
#[derive(Default)]
pub struct Sum(pub Vec<Box<dyn Wind>>);

impl Wind for Sum {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        self.0.iter().map(|wind| wind.sample(place, time)).sum()
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
}
