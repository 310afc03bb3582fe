//! Pictures into files: an image, a movie, a folder of images. By the same adapter always the same bytes.

use std::path::Path;

use anyhow::{Context as _, ensure};
use honami_media::write::{self, Format, Kind, Movie};
use honami_model::picture::Range;
use honami_scene::control::Event;
use honami_scene::{Camera, Orbit};

use crate::app::pipe;
use crate::args::{Args, FPS};
use crate::gpu::Gpu;
use crate::target::Target;

/// What is drawn.
pub trait Picture {
    /// From where it is seen at first.
    fn orbit(&self) -> Orbit;

    /// Frames per second and how many there are, of what was filmed; `None` of what has no end.
    fn filmed(&self) -> Option<(f64, u32)>;

    /// Draws all of it.
    ///
    /// # Errors
    /// What was not to be had, and [`GpuError`](crate::gpu::GpuError).
    fn draw(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<()>;
}

/// A frame that is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Seconds from the beginning of what is shown.
    pub time: f64,
    /// From where it is seen.
    pub camera: Camera,
}

/// Seconds of a movie of what has no end, where nothing is said.
const SECONDS: f64 = 10.0;

/// Draws what was asked for into a file. What is unfinished leaves nothing behind.
///
/// # Errors
/// What was not to be had or cannot be written.
pub fn run(gpu: &Gpu, picture: &mut dyn Picture, out: &Path, args: &Args) -> anyhow::Result<()> {
    let kind = Kind::of(out)?;
    kind.admit(out)?;
    let reel = Reel::new(picture, args, kind == Kind::Still)?;
    let target = Target::new(gpu, args.size())?;
    if kind == Kind::Still {
        picture.draw(gpu, &target, &reel.shot(reel.n_frames - 1))?;
        let size = target.size();
        return Ok(write::still(out, &target.read(gpu)?, size.width, size.height)?);
    }
    let mut movie = create((out, kind), &target, reel.fps)?;
    for k in 0..reel.n_frames {
        picture.draw(gpu, &target, &reel.shot(k)).with_context(|| format!("frame {k}"))?;
        movie.push_rgb(&target.read(gpu)?)?;
        if args.attended {
            pipe::tell(&Event::Frame(k));
        }
    }
    Ok(movie.finish()?)
}

/// The frames of a movie, or those up to an image.
struct Reel {
    fps: f64,
    n_frames: u32,
    orbit: Orbit,
    /// By how much the camera goes round between the first and the last, radians.
    turn: f32,
}

impl Reel {
    fn new(picture: &dyn Picture, args: &Args, is_still: bool) -> anyhow::Result<Self> {
        let filmed = picture.filmed();
        let fps = args.fps.or(filmed.map(|(fps, _)| fps)).unwrap_or(FPS);
        let seconds = |s: f64| (s * fps).round().clamp(1.0, f64::from(u32::MAX)) as u32;
        let n_frames = match (args.frames, args.seconds, filmed) {
            (Some(frames), ..) => frames,
            (None, Some(s), _) => seconds(s),
            (None, None, _) if is_still => 1,
            (None, None, Some((filmed_fps, n))) => seconds(f64::from(n) / filmed_fps),
            (None, None, None) => seconds(SECONDS),
        };
        ensure!(
            n_frames <= 1_000_000,
            "{n_frames} frames are too many: say fewer --seconds or a lower --fps"
        );
        let mut orbit = picture.orbit();
        orbit.azimuth = args.azimuth.map_or(orbit.azimuth, f32::to_radians);
        orbit.elevation = args.elevation.map_or(orbit.elevation, f32::to_radians);
        orbit.zoom(args.distance as f32);
        Ok(Self { fps, n_frames, orbit, turn: args.turn.to_radians() })
    }

    fn shot(&self, k: u32) -> Shot {
        let share = k as f32 / (self.n_frames - 1).max(1) as f32;
        let orbit = Orbit { azimuth: self.orbit.azimuth + self.turn * share, ..self.orbit };
        Shot { time: f64::from(k) / self.fps, camera: orbit.camera() }
    }
}

fn create((out, kind): (&Path, Kind), target: &Target, fps: f64) -> anyhow::Result<Box<dyn Movie>> {
    let size = target.size();
    // Players of compressed movies know limited range best.
    let range = if kind == Kind::Mp4 { Range::Limited } else { Range::Full };
    let format = Format { width: size.width, height: size.height, fps, colour: true, range };
    Ok(write::create(out, &format)?)
}

#[cfg(test)]
mod tests;
