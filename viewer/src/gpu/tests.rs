//! Which adapter is taken, and what is said where there is none.

use super::{Gpu, GpuError, adapters, rank};
use crate::testing;
use wgpu::{Backend, DeviceType};

#[test]
fn cards_come_before_software_and_vulkan_before_gl() {
    let Some(gpu) = testing::gpu() else { return };
    let of = |device_type, backend| {
        let mut info = gpu.info.clone();
        (info.device_type, info.backend) = (device_type, backend);
        rank(&info)
    };
    let order = [
        (DeviceType::DiscreteGpu, Backend::Vulkan),
        (DeviceType::DiscreteGpu, Backend::Gl),
        (DeviceType::IntegratedGpu, Backend::Vulkan),
        (DeviceType::VirtualGpu, Backend::Gl),
        (DeviceType::Cpu, Backend::Vulkan),
        (DeviceType::Cpu, Backend::Gl),
    ];
    assert!(order.map(|(kind, backend)| of(kind, backend)).is_sorted_by(|a, b| a < b));
    let found: Vec<_> = adapters().iter().map(rank).collect();
    assert!(found.is_sorted());
}

#[test]
fn an_adapter_is_taken_by_its_name_or_refused_with_those_there_are() {
    let Some(gpu) = testing::gpu() else { return };
    let name = gpu.name();
    let same = Gpu::open(Some(&name.to_uppercase())).unwrap();
    assert_eq!(same.name(), name);
    let error = Gpu::open(Some("card of gold")).unwrap_err();
    assert!(matches!(&error, GpuError::Name { there, .. } if there.contains(&name)), "{error}");
}

/// The first error stays; whoever asks gets it, and nothing is drawn on as if all were well.
#[test]
fn what_an_adapter_refuses_and_that_it_is_gone_is_told() {
    let Some(gpu) = testing::gpu() else { return };
    gpu.check().unwrap();
    let size = 4;
    let usage = wgpu::BufferUsages::COPY_DST;
    let _refused = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage: usage | wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE,
        mapped_at_creation: false,
    });
    let error = gpu.check().unwrap_err().to_string();
    assert!(error.starts_with(&gpu.name()) && error.contains("failed"), "{error}");

    let Some(gpu) = testing::gpu() else { return };
    gpu.device.destroy();
    gpu.wait().unwrap_or_default();
    let error = gpu.check().unwrap_err();
    assert!(matches!(error, GpuError::Lost { .. }), "{error}");
    assert!(!error.to_string().contains('\n'));
}
