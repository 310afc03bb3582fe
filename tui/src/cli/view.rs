//! `view`: scenes in the viewer's window, in the terminal, or into files.

mod forest;
mod window;

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use anyhow::Context as _;
use honami_model::brief::counted;
use honami_workbench::grow::GrowRequest;
use honami_workbench::plugins::{Host, Kind, PluginInfo, Value, Values};
use honami_workbench::scene::{Scene, SkeletonScene};
use honami_workbench::store::{Access, Project};
use serde_json::json;

use super::args::Common;
use super::args::view::{View, ViewWhat};
use super::{Answer, Outcome, Usage, grow, look, movie, report, there, told_options, want};
use crate::viewer::{self, Scenes, usual_size};

/// Options of forests and of plants.
const OF_FORESTS: [&str; 25] = [
    "forest",
    "wind",
    "leaves",
    "leaf_length",
    "size_spread",
    "mass_spread",
    "spacing",
    "alpha",
    "beta",
    "air_damping",
    "heavier",
    "seed",
    "modes",
    "classes",
    "unit",
    "diameters",
    "radius",
    "longest",
    "young",
    "poisson",
    "density",
    "leaf_mass",
    "leaf_drag",
    "drag",
    "air_density",
];

/// Options of what is drawn into files: a window goes on by itself.
const OF_FILES: [&str; 3] = ["turn", "frames", "seconds"];

/// Refuses what was typed of these, which nothing would heed; `what` says of whom they are, and what is shown.
fn none_of(args: &View, options: &[&str], what: &str) -> Result<(), Usage> {
    let typed = args.typed.0.iter().find(|id| options.contains(&id.as_str()));
    want(typed.is_none(), || {
        format!("--{} is {what}: leave it out", typed.map_or_else(String::new, |id| id.replace('_', "-")))
    })
}

/// Shows a scene.
pub(super) fn view(args: &View, common: &Common) -> anyhow::Result<Outcome> {
    if let Some(out) = &args.offscreen {
        movie::admit(out, true)?;
    }
    if let Some(wanted) = &args.shot.adapter
        && let Ok(viewer) = viewer::program()
    {
        is_called(&viewer, wanted)?;
    }
    let is_mp4 = |out: &Path| out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mp4"));
    if let Some(size) = args.size.filter(|_| args.offscreen.as_deref().is_some_and(is_mp4)) {
        want(size.width % 2 == 0 && size.height % 2 == 0, || {
            format!("an .mp4 has even sides, not {}x{}", size.width, size.height)
        })?;
    }
    let source = Path::new(&args.plant.source);
    let is_project = source.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("honami"));
    match args.what.unwrap_or(if is_project { ViewWhat::Skeleton } else { ViewWhat::Forest }) {
        ViewWhat::Forest => forest::view(args, common),
        ViewWhat::Skeleton => {
            want(is_project, || {
                format!("{} has no skeleton: a project (.honami) is wanted, or forest", source.display())
            })?;
            let of_forests = |id: &&String| OF_FORESTS.contains(&id.as_str());
            if let Some(option) = args.typed.0.iter().find(of_forests) {
                let (option, source) = (option.replace('_', "-"), source.display());
                return Err(Usage(format!(
                    "--{option} is of forests, and a skeleton is shown: `honami view {source} forest`, or leave it out"
                ))
                .into());
            }
            want(!args.terminal, || {
                format!("a skeleton is shown in the terminal by v k in `honami {}`", source.display())
            })?;
            if args.offscreen.is_none() {
                none_of(args, &OF_FILES, "of files (--offscreen), and a window is shown")?;
                none_of(args, &["fps"], "of files (--offscreen), and a window has the clip's own")?;
            }
            viewer::program()?;
            there(source)?;
            match &args.offscreen {
                Some(out) => skeleton(args, source, out, common).map(Outcome::Answer),
                None => window::window(args, source, common).map(Outcome::Exit),
            }
        }
    }
}

