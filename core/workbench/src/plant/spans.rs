//! How unlike the copies of a plant are.

use super::Vibrating;
use super::sway::Motion;

/// Of all copies, the least and the most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spans {
    /// Of the slowest mode, hertz.
    pub hz: [f64; 2],
    /// Metres.
    pub height: [f64; 2],
    /// Wood and leaves, kilograms.
    pub kilograms: [f64; 2],
}

impl Spans {
    /// Of the copies of a plant as they move.
    #[must_use]
    pub fn of(plant: &Vibrating, motion: &Motion) -> Self {
        let stands = motion.grove(plant).stands;
        let (heavier, kilograms, hz) = (motion.damping.mass, plant.beams.kilograms(), plant.modes.hz(0));
        let span = |of: &dyn Fn(f64, f64) -> f64| {
            let values = stands.iter().map(|stand| of(f64::from(stand.scale), f64::from(stand.mass)));
            values.fold([f64::INFINITY, 0.0], |[least, most], value| [value.min(least), value.max(most)])
        };
        Self {
            // A copy that is s times as large swings s times as slowly.
            hz: span(&|scale, mass| hz / (scale * (mass * heavier).sqrt())),
            height: span(&|scale, _| plant.height * scale),
            kilograms: span(&|scale, mass| kilograms * heavier * scale.powi(3) * mass),
        }
    }
}
