//! A forest that the card moves: modes, what is seen, and nodes, in shaders; by the numbers of [`Forest`].

use bytemuck::{Pod, Zeroable};
use honami_mechanics::wind::Wind;
use honami_mechanics::{Damping, Felt, Following, Forest, ForestError, Pace, Vector};
use honami_scene::forest::live::{self, Begun};
use honami_scene::grove::Grove;
use honami_scene::{Camera, ForestScene};
use rayon::prelude::*;
use wgpu::BufferUsages as Uses;
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};

use super::MOST_BYTES;
use super::chains::Chains;
use super::stage::{LEVEL_BYTES, Stage};
use crate::gpu::{Gpu, GpuError};
use crate::shaders;

/// Modes that a workgroup takes, and workgroups in a row, of which an adapter has no more than so many.
const MODES: u32 = 64;
const ROW: u32 = 32_768;
/// Bytes of what a level's nodes are posed by: workgroups, where its displacements begin, copies with room and copies seen.
const GROUPS_BYTES: u64 = 24;

/// What is seen from where, as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Eye {
    eye: [f32; 3],
    n_copies: u32,
    forward: [f32; 3],
    n_levels: u32,
    right: [f32; 3],
    slope_right: f32,
    up: [f32; 3],
    slope_up: f32,
    far: f32,
    middle: f32,
    reach: f32,
    n_rows: u32,
    /// So many times as far away as usual levels begin.
    sharper: f32,
    filler: [u32; 3],
}

/// What shaders go on by.
pub(super) struct Card {
    grove: Grove,
    wind: Begun,
    /// Where all numbers come from; it stays at rest itself.
    forest: Forest,
    n_steps: u64,
    felt: Vec<Felt>,
    /// At the crowns of all copies in the last step, metres per second.
    winds: Vec<Vector>,
    feels: wgpu::Buffer,
    /// Amplitudes and speeds of all copies.
    state: wgpu::Buffer,
    steps: wgpu::Buffer,
    eye: wgpu::Buffer,
    groups: wgpu::Buffer,
    step: Work,
    list: Work,
    share: Work,
    /// A level each.
    pose: Vec<Work>,
    middle: f64,
    reach: f64,
}

/// A shader with what it works on.
struct Work {
    pipeline: wgpu::ComputePipeline,
    bound: wgpu::BindGroup,
}

impl Card {
    /// One that has felt its wind for as long as the scene says; on this stage.
    pub(super) fn new(gpu: &Gpu, scene: &ForestScene, stage: &Stage) -> anyhow::Result<Self> {
        let mut made = Self::at_rest(gpu, scene, stage)?;
        gpu.check()?;
        for _ in 0..(scene.run_in / scene.pace.step).round() as u32 {
            made.step(gpu)?;
        }
        Ok(made)
    }

