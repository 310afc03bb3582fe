//! Files, by a picture that is one colour after another.

use super::{Picture, Shot, run};
use crate::args::Args;
use crate::gpu::Gpu;
use crate::target::Target;
use crate::testing;
use clap::Parser as _;
use honami_scene::Orbit;
use std::path::Path;

/// Of one colour, redder from second to second; fails at a time.
struct Flat {
    filmed: Option<(f64, u32)>,
    fails_at: f64,
    shots: Vec<Shot>,
}

impl Picture for Flat {
    fn orbit(&self) -> Orbit {
        Orbit { target: [0.0; 3], distance: 2.0, azimuth: 0.0, elevation: 0.0, angle: 1.0 }
    }

    fn filmed(&self) -> Option<(f64, u32)> {
        self.filmed
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<()> {
        anyhow::ensure!(shot.time < self.fails_at, "no more paint");
        self.shots.push(*shot);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        drop(target.pass(&mut encoder));
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

fn flat() -> Flat {
    Flat { filmed: None, fails_at: f64::INFINITY, shots: Vec::new() }
}

fn args(out: &Path, words: &str) -> Args {
    let words = words.split_whitespace();
    let out = out.to_str().unwrap();
    Args::try_parse_from(["viewer", "scene", "--offscreen", out, "--size", "18x9"].into_iter().chain(words))
        .unwrap()
}

fn draw(flat: &mut Flat, out: &Path, words: &str) -> Option<anyhow::Result<()>> {
    let gpu = testing::gpu()?;
    Some(run(&gpu, flat, out, &args(out, words)))
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

#[test]
fn images_and_movies_have_the_frames_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let table = [
        ("a.png", "", None, vec![0.0]),
        ("b.PNG", "--frames 3 --fps 10", None, vec![0.2]),
        ("c", "--seconds 0.3 --fps 10", None, vec![0.0, 0.1, 0.2]),
        ("d.e/", "--frames 2", None, vec![0.0, 0.04]),
        ("f.y4m", "", Some((4.0, 3)), vec![0.0, 0.25, 0.5]),
        ("g.y4m", "--fps 8", Some((4.0, 1)), vec![0.0, 0.125]),
    ];
    for (name, words, filmed, times) in table {
        let out = folder.path().join(name);
        let mut flat = Flat { filmed, ..flat() };
        let Some(done) = draw(&mut flat, &out, words) else { return };
        done.unwrap();
        let drawn: Vec<f64> = flat.shots.iter().map(|shot| shot.time).collect();
        assert_eq!(drawn, times, "{name}");
        let whole = match name {
            "a.png" | "b.PNG" => image::open(&out).unwrap().to_rgb8().dimensions() == (18, 9),
            "f.y4m" | "g.y4m" => std::fs::metadata(&out).unwrap().len() > 18 * 9 * times.len() as u64,
            _ => names(&out).len() == times.len(),
        };
        assert!(whole, "{name}");
    }
}

#[test]
fn the_camera_stands_where_it_is_wanted_and_goes_round() {
    let folder = tempfile::tempdir().unwrap();
    let mut flat = flat();
    let words = "--frames 3 --azimuth 90 --elevation 30 --distance 2 --turn -180";
    let Some(done) = draw(&mut flat, &folder.path().join("x"), words) else { return };
    done.unwrap();
    let level = 4.0 * 30.0_f32.to_radians().cos();
    let wanted = [[level, 0.0], [0.0, -level], [-level, 0.0]];
    for (shot, [x, y]) in flat.shots.iter().zip(wanted) {
        let eye = shot.camera.eye;
        assert!((eye[0] - x).abs() < 1e-4 && (eye[1] - y).abs() < 1e-4 && (eye[2] - 2.0).abs() < 1e-4);
    }
}

#[test]
fn what_fails_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "b", "c.y4m", "missing/d.png", "e.gif"] {
        let mut flat = Flat { fails_at: 0.05, ..flat() };
        let Some(done) = draw(&mut flat, &folder.path().join(name), "--frames 4") else { return };
        let error = format!("{:#}", done.unwrap_err());
        assert!(
            error.contains("no more paint") || name.contains("missing") || name.contains("gif"),
            "{error}"
        );
        assert_eq!(names(folder.path()), [""; 0], "{name}");
    }
}
