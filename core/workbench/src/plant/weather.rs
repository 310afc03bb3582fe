//! Winds over the ground on which a plant and its copies move.

use honami_mechanics::{Stand, Vector};
pub use honami_scene::weather::{Ground, Typed, WeatherError, help, read, value, with_value};

use super::Vibrating;
use super::sway::{Motion, free};

/// What wind blows over where a plant and its copies stand, for as long as they move.
#[must_use]
pub fn ground(plant: &Vibrating, motion: &Motion) -> Ground {
    let grove = motion.grove(plant);
    let heavy = plant.beams.kilograms() * motion.damping.mass;
    let tree = |(place, stand): (&Vector, &Stand)| {
        ([place.x, place.y], heavy * f64::from(stand.scale.powi(3) * stand.mass))
    };
    let trees = grove.places.iter().zip(&grove.stands).map(tree).collect();
    Ground::new(trees, f64::from(motion.n_frames) / motion.fps, free())
}
