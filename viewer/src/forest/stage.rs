//! Buffers of a forest: what is drawn of which copies. Those who move it write here, and the paint reads.

use bytemuck::{Pod, Zeroable};
use honami_mechanics::Felt;
use honami_scene::ForestScene;
use wgpu::BufferUsages as Uses;
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};

use super::By;
use super::body::{Part, Parts};
use super::shade;
use crate::gpu::{Gpu, GpuError};

/// From the numbers of one level to the next, bytes: what every adapter can begin a binding at.
pub(super) const LEVEL_BYTES: u32 = 256;
/// Bytes of what draws something so many times: how many indices, how many times, the first index, and two that are 0.
pub(super) const CALL_BYTES: u64 = 20;

/// Bytes of a displacement, and what all of them take at most: a card has other things to hold, too.
const MOVED_BYTES: usize = 12;
const MOST_MOVED: usize = 1 << 30;

/// A copy, as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct CopyNumbers {
    place: [f32; 2],
    /// Sine and cosine of its turn.
    turn: [f32; 2],
    scale: f32,
    /// Of its own, 0 to 1.
    chance: f32,
    filler: [u32; 2],
}

/// A level, as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct LevelNumbers {
    /// Where its list of copies begins.
    list: u32,
    first_ring: u32,
    first_leaf: u32,
    n_sides: u32,
    /// From so many metres on, of a copy of the plant's own size.
    from: f32,
    n_nodes: u32,
    n_modes: u32,
    level: u32,
}

/// What draws wood, or leaves, of a level.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Call {
    n_indices: u32,
    n_copies: u32,
    first_index: u32,
    base_vertex: i32,
    first_copy: u32,
}

/// All buffers.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) n_copies: usize,
    /// How many displacements there is room for.
    pub(super) n_rows: usize,
    /// How many nodes each level has.
    n_nodes: Vec<u32>,
    is_roomy: bool,
    pub(super) copies: wgpu::Buffer,
    /// Of every copy that is drawn: its first displacement.
    pub(super) firsts: wgpu::Buffer,
    /// How fast the air is at every copy, metres per second.
    airs: wgpu::Buffer,
    /// Of every level, in room for all: which copies are drawn so.
    pub(super) seen: wgpu::Buffer,
    /// U: displacements of nodes, metres.
    pub(super) moved: wgpu::Buffer,
    rings: wgpu::Buffer,
    leaves: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    /// What casts the shadows of wood, and how many pieces that are.
    pub(super) pieces: wgpu::Buffer,
    pub(super) n_pieces: u32,
    /// Of every level, so many [`LEVEL_BYTES`] apart.
    pub(super) levels: wgpu::Buffer,
    /// Of every level two calls: its wood, its leaves.
    pub(super) calls: wgpu::Buffer,
    parts: Vec<Part>,
    first_card: u32,
}

