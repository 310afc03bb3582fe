//! How a forest looks: sky and ground, shadows on it, wood, leaves.

use bytemuck::{Pod, Zeroable};
use honami_scene::sky::{SUN, Shadow};
use honami_scene::{Camera, ForestScene};
use wgpu::{BindingType, BufferBindingType, ShaderStages};

use super::shade;
use super::skin::{self, Drawn};
use super::stage::{CALL_BYTES, LEVEL_BYTES, Stage};
use crate::gpu::Gpu;
use crate::offscreen::Shot;
use crate::target::{COLOUR, Target, nearest};
use crate::{lens, shaders};

/// From where it is seen and when, as shaders read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Look {
    matrix: [[f32; 4]; 4],
    eye: [f32; 3],
    time: f32,
    /// Rays to the edges of the picture: right, up, and forward of length 1.
    right: [f32; 3],
    /// Of the plant, metres.
    height: f32,
    up: [f32; 3],
    /// Half of the length of a crown's shadow along the sun's way, metres.
    along: f32,
    forward: [f32; 3],
    /// Metres that a pixel is wide a metre away.
    pixel: f32,
    sun: [f32; 3],
    /// Half of the width of a crown's shadow, metres.
    wide: f32,
    /// Of a crown's shadow, metres from the root.
    middle: [f32; 2],
    /// How much of the sun leaves take.
    dense: f32,
    filler: f32,
}

/// Pipelines for a number of samples.
pub(super) struct Paint {
    samples: u32,
    look: wgpu::Buffer,
    looked: wgpu::BindGroup,
    read: wgpu::BindGroup,
    sky: wgpu::RenderPipeline,
    shadows: wgpu::RenderPipeline,
    strokes: wgpu::RenderPipeline,
    wood: wgpu::RenderPipeline,
    leaves: wgpu::RenderPipeline,
    /// Of vertices that are worked out already: wood, leaves.
    skinned: [wgpu::RenderPipeline; 2],
}

/// How a pipeline draws.
struct Way {
    vertex: &'static str,
    fragment: &'static str,
    /// Whether it hides what is behind it.
    is_solid: bool,
    blend: Option<wgpu::BlendState>,
    cull: Option<wgpu::Face>,
    /// Whether its edges are told by how much of a pixel is covered.
    is_cut: bool,
}

/// What is darker stays.
const DARKEST: wgpu::BlendState = {
    let least = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Min,
    };
    wgpu::BlendState { color: least, alpha: least }
};
const BACKDROP: Way = Way {
    vertex: "over_all",
    fragment: "sky_and_ground",
    is_solid: false,
    blend: None,
    cull: None,
    is_cut: false,
};
const SHADOWS: Way = Way { vertex: "shadow_at", fragment: "shadow", blend: Some(DARKEST), ..BACKDROP };
const STROKES: Way = Way { vertex: "stroke_at", fragment: "stroke", ..SHADOWS };
const WOOD: Way =
    Way { vertex: "wood_at", fragment: "wood", is_solid: true, cull: Some(wgpu::Face::Back), ..BACKDROP };
const SKINNED_WOOD: Way = Way { vertex: "wood_skinned", ..WOOD };
const SKINNED_LEAVES: Way = Way { vertex: "leaf_skinned", ..LEAVES };
const LEAVES: Way = Way { vertex: "leaf_at", fragment: "leaf", is_solid: true, is_cut: true, ..BACKDROP };

