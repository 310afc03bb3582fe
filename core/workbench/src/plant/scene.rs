//! A plant, or a forest of it, as a scene: all that whoever draws it has to know.

use honami_mechanics::{Form, Pace, Stirring};
use honami_scene::body::{Body, Foliage};
use honami_scene::forest::live;
use honami_scene::{ForestScene, Orbit};

use super::Vibrating;
use super::sway::{Motion, free};
use crate::error::WorkbenchError;

/// Between the upper and the lower edge of a picture, radians.
const ANGLE: f32 = 0.6;
/// Of the eye above the level of what it looks at, radians: of one plant, and of a forest.
const ELEVATIONS: [f32; 2] = [0.06, 0.2];
/// So many heights away is the eye from one plant.
const AWAY: f32 = 2.4;
/// Of the side of a forest.
const AWAY_FROM_MANY: f32 = 1.0;
/// Seconds that a wind blows before what is shown begins: what it sets swinging by beginning has died away by then.
const RUN_IN_S: f64 = 20.0;

/// How a plant is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// What it is called in titles.
    pub name: String,
    /// The wind, as it is typed.
    pub wind: String,
    /// Leaves on the end of every branch; `None`: as a full crown has.
    pub leaves: Option<u32>,
    /// Of a leaf, metres; `None`: as plants of that size have.
    pub leaf_length: Option<f64>,
}

/// The scene of a plant that moves so; it moves by turns of its segments.
///
/// # Errors
/// [`WorkbenchError::Spread`] and its like of what the motion cannot be, [`WorkbenchError::Weather`] of the wind.
pub fn scene(plant: &Vibrating, motion: &Motion, shown: &Shown) -> Result<ForestScene, WorkbenchError> {
    motion.check()?;
    let grove = motion.grove(plant);
    motion.bears(plant, &grove.stands)?;
    let usual = Foliage::usual(&plant.beams);
    let foliage = Foliage {
        per_end: shown.leaves.unwrap_or(usual.per_end),
        length: shown.leaf_length.unwrap_or(usual.length),
        ..usual
    };
    let pace = Pace { step: motion.step(), integrator: motion.integrator, damping: motion.damping };
    let places: Vec<[f32; 2]> = grove.places.iter().map(|at| [at.x as f32, at.y as f32]).collect();
    let scene = ForestScene {
        name: shown.name.clone(),
        stirring: Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), Form::Turn),
        body: Body::new(&plant.beams, plant.modes.len(), &foliage),
        orbit: orbit(plant, &places),
        places,
        stands: grove.stands,
        kilograms: plant.beams.kilograms(),
        pace,
        wind: shown.wind.clone(),
        run_in: RUN_IN_S,
    };
    // Whether there is such a wind here is said before anything is shown.
    live::wind(&scene, &scene.wind, free())?;
    Ok(scene)
}

/// One plant whole, from the front; of many most, from over the nearest.
fn orbit(plant: &Vibrating, places: &[[f32; 2]]) -> Orbit {
    let size = plant.size() as f32;
    let middle: [f32; 2] = [0, 1].map(|axis| {
        let along = || places.iter().map(|place| place[axis]);
        f32::midpoint(along().fold(f32::INFINITY, f32::min), along().fold(f32::NEG_INFINITY, f32::max))
    });
    let side = 2.0 * places.iter().map(|[x, y]| (x - middle[0]).hypot(y - middle[1])).fold(0.0, f32::max);
    let is_alone = places.len() == 1;
    Orbit {
        target: [middle[0], middle[1], 0.5 * size],
        distance: AWAY * size + AWAY_FROM_MANY * side,
        azimuth: 0.0,
        elevation: ELEVATIONS[usize::from(!is_alone)],
        angle: ANGLE,
    }
}

#[cfg(test)]
mod tests;
