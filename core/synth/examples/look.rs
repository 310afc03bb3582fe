//! Renders one frame of a scene into a PNG: `look OUT.png [calm|wind|storm] [demo|benchmark] [frame] [seed]`.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use honami_synth::{Level, Scene, Settings};

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let out =
        PathBuf::from(words.next().ok_or("usage: look OUT.png [LEVEL] [demo|benchmark] [FRAME] [SEED]")?);
    let level: Level = words.next().as_deref().unwrap_or("calm").parse()?;
    let mut settings = match words.next().as_deref() {
        Some("demo") => Settings { level, ..Settings::default() },
        _ => Settings::benchmark(level),
    };
    let frame = words.next().map_or(Ok(0), |word| word.parse())?;
    settings.seed = words.next().map_or(Ok(settings.seed), |word| word.parse())?;
    let start = Instant::now();
    let scene = Scene::new(&settings)?;
    let grown_ms = start.elapsed().as_secs_f64() * 1e3;
    let start = Instant::now();
    let n_timed = scene.n_frames().min(40);
    let bytes: usize = (0..n_timed).map(|frame| scene.render(frame).y.len()).sum();
    let frame_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(n_timed);
    let picture = scene.render(frame);
    let planes = picture.planes();
    image::RgbImage::from_fn(picture.width, picture.height, |x, y| image::Rgb(planes.rgb(x, y)))
        .save(&out)?;
    let seen = |frame: usize| scene.truth().leaves.iter().filter(|leaf| leaf.path[frame].visible).count();
    writeln!(
        std::io::stdout(),
        "{} leaves ({} seen), {} branches, {:.3} px a frame; grown in {grown_ms:.0} ms, \
         {frame_ms:.1} ms a frame ({bytes} bytes)",
        scene.truth().leaves.len(),
        seen(frame as usize),
        scene.truth().branches.len(),
        scene.mean_step_px(),
    )?;
    Ok(())
}
