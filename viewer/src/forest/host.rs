//! A forest that the processor's cores move.

use std::sync::Arc;
use std::thread::available_parallelism;

use honami_scene::forest::live::{Live, Seen};
use honami_scene::{Camera, ForestScene};

use super::MOST_BYTES;
use super::skin::{self, Drawn, Eye, Vertex};
use crate::gpu::{Gpu, GpuError};

/// What lives on the cores, and the vertices of what is seen of it.
pub(super) struct Host {
    live: Live,
    n_threads: usize,
    vertices: Vec<Vertex>,
    buffer: Option<wgpu::Buffer>,
    drawn: Vec<Drawn>,
}

impl Host {
    /// One that has felt its wind for as long as the scene says.
    pub(super) fn new(scene: &Arc<ForestScene>) -> anyhow::Result<Self> {
        let n_threads = available_parallelism().map_or(1, usize::from);
        let live = Live::new(Arc::clone(scene), n_threads, MOST_BYTES)?;
        Ok(Self { live, n_threads, vertices: Vec::new(), buffer: None, drawn: Vec::new() })
    }

    /// What goes on.
    pub(super) fn live(&mut self) -> &mut Live {
        &mut self.live
    }

    /// Puts all that is seen in a picture where it is now.
    pub(super) fn put(
        &mut self,
        gpu: &Gpu,
        scene: &ForestScene,
        camera: &Camera,
        size: [u32; 2],
        eye: &Eye,
    ) -> anyhow::Result<()> {
        let airs: Vec<f32> =
            (0..scene.places.len()).map(|copy| self.live.blowing(copy).norm() as f32).collect();
        let mut seen = self.live.seen(camera, size)?;
        // Near ones first: what they hide is not shaded.
        let away = |seen: &Seen<'_>| {
            let [x, y] = scene.places[seen.copy];
            (x - camera.eye[0]).hypot(y - camera.eye[1])
        };
        seen.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let n_vertices = skin::n_vertices(scene, &seen);
        let wanted = n_vertices * size_of::<Vertex>() as u64;
        // What begins at a vertex is told by how many there are before it, in 31 bits.
        let most = gpu.device.limits().max_buffer_size.min(i32::MAX as u64 * size_of::<Vertex>() as u64);
        if wanted > most {
            let (adapter, what, n_copies) = (gpu.name(), "vertices", seen.len());
            let fault = GpuError::Copies { adapter, what, n_copies, wanted, most, has_processor: false };
            return Err(fault.into());
        }
        self.drawn = skin::skin(scene, &seen, eye, &airs, (self.n_threads, &mut self.vertices));
        if self.buffer.as_ref().is_none_or(|buffer| buffer.size() < wanted) {
            // A half more than is wanted now: what moves is not made anew for every leaf that comes into view.
            self.buffer = Some(gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("vertices"),
                size: (wanted + wanted / 2).next_multiple_of(4).clamp(4, most),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer {
            gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&self.vertices));
        }
        Ok(())
    }

    /// What was put: vertices, and of which copies.
    pub(super) fn seen(&self) -> Option<(&wgpu::Buffer, &[Drawn])> {
        self.buffer.as_ref().map(|buffer| (buffer, self.drawn.as_slice()))
    }
}
