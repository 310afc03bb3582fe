//! A plant, or a forest of it, with its motion in one file of glTF.
//!
//! Its modes become morph targets: where nodes are is a sum of what modes do to them, one term for each mode and power of
//! its arc tangent. Where a motion is such a sum, the file has in every frame what the simulation has; where segments turn
//! by all modes together, it comes near, and how near is told. Joints would have to be as many as nodes, more than engines
//! take. A copy costs a weight a target and frame, not a mesh.

use std::sync::Arc;

use honami_exchange::AtomicFile;
use honami_exchange::plant::{Body, Placed, Sizes, Target, write_glb};
use honami_mechanics::wind::Wind;
use honami_mechanics::{Bending, Detail, Direction, Following, Pose, Stand, Stirring, Threads};

use super::Vibrating;
use super::grove::Grove;
use super::sway::{Motion, free};
use super::tubes::{SIDES, Tubes};
use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// What powers of the arc tangent are called.
const POWERS: [&str; 3] = ["", ", squared", ", cubed"];

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    /// Of the mesh.
    pub n_vertices: usize,
    /// Morph targets, so many for each mode.
    pub n_targets: usize,
    /// Of the file.
    pub bytes: u64,
    /// How far nodes of the first copy are from where the simulation has them, metres, at most.
    pub off: f64,
}

/// A plant with its motion, ready to be written.
pub(super) struct Scene {
    body: Body,
    copies: Vec<Placed>,
    fps: f64,
    /// Metres.
    off: f64,
}

/// Moves a plant as [`sway`](super::sway::sway) does, by its own modes.
///
/// # Errors
/// What [`Forest`](honami_mechanics::Forest) refuses, and more than readers of such files or this machine can hold.
pub(super) fn scene(
    plant: &Vibrating,
    wind: &dyn Wind,
    motion: &Motion,
    progress: &dyn Progress,
) -> Result<Scene, WorkbenchError> {
    let stirring = Arc::new(Stirring::new(&plant.beams, &plant.modes, plant.basis.clone(), motion.form));
    let bendings = Following::curves(&plant.beams, &plant.modes, motion.form);
    let tubes = Tubes::new(&plant.beams);
    let sizes = Sizes {
        n_vertices: tubes.n_vertices(),
        n_triangles: tubes.triangles().len(),
        n_targets: n_targets(&bendings),
        n_copies: motion.n_copies,
        n_frames: motion.n_frames,
    };
    let (bytes, there) = (sizes.bytes()? as usize, free());
    if bytes > there {
        let (copies, nodes) = (motion.n_copies, plant.beams.len());
        return Err(WorkbenchError::Memory { copies, nodes, bytes, there });
    }
    let (copies, off) = weights(plant, &stirring, &bendings, wind, motion, progress)?;
    let body = body(plant, &stirring, &bendings, &tubes, motion.damping.mass.sqrt());
    Ok(Scene { body, copies, fps: motion.fps, off })
}

impl Scene {
    /// Writes it as a .glb.
    pub(super) fn write(&self, file: AtomicFile) -> Result<Made, WorkbenchError> {
        let Self { body, copies, fps, off } = self;
        let bytes = write_glb(file, "plant", *fps, body, copies)?;
        Ok(Made { n_vertices: body.positions.len(), n_targets: body.targets.len(), bytes, off: *off })
    }
}

fn n_targets(bendings: &[Bending]) -> usize {
    bendings.iter().map(|bending| bending.powers().len()).sum()
}

/// Where copies stand, and what they have of every target in every frame; and how far the first is off at most.
fn weights(
    plant: &Vibrating,
    stirring: &Arc<Stirring>,
    bendings: &[Bending],
    wind: &dyn Wind,
    motion: &Motion,
    progress: &dyn Progress,
) -> Result<(Vec<Placed>, f64), WorkbenchError> {
    let grove = Grove::new(plant.height, motion);
    let n_weights = motion.n_frames as usize * n_targets(bendings);
    let copy = |(place, stand): (&Direction, &Stand)| Placed {
        place: single(place),
        turn: stand.turn,
        scale: stand.scale,
        weights: Vec::with_capacity(n_weights),
    };
    let mut copies: Vec<Placed> = grove.places.iter().zip(&grove.stands).map(copy).collect();
    let nodes: Vec<u32> = (0..stirring.n_nodes() as u32).collect();
    let mut forest = grove.forest(stirring, &nodes, motion)?;
    let mut details = vec![Detail::default(); copies.len()];
    details[0] = Detail { n_nodes: u32::MAX, n_modes: u32::MAX };
    let (mut first, mut off) = (vec![[0.0; 3]; nodes.len()], 0.0_f64);
    let threads = Threads::new(motion.n_threads)?;
    for frame in 0..motion.n_frames {
        if progress.report(u64::from(frame), u64::from(motion.n_frames), "motion") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        for (k, copy) in copies.iter_mut().enumerate() {
            for (bending, q) in bendings.iter().zip(forest.amplitudes(k)) {
                let s = bending.b().map_or(*q, |b| (b as f32 * q).atan());
                copy.weights.extend((1..=bending.powers().len() as i32).map(|power| s.powi(power)));
            }
        }
        forest.pose(Pose { details: Some(&details), motion: &mut first }, &threads);
        off = off.max(farthest(bendings, forest.amplitudes(0), &first));
        for _ in 0..motion.n_substeps {
            let time = forest.time();
            forest.step(&|copy| grove.blowing(wind, copy, time), None, &threads)?;
        }
    }
    Ok((copies, off))
}

/// Metres between where curves have nodes and where they are, at most.
fn farthest(bendings: &[Bending], amplitudes: &[f32], moved: &[[f32; 3]]) -> f64 {
    let off = |(node, moved): (usize, &[f32; 3])| {
        let curves = bendings.iter().zip(amplitudes);
        let curved: Direction = curves.map(|(bending, q)| bending.displacement(node, f64::from(*q))).sum();
        (curved - Direction::from(moved.map(f64::from))).norm()
    };
    moved.iter().enumerate().map(off).fold(0.0, f64::max)
}

/// The mesh at rest, its root at 0, and what modes do to it; so many times as slow as its wood alone.
fn body(plant: &Vibrating, stirring: &Stirring, bendings: &[Bending], tubes: &Tubes, slower: f64) -> Body {
    let mut body = Body { triangles: tubes.triangles(), ..Body::default() };
    for ring in tubes.rings() {
        let centre = stirring.rest()[ring.node as usize];
        for outward in ring.outward() {
            body.positions.push(single(&(centre + outward * ring.radius)));
            body.normals.push(single(&outward));
        }
    }
    for (mode, bending) in bendings.iter().enumerate() {
        // Of the arc tangent, of which a small amplitude is so much.
        let of_arc = bending.b().map_or(1.0, f64::recip);
        for (power, moved) in bending.powers().iter().enumerate() {
            let mut vertices = Vec::with_capacity(SIDES * tubes.rings().len());
            for ring in tubes.rings() {
                let node = ring.node as usize;
                let turn =
                    if power == 0 { plant.modes.rotation(mode, node) * of_arc } else { Direction::zeros() };
                vertices.extend(
                    ring.outward().map(|out| single(&(moved[node] + turn.cross(&out) * ring.radius))),
                );
            }
            let hz = plant.modes.hz(mode) / slower;
            let name = format!("mode {}, {hz:.4} Hz{}", mode + 1, POWERS[power]);
            body.targets.push(Target { name, moved: vertices });
        }
    }
    body
}

fn single(at: &Direction) -> [f32; 3] {
    [at.x as f32, at.y as f32, at.z as f32]
}
