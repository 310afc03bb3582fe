//! What a forest in the viewer takes: `viewer_bench [COPIES [NODES [MODES]]] [--card|--cpu] [--all] [--sharp] [--out IMAGE.png]`.
//!
//! A tree of 3437 nodes with 25 modes, a hundred times, at 1280x720: frames per second and milliseconds by part, median and
//! spread (from the first quartile to the third), memory, start. `--all`: every node of every copy;
//! `--sharp`: one sample a pixel in place of four.

use std::time::Instant;

use honami_viewer::forest::{By, ForestPicture, Times};
use honami_viewer::gpu::Gpu;
use honami_viewer::offscreen::{Picture as _, Shot};
use honami_viewer::target::{Size, Target};
use serde_json::json;

#[expect(unreachable_pub, clippy::unwrap_used, reason = "it is that of the tests, of a tree that there is")]
#[path = "../src/testing/forest.rs"]
mod forest;

const FRAMES: usize = 40;
const FPS: f64 = 25.0;

fn main() -> anyhow::Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let is = |flag: &str| args.iter().any(|arg| arg == flag);
    let out = args.iter().position(|arg| arg == "--out").and_then(|k| args.get(k + 1));
    let mut sizes = args.iter().filter_map(|arg| arg.parse::<usize>().ok());
    let mut size = |usual| sizes.next().unwrap_or(usual);
    let (n_copies, n_nodes, n_modes) = (size(100), size(3437), size(25));
    let mut scene = forest::forest(n_nodes, n_modes, n_copies);
    if is("--all") {
        scene.body.levels.truncate(1);
    }

    let start = Instant::now();
    let gpu = Gpu::open(None)?;
    let by = match (is("--card"), is("--cpu")) {
        (true, _) => By::Card,
        (_, true) => By::Processor,
        _ => By::best(&gpu, &scene),
    };
    let mut picture = ForestPicture::new(&gpu, scene, by)?;
    let target =
        Target::new(&gpu, Size { width: 1280, height: 720, samples: if is("--sharp") { 1 } else { 4 } })?;
    let camera = picture.orbit().camera();
    picture.draw(&gpu, &target, &Shot { time: 0.0, camera })?;
    let pixels = target.read(&gpu)?;
    let first_s = start.elapsed().as_secs_f64();
    if let Some(out) = out {
        honami_media::write::still(out.as_ref(), &pixels, 1280, 720)?;
    }

    let mut times = Vec::new();
    for k in 1..=FRAMES {
        times.push(picture.timed(&gpu, &target, &Shot { time: k as f64 / FPS, camera })?);
    }
    let ms = |of: fn(&Times) -> f64| {
        let mut of: Vec<f64> = times.iter().map(|times| of(times) * 1000.0).collect();
        of.sort_by(f64::total_cmp);
        [of[FRAMES / 2], of[FRAMES * 3 / 4] - of[FRAMES / 4]].map(|ms| (ms * 100.0).round() / 100.0)
    };
    let frame = ms(|t| t.modes + t.pose + t.draw);
    // Each mode of each node of each copy, where none is left out.
    let updates =
        is("--all").then(|| (n_copies * n_nodes * n_modes) as f64 / ms(|t| t.modes + t.pose)[0] * 1000.0);
    let json = json!({
        "adapter": gpu.name(), "by": format!("{by:?}"),
        "copies": n_copies, "nodes": n_nodes, "modes": n_modes,
        "fps": (10_000.0 / frame[0]).round() / 10.0, "frame_ms": frame,
        "wind_ms": ms(|t| t.wind), "modes_ms": ms(|t| t.modes), "pose_ms": ms(|t| t.pose), "draw_ms": ms(|t| t.draw),
        "node_modes_per_s": updates.map(f64::round), "first_frame_s": first_s, "peak_mb": peak_mb(),
    });
    std::io::Write::write_all(&mut std::io::stdout(), format!("{json:#}\n").as_bytes())?;
    Ok(())
}

/// The most memory that it had, where the system tells.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1024.0)
}
