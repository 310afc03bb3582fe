//! The viewer's window beside the terminal: the real programs, on a display that nobody sees, clicked and killed.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use portable_pty::CommandBuilder;
use rustix::process::{Pid, Signal, kill_process};

use super::work::{plugins, said};
use super::x11::Display;
use super::{PATIENCE, Terminal, folder};

/// The window's button that plays, pixels from its upper left: below a picture 720 pixels high.
const PLAY: [u16; 2] = [27, 748];
/// Where its slider of time begins, beside that, and how wide it is.
const RAIL: ([u16; 2], u16) = ([56, 748], 860);

/// Ends a program when this goes.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        self.0.kill().and_then(|()| self.0.wait()).map(drop).unwrap_or_default();
    }
}

/// What is skipped for want of something that `HONAMI_SKIP=never` forbids to do without.
fn missing<T>(what: &str) -> Option<T> {
    let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
    assert!(!never, "there is no {what}, and HONAMI_SKIP=never forbids to do without");
    std::io::stderr().write_all(format!("skipped: needs {what}\n").as_bytes()).unwrap();
    None
}

/// A display, its number, and what draws on it; `None`, which is told, where either is missing.
fn display() -> Option<(Ended, u32)> {
    let viewer = Path::new(env!("CARGO_BIN_EXE_honami")).with_file_name("honami-viewer");
    let Ok(adapters) = Command::new(viewer).args(["--adapters", "--json"]).output() else {
        return missing("viewer (cargo build -p honami-viewer)");
    };
    let told: serde_json::Value = serde_json::from_slice(&adapters.stdout).unwrap_or_default();
    if told["adapters"].get(0).is_none() {
        return missing("driver to draw with (apt-get install mesa-vulkan-drivers)");
    }
    let begun = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1300x800x24", "-nolisten", "tcp"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut server) = begun else { return missing("Xvfb") };
    // It writes which display it is once it can be used.
    let mut number = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
    Some((Ended(server), number.trim().parse().unwrap()))
}

/// The viewers that a program has started and that have not ended.
fn viewers(parent: u32) -> Vec<i32> {
    let processes = std::fs::read_dir("/proc").unwrap().flatten();
    let own = processes.filter_map(|process| {
        let stat = std::fs::read_to_string(process.path().join("stat")).ok()?;
        let (head, rest) = stat.rsplit_once(") ")?;
        let mut rest = rest.split(' ');
        let is_own = rest.next()? != "Z" && rest.next()?.parse() == Ok(parent);
        let is_viewer = head.ends_with("(honami-viewer");
        (is_own && is_viewer).then(|| process.file_name().to_str()?.parse().ok())?
    });
    own.collect()
}

/// The frame that the terminal says it is in.
fn frame(screen: &vt100::Screen) -> Option<u32> {
    screen.contents().trim_end().lines().last()?.split_once('/')?.0.trim().parse().ok()
}

/// Where the slider of time stands in the window, of its whole way; `None` before it is drawn.
fn slider(display: &mut Display) -> Option<f64> {
    let row = display.row(RAIL.0, RAIL.1);
    // Its handle alone has an edge so bright.
    let bright: Vec<usize> = (0..row.len()).filter(|x| row[*x] > 190).collect();
    let middle = bright.first()?.midpoint(*bright.last()?);
    Some(middle as f64 / f64::from(RAIL.1))
}

/// Waits until something is seen on the display.
#[track_caller]
fn wait_until(terminal: &mut Terminal, what: &str, mut is_it: impl FnMut() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !is_it() {
        assert!(terminal.listen(Duration::from_millis(50)).1, "{what}: it ended");
        assert!(Instant::now() < until, "{what}: still not");
    }
}

#[test]
fn the_window_is_in_step_and_its_end_is_a_line() {
    let Some((_server, number)) = display() else { return };
    let folder = folder();
    let plugins = plugins();
    said(folder.path(), "synth leaves.y4m --size 160x120 --frames 40");
    said(folder.path(), "new p.honami leaves.y4m");
    said(folder.path(), "track p.honami --with anchored");
    said(folder.path(), "cluster p.honami --with bod");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_honami"));
    command.arg("p.honami");
    command.env("HONAMI_PLUGIN_PATH", plugins);
    command.env("DISPLAY", format!(":{number}"));
    command.env("XDG_RUNTIME_DIR", folder.path());
    command.env_remove("WAYLAND_DISPLAY");
    let mut terminal = Terminal::start(command, folder.path(), (120, 36), true);
    let mut display = Display::connect(number);
    terminal.wait_for("the project", |screen| frame(screen) == Some(0));
    terminal.press("vw");
    terminal.wait_for_text("the viewer's window is open");
    let own = terminal.child.process_id().unwrap();
    let [viewer] = viewers(own)[..] else { panic!("not one viewer") };
    // The window goes where the terminal goes.
    for (keys, least, most) in [("ge", 0.9, 1.0), ("gs", 0.0, 0.1), ("20gf", 0.45, 0.6)] {
        terminal.press(keys);
        wait_until(&mut terminal, keys, || {
            slider(&mut display).is_some_and(|at| (least..=most).contains(&at))
        });
    }
    // The terminal goes where the window goes: it plays there, until a key stops it.
    terminal.wait_for("where the terminal went", |screen| frame(screen) == Some(20));
    display.click(PLAY);
    terminal.wait_for("where the window goes", |screen| frame(screen) != Some(20));
    terminal.press("gs");
    wait_until(&mut terminal, "stopped", || slider(&mut display).is_some_and(|at| at < 0.1));
    // However it ends, that is a line, and the terminal goes on.
    kill_process(Pid::from_raw(viewer).unwrap(), Signal::KILL).unwrap();
    terminal.wait_for_text("the viewer crashed, by signal 9");
    terminal.press("7gf");
    terminal.wait_for("the terminal", |screen| frame(screen) == Some(7));
    // Another one opens; the key that opened it closes it, and so does leaving.
    for close in ["vw", "q"] {
        terminal.press("vw");
        terminal.wait_for_text("the viewer's window is open");
        let [viewer] = viewers(own)[..] else { panic!("not one viewer") };
        terminal.press(close);
        let gone = || !Path::new(&format!("/proc/{viewer}/exe")).exists();
        match close {
            "q" => assert!(terminal.wait_for_end()),
            _ => terminal.wait_for_text("the viewer's window is closed"),
        }
        let until = Instant::now() + PATIENCE;
        while !gone() {
            assert!(Instant::now() < until, "the window is still there after {close}");
            terminal.listen(Duration::from_millis(50));
        }
    }
    terminal.assert_restored();
    let caches = std::fs::read_dir(folder.path().join("honami/frames")).into_iter().flatten().flatten();
    let scenes = caches.filter(|cache| cache.file_name().to_string_lossy().starts_with("scene-"));
    assert_eq!(scenes.count(), 0, "scenes are left among the caches");
}
