//! Forests: a plant and its copies in the wind.

use std::io::IsTerminal as _;
use std::path::Path;
use std::process::ExitCode;

use honami_model::brief::{Brief, counted};
use honami_workbench::mechanics::Integrator;
use honami_workbench::plant::scene::{Shown, scene};
use honami_workbench::plant::sway::Motion;
use honami_workbench::plant::{self};
use honami_workbench::scene::{ForestScene, Scene};
use serde_json::json;

use super::{OF_FILES, none_of, window, words};
use crate::cli::args::Common;
use crate::cli::args::view::{Shot, View};
use crate::cli::{Answer, Outcome, Usage, ends, report, simulate, want};
use crate::viewer::{self, Scenes};

/// Pixels of a picture, unless it was said how large.
pub(super) const SIZE: [u32; 2] = [1280, 720];
/// Seconds of a movie, where nobody says.
const SECONDS: f64 = 10.0;
/// Frames of a movie at most.
const MOST_FRAMES: f64 = 1e6;
/// From where a forest can be seen, degrees above the horizon.
const ELEVATIONS: std::ops::RangeInclusive<f64> = 0.0..=90.0;
/// Options of skeletons.
const OF_SKELETONS: [&str; 7] = ["with", "set", "groups", "root", "flat", "as_grown", "parts"];
/// Options of what the viewer draws, which the terminal does without.
const OF_CARDS: [&str; 3] = ["size", "samples", "adapter"];
/// Leaves are between so long, metres.
const LEAF_LENGTHS: std::ops::RangeInclusive<f64> = 1e-4..=10.0;

/// Shows a forest in a window, or in the terminal, or draws it into a file.
pub(super) fn view(args: &View, common: &Common) -> anyhow::Result<Outcome> {
    if let Some(length) = args.trees.leaf_length {
        want(LEAF_LENGTHS.contains(&length), || {
            let (least, most) = (LEAF_LENGTHS.start(), LEAF_LENGTHS.end());
            format!("a leaf is {least:?} to {most:?} m long, not {length:?}")
        })?;
    }
    if let Some(option) = args.typed.0.iter().find(|id| OF_SKELETONS.contains(&id.as_str())) {
        let option = option.replace('_', "-");
        return Err(Usage(format!("--{option} is of skeletons, and a forest is shown: leave it out")).into());
    }
    if let Some(elevation) = args.shot.elevation {
        want(ELEVATIONS.contains(&elevation), || {
            format!("a forest is seen from 0 to 90 degrees above the horizon, not from {elevation:?}")
        })?;
    }
    if args.offscreen.is_none() {
        none_of(args, &OF_FILES, "of files (--offscreen)")?;
    }
    let n_frames = n_frames(&args.shot);
    want(n_frames <= MOST_FRAMES, || {
        format!("{} frames are too many: say fewer --seconds or a lower --fps", Brief(n_frames))
    })?;
    let has_display = viewer::has_display(|name| std::env::var_os(name));
    let in_window = args.offscreen.is_none() && !args.terminal && has_display && viewer::program().is_ok();
    let is_shown =
        in_window || (std::io::stdout().is_terminal() && std::io::stdin().is_terminal() && !common.json);
    want(args.offscreen.is_some() || is_shown, || {
        "--offscreen OUT is wanted where there is no display and no terminal to show a forest in".to_owned()
    })?;
    if args.offscreen.is_some() {
        viewer::program()?;
    } else if !in_window {
        none_of(args, &OF_CARDS, "of pictures that the viewer draws, and the terminal draws by itself")?;
    }
    let (scene, told, notes) = made(args, common)?;
    if let Some(out) = &args.offscreen {
        return offscreen(args, scene, out, (told, &notes), common).map(Outcome::Answer);
    }
    notes.iter().for_each(|note| report::say(&format!("note: {note}")));
    if in_window {
        return window::forest(args, scene, common).map(Outcome::Exit);
    }
    ends::leave();
    let shot = &args.shot;
    let mut scene = scene;
    let orbit = &mut scene.orbit;
    orbit.azimuth = shot.azimuth.map_or(orbit.azimuth, |degrees| degrees.to_radians() as f32);
    orbit.elevation = shot.elevation.map_or(orbit.elevation, |degrees| degrees.to_radians() as f32);
    orbit.zoom(shot.distance.unwrap_or(1.0) as f32);
    orbit.stay_above();
    let end = crate::app::run_forest(scene)?;
    Ok(Outcome::Exit(end.map_or(ExitCode::SUCCESS, |end| ExitCode::from(end.status()))))
}

/// Frames of a movie.
fn n_frames(shot: &Shot) -> f64 {
    let of_time = || shot.seconds.unwrap_or(SECONDS) * shot.fps.unwrap_or(Motion::default().fps);
    shot.frames.map_or_else(|| of_time().round().max(1.0), f64::from)
}

/// The scene, what is in it, and what is to be said of the plant.
fn made(args: &View, common: &Common) -> anyhow::Result<(ForestScene, String, Vec<String>)> {
    let trees = &args.trees;
    let bar = report::Bar::with(common);
    let plant = plant::vibrate(&simulate::wish(&args.plant), &bar)?;
    let motion = Motion {
        fps: args.shot.fps.unwrap_or(Motion::default().fps),
        integrator: Integrator::Exact,
        ..trees.stand.motion()
    };
    let name = Path::new(&args.plant.source).file_name();
    let name = name.map_or_else(|| args.plant.source.clone(), |name| name.to_string_lossy().into_owned());
    let shown =
        Shown { name, wind: trees.wind.clone(), leaves: trees.leaves, leaf_length: trees.leaf_length };
    let scene = scene(&plant, &motion, &shown)?;
    let leaves = scene.body.levels.first().map_or(0, |level| level.leaves.len());
    let copies = match scene.places.len() {
        1 => "1 plant".to_owned(),
        n => format!("{n} plants"),
    };
    let told = format!(
        "{copies} of {} with {} and {}, in {}",
        counted(plant.beams.len(), "node"),
        if leaves == 1 { "1 leaf".to_owned() } else { format!("{leaves} leaves") },
        counted(plant.modes.len(), "mode"),
        scene.wind
    );
    Ok((scene, told, plant.notes))
}

/// Draws into a file.
fn offscreen(
    args: &View,
    scene: ForestScene,
    out: &Path,
    (told, notes): (String, &[String]),
    common: &Common,
) -> anyhow::Result<Answer> {
    let mut scenes = Scenes::new()?;
    let [width, height] = args.size.map_or(SIZE, |size| [size.width, size.height]);
    let path = scenes.write(&Scene::Forest(Box::new(scene)))?;
    let mut words = words(args, &path, [width, height]);
    words.extend(["--offscreen".into(), out.into()]);
    viewer::have(&words, n_frames(&args.shot) as u32, &report::Bar::with(common))?;
    let mut text = format!("{}: {told}", out.display());
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let json = json!({ "out": out, "size": [width, height], "forest": told, "notes": notes });
    Ok(Answer { json, text, done: true })
}