    fn at_rest(gpu: &Gpu, scene: &ForestScene, stage: &Stage) -> anyhow::Result<Self> {
        let Following::Turns(turning) = scene.stirring.following() else {
            anyhow::bail!("the plant {} does not move by turns, which a card adds up", scene.name);
        };
        let forest = Forest::new(&scene.stirring, &scene.body.order, &scene.stands, &scene.pace)?;
        let numbers = forest.numbers();
        let (n_copies, n_modes, n_nodes) = (forest.len(), numbers.n_modes, scene.body.order.len());
        let chains = Chains::new(turning, &scene.body.order);
        let n_ranks = chains.ranks.len() as u32 - 1;
        let made = |contents: &[u8], usage| {
            gpu.device.create_buffer_init(&BufferInitDescriptor { label: Some("plant"), contents, usage })
        };
        let held = |contents: &[u8]| made(contents, Uses::STORAGE);
        let floats = |contents: &[f32]| held(bytemuck::cast_slice(contents));
        let whole = |contents: &[u32]| held(bytemuck::cast_slice(contents));
        let empty = |size: usize, usage| {
            let size = (size as u64).max(16);
            let label = Some("state");
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label,
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let feels = empty(size_of::<Felt>() * n_copies, Uses::STORAGE | Uses::COPY_DST);
        let state = empty(8 * n_copies * n_modes, Uses::STORAGE | Uses::COPY_DST | Uses::COPY_SRC);
        let eye = empty(size_of::<Eye>(), Uses::UNIFORM | Uses::COPY_DST);
        let groups =
            empty(GROUPS_BYTES as usize * stage.n_levels(), Uses::STORAGE | Uses::INDIRECT | Uses::COPY_SRC);
        let row = ROW * MODES;
        let size = made(bytemuck::bytes_of(&[n_copies as u32, n_modes as u32, row, 0]), Uses::UNIFORM);
        let steps = made(bytemuck::cast_slice(&numbers.steps.concat()), Uses::STORAGE | Uses::COPY_DST);
        let basis = floats(numbers.basis);
        let (tensors, kinds) = (floats(numbers.tensors), whole(&numbers.kinds));
        let step =
            work(gpu, "step", "step_modes", &[&size, &steps, &basis, &tensors, &kinds, &feels, &state]);
        let seen = [&eye, &stage.copies, &stage.levels, &stage.seen, &stage.calls, &groups];
        let list = work(gpu, "cull", "list", &seen[..5]);
        let share =
            some(gpu, "cull", "share", &[(0, &eye), (2, &stage.levels), (4, &stage.calls), (5, &groups)]);
        let turns = floats(&turns(turning, &scene.body.order));
        let plant = made(bytemuck::bytes_of(&[n_nodes as u32, n_modes as u32, n_ranks, 0]), Uses::UNIFORM);
        let rows = whole(chains.chains.as_flattened());
        let mut nodes = chains.nodes;
        nodes.resize(n_nodes, 0);
        nodes.extend(chains.ranks);
        let nodes = whole(&nodes);
        let all = [&turns, &rows, &nodes, &state, &stage.seen, &groups, &stage.firsts, &stage.moved];
        let pose = poses(gpu, &plant, stage, &all);
        Ok(Self {
            grove: scene.grove(),
            wind: Begun::new(live::wind(scene, &scene.wind, MOST_BYTES)?, scene.run_in),
            n_steps: 0,
            felt: vec![Felt::default(); n_copies],
            winds: vec![Vector::zeros(); n_copies],
            feels,
            state,
            steps,
            eye,
            groups,
            step,
            list,
            share,
            pose,
            middle: scene.stirring.height() / 2.0,
            reach: scene.stirring.reach(),
            forest,
        })
    }

    /// From now on this wind blows: it begins now.
    pub(super) fn begin(&mut self, wind: Box<dyn Wind>) {
        self.wind = Begun::new(wind, self.time());
    }

    /// From now on the same wind blows with other values: its time goes on.
    pub(super) fn turn(&mut self, wind: Box<dyn Wind>) {
        self.wind.turn(wind);
    }

    /// From now on it is damped so, and so heavy.
    pub(super) fn damp(&mut self, gpu: &Gpu, damping: Damping) -> Result<(), ForestError> {
        let pace = Pace { damping, ..*self.forest.pace() };
        self.forest.retune(&pace)?;
        gpu.queue.write_buffer(&self.steps, 0, bytemuck::cast_slice(&self.forest.numbers().steps.concat()));
        Ok(())
    }

    /// The wind at the crown of a copy now, metres per second.
    pub(super) fn blowing(&self, copy: usize) -> Vector {
        self.grove.blowing(&self.wind, copy, self.time())
    }

    fn time(&self) -> f64 {
        self.n_steps as f64 * self.forest.pace().step
    }

    /// At rest again, before its run-in; the wind that blows now begins where that ends.
    pub(super) fn restart(&mut self, gpu: &Gpu, scene: &ForestScene) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.state, 0, None);
        gpu.queue.submit([encoder.finish()]);
        self.n_steps = 0;
        self.winds.fill(Vector::zeros());
        self.wind.restart(scene.run_in);
    }

    /// A step of all modes, in the wind at every copy.
    pub(super) fn step(&mut self, gpu: &Gpu) -> Result<(), ForestError> {
        let time = self.time();
        let (grove, wind) = (&self.grove, &self.wind);
        let copies = (0..self.felt.len()).into_par_iter();
        copies.map(|copy| grove.blowing(wind, copy, time)).collect_into_vec(&mut self.winds);
        if let Some(copy) = self.winds.iter().position(|wind| !wind.iter().all(|v| v.is_finite())) {
            return Err(ForestError::Wind { copy, time });
        }
        for (copy, (felt, wind)) in self.felt.iter_mut().zip(&self.winds).enumerate() {
            *felt = self.forest.felt(copy, wind);
        }
        let bytes: Vec<f32> =
            self.felt.iter().flat_map(|felt| felt.pressed.into_iter().chain(felt.held)).collect();
        gpu.queue.write_buffer(&self.feels, 0, bytemuck::cast_slice(&bytes));
        let n_groups = (self.felt.len() as u32 * self.forest.numbers().n_modes as u32).div_ceil(MODES);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.step.on(&mut pass);
        pass.dispatch_workgroups(n_groups.min(ROW), n_groups.div_ceil(ROW), 1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        self.n_steps += 1;
        Ok(())
    }

    /// Poses what is seen of copies in a picture, on the stage.
    ///
    /// # Errors
    /// [`GpuError::Copies`].
    pub(super) fn put(
        &self,
        gpu: &Gpu,
        camera: &Camera,
        [width, height]: [u32; 2],
        stage: &Stage,
    ) -> Result<(), GpuError> {
        // What leaves flutter in is what was felt last.
        let airs = self.winds.iter().map(|wind| wind.norm() as f32);
        stage.feel(gpu, airs);
        let eye = self.eye(camera, [width, height], stage);
        gpu.queue.write_buffer(&self.eye, 0, bytemuck::bytes_of(&eye));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        self.list.on(&mut pass);
        pass.dispatch_workgroups(stage.n_levels() as u32, 1, 1);
        self.share.on(&mut pass);
        pass.dispatch_workgroups(1, 1, 1);
        for (level, pose) in (0..).zip(&self.pose) {
            pose.on(&mut pass);
            pass.dispatch_workgroups_indirect(&self.groups, GROUPS_BYTES * level);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        if stage.is_roomy() { Ok(()) } else { stage.check(gpu, &self.seen(gpu)?) }
    }

    /// How many copies of each level were seen.
    fn seen(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let bytes = gpu.read(&self.groups)?;
        let numbers: Vec<u32> = bytes.as_chunks().0.iter().map(|four| u32::from_ne_bytes(*four)).collect();
        Ok(numbers.chunks_exact(GROUPS_BYTES as usize / 4).map(|groups| groups[5]).collect())
    }

    fn eye(&self, camera: &Camera, [width, height]: [u32; 2], stage: &Stage) -> Eye {
        let view = live::view(camera, f64::from(width) / f64::from(height));
        let forward = view.towards.normalize();
        let right = forward.cross(&Vector::z()).normalize();
        let half = (view.angle / 2.0).tan();
        let single = |v: Vector| v.cast::<f32>().into();
        Eye {
            eye: single(view.eye),
            n_copies: stage.n_copies as u32,
            forward: single(forward),
            n_levels: stage.n_levels() as u32,
            right: single(right),
            slope_right: (half * view.aspect) as f32,
            up: single(right.cross(&forward)),
            slope_up: half as f32,
            far: view.far as f32,
            middle: self.middle as f32,
            reach: self.reach as f32,
            n_rows: stage.n_rows as u32,
            sharper: live::sharper(height) as f32,
            filler: [0; 3],
        }
    }
}

impl Work {
    fn on(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bound, &[]);
    }
}

