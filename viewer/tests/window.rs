//! The window under a display of its own: opened, driven through the control pipe, captured, and ended.
#![expect(clippy::unwrap_used, reason = "a failed step of a test is a failed test")]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

use honami_scene::control::Event;
use honami_scene::skeleton::{Bone, Film, Group, Joint};
use honami_scene::{ForestScene, Scene, SkeletonScene};
use image::RgbImage;
use tempfile::TempDir;

#[expect(unreachable_pub, reason = "it is that of the library's tests")]
#[path = "../src/testing/forest.rs"]
mod forest;

const VIEWER: &str = env!("CARGO_BIN_EXE_honami-viewer");

/// A trunk with one branch, of a red group, that sways.
fn scene() -> Scene {
    let bone = |node| Some(Bone { node, gain: 1.0, ..Bone::default() });
    let rest = [0.0, 0.0, 1.0];
    let joints = vec![
        Joint::default(),
        Joint { parent: Some(0), bone: bone(4), rest, ..Joint::default() },
        Joint {
            parent: Some(1),
            group: Some(0),
            bone: bone(2),
            rest,
            name: "group 1".into(),
            ..Joint::default()
        },
    ];
    let places = |frame: u32| [[60.0, 0.0, -85.0], [60.0, 0.0, -50.0], [40.0 + frame as f32, 0.0, -20.0]];
    Scene::Skeleton(Box::new(SkeletonScene {
        name: "a twig".to_owned(),
        clip: Film { width: 120, height: 90, n_frames: 20, ..Film::default() },
        joints,
        places: (0..20).flat_map(places).collect(),
        first_frame: 5,
        times: (0..20).map(|frame| f64::from(frame) / 25.0).collect(),
        groups: vec![Group { colour: [255, 80, 80], ..Group::default() }],
        ..SkeletonScene::default()
    }))
}

/// Ends a program when this goes.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        self.0.kill().and_then(|()| self.0.wait()).map(drop).unwrap_or_default();
    }
}

/// A display that nobody sees, and its name; `None`, which is told, where there is no Xvfb, which `HONAMI_SKIP=never` forbids.
fn display() -> Option<(Ended, String)> {
    let begun = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1024x768x24", "-nolisten", "tcp"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut server) = begun else {
        let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
        assert!(!never, "there is no Xvfb, and HONAMI_SKIP=never forbids to do without");
        std::io::stderr().write_all(b"skipped: needs Xvfb\n").unwrap();
        return None;
    };
    // It writes which display it is once it can be used.
    let mut number = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
    Some((Ended(server), format!(":{}", number.trim())))
}

/// A viewer that says nothing for so long has hung.
const PATIENCE: Duration = Duration::from_secs(120);

/// A window on a display of its own.
struct Window {
    folder: TempDir,
    child: Ended,
    tell: Option<ChildStdin>,
    events: Receiver<Event>,
    _display: Ended,
}

