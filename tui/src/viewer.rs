//! The viewer, a program of its own beside this one: found, had draw scenes, told what to show, and heard.

mod scenes;
#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Read, Write as _};
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::{Context as _, ensure};
use honami_workbench::WorkbenchError;
use honami_workbench::doctor::Finding;
use honami_workbench::plugins::plain;
use honami_workbench::progress::{Flow, Progress};
use honami_workbench::scene::control::{self, Event, Garbled, PROTOCOL};

pub(crate) use self::scenes::{Scenes, skeleton, usual_size};

/// What it is called.
const NAME: &str = "honami-viewer";

/// What a viewer has said, or that it has ended.
#[derive(Clone, Debug)]
pub enum Heard {
    /// Something.
    Said(Event),
    /// Nothing that is known.
    Garbled(Garbled),
    /// It is gone; how, where that was not as it should.
    Ended(Option<String>),
}

/// Whoever lists what draws has so long.
const PATIENCE: Duration = Duration::from_secs(20);
/// Lines for a viewer that wait to be written.
const WAITING: usize = 1024;

/// Who tells a viewer what to do. The viewer ends when the last of these goes.
///
/// A thread of its own writes: whoever waited for the viewer to read could not hear what that waits to say.
#[derive(Clone, Debug)]
pub(crate) struct Teller(SyncSender<String>);

impl Teller {
    /// Tells it lines without waiting; whether they will be written. A viewer that has gone hears nothing, which its end
    /// tells.
    pub(crate) fn tell(&self, lines: &str) -> bool {
        !matches!(self.0.try_send(lines.to_owned()), Err(TrySendError::Full(_)))
    }

    /// Tells it lines, as soon as there is room for them.
    pub(crate) fn pass(&self, lines: &str) {
        self.0.send(lines.to_owned()).unwrap_or_default();
    }
}

/// Writes what is told, until nobody tells any more or nobody reads.
fn write(mut pipe: ChildStdin, told: &Receiver<String>) {
    for lines in told {
        if pipe.write_all(lines.as_bytes()).and_then(|()| pipe.flush()).is_err() {
            return;
        }
    }
}

/// The viewer's file.
///
/// # Errors
/// Where it is not there, with the command that builds it.
pub(crate) fn program() -> anyhow::Result<PathBuf> {
    let own = std::env::current_exe().context("cannot find the viewer beside this program")?;
    beside(&own)
}

fn beside(own: &Path) -> anyhow::Result<PathBuf> {
    let path = own.with_file_name(format!("{NAME}{}", std::env::consts::EXE_SUFFIX));
    let is_debug = own.parent().is_some_and(|folder| folder.ends_with("debug"));
    ensure!(
        path.is_file(),
        "the viewer is not there: {} was looked for; `{}` builds it",
        path.display(),
        build(!is_debug)
    );
    Ok(path)
}

/// What builds it.
fn build(is_release: bool) -> String {
    format!("cargo build {}-p {NAME}", if is_release { "--release " } else { "" })
}

/// Whether there is a display for a window, by variables of the environment.
pub(crate) fn has_display(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY"]
        .into_iter()
        .any(|name| variable(name).is_some_and(|value| !value.is_empty()))
}

/// What a window needs here.
///
/// # Errors
/// Where the viewer is not there, or no display; what draws without one is nothing to somebody in a terminal.
pub(crate) fn opens(variable: impl Fn(&str) -> Option<OsString>) -> anyhow::Result<()> {
    program()?;
    ensure!(
        has_display(variable),
        "there is no display for a window: neither DISPLAY nor WAYLAND_DISPLAY is set"
    );
    Ok(())
}

/// Has the viewer draw so many frames, or as many as there are, and waits for its end.
///
/// # Errors
/// Where it is not there, does not start, or fails, by its own words where it has any.
pub(crate) fn have(args: &[OsString], n_frames: u32, progress: &dyn Progress) -> anyhow::Result<()> {
    let program = program()?;
    // Where this process ends, so does the pipe, and with it the viewer.
    let mut command = command(&program, args);
    let spawned = command.arg("--attended").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let mut child = spawned.with_context(|| starting(&program))?;
    let held = child.stdin.take();
    let mut words = String::new();
    for line in
        child.stdout.take().into_iter().flat_map(|told| BufReader::new(told).lines().map_while(Result::ok))
    {
        match control::event(&line) {
            Ok(Event::Failed(why)) => words = why,
            Ok(Event::Frame(frame))
                if progress.report(u64::from(frame) + 1, u64::from(n_frames), "frames") == Flow::Stop =>
            {
                drop(held);
                child.wait().with_context(|| starting(&program))?;
                return Err(WorkbenchError::Stopped.into());
            }
            _ => {}
        }
    }
    let status = child.wait().with_context(|| starting(&program))?;
    drop(held);
    ending(status).map_or(Ok(()), |how| Err(anyhow::anyhow!(with_words(status, how, &words))))
}

/// Why a viewer that says what it speaks is not to be talked to, where it is another version.
pub(crate) fn stranger(protocol: u32) -> Option<&'static str> {
    (protocol != PROTOCOL).then_some("the viewer is of another version of honami: build both anew")
}

