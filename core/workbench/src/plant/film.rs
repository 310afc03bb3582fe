//! A plant that is filmed while it moves, from the side on which it moves most.

use honami_mechanics::Vector;
use honami_mechanics::wind::Wind;
use honami_synth::Moving as Filmed;

use super::Vibrating;
use super::mover::{Mover, Moving, Way};
use super::sway::{Motion, free, room_of_winds};
use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::Progress;

/// A plant before the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Where all its nodes are in every frame, in the plane in which they move most.
    pub filmed: Filmed,
    /// What the simulator warned of, and what there is to warn of its motion.
    pub warnings: Vec<String>,
}

/// Moves a plant by a simulator and looks at it.
///
/// # Errors
/// What the simulator refuses, [`WorkbenchError::FilmMemory`], [`WorkbenchError::WindMemory`], and [`WorkbenchError::Stopped`].
pub fn film(
    plant: &Vibrating,
    mover: &Mover<'_>,
    wind: &dyn Wind,
    motion: &Motion,
    progress: &dyn Progress,
) -> Result<Film, WorkbenchError> {
    motion.check()?;
    let n_nodes = plant.beams.len();
    // Where every node is in every frame, in space and in the picture.
    let (frames, there) = (motion.n_frames, free());
    let bytes = (frames as usize).saturating_mul(n_nodes * size_of::<[f64; 5]>());
    if bytes > there {
        return Err(WorkbenchError::FilmMemory { frames, nodes: n_nodes, bytes, there });
    }
    room_of_winds(motion)?;
    let grove = motion.grove(plant);
    let ear = Ear::new(&mover.plugin.short_name, progress);
    let root = plant.beams.position(0);
    let mut frames: Vec<Vec<Vector>> = Vec::new();
    // Sums over all nodes and frames: of x x, y y and x y of displacements.
    let mut spread = [0.0; 3];
    let way = Way::Steps(*mover);
    let played = Moving::new(plant, &way, &grove, wind, motion, &ear)?.play(&ear, |_, moved| {
        let place = |node: usize| {
            let by = moved.of(0, node);
            spread = [spread[0] + by.x * by.x, spread[1] + by.y * by.y, spread[2] + by.x * by.y];
            plant.beams.position(node) - root + by
        };
        frames.push((0..n_nodes).map(place).collect());
        Ok(())
    })?;
    // The longer axis of the ellipse of displacements.
    let angle = (2.0 * spread[2]).atan2(spread[0] - spread[1]) / 2.0;
    let (sin, cos) = angle.sin_cos();
    let seen = |at: &Vector| [cos * at.x + sin * at.y, at.z];
    let filmed = Filmed {
        parents: (0..n_nodes).map(|node| plant.beams.parent(node)).collect(),
        radii: (0..n_nodes).map(|node| plant.beams.radius(node)).collect(),
        frames: frames.iter().map(|frame| frame.iter().map(seen).collect()).collect(),
    };
    let warnings = ear.warnings().into_iter().chain(played.too_far(plant)).collect();
    Ok(Film { filmed, warnings })
}
