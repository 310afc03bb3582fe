//! What hosting costs: `cargo run --release -p honami-host --example overhead` prints it as JSON.
//!
//! The plugins do next to nothing: one in C (the fossil of ABI 1.0), one in Rust through the SDK (the zoo's drift).
//! Times are medians; the smallest and the 99th of a hundred stand beside them.

use honami_host::{
    CallContext, FrameView, Host, Hosting, Kind, Point, Registry, SearchPath, StreamInfo, Tracker, Values,
};
use honami_model::picture::Gray;
use serde_json::{Value, json};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const PUSHES: usize = 2_000;
const STARTS: usize = 50;
const LIBRARIES: usize = 50;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let zoo = built(&["--package", "honami-host", "--example", "zoo"], "zoo")?;
    built(&["--package", "honami-plughost"], "honami-plughost")?;
    let named = vec![root.join("tests/fossil/honami-fossil-1.0-x86_64.so"), zoo.clone()];
    let registry = Registry::scan_path(&SearchPath { named, ..SearchPath::default() });
    let mut pushes = Vec::new();
    for (hosting, plugin, [width, height], n_points) in [
        (Hosting::InProcess, "null", [64, 48], 100),
        (Hosting::InProcess, "drift", [64, 48], 100),
        (Hosting::InProcess, "drift", [1920, 1080], 1000),
        (Hosting::Isolated, "drift", [64, 48], 100),
        (Hosting::Isolated, "drift", [640, 360], 1000),
        (Hosting::Isolated, "drift", [1920, 1080], 1000),
    ] {
        let us = push_us(&registry, hosting, plugin, [width, height], n_points)?;
        let size = format!("{width}x{height}");
        pushes.push(json!({ "hosting": word(hosting), "plugin": plugin, "frame": size, "points": n_points, "us": us }));
    }
    let starts: Vec<Value> = [Hosting::InProcess, Hosting::Isolated]
        .into_iter()
        .map(|hosting| Ok(json!({ "hosting": word(hosting), "ms": start_ms(&registry, hosting)? })))
        .collect::<Outcome<_>>()?;
    let said = json!({ "push": pushes, "start_to_first_answer": starts, "list_of_50_ms": list_ms(&zoo)? });
    #[expect(clippy::print_stdout, reason = "the output of this program")]
    {
        println!("{}", serde_json::to_string_pretty(&said)?);
    }
    Ok(())
}

fn word(hosting: Hosting) -> &'static str {
    match hosting {
        Hosting::InProcess => "in process",
        Hosting::Isolated => "isolated",
    }
}

/// What cargo builds, built as this program was.
fn built(what: &[&str], name: &str) -> Outcome<PathBuf> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--message-format=json"]).args(what);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    let output = build.current_dir(env!("CARGO_MANIFEST_DIR")).output()?;
    let text = String::from_utf8(output.stdout)?;
    let artifacts = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut files = artifacts.filter(|a| a["target"]["name"] == name);
    let file = files.next().and_then(|artifact| Some(artifact["filenames"][0].as_str()?.into()));
    file.ok_or_else(|| format!("cargo did not build {name}").into())
}

/// The smallest, the median and the 99th of a hundred.
fn spread(mut values: Vec<f64>) -> Value {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| (values[((values.len() - 1) as f64 * share) as usize] * 1000.0).round() / 1000.0;
    json!({ "median": at(0.5), "min": at(0.0), "p99": at(0.99) })
}

fn begun(registry: &Registry, hosting: Hosting, plugin: &str, [width, height]: [u32; 2]) -> Outcome<Tracker> {
    let cx = CallContext::silent();
    let info = registry.find(Kind::Tracker, plugin)?;
    let mut values = Values::default();
    values.set_text(&info.params, if plugin == "null" { "drift=0" } else { "speed=0" })?;
    let (mut tracker, _) = Host::new().hosting(hosting).tracker(info, &values, &cx)?;
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
    Ok(tracker)
}

/// Microseconds a push, checks and copies included.
fn push_us(
    registry: &Registry,
    hosting: Hosting,
    plugin: &str,
    [width, height]: [u32; 2],
    n_points: u32,
) -> Outcome<Value> {
    let cx = CallContext::silent();
    let mut tracker = begun(registry, hosting, plugin, [width, height])?;
    let points: Vec<Point> = (0..n_points).map(|id| Point { id, x: 1.0, y: 2.0 }).collect();
    tracker.seed(&points, &cx)?;
    let pixels = vec![7; (width * height) as usize];
    let gray = Gray { data: &pixels, width, height, stride: width as usize };
    let mut times = Vec::with_capacity(PUSHES);
    for index in 0..PUSHES as i64 {
        let frame = FrameView { gray, chroma: None, range: None, index, time_s: index as f64 };
        let start = Instant::now();
        tracker.push(&frame, &cx)?;
        times.push(start.elapsed().as_secs_f64() * 1e6);
    }
    Ok(spread(times))
}

/// From nothing to the answer of the first call.
fn start_ms(registry: &Registry, hosting: Hosting) -> Outcome<Value> {
    let mut times = Vec::with_capacity(STARTS);
    for _ in 0..STARTS {
        let start = Instant::now();
        let tracker = begun(registry, hosting, "drift", [64, 48])?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        drop(tracker);
    }
    Ok(spread(times))
}

/// A folder of fifty libraries, listed without running any.
fn list_ms(library: &Path) -> Outcome<Value> {
    let folder = std::env::temp_dir().join(format!("honami-overhead-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    for n in 0..LIBRARIES {
        std::fs::copy(library, folder.join(format!("library-{n}.so")))?;
    }
    let mut times = Vec::with_capacity(STARTS);
    for _ in 0..STARTS {
        let start = Instant::now();
        let registry =
            Registry::scan_path(&SearchPath { named: vec![folder.clone()], ..SearchPath::default() });
        times.push(start.elapsed().as_secs_f64() * 1e3);
        assert_eq!(registry.shadowed().len() + registry.plugins().len(), LIBRARIES * 7);
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(spread(times))
}
