//! A forest: one plant, how it moves, and where its copies stand in which wind.

use honami_mechanics::{Pace, Stand, Stirring};
use serde::{Deserialize, Serialize};

use crate::body::Body;
use crate::camera::Orbit;

/// Copies of a plant in the wind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForestScene {
    /// What the plant was read from, for titles.
    pub name: String,
    /// How it moves: by turns of its segments.
    pub stirring: Stirring,
    /// What it looks like.
    pub body: Body,
    /// Where copies stand, metres,
    pub places: Vec<[f32; 2]>,
    /// and how: one a place.
    pub stands: Vec<Stand>,
    /// What a plant weighs, kilograms: winds that flow are held back by it.
    pub kilograms: f64,
    /// How it goes on.
    pub pace: Pace,
    /// The wind, as it is typed.
    pub wind: String,
    /// Seconds that the wind blew before what is shown begins.
    pub run_in: f64,
    /// From where it is seen at first.
    pub orbit: Orbit,
}
