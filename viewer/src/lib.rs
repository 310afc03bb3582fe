//! The viewer: scenes drawn by a graphics card, or by a driver that does without one.
//!
//! [`gpu`] finds what draws, [`target`] is what is drawn on, [`offscreen`] writes what was drawn into files. What draws a
//! scene is a [`Picture`].

pub mod app;
pub mod args;
pub mod forest;
pub mod gpu;
pub mod lens;
pub mod offscreen;
pub mod shaders;
pub mod skeleton;
pub mod target;
#[cfg(test)]
mod testing;

use std::io::Write as _;

use anyhow::bail;
use honami_media::MediaError;
use honami_media::write::Kind;
use honami_model::brief;
use honami_scene::Scene;
use honami_scene::control::Event;
use serde_json::json;

use args::Args;
use forest::{By, ForestPicture};
use gpu::{Gpu, GpuError};
use offscreen::Picture;
use skeleton::{Part, SkeletonPicture};

/// Does what is asked for.
///
/// # Errors
/// What was not to be had or cannot be written, in one line.
pub fn run(args: &Args) -> anyhow::Result<()> {
    if args.adapters {
        return list(args);
    }
    let Some(path) = &args.scene else { return Ok(()) };
    let Some(out) = &args.offscreen else { return app::run(path, args) };
    Kind::of(out)?.admit(out)?;
    let gpu = Gpu::open(args.adapter.as_deref())?;
    let scene = honami_scene::file::read(path)?;
    offscreen::run(&gpu, &mut *picture(&gpu, scene, args)?, out, args)
}

/// Whether whoever typed the command asked for what there is not, rather than the work having failed.
#[must_use]
pub fn is_usage(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(GpuError::Name { .. }))
        || matches!(error.downcast_ref(), Some(MediaError::Ending { .. }))
}

/// Says why it failed: to whoever attends, who says it on, else on standard error.
pub fn complain(error: &anyhow::Error, is_attended: bool) {
    let why = brief::told(error.as_ref());
    if is_attended {
        app::pipe::tell(&Event::Failed(why));
    } else {
        say(&why);
    }
}

/// What draws a scene.
fn picture(gpu: &Gpu, scene: Scene, args: &Args) -> anyhow::Result<Box<dyn Picture>> {
    match scene {
        Scene::Forest(scene) => {
            let by = if args.cpu { By::Processor } else { By::best(gpu, &scene) };
            Ok(Box::new(ForestPicture::new(gpu, *scene, by)?))
        }
        Scene::Skeleton(scene) => {
            let picture = SkeletonPicture::new(*scene, Part::these(&args.parts));
            picture.without_clip.iter().chain(&picture.why_empty()).for_each(|why| say(why));
            Ok(Box::new(picture))
        }
    }
}

/// One line on standard error; nobody left to hear it is no reason to fail.
fn say(line: &str) {
    writeln!(std::io::stderr(), "honami-viewer: {line}").unwrap_or_default();
}

/// The adapters there are, the one that would be used first; those with a name, where one is wanted.
fn list(args: &Args) -> anyhow::Result<()> {
    let mut adapters = gpu::adapters();
    if let Some(wanted) = &args.adapter {
        adapters = gpu::called(adapters, wanted)?;
    }
    let mut out = std::io::stdout().lock();
    if args.json {
        let row = |info: &wgpu::AdapterInfo| {
            json!({
                "name": info.name,
                "backend": info.backend.to_string(),
                "driver": format!("{} {}", info.driver, info.driver_info).trim(),
                "software": info.device_type == wgpu::DeviceType::Cpu,
            })
        };
        let rows: Vec<_> = adapters.iter().map(row).collect();
        writeln!(out, "{}", json!({ "adapters": rows }))?;
        return Ok(());
    }
    if adapters.is_empty() {
        bail!(gpu::GpuError::None);
    }
    for info in &adapters {
        let kind = if info.device_type == wgpu::DeviceType::Cpu { "software" } else { "card" };
        writeln!(out, "{}, {kind}, {} {}", gpu::name(info), info.driver, info.driver_info)?;
    }
    Ok(())
}
