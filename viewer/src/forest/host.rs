//! A forest that the processor's cores move.

use std::sync::Arc;
use std::thread::available_parallelism;

use anyhow::ensure;
use honami_scene::forest::live::Live;
use honami_scene::{Camera, ForestScene};

use super::MOST_BYTES;
use super::stage::Stage;
use crate::gpu::Gpu;
use crate::target::Size;

/// What lives on the cores, and what of it the stage is told.
pub(super) struct Host {
    live: Live,
    /// Where the displacements of each copy begin, and those of all that are seen.
    firsts: Vec<u32>,
    moved: Vec<[f32; 3]>,
    /// Of every level the copies that are drawn by it.
    lists: Vec<Vec<u32>>,
}

impl Host {
    /// One that has felt its wind for as long as the scene says.
    pub(super) fn new(scene: &Arc<ForestScene>) -> anyhow::Result<Self> {
        let (n_copies, n_levels) = (scene.places.len(), scene.body.levels.len());
        let n_threads = available_parallelism().map_or(1, usize::from);
        let live = Live::new(Arc::clone(scene), n_threads, MOST_BYTES)?;
        Ok(Self { live, firsts: vec![0; n_copies], moved: Vec::new(), lists: vec![Vec::new(); n_levels] })
    }

    /// What goes on.
    pub(super) fn live(&mut self) -> &mut Live {
        &mut self.live
    }

    /// Poses what is seen of copies in a picture and hands it to the stage.
    pub(super) fn put(
        &mut self,
        gpu: &Gpu,
        camera: &Camera,
        size: Size,
        stage: &Stage,
    ) -> anyhow::Result<()> {
        self.lists.iter_mut().for_each(Vec::clear);
        self.moved.clear();
        for seen in self.live.seen(camera, [size.width, size.height])? {
            self.firsts[seen.copy] = self.moved.len() as u32;
            self.moved.extend_from_slice(seen.motion);
            self.lists[seen.level].push(seen.copy as u32);
        }
        let n_rows = self.moved.len();
        ensure!(
            n_rows <= stage.n_rows,
            "{} has room for {} nodes, and {n_rows} are seen at once: come nearer, or take fewer copies",
            gpu.name(),
            stage.n_rows
        );
        gpu.queue.write_buffer(&stage.firsts, 0, bytemuck::cast_slice(&self.firsts));
        gpu.queue.write_buffer(&stage.moved, 0, bytemuck::cast_slice(&self.moved));
        stage.list(gpu, &self.lists);
        Ok(())
    }
}
