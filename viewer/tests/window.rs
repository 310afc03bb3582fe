//! The window under a display of its own: opened, driven through the control pipe, captured, and ended.
#![expect(clippy::unwrap_used, reason = "a failed step of a test is a failed test")]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use honami_scene::control::Event;
use honami_scene::skeleton::{Bone, Film, Group, Joint};
use honami_scene::{ForestScene, Scene, SkeletonScene};

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
        is_open: true,
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

/// The next event that is like this.
fn heard(lines: &mut BufReader<ChildStdout>, is_it: impl Fn(&Event) -> bool) -> Event {
    loop {
        let mut line = String::new();
        assert!(lines.read_line(&mut line).unwrap() > 0, "the viewer has ended");
        let event = honami_scene::control::event(&line).unwrap();
        if is_it(&event) {
            return event;
        }
    }
}

#[test]
fn a_window_is_opened_driven_captured_and_ended() {
    let Some((_server, display)) = display() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (path, picture) = (folder.path().join("a.scene"), folder.path().join("window.png"));
    honami_scene::file::write(&path, &scene()).unwrap();
    let mut child = Command::new(VIEWER)
        .arg(&path)
        .args(["--control", "--size", "640x480"])
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut tell = child.stdin.take().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    heard(&mut lines, |event| matches!(event, Event::Ready { protocol: 1, adapter } if !adapter.is_empty()));
    writeln!(tell, "garbled\nframe 12\nselect {{\"bone\":2}}\nwind storm").unwrap();
    let Event::Failed(why) = heard(&mut lines, |event| matches!(event, Event::Failed(_))) else {
        unreachable!()
    };
    assert!(why.contains("garbled"), "{why}");
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("wind")));
    writeln!(tell, "{{\"capture\":{:?}}}", picture.to_str().unwrap()).unwrap();
    heard(&mut lines, |event| *event == Event::Captured(picture.clone()));
    let window = image::open(&picture).unwrap().into_rgb8();
    assert!(window.width() >= 640 && window.height() >= 480);
    let n_red = window.pixels().filter(|at| at.0[0] > 150 && at.0[1] < 110 && at.0[2] < 110).count();
    assert!(n_red > 200, "the branch is seen: {n_red} pixels of its colour");
    // A scene that is cut short is told, and what was shown stays.
    let short = folder.path().join("short.scene");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&short, &whole[..whole.len() - 5]).unwrap();
    let scene =
        |path: &Path| format!("{{\"scene\":{{\"protocol\":1,\"path\":{:?}}}}}", path.to_str().unwrap());
    writeln!(tell, "{}\n{}\ncut 3", scene(&short), scene(&path)).unwrap();
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("cut short")));
    heard(&mut lines, |event| *event == Event::Cut(3));
    // The end of the pipe is its end.
    drop(tell);
    heard(&mut lines, |event| *event == Event::Closed);
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_forest_sways_in_its_window_and_its_wind_is_turned() {
    let Some((_server, display)) = display() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (path, picture) = (folder.path().join("a.scene"), folder.path().join("window.png"));
    honami_scene::file::write(&path, &Scene::Forest(Box::new(forest::forest(60, 6, 4)))).unwrap();
    let mut child = Command::new(VIEWER)
        .arg(&path)
        .args(["--control", "--size", "640x480"])
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .env("XDG_RUNTIME_DIR", folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut tell = child.stdin.take().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    heard(&mut lines, |event| matches!(event, Event::Ready { protocol: 1, .. }));
    writeln!(tell, "wind storm+vortex:x=2,y=1\nwind breeze\ncut 3\npause\nframe 25").unwrap();
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("\"breeze\" is no wind")));
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("a forest has no groups")));
    writeln!(tell, "{{\"capture\":{:?}}}", picture.to_str().unwrap()).unwrap();
    heard(&mut lines, |event| *event == Event::Captured(picture.clone()));
    let window = image::open(&picture).unwrap().into_rgb8();
    let n_green = window.pixels().filter(|at| at.0[1] > at.0[0] && at.0[0] > at.0[2]).count();
    assert!(n_green > 20_000, "the ground is seen: {n_green} green pixels");
    writeln!(tell, "frame 4000000000").unwrap();
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("is too far")));
    // Of a forest that cannot be shown nothing is taken: neither its name nor its wind.
    let (none, after) = (folder.path().join("none.scene"), folder.path().join("after.png"));
    let odd = ForestScene { name: "none".to_owned(), wind: "breeze".to_owned(), ..forest::forest(60, 6, 9) };
    honami_scene::file::write(&none, &Scene::Forest(Box::new(odd))).unwrap();
    writeln!(tell, "{{\"scene\":{{\"protocol\":1,\"path\":{:?}}}}}", none.to_str().unwrap()).unwrap();
    heard(&mut lines, |event| matches!(event, Event::Failed(why) if why.contains("\"breeze\" is no wind")));
    writeln!(tell, "{{\"capture\":{:?}}}", after.to_str().unwrap()).unwrap();
    heard(&mut lines, |event| *event == Event::Captured(after.clone()));
    assert!(image::open(&after).unwrap().into_rgb8() == window, "all is as it was");
    drop(tell);
    heard(&mut lines, |event| *event == Event::Closed);
    assert!(child.wait().unwrap().success());
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
