//! What the tests share: libraries built by cargo and cc, a store of their own, a small stream.

use honami_host::{
    CallContext, FrameView, Host, HostError, Hosting, Kind, PluginInfo, Point, Points, Registry, SearchPath,
    StreamInfo, Tracker, Values,
};
use honami_model::picture::Gray;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

pub(crate) const WIDTH: u32 = 8;
pub(crate) const HEIGHT: u32 = 4;

/// A folder for this run, kept until the process ends.
pub(crate) fn scratch() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
        // Runs that are over leave theirs behind: a static is never dropped.
        for old in std::fs::read_dir(tmp).into_iter().flatten().flatten() {
            let name = old.file_name().into_string().unwrap_or_default();
            let process = name.strip_prefix("host-").map(|pid| Path::new("/proc").join(pid));
            if process.is_some_and(|process| !process.exists()) {
                std::fs::remove_dir_all(old.path()).unwrap_or_default();
            }
        }
        tmp.join(format!("host-{}", std::process::id()))
    })
}

pub(crate) fn host() -> Host {
    Host::with_store(scratch().join("store")).hosting(Hosting::InProcess)
}

/// The zoo's library. cargo is asked for the path: a guessed one may be stale.
pub(crate) fn zoo() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        let output = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--example", "zoo", "--message-format=json"])
            .args(what("-p honami-host"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        let artifacts = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        let mut files = artifacts.filter(|a| a["target"]["name"] == "zoo").map(|a| a["filenames"][0].clone());
        PathBuf::from(files.next_back().unwrap().as_str().unwrap())
    })
}

/// Where to look for what is built: everywhere, where all is tested together (`HONAMI_BUILD`), or much would be built
/// once more, with other features.
fn what(package: &str) -> Vec<String> {
    let what = std::env::var("HONAMI_BUILD").unwrap_or_else(|_| package.to_owned());
    what.split_whitespace().map(str::to_owned).collect()
}

/// A host whose plugins have processes of their own, in a program that is built when it is first needed.
pub(crate) fn isolating() -> Host {
    static BUILT: OnceLock<()> = OnceLock::new();
    BUILT.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--quiet", "--bin", "honami-plughost"]).args(what("-p honami-plughost"));
        assert!(cargo.status().unwrap().success());
    });
    host().hosting(Hosting::Isolated)
}

/// Whether there is a compiler of this name; says so if not, which `HONAMI_SKIP=never` forbids.
pub(crate) fn has_compiler(name: &str) -> bool {
    let is_there = Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
    assert!(is_there || !never, "there is no compiler {name}, and HONAMI_SKIP=never forbids to do without");
    if !is_there {
        eprintln!("skipped: needs a compiler ({name})");
    }
    is_there
}

/// Whether there is a C compiler; says so if not.
pub(crate) fn has_cc() -> bool {
    has_compiler("cc")
}

/// Compiles a C plugin into the scratch folder. Its name comes to it when it is whole: tests that share one compile it
/// at the same time, and none must find half of it.
pub(crate) fn compile(source: &str, name: &str, include: &str, flags: &[&str]) -> PathBuf {
    static BUILT: AtomicUsize = AtomicUsize::new(0);
    std::fs::create_dir_all(scratch()).unwrap();
    let (root, library) = (Path::new(env!("CARGO_MANIFEST_DIR")), scratch().join(format!("{name}.so")));
    let fresh = library.with_extension(format!("{}.o", BUILT.fetch_add(1, Ordering::Relaxed)));
    let output = Command::new("cc")
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"])
        .args(["-fvisibility=hidden", "-I", include])
        .args(flags)
        .args([Path::new(source), Path::new("-o"), &fresh])
        .current_dir(root)
        .output()
        .unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    std::fs::rename(&fresh, &library).unwrap();
    library
}

/// The plugins of libraries that the user names.
pub(crate) fn named(paths: &[&Path]) -> Registry {
    let named = paths.iter().map(|path| path.to_path_buf()).collect();
    Registry::scan_path(&SearchPath { named, ..SearchPath::default() })
}

pub(crate) fn of_zoo(kind: Kind, name: &str) -> PluginInfo {
    let registry = named(&[zoo()]);
    assert!(registry.problems().is_empty(), "{:?}", registry.problems());
    registry.find(kind, name).unwrap().clone()
}

pub(crate) fn start(info: &PluginInfo, settings: &[&str]) -> Result<Tracker, HostError> {
    start_in(&host(), info, settings)
}

pub(crate) fn start_in(host: &Host, info: &PluginInfo, settings: &[&str]) -> Result<Tracker, HostError> {
    let mut values = Values::default();
    for setting in settings {
        values.set_text(&info.params, setting)?;
    }
    Ok(host.tracker(info, &values, &CallContext::silent())?.0)
}

pub(crate) fn stream() -> StreamInfo {
    let (width, height, fps) = (WIDTH, HEIGHT, Some(25.0));
    StreamInfo { width, height, fps, n_frames: None, reversed: false, max_threads: 1, seed: 1, births: 0..0 }
}

/// Pixels of frame n: a gradient that moves.
pub(crate) fn pixels(n: i64) -> Vec<u8> {
    (0..i64::from(WIDTH * HEIGHT)).map(|k| ((k * 7 + n * 13) % 251) as u8).collect()
}

pub(crate) fn view(pixels: &[u8], index: i64) -> FrameView<'_> {
    let gray = Gray { data: pixels, width: WIDTH, height: HEIGHT, stride: WIDTH as usize };
    FrameView { gray, chroma: None, range: None, index, time_s: index as f64 / 25.0 }
}

pub(crate) fn point(id: u32, x: f32, y: f32) -> Point {
    Point { id, x, y }
}

/// Pushes a frame.
pub(crate) fn push(tracker: &mut Tracker, index: i64) -> Result<Vec<Points>, HostError> {
    tracker.push(&view(&pixels(index), index), &CallContext::silent())
}

/// Ids of the rows of a frame, with their statuses as numbers.
pub(crate) fn ids(points: &Points) -> Vec<(u32, u8)> {
    points.rows.iter().map(|row| (row.id, row.status as u8)).collect()
}