/// Whether an adapter has this in its name: the viewer knows, and a plant may take minutes before that is asked.
fn is_called(viewer: &Path, wanted: &str) -> anyhow::Result<()> {
    let mut command = Command::new(viewer);
    command.args(["--adapters", "--adapter", wanted]).env("MESA_SHADER_CACHE_DISABLE", "true");
    let asked = command.output().with_context(|| format!("cannot start {}", viewer.display()))?;
    let said = String::from_utf8_lossy(&asked.stderr);
    let why = said.lines().last().unwrap_or_default();
    want(asked.status.code() != Some(2), || why.trim_start_matches("honami-viewer: ").to_owned())?;
    Ok(())
}

/// What grows, and how.
struct Grower {
    host: Host,
    plugin: PluginInfo,
    request: GrowRequest,
}

impl Grower {
    fn of(args: &View, common: &Common) -> anyhow::Result<Self> {
        let options = told_options(common);
        let name = args.plugin.with.as_deref().unwrap_or(grow::DEFAULT);
        let plugin = options.registry().find(Kind::Structure, name)?.clone();
        let mut params = Values::defaults(&plugin.params);
        if args.flat {
            want(plugin.params.iter().any(|param| param.id == "flat"), || {
                format!(
                    "--flat is of plugins with a parameter of that name, and {} has none",
                    plugin.short_name
                )
            })?;
            params.set(&plugin.params, "flat", Value::Bool(true))?;
        }
        for assignment in &args.plugin.set {
            params.set_text(&plugin.params, assignment)?;
        }
        let request = GrowRequest {
            params,
            root: args.root.map(|place| place.0),
            as_grown: args.as_grown,
            groups: args.groups,
            ..GrowRequest::default()
        };
        Ok(Self { host: options.host, plugin, request })
    }

    /// The skeleton as it is now, and what is to be said of it.
    fn grow(&self, project: &Project, common: &Common) -> anyhow::Result<(SkeletonScene, Vec<String>)> {
        let bar = report::Bar::with(common);
        let is_writable = project.access() == Access::Write;
        Ok(viewer::skeleton(project, (&self.host, &self.plugin), &self.request, is_writable, &bar)?)
    }
}

/// Draws a skeleton into a file.
fn skeleton(args: &View, project: &Path, out: &Path, common: &Common) -> anyhow::Result<Answer> {
    let (scene, notes) = Grower::of(args, common)?.grow(&look(project)?, common)?;
    let told = told(&scene);
    let there = u32::try_from(scene.times.len()).unwrap_or(u32::MAX);
    let n_frames = args.shot.frames.unwrap_or(there);
    want(args.shot.fps.is_some() || n_frames <= there, || {
        format!("the skeleton has {}, not {n_frames}", counted(there as usize, "frame"))
    })?;
    let mut scenes = Scenes::new()?;
    let size = args.size.map_or_else(|| usual_size(&scene), |size| [size.width, size.height]);
    let path = scenes.write(&Scene::Skeleton(Box::new(scene)))?;
    let mut words = words(args, &path, size);
    words.extend(["--offscreen".into(), out.into()]);
    viewer::have(&words, n_frames, &report::Bar::with(common))?;
    let mut text = format!("{}: {told}", out.display());
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let json = json!({ "out": out, "size": size, "skeleton": told, "notes": notes });
    Ok(Answer { json, text, done: true })
}

/// `9 bones of 4 groups, frames 3-150`.
fn told(scene: &SkeletonScene) -> String {
    let n_bones = scene.joints.iter().skip(1).filter(|joint| joint.copy_of.is_none()).count();
    let (first, n_frames) = (scene.first_frame as usize, scene.times.len());
    let frames = format!("frames {first}-{}", (first + n_frames).saturating_sub(1));
    format!("{} of {}, {frames}", counted(n_bones, "bone"), counted(scene.groups.len(), "group"))
}

/// What the viewer is called with.
fn words(args: &View, scene: &Path, [width, height]: [u32; 2]) -> Vec<OsString> {
    let names = args.parts.iter().filter_map(clap::ValueEnum::to_possible_value);
    let names: Vec<String> = names.map(|part| part.get_name().to_owned()).collect();
    let mut words: Vec<OsString> = vec![scene.into(), format!("--size={width}x{height}").into()];
    words.extend((!names.is_empty()).then(|| format!("--parts={}", names.join(",")).into()));
    words.extend(args.shot.words().into_iter().map(OsString::from));
    words
}
