//! What draws: a graphics card by Vulkan or GL, or a driver that draws without one.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::{AdapterInfo, Backend, Backends, DeviceType};

/// Why nothing is drawn.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// Neither a card nor a driver that does without.
    #[error(
        "there is nothing to draw with, neither a graphics card nor a driver that does without one: install one (apt-get \
         install mesa-vulkan-drivers)"
    )]
    None,
    /// No adapter has such a name.
    #[error("no adapter is called {wanted:?}; there are: {}", there.join("; "))]
    Name {
        /// What was asked for.
        wanted: String,
        /// Those there are.
        there: Vec<String>,
    },
    /// It is there and does not open.
    #[error("{adapter} does not open: {why}")]
    Closed {
        /// Its name.
        adapter: String,
        /// What its driver said.
        why: String,
    },
    /// It cannot do what is asked.
    #[error("{adapter} draws no {what}: {most} at most")]
    TooLarge {
        /// Its name.
        adapter: String,
        /// What was wanted.
        what: String,
        /// Its limit.
        most: String,
    },
    /// More copies are seen at once than it holds.
    #[error(
        "{adapter} holds {most} bytes of {what}, and the {n_copies} copies that are seen at once have {wanted}: take fewer \
         copies or a narrower view{}", if *has_processor { ", or move them by the processor (honami-viewer --cpu)" } else { "" }
    )]
    Copies {
        /// Its name.
        adapter: String,
        /// What copies have in it.
        what: &'static str,
        /// How many are seen.
        n_copies: usize,
        /// What they have, bytes,
        wanted: u64,
        /// and what it holds.
        most: u64,
        /// Whether the processor could move them instead.
        has_processor: bool,
    },
    /// It was there, and is no more.
    #[error("{adapter} was lost while it drew ({why}): try again, or another by --adapter")]
    Lost {
        /// Its name.
        adapter: String,
        /// What its driver said.
        why: String,
    },
    /// It refused something, or has no memory left.
    #[error("{adapter} failed: {why}")]
    Failed {
        /// Its name.
        adapter: String,
        /// The first that it said.
        why: String,
    },
}

/// An adapter that is open for drawing.
#[derive(Debug)]
pub struct Gpu {
    /// What makes buffers, textures and pipelines,
    pub device: wgpu::Device,
    /// and what takes work for them.
    pub queue: wgpu::Queue,
    info: AdapterInfo,
    /// The first that went wrong.
    fault: Arc<Mutex<Option<GpuError>>>,
}

impl Gpu {
    /// The best adapter, or the best of those with `wanted` in their names (capitals or not).
    ///
    /// # Errors
    /// [`GpuError::None`], [`GpuError::Name`], [`GpuError::Closed`].
    pub fn open(wanted: Option<&str>) -> Result<Self, GpuError> {
        let found = found();
        let infos: Vec<AdapterInfo> = found.iter().map(wgpu::Adapter::get_info).collect();
        let best = called(infos.clone(), wanted.unwrap_or_default())?;
        let adapter = found.iter().zip(&infos).find(|(_, info)| best.first() == Some(info));
        let (adapter, _) = adapter.ok_or(GpuError::None)?;
        Self::of(adapter, adapter.limits())
    }

