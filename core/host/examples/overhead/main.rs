//! What hosting costs: `cargo run --release -p honami-host --example overhead` prints it as JSON.
//!
//! The plugins do next to nothing: one in C (the fossil of ABI 1.0), one in Rust through the SDK (the zoo's drift), one in
//! Python. Times are medians; the smallest and the 99th of a hundred stand beside them, and the goal where there is one.

mod faults;

use honami_host::{
    CallContext, FrameView, Host, Hosting, Kind, PluginInfo, Point, Registry, SearchPath, StreamInfo,
    Tracker, Values,
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

/// A tracker in Python that leaves its points where they are.
const STILL: &str = r#"
import honami
import numpy as np

@honami.tracker("org.honami.still", "Still")
class Still:
    def begin(self, stream): self.points = None
    def seed(self, points): self.points = [np.copy(c) for c in (points.id, points.x, points.y)]
    def push(self, frame): return honami.Points(*self.points, np.full(len(self.points[0]), honami.TRACKED))

honami.run()
"#;

fn main() -> Outcome<()> {
    let mut args = std::env::args_os().skip(1);
    if args.next().is_some_and(|word| word == faults::SHUT_IN) {
        faults::shut_in_now(args.next().unwrap_or_default().into());
        return Ok(());
    }
    let folder = std::env::temp_dir().join(format!("honami-overhead-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let said = measured(&folder);
    std::fs::remove_dir_all(&folder)?;
    #[expect(clippy::print_stdout, reason = "the output of this program")]
    {
        println!("{}", serde_json::to_string_pretty(&said?)?);
    }
    Ok(())
}

fn measured(folder: &Path) -> Outcome<Value> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let zoo = built(&["--package", "honami-host", "--example", "zoo"], "zoo")?;
    built(&["--package", "honami-plughost"], "honami-plughost")?;
    let mut named = vec![root.join("tests/fossil/honami-fossil-1.0-x86_64.so"), zoo.clone()];
    named.extend(still(folder)?);
    let registry = Registry::scan_path(&SearchPath { named, ..SearchPath::default() });
    let mut pushes = Vec::new();
    for (hosting, plugin, [width, height], n_points, goal_us) in [
        (Hosting::InProcess, "null", [64, 48], 1, Some(1)),
        (Hosting::InProcess, "null", [64, 48], 100, None),
        (Hosting::InProcess, "drift", [64, 48], 100, None),
        (Hosting::InProcess, "drift", [1920, 1080], 1000, None),
        (Hosting::Isolated, "drift", [64, 48], 100, None),
        (Hosting::Isolated, "drift", [640, 360], 1000, None),
        (Hosting::Isolated, "drift", [1920, 1080], 1000, Some(100)),
        (Hosting::Isolated, "still", [1920, 1080], 1000, None),
    ] {
        if registry.find(Kind::Tracker, plugin).is_err() {
            continue;
        }
        let us = push_us(&registry, hosting, plugin, [width, height], n_points)?;
        let size = format!("{width}x{height}");
        pushes.push(json!({
            "hosting": word(hosting), "plugin": plugin, "frame": size, "points": n_points, "goal": goal_us, "us": us,
        }));
    }
    let starts: Vec<Value> = [
        (Hosting::InProcess, "drift", None),
        (Hosting::Isolated, "drift", Some(10)),
        (Hosting::Isolated, "still", None),
    ]
    .into_iter()
    .filter(|(_, plugin, _)| registry.find(Kind::Tracker, plugin).is_ok())
    .map(|(hosting, plugin, goal)| {
        let ms = start_ms(&registry, hosting, plugin)?;
        Ok(json!({ "hosting": word(hosting), "plugin": plugin, "goal": goal, "ms": ms }))
    })
    .collect::<Outcome<_>>()?;
    Ok(json!({
        "push": pushes,
        "start_to_first_answer": starts,
        "sandbox_ms": faults::sandbox_ms(&zoo)?,
        "deaths": faults::deaths(folder)?,
        "list_of_50_ms": { "goal": 20, "measured": list_ms(folder, &zoo)? },
    }))
}

/// The tracker in Python with its manifest; none without numpy.
fn still(folder: &Path) -> Outcome<Option<PathBuf>> {
    let script = folder.join("still.py");
    std::fs::write(&script, STILL)?;
    let sdk = Path::new(env!("CARGO_MANIFEST_DIR")).join("../plugin/python");
    let mut python = Command::new("python3");
    let described = python.arg(&script).arg("--honami-manifest").env("PYTHONPATH", sdk).output();
    Ok(described.is_ok_and(|output| output.status.success()).then_some(script))
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

fn begun(registry: &Registry, hosting: Hosting, plugin: &str, size: [u32; 2]) -> Outcome<Tracker> {
    let info = registry.find(Kind::Tracker, plugin)?;
    let stands_still: &[&str] = match plugin {
        "null" => &["drift=0"],
        "drift" => &["speed=0"],
        _ => &[],
    };
    begun_with(&Host::new().hosting(hosting), info, stands_still, size)
}

fn begun_with(
    host: &Host,
    info: &PluginInfo,
    settings: &[&str],
    [width, height]: [u32; 2],
) -> Outcome<Tracker> {
    let cx = CallContext::silent();
    let mut values = Values::default();
    for setting in settings {
        values.set_text(&info.params, setting)?;
    }
    let (mut tracker, _) = host.tracker(info, &values, &cx)?;
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
fn start_ms(registry: &Registry, hosting: Hosting, plugin: &str) -> Outcome<Value> {
    let mut times = Vec::with_capacity(STARTS);
    for _ in 0..STARTS {
        let start = Instant::now();
        let tracker = begun(registry, hosting, plugin, [64, 48])?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        drop(tracker);
    }
    Ok(spread(times))
}

/// A folder of fifty libraries, listed without running any.
fn list_ms(folder: &Path, library: &Path) -> Outcome<Value> {
    let folder = folder.join("fifty");
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
    Ok(spread(times))
}
