//! What is drawn on: a picture, how near each of its pixels is, and, where edges are to be smooth, several samples of both.

use std::fmt;

use crate::gpu::{Gpu, GpuError};

/// Colours as they are shown (sRGB, 8 bits): shaders write them so, and windows show them so.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// How near: the nearest that is seen over the distance, so 1 there and 0 without end.
pub const NEARNESS: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Pixels wide and high, and how many samples of each are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// 1, or 4 for smooth edges.
    pub samples: u32,
}

/// A picture of a size.
#[derive(Debug)]
pub struct Target {
    size: Size,
    picture: wgpu::Texture,
    shown: wgpu::TextureView,
    /// Several samples a pixel, which become the picture.
    many: Option<wgpu::TextureView>,
    nearness: wgpu::TextureView,
    read: wgpu::Buffer,
}

impl Target {
    /// An empty picture.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn new(gpu: &Gpu, size: Size) -> Result<Self, GpuError> {
        let most = gpu.device.limits().max_texture_dimension_2d;
        if size.width == 0 || size.height == 0 || size.width.max(size.height) > most {
            let (what, most) = (format!("picture of {size}"), format!("{most}x{most}"));
            return Err(GpuError::TooLarge { adapter: gpu.name(), what, most });
        }
        let texture = |label, format, sample_count, usage| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size.width, height: size.height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let shown = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        let none = wgpu::TextureUsages::empty();
        let picture = texture("picture", COLOUR, 1, shown);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let many = (size.samples > 1).then(|| view(&texture("samples", COLOUR, size.samples, none)));
        let nearness = view(&texture("nearness", NEARNESS, size.samples, none));
        let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture that is read"),
            size: u64::from(row_bytes(size.width)) * u64::from(size.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let shown = view(&picture);
        gpu.check()?;
        Ok(Self { size, picture, shown, many, nearness, read })
    }

    /// Its size.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.size.width as f32 / self.size.height as f32
    }

    /// The picture, for whoever shows it.
    #[must_use]
    pub fn shown(&self) -> &wgpu::TextureView {
        &self.shown
    }

    /// What draws anew from here on: all is black and without end.
    #[must_use]
    pub fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let (view, resolve_target) = match &self.many {
            Some(many) => (many, Some(&self.shown)),
            None => (&self.shown, None),
        };
        let store = if self.many.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.nearness,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    /// Its pixels, red, green, blue, row by row from the top.
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::Failed`].
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<[u8; 3]>, GpuError> {
        let Size { width, height, .. } = self.size;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes(width)),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.picture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &self.read, layout },
            self.picture.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.mapped(&self.read)?;
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for row in bytes.chunks_exact(row_bytes(width) as usize) {
            let row = row.as_chunks::<4>().0.iter().take(width as usize);
            pixels.extend(row.map(|[red, green, blue, _]| [*red, *green, *blue]));
        }
        Ok(pixels)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// Nearest of what was drawn so far: what pipelines want that draw solid things, or, with `writes` off, what shines through.
#[must_use]
pub fn nearest(writes: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: NEARNESS,
        depth_write_enabled: Some(writes),
        depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Bytes from a row to the next: cards copy whole pieces.
fn row_bytes(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