/// A shader on buffers in the order of its bindings.
fn work(gpu: &Gpu, shader: &'static str, entry: &'static str, buffers: &[&wgpu::Buffer]) -> Work {
    let buffers: Vec<_> = (0..).zip(buffers.iter().copied()).collect();
    some(gpu, shader, entry, &buffers)
}

/// A shader on buffers at these bindings.
fn some(gpu: &Gpu, shader: &'static str, entry: &'static str, buffers: &[(u32, &wgpu::Buffer)]) -> Work {
    let pipeline = pipeline(gpu, shader, entry);
    let entries = buffers.iter().map(|(binding, buffer)| wgpu::BindGroupEntry {
        binding: *binding,
        resource: buffer.as_entire_binding(),
    });
    let bound = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(entry),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries.collect::<Vec<_>>(),
    });
    Work { pipeline, bound }
}

/// What poses each level: the numbers of the plant and of the level, and then these buffers.
fn poses(gpu: &Gpu, plant: &wgpu::Buffer, stage: &Stage, buffers: &[&wgpu::Buffer]) -> Vec<Work> {
    let pipeline = pipeline(gpu, "pose", "pose");
    let of_level =
        |level: u64| {
            let numbers = wgpu::BufferBinding {
                buffer: &stage.levels,
                offset: level * u64::from(LEVEL_BYTES),
                size: std::num::NonZeroU64::new(32),
            };
            let mut entries = vec![
                wgpu::BindGroupEntry { binding: 0, resource: plant.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Buffer(numbers) },
            ];
            entries.extend((2..).zip(buffers).map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            }));
            let bound = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("pose"),
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries,
            });
            Work { pipeline: pipeline.clone(), bound }
        };
    (0..stage.n_levels() as u64).map(of_level).collect()
}

fn pipeline(gpu: &Gpu, shader: &'static str, entry: &'static str) -> wgpu::ComputePipeline {
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: None,
        module: &shaders::module(&gpu.device, shader),
        entry_point: Some(entry),
        compilation_options: Default::default(),
        cache: None,
    })
}

/// T as shaders read it: of every mode x, y and z of all nodes in their order; and then the segments at rest.
fn turns(turning: &honami_mechanics::Turning, order: &[u32]) -> Vec<f32> {
    let of_modes = (0..turning.n_modes()).map(|mode| turning.turns(mode));
    let rows = of_modes.chain([turning.segments()]);
    let row = |row: &[Vector], axis: usize| -> Vec<f32> {
        // The root has no segment.
        let of = |node: &u32| node.checked_sub(1).map_or(0.0, |segment| row[segment as usize][axis] as f32);
        order.iter().map(of).collect()
    };
    rows.flat_map(|turns| (0..3).flat_map(move |axis| row(turns, axis))).collect()
}
