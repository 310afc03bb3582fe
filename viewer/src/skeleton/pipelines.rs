//! The pipelines of skeletons, and the order in which they draw.

use bytemuck::Pod;
use wgpu::util::DeviceExt as _;
use wgpu::{BufferUsages, ShaderStages, VertexFormat};

use super::drawn::{Ball, Drawn, Frame, Stroke, Tube};
use crate::gpu::Gpu;
use crate::shaders;
use crate::target::{COLOUR, Target, nearest};

/// Vertices of a bone, of a ball, and of what is flat: as `skeleton.wgsl` counts them.
const TUBE: u32 = 20 * 6;
const BALL: u32 = 24 * 14 * 6;
const FLAT: u32 = 6;

/// Everything that draws skeletons.
pub(super) struct Pipelines {
    layout: wgpu::BindGroupLayout,
    frame: wgpu::Buffer,
    smoothly: wgpu::Sampler,
    bound: wgpu::BindGroup,
    sky: wgpu::RenderPipeline,
    film: wgpu::RenderPipeline,
    ground: wgpu::RenderPipeline,
    tubes: wgpu::RenderPipeline,
    balls: wgpu::RenderPipeline,
    tube_outlines: wgpu::RenderPipeline,
    ball_outlines: wgpu::RenderPipeline,
    shells: wgpu::RenderPipeline,
    strokes: wgpu::RenderPipeline,
    marks: wgpu::RenderPipeline,
}

/// How a pipeline differs from the others.
struct Kind<'a> {
    vertex: &'a str,
    fragment: &'a str,
    /// Vectors of four that an instance has.
    n_vectors: u32,
    cull: Option<wgpu::Face>,
    depth: wgpu::DepthStencilState,
}

impl Pipelines {
    /// All of them, for pictures with so many samples.
    pub(super) fn new(gpu: &Gpu, samples: u32) -> Self {
        let device = &gpu.device;
        let layout = layout(device);
        let module = shaders::module(device, "skeleton");
        let of = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("skeleton"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let make = |kind: &Kind<'_>| pipeline(device, &module, &of, samples, kind);
        let (front, back) = (Some(wgpu::Face::Front), Some(wgpu::Face::Back));
        let always =
            wgpu::DepthStencilState { depth_compare: Some(wgpu::CompareFunction::Always), ..nearest(false) };
        let behind = |vertex, fragment, depth: &wgpu::DepthStencilState| {
            make(&Kind { vertex, fragment, n_vectors: 0, cull: None, depth: depth.clone() })
        };
        let solid = |vertex, fragment, n_vectors, cull, writes| {
            make(&Kind { vertex, fragment, n_vectors, cull, depth: nearest(writes) })
        };
        let frame = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<Frame>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let smoothly = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smoothly"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let black = film(gpu, &[[0; 3]], 1, 1);
        let bound = bind(device, &layout, &frame, &black, &smoothly);
        Self {
            sky: behind("sky", "calm", &always),
            film: behind("screen", "filmed", &always),
            ground: behind("ground", "earth", &always),
            tubes: solid("tube", "solid", 3, back, true),
            balls: solid("ball", "solid", 5, back, true),
            tube_outlines: solid("tube", "outline", 3, front, true),
            ball_outlines: solid("ball", "outline", 5, front, true),
            shells: solid("ball", "shell", 5, back, false),
            strokes: solid("stroke", "stroked", 5, None, false),
            marks: make(&Kind {
                vertex: "stroke",
                fragment: "stroked",
                n_vectors: 5,
                cull: None,
                depth: always,
            }),
            layout,
            frame,
            smoothly,
            bound,
        }
    }

    /// From now on this is the clip's frame.
    pub(super) fn show_film(&mut self, gpu: &Gpu, pixels: &[[u8; 3]], width: u32, height: u32) {
        let film = film(gpu, pixels, width, height);
        self.bound = bind(&gpu.device, &self.layout, &self.frame, &film, &self.smoothly);
    }

    /// Draws all of it.
    pub(super) fn draw(&self, gpu: &Gpu, target: &Target, drawn: &Drawn) {
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&drawn.frame));
        let tubes = instances(gpu, &drawn.tubes);
        let balls = instances(gpu, &drawn.balls);
        let tube_outlines = instances(gpu, &drawn.tube_outlines);
        let ball_outlines = instances(gpu, &drawn.ball_outlines);
        let shells = instances(gpu, &drawn.shells);
        let strokes = instances(gpu, &drawn.strokes);
        let marks = instances(gpu, &drawn.marks);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = target.pass(&mut encoder);
        pass.set_bind_group(0, &self.bound, &[]);
        for (pipeline, is_drawn) in [(&self.sky, true), (&self.film, drawn.is_filmed), (&self.ground, true)] {
            if is_drawn {
                pass.set_pipeline(pipeline);
                pass.draw(0..FLAT, 0..1);
            }
        }
        for (pipeline, lot, n_vertices) in [
            (&self.tubes, &tubes, TUBE),
            (&self.balls, &balls, BALL),
            (&self.tube_outlines, &tube_outlines, TUBE),
            (&self.ball_outlines, &ball_outlines, BALL),
            (&self.shells, &shells, BALL),
            (&self.strokes, &strokes, FLAT),
            (&self.marks, &marks, FLAT),
        ] {
            let Some((buffer, n)) = lot else { continue };
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..n_vertices, 0..*n);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }
}

