//! What a call through the ABI costs: `cargo run --release -p honami-host --example overhead` prints it as JSON.
//!
//! The plugins do next to nothing: one in C (the fossil of ABI 1.0), one in Rust through the SDK (the zoo's drift).

use honami_host::{CallContext, FrameView, Host, Kind, Point, Registry, SearchPath, StreamInfo, Values};
use honami_model::picture::Gray;
use std::error::Error;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

const PUSHES: u32 = 2_000;
const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn Error>> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let named = vec![root.join("tests/fossil/honami-fossil-1.0-x86_64.so"), zoo()?];
    let registry = Registry::scan_path(&SearchPath { named, ..SearchPath::default() });
    let mut rows = Vec::new();
    for plugin in ["null", "drift"] {
        for n_points in [0, 4, 100, 1500] {
            let mut rounds =
                (0..ROUNDS).map(|_| push_ns(&registry, plugin, n_points)).collect::<Result<Vec<_>, _>>()?;
            rounds.sort_by(f64::total_cmp);
            let (best, median) = (rounds[0].round(), rounds[ROUNDS / 2].round());
            rows.push(serde_json::json!({
                "plugin": plugin, "points": n_points, "push_ns_min": best, "push_ns_median": median,
            }));
        }
    }
    #[expect(clippy::print_stdout, reason = "the output of this program")]
    {
        println!("{}", serde_json::to_string_pretty(&rows)?);
    }
    Ok(())
}

/// The zoo's library, built as this program was.
fn zoo() -> Result<PathBuf, Box<dyn Error>> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--package", "honami-host", "--example", "zoo", "--message-format=json"]);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    let output = build.current_dir(env!("CARGO_MANIFEST_DIR")).output()?;
    let text = String::from_utf8(output.stdout)?;
    let artifacts = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let mut files = artifacts.filter(|a| a["target"]["name"] == "zoo");
    let file = files.next().and_then(|artifact| Some(artifact["filenames"][0].as_str()?.into()));
    file.ok_or_else(|| "cargo did not build the zoo".into())
}

/// Nanoseconds a push, checks and copies included.
fn push_ns(registry: &Registry, plugin: &str, n_points: u32) -> Result<f64, Box<dyn Error>> {
    let cx = CallContext::silent();
    let info = registry.find(Kind::Tracker, plugin)?;
    let mut values = Values::default();
    values.set_text(&info.params, if plugin == "null" { "drift=0" } else { "speed=0" })?;
    let (mut tracker, _) = Host::new().tracker(info, &values, &cx)?;
    let (width, height) = (64, 48);
    let stream = StreamInfo {
        width,
        height,
        fps: None,
        n_frames: None,
        reversed: false,
        max_threads: 1,
        seed: 0,
        births: 0..0,
    };
    tracker.begin(stream, &cx)?;
    let points: Vec<Point> = (0..n_points).map(|id| Point { id, x: 1.0, y: 2.0 }).collect();
    tracker.seed(&points, &cx)?;
    let pixels = vec![0; (width * height) as usize];
    let gray = Gray { data: &pixels, width, height, stride: width as usize };
    let start = Instant::now();
    for n in 0..PUSHES {
        let index = i64::from(n);
        tracker.push(&FrameView { gray, chroma: None, range: None, index, time_s: f64::from(n) }, &cx)?;
    }
    Ok(start.elapsed().as_nanos() as f64 / f64::from(PUSHES))
}
