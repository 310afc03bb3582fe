//! A plant that is filmed while it moves, from the side on which it moves most.

use std::sync::Arc;

use honami_mechanics::wind::Wind;
use honami_mechanics::{Direction, Pose, Stand, Stirring, Threads};
use honami_synth::Moving;

use super::Vibrating;
use super::grove::Grove;
use super::sway::{Motion, free};
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// Where all nodes are in every frame of a motion, in the plane in which they move most.
///
/// # Errors
/// What [`Forest`](honami_mechanics::Forest) refuses, and [`WorkbenchError::Stopped`].
pub fn film(
    plant: &Vibrating,
    wind: &dyn Wind,
    motion: &Motion,
    progress: &dyn Progress,
) -> Result<Moving, WorkbenchError> {
    motion.check()?;
    let n_nodes = plant.beams.len();
    // Where every node is in every frame, in space and in the picture.
    let (frames, there) = (motion.n_frames, free());
    let bytes = (frames as usize).saturating_mul(n_nodes * size_of::<[f64; 5]>());
    if bytes > there {
        return Err(WorkbenchError::FilmMemory { frames, nodes: n_nodes, bytes, there });
    }
    let stirring = Arc::new(Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), motion.form));
    let grove =
        Grove { places: vec![Direction::zeros()], stands: vec![Stand::default()], height: plant.height };
    let nodes: Vec<u32> = (0..n_nodes as u32).collect();
    let mut forest = grove.forest(&stirring, &nodes, motion)?;
    let threads = Threads::new(motion.n_threads)?;
    let mut moved = vec![[0.0; 3]; n_nodes];
    let mut frames: Vec<Vec<Direction>> = Vec::new();
    // Sums over all nodes and frames: of x x, y y and x y of displacements.
    let mut spread = [0.0; 3];
    for frame in 0..motion.n_frames {
        if progress.report(u64::from(frame), u64::from(motion.n_frames), "motion") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        forest.pose(Pose { details: None, motion: &mut moved }, &threads);
        let places = moved.iter().zip(stirring.rest()).map(|(moved, rest)| {
            let [x, y, z] = moved.map(f64::from);
            spread = [spread[0] + x * x, spread[1] + y * y, spread[2] + x * y];
            rest + Direction::new(x, y, z)
        });
        frames.push(places.collect());
        for _ in 0..motion.n_substeps {
            let time = forest.time();
            forest.step(&|copy| grove.blowing(wind, copy, time), None, &threads)?;
        }
    }
    // The longer axis of the ellipse of displacements.
    let angle = (2.0 * spread[2]).atan2(spread[0] - spread[1]) / 2.0;
    let (sin, cos) = angle.sin_cos();
    let seen = |at: &Direction| [cos * at.x + sin * at.y, at.z];
    Ok(Moving {
        parents: (0..n_nodes).map(|node| plant.beams.parent(node)).collect(),
        radii: (0..n_nodes).map(|node| plant.beams.radius(node)).collect(),
        frames: frames.iter().map(|frame| frame.iter().map(seen).collect()).collect(),
    })
}