/// What all shaders see: the frame, and the clip's.
fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("skeleton"),
        entries: &[entry(0, uniform), entry(1, texture), entry(2, sampler)],
    })
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    frame: &wgpu::Buffer,
    film: &wgpu::TextureView,
    smoothly: &wgpu::Sampler,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("skeleton"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(film) },
            wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(smoothly) },
        ],
    })
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
    samples: u32,
    kind: &Kind<'_>,
) -> wgpu::RenderPipeline {
    let vectors: Vec<wgpu::VertexAttribute> = (0..kind.n_vectors)
        .map(|k| wgpu::VertexAttribute {
            format: VertexFormat::Float32x4,
            offset: u64::from(k) * 16,
            shader_location: k,
        })
        .collect();
    let instances = wgpu::VertexBufferLayout {
        array_stride: u64::from(kind.n_vectors) * 16,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &vectors,
    };
    let buffers = if vectors.is_empty() { vec![] } else { vec![Some(instances)] };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.vertex),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(kind.vertex),
            compilation_options: Default::default(),
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState { cull_mode: kind.cull, ..Default::default() },
        depth_stencil: Some(kind.depth.clone()),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(kind.fragment),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOUR,
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Instances on the card, and how many; `None` of none.
fn instances<T: Pod>(gpu: &Gpu, all: &[T]) -> Option<(wgpu::Buffer, u32)> {
    let n = u32::try_from(all.len()).ok().filter(|n| *n > 0)?;
    let contents = bytemuck::cast_slice(all);
    let init =
        wgpu::util::BufferInitDescriptor { label: Some("instances"), contents, usage: BufferUsages::VERTEX };
    Some((gpu.device.create_buffer_init(&init), n))
}

/// A picture on the card.
fn film(gpu: &Gpu, pixels: &[[u8; 3]], width: u32, height: u32) -> wgpu::TextureView {
    let bytes: Vec<u8> =
        pixels.iter().flat_map(|[red, green, blue]| [*red, *green, *blue, u8::MAX]).collect();
    let film = wgpu::TextureDescriptor {
        label: Some("film"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: COLOUR,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let order = wgpu::util::TextureDataOrder::LayerMajor;
    gpu.device.create_texture_with_data(&gpu.queue, &film, order, &bytes).create_view(&Default::default())
}

const _: () = {
    assert!(size_of::<Tube>() == 48 && size_of::<Ball>() == 80 && size_of::<Stroke>() == 80);
};