impl Paint {
    pub(super) fn new(gpu: &Gpu, stage: &Stage, samples: u32) -> Self {
        let device = &gpu.device;
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let look_layout = layout(gpu, &[entry(0, stages, BufferBindingType::Uniform, false)]);
        let storage = BufferBindingType::Storage { read_only: true };
        let mut entries: Vec<_> = (0..7).map(|k| entry(k, ShaderStages::VERTEX, storage, false)).collect();
        entries.push(entry(7, ShaderStages::VERTEX, BufferBindingType::Uniform, true));
        let read_layout = layout(gpu, &entries);
        let look = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("look"),
            size: size_of::<Look>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let looked = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("look"),
            layout: &look_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: look.as_entire_binding() }],
        });
        let level = wgpu::BufferBinding {
            buffer: &stage.levels,
            offset: 0,
            size: std::num::NonZeroU64::new(u64::from(LEVEL_BYTES)),
        };
        let whole = (0..)
            .zip(stage.read())
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let level = wgpu::BindGroupEntry { binding: 7, resource: wgpu::BindingResource::Buffer(level) };
        let read = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("forest"),
            layout: &read_layout,
            entries: &whole.chain([level]).collect::<Vec<_>>(),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("forest"),
            bind_group_layouts: &[Some(&look_layout), Some(&read_layout)],
            immediate_size: 0,
        });
        let module = shaders::module(device, "forest");
        let of = |way: &Way| pipeline(gpu, &layout, &module, samples, way);
        let [sky, shadows, strokes, wood, leaves] = [&BACKDROP, &SHADOWS, &STROKES, &WOOD, &LEAVES].map(of);
        let skinned = [&SKINNED_WOOD, &SKINNED_LEAVES].map(of);
        Self { samples, look, looked, read, sky, shadows, strokes, wood, leaves, skinned }
    }

    pub(super) fn samples(&self) -> u32 {
        self.samples
    }

    /// Draws what is on the stage, or what was skinned.
    pub(super) fn draw(
        &self,
        gpu: &Gpu,
        target: &Target,
        (scene, stage): (&ForestScene, &Stage),
        skinned: Option<(&wgpu::Buffer, &[Drawn])>,
        shot: &Shot,
    ) {
        let look = look(target, scene, shot);
        gpu.queue.write_buffer(&self.look, 0, bytemuck::bytes_of(&look));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = target.pass(&mut encoder);
        pass.set_bind_group(0, &self.looked, &[]);
        pass.set_bind_group(1, &self.read, &[0]);
        pass.set_index_buffer(stage.indices.slice(..), wgpu::IndexFormat::Uint32);
        match skinned {
            Some((vertices, drawn)) => self.draw_skinned(&mut pass, stage, vertices, drawn),
            None => self.draw_posed(&mut pass, stage),
        }
        // What nothing hides.
        pass.set_pipeline(&self.sky);
        pass.draw(0..3, 0..1);
        if look.dense > 0.0 {
            pass.set_pipeline(&self.shadows);
            pass.draw(0..4, 0..stage.n_copies as u32);
        }
        if stage.n_pieces > 0 {
            pass.set_pipeline(&self.strokes);
            pass.set_vertex_buffer(0, stage.pieces.slice(..));
            pass.draw(0..6 * stage.n_copies as u32, 0..stage.n_pieces);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }

    fn draw_posed(&self, pass: &mut wgpu::RenderPass<'_>, stage: &Stage) {
        for (which, pipeline) in (0..).zip([&self.wood, &self.leaves]) {
            pass.set_pipeline(pipeline);
            for level in 0..stage.n_levels() as u32 {
                pass.set_bind_group(1, &self.read, &[level * LEVEL_BYTES]);
                let call = u64::from(2 * level + which) * CALL_BYTES;
                pass.draw_indexed_indirect(&stage.calls, call);
            }
        }
    }

    fn draw_skinned(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        stage: &Stage,
        vertices: &wgpu::Buffer,
        drawn: &[Drawn],
    ) {
        pass.set_vertex_buffer(0, vertices.slice(..));
        for (which, pipeline) in self.skinned.iter().enumerate() {
            pass.set_pipeline(pipeline);
            for drawn in drawn {
                let first = [drawn.wood, drawn.leaves][which] as i32;
                let indices = &stage.indices_of(drawn.level)[which];
                pass.draw_indexed(indices.clone(), first, 0..1);
            }
        }
    }
}

fn look(target: &Target, scene: &ForestScene, shot: &Shot) -> Look {
    let [right, up, forward] = shot.camera.axes();
    let half = (shot.camera.angle / 2.0).tan();
    let shadow = Shadow::of(scene);
    Look {
        matrix: lens::matrix(&shot.camera, target.aspect()),
        eye: shot.camera.eye,
        time: shot.time as f32,
        right: right.map(|v| v * half * target.aspect()),
        height: scene.stirring.height() as f32,
        up: up.map(|v| v * half),
        along: shadow.along,
        forward,
        pixel: pixel(&shot.camera, target.size().height),
        sun: SUN,
        wide: shadow.wide,
        middle: shadow.middle,
        dense: shadow.dense,
        filler: 0.0,
    }
}

/// Metres that a pixel is wide a metre away.
pub(super) fn pixel(camera: &Camera, height: u32) -> f32 {
    2.0 * (camera.angle / 2.0).tan() / height as f32
}

fn entry(
    binding: u32,
    visibility: ShaderStages,
    ty: BufferBindingType,
    has_dynamic_offset: bool,
) -> wgpu::BindGroupLayoutEntry {
    let ty = BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn layout(gpu: &Gpu, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("forest"), entries })
}

fn pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    samples: u32,
    way: &Way,
) -> wgpu::RenderPipeline {
    let is_strip = way.vertex == SHADOWS.vertex;
    let read: &[Option<wgpu::VertexBufferLayout<'_>>] = match way.vertex {
        vertex if [SKINNED_WOOD.vertex, SKINNED_LEAVES.vertex].contains(&vertex) => &[Some(skin::LAYOUT)],
        vertex if vertex == STROKES.vertex => &[Some(shade::LAYOUT)],
        _ => &[],
    };
    let topology = match is_strip {
        true => wgpu::PrimitiveTopology::TriangleStrip,
        false => wgpu::PrimitiveTopology::TriangleList,
    };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(way.fragment),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(way.vertex),
            compilation_options: Default::default(),
            buffers: read,
        },
        primitive: wgpu::PrimitiveState { topology, cull_mode: way.cull, ..Default::default() },
        depth_stencil: Some(nearest(way.is_solid)),
        multisample: wgpu::MultisampleState {
            count: samples,
            mask: !0,
            alpha_to_coverage_enabled: way.is_cut && samples > 1,
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(way.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOUR,
                blend: way.blend,
                write_mask: wgpu::ColorWrites::COLOR,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
