//! A forest that the processor's cores move.

use anyhow::ensure;
use honami_mechanics::{Blowing, Detail, DetailError, Details, Forest, Pose, Threads, View};
use honami_scene::ForestScene;
use honami_scene::grove::Grove;

use super::stage::Stage;
use crate::gpu::Gpu;

/// Modes, and nodes of what is seen.
pub(super) struct Host {
    forest: Forest,
    threads: Threads,
    details: Details,
    /// How much of every copy, where its displacements begin, and these.
    of_copies: Vec<Detail>,
    firsts: Vec<u32>,
    moved: Vec<[f32; 3]>,
    /// Of every level the copies that are drawn by it.
    lists: Vec<Vec<u32>>,
}

impl Host {
    pub(super) fn new(scene: &ForestScene, forest: Forest, threads: Threads) -> Result<Self, DetailError> {
        let (n_copies, n_levels) = (forest.len(), scene.body.levels.len());
        Ok(Self {
            forest,
            threads,
            details: scene.body.details()?,
            of_copies: vec![Detail::default(); n_copies],
            firsts: vec![0; n_copies],
            moved: Vec::new(),
            lists: vec![Vec::new(); n_levels],
        })
    }

    pub(super) fn reset(&mut self) {
        self.forest.reset();
    }

    pub(super) fn step(&mut self, blowing: Blowing<'_>) -> anyhow::Result<()> {
        Ok(self.forest.step(blowing, None, &self.threads)?)
    }

    /// Poses what is seen of copies and hands it to the stage.
    pub(super) fn put(
        &mut self,
        gpu: &Gpu,
        scene: &ForestScene,
        grove: &Grove,
        view: &View,
        stage: &Stage,
    ) -> anyhow::Result<()> {
        self.lists.iter_mut().for_each(Vec::clear);
        let mut n_rows = 0_usize;
        for (copy, (place, stand)) in (0..).zip(grove.places.iter().zip(&grove.stands)) {
            let level = self.details.level(&scene.stirring, view, place, stand.scale.into());
            let detail = level.map_or_else(Detail::default, |level| scene.body.levels[level].detail());
            self.firsts[copy as usize] = n_rows as u32;
            self.of_copies[copy as usize] = detail;
            n_rows += detail.n_nodes as usize;
            if let Some(level) = level {
                self.lists[level].push(copy);
            }
        }
        ensure!(
            n_rows <= stage.n_rows,
            "{} has room for {} nodes, and {n_rows} are seen at once: come nearer, or take fewer copies",
            gpu.name(),
            stage.n_rows
        );
        self.moved.resize(n_rows, [0.0; 3]);
        self.forest.pose(Pose { details: Some(&self.of_copies), motion: &mut self.moved }, &self.threads);
        gpu.queue.write_buffer(&stage.firsts, 0, bytemuck::cast_slice(&self.firsts));
        gpu.queue.write_buffer(&stage.moved, 0, bytemuck::cast_slice(&self.moved));
        stage.list(gpu, &self.lists);
        Ok(())
    }
}
