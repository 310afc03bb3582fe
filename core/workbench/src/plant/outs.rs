//! What is written of a motion: nothing has its name before all of it is there.

use std::path::Path;

use honami_exchange::plant::{BeamRow, PointCache, SwayRow};
use honami_exchange::{AtomicFile, Writer};

use super::Vibrating;
use super::glb::{Made, Scene};
use super::sway::Motion;
use crate::error::WorkbenchError;

/// Files that are wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outs<'a> {
    /// A table: where its sensors are, a row a sensor and frame.
    pub table: Option<&'a Path>,
    /// A point cache: where all nodes of all copies are.
    pub cache: Option<&'a Path>,
    /// The plant with its motion, and all copies.
    pub glb: Option<&'a Path>,
    /// The beams of the plant.
    pub beams: Option<&'a Path>,
}

/// Files that are begun, and leave nothing behind until they are finished.
pub(super) struct Files {
    pub(super) table: Option<Writer<SwayRow>>,
    pub(super) cache: Option<PointCache>,
    glb: Option<AtomicFile>,
    beams: Option<Writer<BeamRow>>,
}

impl Files {
    /// Begins them all.
    pub(super) fn create(plant: &Vibrating, motion: &Motion, outs: Outs<'_>) -> Result<Self, WorkbenchError> {
        let n_points = motion.n_copies * plant.beams.len();
        let cache = |path: &Path| PointCache::create(path, n_points, motion.n_frames);
        Ok(Self {
            table: outs.table.map(Writer::create).transpose()?,
            cache: outs.cache.map(cache).transpose()?,
            glb: outs
                .glb
                .map(|path| AtomicFile::create(path, |head| head.starts_with(b"glTF")))
                .transpose()?,
            beams: outs.beams.map(|path| beams(plant, path)).transpose()?,
        })
    }

    /// Gives them their names; what became of the scene that is in one of them.
    pub(super) fn finish(self, scene: Option<&Scene>) -> Result<Option<Made>, WorkbenchError> {
        let made = scene.zip(self.glb).map(|(scene, file)| scene.write(file)).transpose()?;
        self.table.map(Writer::finish).transpose()?;
        self.cache.map(PointCache::finish).transpose()?;
        self.beams.map(Writer::finish).transpose()?;
        Ok(made)
    }
}

/// The beams of a plant as a table, to be finished.
pub(super) fn beams(plant: &Vibrating, path: &Path) -> Result<Writer<BeamRow>, WorkbenchError> {
    let mut table = Writer::create(path)?;
    for node in 0..plant.beams.len() {
        let at = plant.beams.position(node);
        let (parent, radius) = (plant.beams.parent(node), plant.beams.radius(node));
        table.write(&BeamRow { node: node as u32, parent, x: at.x, y: at.y, z: at.z, radius })?;
    }
    Ok(table)
}