/// Starts the viewer's window; what it says comes to `heard`, on a thread of its own, its end last. Where `errors` are piped,
/// the last of them are in the line about its end.
///
/// # Errors
/// Where it is not there, or does not start.
pub(crate) fn start(
    args: &[OsString],
    errors: Stdio,
    heard: impl FnMut(Heard) + Send + 'static,
) -> anyhow::Result<Teller> {
    let program = program()?;
    let mut command = command(&program, args);
    let spawned = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(errors).spawn();
    let mut child = spawned.with_context(|| starting(&program))?;
    let (tell, hear) = child.stdin.take().zip(child.stdout.take()).with_context(|| starting(&program))?;
    let words = child.stderr.take().map(|errors| {
        std::thread::Builder::new().name("the viewer's errors".to_owned()).spawn(move || last_words(errors))
    });
    let words = words.transpose().with_context(|| starting(&program))?;
    std::thread::Builder::new()
        .name("viewer".to_owned())
        .spawn(move || listen(hear, child, words, heard))
        .with_context(|| starting(&program))?;
    let (teller, told) = sync_channel(WAITING);
    std::thread::Builder::new()
        .name("to the viewer".to_owned())
        .spawn(move || write(tell, &told))
        .with_context(|| starting(&program))?;
    Ok(Teller(teller))
}

fn listen(
    hear: ChildStdout,
    mut child: Child,
    words: Option<JoinHandle<String>>,
    mut heard: impl FnMut(Heard),
) {
    for line in BufReader::new(hear).lines().map_while(Result::ok) {
        heard(control::event(&line).map_or_else(Heard::Garbled, Heard::Said));
    }
    let status = child.wait();
    let words = words.and_then(|words| words.join().ok()).unwrap_or_default();
    heard(Heard::Ended(match status {
        Ok(status) => ending(status).map(|how| with_words(status, how, &words)),
        Err(error) => Some(format!("the viewer: {error}")),
    }));
}

/// The last line that says something; after a panic a hint follows what it said.
fn last_words(errors: impl Read) -> String {
    let lines = BufReader::new(errors).split(b'\n').map_while(Result::ok);
    let lines = lines.map(|line| plain(&String::from_utf8_lossy(&line)).trim().to_owned());
    lines.filter(|line| !line.is_empty() && !line.starts_with("note: ")).last().unwrap_or_default()
}

/// How it has ended, in its own words where it has said why.
fn with_words(status: ExitStatus, how: String, words: &str) -> String {
    match (status.code(), words.strip_prefix(&format!("{NAME}: ")).unwrap_or(words)) {
        (_, "") => how,
        (Some(1 | 2), words) => format!("the viewer: {words}"),
        (_, words) => format!("{how}; it last said: {words}"),
    }
}

/// What this machine has of it: which adapter it would draw with.
#[must_use]
pub(crate) fn finding() -> Finding {
    let program = program();
    let adapter = program.as_ref().ok().map(|program| adapter(program));
    let found = match &adapter {
        None => "not built".to_owned(),
        Some(adapter) => adapter.as_ref().map_or_else(String::clone, |name| format!("draws with {name}")),
    };
    let advice = match &adapter {
        None => format!("`{}` builds it", build(true)),
        Some(_) => "sudo apt-get install mesa-vulkan-drivers draws without a graphics card".to_owned(),
    };
    Finding {
        what: "viewer",
        there: matches!(adapter, Some(Ok(_))),
        found,
        adds: "skeletons and forests in a window and in movies (`honami view`)",
        advice: Some(advice),
    }
}

/// The adapter that a viewer would draw with, or why it has none.
fn adapter(program: &Path) -> Result<String, String> {
    // Whoever only asks wants no cache of compiled shaders at home.
    let mut command = command(program, &["--adapters".into(), "--json".into()]);
    command.env("MESA_SHADER_CACHE_DISABLE", "true").stdin(Stdio::null());
    let spawned = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = spawned.map_err(|error| format!("{}: {error}", starting(program)))?;
    let end = |child: &mut Child| child.wait().map_err(|error| error.to_string());
    let (told, ended) = sync_channel(1);
    let (out, errors) = (child.stdout.take(), child.stderr.take());
    let listen = move || {
        let words = errors.map(last_words).unwrap_or_default();
        let said = out.and_then(|out| serde_json::from_reader(out).ok()).unwrap_or_default();
        told.send((said, words)).unwrap_or_default();
    };
    std::thread::Builder::new()
        .name("adapters".to_owned())
        .spawn(listen)
        .map_err(|error| error.to_string())?;
    let Ok::<(serde_json::Value, _), _>((told, words)) = ended.recv_timeout(PATIENCE) else {
        child.kill().and_then(|()| child.wait().map(drop)).unwrap_or_default();
        return Err(format!("the viewer says nothing for {} s: a driver hangs", PATIENCE.as_secs()));
    };
    let status = end(&mut child)?;
    if let Some(how) = ending(status).filter(|_| told.is_null()) {
        return Err(with_words(status, how, &words));
    }
    let first = told["adapters"].get(0).ok_or("there is nothing to draw with: no card and no driver")?;
    let word = |name: &str| first[name].as_str().unwrap_or_default().to_owned();
    let kind = if first["software"] == true { ", without a graphics card" } else { "" };
    Ok(format!("{} by {}{kind}", word("name"), word("backend")))
}

fn command(program: &Path, args: &[OsString]) -> Command {
    let mut command = Command::new(program);
    command.args(args);
    // Drivers complain of it where nobody has logged in, as over SSH, though they need nothing of it.
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    }
    command
}

fn starting(program: &Path) -> String {
    format!("cannot start {}", program.display())
}

/// How it has ended where that was not as it should.
fn ending(status: ExitStatus) -> Option<String> {
    if status.success() {
        return None;
    }
    Some(match (status.code(), status.signal()) {
        (Some(code), _) => format!("the viewer failed, with status {code}"),
        (None, Some(signal)) => format!("the viewer crashed, by signal {signal}"),
        (None, None) => "the viewer crashed".to_owned(),
    })
}
