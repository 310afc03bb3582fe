//! How soon the host knows what has become of a plugin, and what shutting one in takes.

use crate::{Outcome, begun_with, spread};
use honami_host::{
    CallContext, Flow, FrameView, Host, HostError, Hosting, Kind, Patience, PluginInfo, Registry, SearchPath,
    Silence, shut_in,
};
use honami_model::picture::Gray;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Instant;

const CRASHES: usize = 30;
const SET_UPS: usize = 50;

/// Argument under which this program is a process that gives up what a plugin's does, and says how long that took.
pub(crate) const SHUT_IN: &str = "--shut-in";

/// Milliseconds from handing over the frame in which a plugin crashes to the error, and from handing over one in which it
/// hangs to telling so; nothing without a C compiler.
pub(crate) fn deaths(folder: &Path) -> Outcome<Value> {
    let Ok(crashes) = bad(folder, "SEGFAULT") else { return Ok(Value::Null) };
    let times = (0..CRASHES).map(|_| until_told(&crashes, "died of SIGSEGV")).collect::<Outcome<_>>()?;
    let hangs = until_told(&bad(folder, "SLEEPS")?, "no sign of life")?;
    Ok(json!({
        "crash_seen_ms": { "goal": 5, "measured": spread(times) },
        "hang_named_ms": { "goal": 2000, "measured": hangs.round() },
    }))
}

/// The plugin of the tests that has this fault in frame 2.
fn bad(folder: &Path, fault: &str) -> Outcome<PluginInfo> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = folder.join(format!("{fault}.so"));
    let mut compiler = Command::new("cc");
    compiler.args(["-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"]).arg(root.join("../abi/include"));
    compiler.arg(format!("-DFAULT={fault}")).arg(root.join("tests/bad/bad.c")).arg("-o").arg(&library);
    if !compiler.status()?.success() {
        return Err("the bad plugin does not compile".into());
    }
    let path = SearchPath { named: vec![library], ..SearchPath::default() };
    Ok(Registry::scan_path(&path).find(Kind::Tracker, "bad")?.clone())
}

/// Milliseconds from handing over frame 2 to hearing these words as an error, or that there is no sign of life.
fn until_told(info: &PluginInfo, words: &str) -> Outcome<f64> {
    let host = Host::new().hosting(Hosting::Isolated).without_quarantine();
    let mut tracker = begun_with(&host, info, &[], [64, 48])?;
    let pixels = [7; 64 * 48];
    let gray = Gray { data: &pixels, width: 64, height: 48, stride: 64 };
    let frame = FrameView { gray, chroma: None, range: None, index: 2, time_s: 2.0 };
    let (start, heard) = (Instant::now(), OnceLock::new());
    let silent = |silence: Option<Silence>| {
        if silence.is_some() {
            heard.get_or_init(|| start.elapsed());
        }
        Patience::Usual
    };
    let stop = |_: f64, _: &str| if heard.get().is_some() { Flow::Stop } else { Flow::Continue };
    let cx = CallContext { progress: &stop, silent: &silent, ..CallContext::silent() };
    let told = tracker.push(&frame, &cx);
    let took = start.elapsed();
    match (heard.get(), told) {
        (Some(took), Err(HostError::Cancelled { .. })) => Ok(took.as_secs_f64() * 1e3),
        (None, Err(error)) if error.to_string().contains(words) => Ok(took.as_secs_f64() * 1e3),
        (_, told) => Err(format!("wanted {words:?}, got {told:?}").into()),
    }
}

/// Milliseconds that a process takes to give up what it must before it loads a plugin.
pub(crate) fn sandbox_ms(library: &Path) -> Outcome<Value> {
    let once = || -> Outcome<f64> {
        let said = Command::new(std::env::current_exe()?).arg(SHUT_IN).arg(library).output()?;
        Ok(String::from_utf8(said.stdout)?.trim().parse()?)
    };
    let times = (0..SET_UPS).map(|_| once()).collect::<Outcome<_>>()?;
    Ok(json!({ "goal": 2, "measured": spread(times) }))
}

/// The process that [`sandbox_ms`] starts.
pub(crate) fn shut_in_now(library: PathBuf) {
    let start = Instant::now();
    shut_in(&library, &[]);
    #[expect(clippy::print_stdout, reason = "the answer to who has started this")]
    {
        println!("{}", start.elapsed().as_secs_f64() * 1e3);
    }
}