impl Stage {
    /// Room for all of a forest; for displacements, where the card works them out, as much as the adapter has, 1 GiB at most.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] where what every copy has does not fit, and what the adapter met.
    pub(super) fn new(gpu: &Gpu, scene: &ForestScene, by: By) -> Result<Self, GpuError> {
        let parts = Parts::new(&scene.body);
        let n_copies = scene.places.len();
        let limits = gpu.device.limits();
        // Shaders count by 32 bits, four bytes a number.
        let most =
            limits.max_buffer_size.min(limits.max_storage_buffer_binding_size).min(4 * u64::from(u32::MAX));
        let most = most as usize;
        let all_rows = match by {
            By::Processor => 0,
            By::Card => n_copies.saturating_mul(scene.body.order.len()),
        };
        let n_rows = all_rows.min(most.min(MOST_MOVED) / MOVED_BYTES);
        let made = |label, contents: &[u8], usage| {
            gpu.device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents, usage })
        };
        let empty = |label, size: usize, usage| {
            let (size, label) = (size.max(16) as u64, Some(label));
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let both = Uses::STORAGE | Uses::COPY_DST | Uses::COPY_SRC;
        let copies: Vec<CopyNumbers> = scene.places.iter().zip(&scene.stands).enumerate().map(copy).collect();
        let rings = bytemuck::cast_slice(&parts.rings);
        if let Some(bytes) = pieces(scene, by, &parts).into_iter().find(|bytes| *bytes > most) {
            let what = format!("forest of {n_copies} copies, which has {bytes} bytes in one piece");
            let most = format!("{most} bytes at most; take fewer copies");
            return Err(GpuError::TooLarge { adapter: gpu.name(), what, most });
        }
        // A plant without leaves has a buffer of them nevertheless.
        let mut leaves = bytemuck::cast_slice(&parts.leaves).to_vec();
        leaves.resize(leaves.len().max(64), 0);
        let shading = shade::pieces(scene);
        let stage = Self {
            n_copies,
            n_rows,
            n_nodes: scene.body.levels.iter().map(|level| level.n_nodes).collect(),
            is_roomy: n_rows == all_rows,
            copies: made("copies", bytemuck::cast_slice(&copies), Uses::STORAGE),
            firsts: empty("firsts", 4 * n_copies, both),
            airs: empty("airs", 4 * n_copies, both),
            seen: empty("seen", 4 * n_copies * parts.levels.len(), both),
            moved: empty("moved", MOVED_BYTES * n_rows, both),
            rings: made("rings", rings, Uses::STORAGE),
            leaves: made("leaves", &leaves, Uses::STORAGE),
            indices: made("indices", bytemuck::cast_slice(&parts.indices), Uses::INDEX),
            pieces: made("pieces", bytemuck::cast_slice(&shading), Uses::VERTEX),
            n_pieces: shading.len() as u32,
            levels: made("levels", &levels(scene, &parts), Uses::UNIFORM | Uses::STORAGE),
            calls: made("calls", &calls(&parts), both | Uses::INDIRECT),
            parts: parts.levels,
            first_card: parts.first_card,
        };
        gpu.check()?;
        Ok(stage)
    }

    /// Whether there is room for the displacements of all copies at once, whatever is seen.
    pub(super) fn is_roomy(&self) -> bool {
        self.is_roomy
    }

    /// Whether there is room for so many copies of each level.
    ///
    /// # Errors
    /// [`GpuError::Copies`].
    pub(super) fn check(&self, gpu: &Gpu, n_seen: &[u32]) -> Result<(), GpuError> {
        let rows = n_seen.iter().zip(&self.n_nodes).map(|(n, n_nodes)| u64::from(*n) * u64::from(*n_nodes));
        let (wanted, most) = (MOVED_BYTES as u64 * rows.sum::<u64>(), (MOVED_BYTES * self.n_rows) as u64);
        if wanted <= most {
            return Ok(());
        }
        let n_copies = n_seen.iter().map(|n| *n as usize).sum();
        let (adapter, what) = (gpu.name(), "displacements");
        Err(GpuError::Copies { adapter, what, n_copies, wanted, most, has_processor: true })
    }

    /// Levels.
    pub(super) fn n_levels(&self) -> usize {
        self.parts.len()
    }

    /// How fast the air is at every copy, metres per second.
    pub(super) fn feel(&self, gpu: &Gpu, speeds: impl Iterator<Item = f32>) {
        gpu.queue.write_buffer(&self.airs, 0, bytemuck::cast_slice(&speeds.collect::<Vec<_>>()));
    }

    /// Indices of the wood of a level, and of all its leaves.
    pub(super) fn indices_of(&self, level: usize) -> [std::ops::Range<u32>; 2] {
        let part = &self.parts[level];
        [
            part.first_index..part.first_index + part.n_indices,
            self.first_card..self.first_card + 6 * part.n_leaves,
        ]
    }

    /// What the paint reads, in the order of its bindings.
    pub(super) fn read(&self) -> [&wgpu::Buffer; 7] {
        [&self.copies, &self.firsts, &self.airs, &self.seen, &self.moved, &self.rings, &self.leaves]
    }
}

/// What must fit as it is, bytes: whatever is seen, all copies have it.
fn pieces(scene: &ForestScene, by: By, parts: &Parts) -> [usize; 5] {
    let n_copies = scene.places.len();
    let n_modes = match by {
        By::Processor => 0,
        By::Card => scene.stirring.n_modes(),
    };
    let of_all = |bytes: usize| n_copies.saturating_mul(bytes);
    [
        size_of_val(parts.rings.as_slice()),
        size_of_val(parts.leaves.as_slice()),
        of_all(size_of::<CopyNumbers>().max(size_of::<Felt>())),
        of_all(4 * parts.levels.len()),
        // Amplitudes and speeds of all modes.
        of_all(8 * n_modes),
    ]
}

fn copy((k, (place, stand)): (usize, (&[f32; 2], &honami_mechanics::Stand))) -> CopyNumbers {
    let (sin, cos) = stand.turn.sin_cos();
    CopyNumbers { place: *place, turn: [sin, cos], scale: stand.scale, chance: chance(k), filler: [0; 2] }
}

/// What chance made of a copy, 0 to 1: as good as that, parts of the golden ratio.
pub(super) fn chance(copy: usize) -> f32 {
    (copy as f64 * 0.618_033_988_749_895).fract() as f32
}

fn levels(scene: &ForestScene, parts: &Parts) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (k, (level, part)) in (0..).zip(scene.body.levels.iter().zip(&parts.levels)) {
        let numbers = LevelNumbers {
            list: k * scene.places.len() as u32,
            first_ring: part.first_ring,
            first_leaf: part.first_leaf,
            n_sides: part.n_sides,
            from: level.from as f32,
            n_nodes: level.n_nodes,
            n_modes: level.n_modes,
            level: k,
        };
        bytes.extend_from_slice(bytemuck::bytes_of(&numbers));
        bytes.resize((k as usize + 1) * LEVEL_BYTES as usize, 0);
    }
    bytes
}

/// Two a level, of no copy yet.
fn calls(parts: &Parts) -> Vec<u8> {
    let call =
        |n_indices, first_index| Call { n_indices, n_copies: 0, first_index, base_vertex: 0, first_copy: 0 };
    let of_level =
        |part: &Part| [call(part.n_indices, part.first_index), call(6 * part.n_leaves, parts.first_card)];
    let calls: Vec<Call> = parts.levels.iter().flat_map(of_level).collect();
    bytemuck::cast_slice(&calls).to_vec()
}