    /// One that holds no more than these limits say.
    fn of(adapter: &wgpu::Adapter, required_limits: wgpu::Limits) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let device = wgpu::DeviceDescriptor { label: Some("honami"), required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&device))
            .map_err(|error| GpuError::Closed { adapter: name(&info), why: error.to_string() })?;
        Ok(Self::adopt(device, queue, info))
    }

    /// The best adapter, as if it held no more than so many bytes in one piece; `None` without one.
    #[cfg(test)]
    pub(crate) fn small(bytes: u64) -> Option<Self> {
        let adapter = found().into_iter().next()?;
        let limits = wgpu::Limits { max_storage_buffer_binding_size: bytes, ..adapter.limits() };
        Self::of(&adapter, limits).ok()
    }

    /// One that another has opened, such as a window: from now on its errors are kept here.
    #[must_use]
    pub fn adopt(device: wgpu::Device, queue: wgpu::Queue, info: AdapterInfo) -> Self {
        let fault = Arc::new(Mutex::new(None));
        let keep = |fault: &Arc<Mutex<Option<GpuError>>>, error| {
            fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        };
        let (kept, adapter) = (Arc::clone(&fault), name(&info));
        device.set_device_lost_callback(move |_, why| {
            keep(&kept, GpuError::Lost { adapter: adapter.clone(), why });
        });
        let (kept, adapter) = (Arc::clone(&fault), name(&info));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            keep(&kept, GpuError::Failed { adapter: adapter.clone(), why: first_lines(&error) });
        }));
        Self { device, queue, info, fault }
    }

    /// What it is called, with the way that leads to it.
    #[must_use]
    pub fn name(&self) -> String {
        name(&self.info)
    }

    /// Whether there is no card behind it, so that what is to be calculated is so sooner on the processor's own cores.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.info.device_type == DeviceType::Cpu
    }

    /// Whether all went well so far.
    ///
    /// # Errors
    /// The first that went wrong: [`GpuError::Lost`], [`GpuError::Failed`].
    pub fn check(&self) -> Result<(), GpuError> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).clone().map_or(Ok(()), Err)
    }

    /// Waits until all that was asked for is done.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn wait(&self) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        waited.map(|_| ()).map_err(|error| self.failed(error))
    }

    /// What a buffer holds; it has the use [`COPY_SRC`](wgpu::BufferUsages::COPY_SRC).
    ///
    /// # Errors
    /// [`GpuError::Lost`], [`GpuError::Failed`].
    pub fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("what is read back"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &read, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        self.mapped(&read)
    }

    /// What a buffer holds that the processor may read.
    pub(crate) fn mapped(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        // Whether it could be mapped is seen below.
        buffer.map_async(wgpu::MapMode::Read, .., |_| ());
        self.wait()?;
        let bytes = buffer.get_mapped_range(..).map_err(|error| self.failed(error))?.to_vec();
        buffer.unmap();
        Ok(bytes)
    }

    fn failed(&self, error: impl std::fmt::Display) -> GpuError {
        GpuError::Failed { adapter: self.name(), why: error.to_string() }
    }
}

/// All there are, best first: cards before drivers that do without, Vulkan before GL.
#[must_use]
pub fn adapters() -> Vec<AdapterInfo> {
    found().iter().map(wgpu::Adapter::get_info).collect()
}

/// Those with `wanted` in their names, capitals or not.
///
/// # Errors
/// [`GpuError::None`] where there are none at all, [`GpuError::Name`] where none is called so.
pub fn called(mut adapters: Vec<AdapterInfo>, wanted: &str) -> Result<Vec<AdapterInfo>, GpuError> {
    if adapters.is_empty() {
        return Err(GpuError::None);
    }
    let there: Vec<String> = adapters.iter().map(name).collect();
    adapters.retain(|info| name(info).to_lowercase().contains(&wanted.to_lowercase()));
    if adapters.is_empty() {
        return Err(GpuError::Name { wanted: wanted.to_owned(), there });
    }
    Ok(adapters)
}

/// The best adapter with `wanted` in its name that can show pictures on a surface.
///
/// # Errors
/// As [`called`].
pub fn pick(
    there: &[wgpu::Adapter],
    surface: Option<&wgpu::Surface<'_>>,
    wanted: &str,
) -> Result<wgpu::Adapter, GpuError> {
    let fits = |adapter: &&wgpu::Adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface));
    let there: Vec<&wgpu::Adapter> = there.iter().filter(fits).collect();
    let best = called(there.iter().map(|adapter| adapter.get_info()).collect(), wanted)?;
    let is_best = |adapter: &&&wgpu::Adapter| best.first() == Some(&adapter.get_info());
    there.iter().find(is_best).map(|adapter| (*adapter).clone()).ok_or(GpuError::None)
}

/// An adapter's name, with the way that leads to it.
#[must_use]
pub fn name(info: &AdapterInfo) -> String {
    format!("{} ({})", info.name, info.backend)
}

fn found() -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let mut adapters = pollster::block_on(instance.enumerate_adapters(Backends::all()));
    adapters.sort_by_key(|adapter| rank(&adapter.get_info()));
    adapters
}

fn rank(info: &AdapterInfo) -> (u8, u8) {
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (kind, u8::from(info.backend != Backend::Vulkan))
}

/// What went wrong, without the layers below it that say it again.
fn first_lines(error: &wgpu::Error) -> String {
    let text = error.to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.take(3).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests;
