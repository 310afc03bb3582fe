//! A plant, or a forest of it, with its motion in one file of glTF.
//!
//! The motion is summed up as it comes: in every frame where nodes are is a sum of few shapes, as near as [`NEAR`] of the
//! plant's height, whoever moved them. Shapes become morph targets. Joints would have to be as many as nodes, more than
//! engines take, and every copy of a forest would have its own; so it has a weight a target and frame.

use honami_exchange::AtomicFile;
use honami_exchange::plant::{Body, Placed, Sizes, Target, write_glb};
use honami_mechanics::{Shapes, Stand, Sums, Threads, Vector};

use super::Vibrating;
use super::mover::{Displacements, rows};
use super::sway::{Motion, free};
use crate::error::WorkbenchError;
use honami_scene::grove::Grove;
use honami_scene::tubes::{Ring, Tubes};

/// How far a node may be off in any frame, of the height of the plant.
pub const NEAR: f64 = 1e-3;

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    /// Of the mesh.
    pub n_vertices: usize,
    /// Morph targets.
    pub n_targets: usize,
    /// Of the file.
    pub bytes: u64,
    /// How far nodes of any copy are from where the simulation has them, metres, at most.
    pub off: f64,
}

/// A motion that is summed up.
pub(super) struct Gathering {
    tubes: Tubes,
    shapes: Shapes,
    sizes: Sizes,
    threads: Threads,
}

/// A plant with its motion, ready to be written.
pub(super) struct Scene {
    body: Body,
    copies: Vec<Placed>,
    fps: f64,
    /// Metres.
    off: f64,
}

impl Gathering {
    /// Before the first of so many frames.
    ///
    /// # Errors
    /// More than readers of such files or this machine can hold, whatever moves.
    pub(super) fn new(plant: &Vibrating, motion: &Motion, n_frames: u32) -> Result<Self, WorkbenchError> {
        let tubes = Tubes::new(&plant.beams);
        let sizes = Sizes {
            n_vertices: tubes.n_vertices(),
            n_triangles: tubes.triangles().len(),
            n_targets: 1,
            n_copies: motion.n_copies,
            n_frames,
        };
        let shapes = Shapes::new(plant.beams.len(), NEAR * plant.size());
        let made = Self { tubes, shapes, sizes, threads: Threads::new(motion.n_threads)? };
        made.has_room(plant.beams.len())?;
        Ok(made)
    }

    /// Takes a frame of all copies.
    ///
    /// # Errors
    /// Displacements that are none; and more than can be held, as soon as it is known.
    pub(super) fn take(&mut self, moved: &Displacements<'_>) -> Result<(), WorkbenchError> {
        self.shapes.take(moved.motion, &self.threads)?;
        if self.shapes.len() > self.sizes.n_targets {
            self.sizes.n_targets = self.shapes.len();
            self.has_room(moved.motion.len() / self.sizes.n_copies)?;
        }
        Ok(())
    }

    fn has_room(&self, nodes: usize) -> Result<(), WorkbenchError> {
        let (bytes, there) = (self.sizes.bytes()? as usize, free());
        let copies = self.sizes.n_copies;
        if bytes > there { Err(WorkbenchError::Memory { copies, nodes, bytes, there }) } else { Ok(()) }
    }

    /// After the last.
    pub(super) fn scene(self, plant: &Vibrating, grove: &Grove, fps: f64) -> Scene {
        let Self { tubes, shapes, threads, .. } = self;
        let sums = shapes.fewest(&threads);
        let (n, n_copies) = (sums.shapes.len(), grove.stands.len());
        let copy = |(k, (place, stand)): (usize, (&Vector, &Stand))| {
            let frames = sums.weights.chunks(n.max(1)).skip(k).step_by(n_copies);
            let weights = frames.flatten().copied().collect();
            Placed { place: single(place), turn: stand.turn, scale: stand.scale, weights }
        };
        let copies = grove.places.iter().zip(&grove.stands).enumerate().map(copy).collect();
        // Of a copy that is so many times as large.
        let largest = grove.stands.iter().map(|stand| f64::from(stand.scale)).fold(0.0, f64::max);
        Scene { body: body(plant, &sums, &tubes), copies, fps, off: largest * sums.off }
    }
}

impl Scene {
    /// Writes it as a .glb.
    pub(super) fn write(&self, file: AtomicFile) -> Result<Made, WorkbenchError> {
        let Self { body, copies, fps, off } = self;
        let bytes = write_glb(file, "plant", *fps, body, copies)?;
        Ok(Made { n_vertices: body.positions.len(), n_targets: body.targets.len(), bytes, off: *off })
    }
}

/// The mesh at rest, its root at 0, and what shapes do to it.
fn body(plant: &Vibrating, sums: &Sums, tubes: &Tubes) -> Body {
    let (beams, rows) = (&plant.beams, rows(&plant.beams.coarse_to_fine()));
    let root = beams.position(0);
    let mut body = Body { triangles: tubes.triangles(), ..Body::default() };
    for ring in tubes.rings() {
        let centre = beams.position(ring.node as usize) - root;
        for outward in ring.outward() {
            body.positions.push(single(&(centre + outward * ring.radius)));
            body.normals.push(single(&outward));
        }
    }
    for (k, (shape, part)) in (1..).zip(sums.shapes.iter().zip(&sums.parts)) {
        let by = |node: u32| shape[rows[node as usize] as usize];
        let of_ring = |ring: &Ring| {
            let (moved, turn) = (by(ring.node), ring.turn(by));
            ring.outward().map(|out| single(&(moved + turn.cross(&out) * ring.radius))).collect::<Vec<_>>()
        };
        let name = format!("shape {k}, {:.3} %", 100.0 * part);
        body.targets.push(Target { name, moved: tubes.rings().iter().flat_map(of_ring).collect() });
    }
    body
}

fn single(at: &Vector) -> [f32; 3] {
    [at.x as f32, at.y as f32, at.z as f32]
}