impl Window {
    /// One that shows a scene, `a.scene` in its folder.
    fn open(scene: &Scene) -> Option<Self> {
        let (display, name) = display()?;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.scene");
        honami_scene::file::write(&path, scene).unwrap();
        let mut child = Command::new(VIEWER)
            .arg(&path)
            .args(["--control", "--size", "640x480"])
            .env("DISPLAY", name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (tell, lines) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        let (said, events) = sync_channel(64);
        let listen = move || {
            for line in lines.lines() {
                said.send(honami_scene::control::event(&line.unwrap()).unwrap()).unwrap_or_default();
            }
        };
        std::thread::Builder::new().spawn(listen).unwrap();
        let window = Self { folder, child: Ended(child), tell, events, _display: display };
        window.hear(|event| matches!(event, Event::Ready { protocol: 1, adapter } if !adapter.is_empty()));
        Some(window)
    }

    fn tell(&mut self, lines: &str) {
        writeln!(self.tell.as_mut().unwrap(), "{lines}").unwrap();
    }

    /// Waits for an event that is like this.
    #[track_caller]
    fn hear(&self, is_it: impl Fn(&Event) -> bool) -> Event {
        loop {
            let event = self.events.recv_timeout(PATIENCE).expect("the viewer says more");
            if is_it(&event) {
                return event;
            }
        }
    }

    /// Waits to hear of a failure in these words.
    #[track_caller]
    fn hear_failure(&self, words: &str) {
        self.hear(|event| matches!(event, Event::Failed(why) if why.contains(words)));
    }

    /// Has another scene shown.
    fn show(&mut self, path: &Path) {
        self.tell(&format!("{{\"scene\":{{\"protocol\":1,\"path\":{:?}}}}}", path.to_str().unwrap()));
    }

    /// What it shows.
    fn captured(&mut self, name: &str) -> RgbImage {
        let path = self.folder.path().join(name);
        self.tell(&format!("{{\"capture\":{:?}}}", path.to_str().unwrap()));
        self.hear(|event| *event == Event::Captured(path.clone()));
        image::open(&path).unwrap().into_rgb8()
    }

    /// The end of the pipe is its end.
    fn end(mut self) {
        drop(self.tell.take());
        self.hear(|event| *event == Event::Closed);
        assert!(self.child.0.wait().unwrap().success());
    }
}

/// Of the pixels in the colour of the branch: how many, and their mean column.
fn branch(window: &RgbImage) -> (usize, f64) {
    let is_red = |at: &[u8; 3]| at[0] > 150 && at[1] < 110 && at[2] < 110;
    let red = window.enumerate_pixels().filter(|(_, _, at)| is_red(&at.0));
    let (n, sum) = red.fold((0, 0.0), |(n, sum), (x, _, _)| (n + 1, sum + f64::from(x)));
    (n, sum / n as f64)
}

#[test]
fn a_window_is_opened_driven_captured_and_ended() {
    let Some(mut window) = Window::open(&scene()) else { return };
    window.tell("garbled\nframe 6\nselect {\"bone\":2}\nwind storm");
    window.hear_failure("garbled");
    window.hear_failure("wind");
    let early = window.captured("early.png");
    assert!(early.width() >= 640 && early.height() >= 480);
    window.tell("frame 20");
    let late = window.captured("late.png");
    let ((n_red, left), (_, right)) = (branch(&early), branch(&late));
    assert!(n_red > 200, "the branch is seen: {n_red} pixels of its colour");
    assert!(right > left + 15.0, "and has swayed by then: {left:.1} to {right:.1}");
    window.tell("select");
    let n_changed = window.captured("none.png").pixels().zip(late.pixels()).filter(|(a, b)| a != b).count();
    assert!(n_changed > 50, "what is chosen looks otherwise: {n_changed} pixels");
    // A scene that is cut short is told, and what was shown stays.
    let (whole, short) = (window.folder.path().join("a.scene"), window.folder.path().join("short.scene"));
    let bytes = std::fs::read(&whole).unwrap();
    std::fs::write(&short, &bytes[..bytes.len() - 5]).unwrap();
    window.show(&short);
    window.hear_failure("cut short");
    window.show(&whole);
    window.tell("cut 3");
    window.hear(|event| *event == Event::Cut(3));
    window.end();
}

#[test]
fn a_forest_sways_in_its_window_and_its_wind_is_turned() {
    let forest = |n_copies| forest::forest(60, 6, n_copies);
    let Some(mut window) = Window::open(&Scene::Forest(Box::new(forest(4)))) else { return };
    window.tell("wind storm+vortex:x=2,y=1\nwind breeze\ncut 3\npause\nframe 25");
    window.hear_failure("\"breeze\" is no wind");
    window.hear_failure("a forest has no groups");
    let early = window.captured("early.png");
    let n_green = early.pixels().filter(|at| at.0[1] > at.0[0] && at.0[0] > at.0[2]).count();
    assert!(n_green > 20_000, "the ground is seen: {n_green} green pixels");
    window.tell("frame 4000000000");
    window.hear_failure("is too far");
    // Of a forest that cannot be shown nothing is taken: neither its name nor its wind.
    let none = window.folder.path().join("none.scene");
    let odd = ForestScene { name: "none".to_owned(), wind: "breeze".to_owned(), ..forest(9) };
    honami_scene::file::write(&none, &Scene::Forest(Box::new(odd))).unwrap();
    window.show(&none);
    window.hear_failure("\"breeze\" is no wind");
    assert!(window.captured("after.png") == early, "all is as it was");
    window.tell("frame 45");
    assert!(window.captured("late.png") != early, "and it sways");
    window.end();
}

#[test]
fn what_is_missing_is_told_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.scene");
    honami_scene::file::write(&path, &scene()).unwrap();
    let told = |path: &Path, words: &[&str]| {
        let mut command = Command::new(VIEWER);
        command.arg(path).args(words).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        let mut child = command.stdin(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut told = String::new();
        child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
        (child.wait().unwrap().code(), told)
    };
    let (code, line) = told(&path, &[]);
    assert_eq!(code, Some(1));
    assert!(
        line.contains("there is no display") && line.contains("--offscreen") && line.lines().count() == 1,
        "{line}"
    );
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
    let (code, line) = told(&path, &["--offscreen", "a.png"]);
    assert!(code == Some(1) && line.contains("cut short"), "{line}");
    assert_eq!(told(&path, &["--size", "big"]).0, Some(2));
}
