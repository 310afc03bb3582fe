//! The recipe that a project was made by.

use std::collections::BTreeSet;
use std::path::Path;

use honami_model::brief::counted;
use honami_model::document::RunId;
use honami_model::provenance::Provenance;
use honami_workbench::plugins::{Kind, Registry, Values};
use honami_workbench::store::Project;
use honami_workbench::track::{Area, detection_of};
use serde_json::json;

use super::super::args::Common;
use super::super::{Answer, look, options, want};

/// What a project was made by.
pub(super) struct Made {
    fps: Option<f64>,
    lines: Vec<String>,
    /// What the lines do not tell.
    pub(super) notes: Vec<String>,
    /// The shown runs that the lines make.
    pub(super) runs: Vec<RunId>,
}

/// Writes the recipe of a project.
pub(in crate::cli) fn save(project: &Path, out: Option<&Path>, common: &Common) -> anyhow::Result<Answer> {
    let made = made(&look(project)?, &options(common).registry())?;
    let text = written(&made);
    let json = json!({ "fps": made.fps, "steps": made.lines, "notes": made.notes, "file": out });
    let Some(out) = out else { return Ok(Answer { json, text: text.trim_end().to_owned(), done: true }) };
    let is_toml = out.extension().is_some_and(|e| e == "toml");
    want(is_toml, || format!("a recipe is a .toml file: {}", out.display()))?;
    honami_workbench::export::text(out, &text)?;
    let mut told = format!("{}: {}", out.display(), counted(made.lines.len(), "step"));
    made.notes.iter().for_each(|note| told += &format!("\nnote: {note}"));
    Ok(Answer { json, text: told, done: true })
}

/// Steps of the recipe that it was made by, else of the tracks and groups that are shown.
pub(super) fn made(project: &Project, registry: &Registry) -> anyhow::Result<Made> {
    let mut made = shown(project, registry)?;
    let steps = project.steps()?;
    if steps.len() > 1 {
        made.lines = steps.into_iter().skip(1).map(|step| step.line).collect();
        made.notes.clear();
    }
    want(!made.lines.is_empty(), || {
        format!("{}: nothing was tracked in it yet, so there is no recipe of it", project.path().display())
    })?;
    Ok(made)
}

fn shown(project: &Project, registry: &Registry) -> anyhow::Result<Made> {
    let (mut lines, mut notes, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    let document = project.document();
    let shown: BTreeSet<_> = document.runs().iter().map(|shown| shown.run).collect();
    for run in shown {
        let info = project.run(run)?;
        let (head, made) = (&info.head, &info.head.provenance);
        let Some((area, every)) = detection_of(project, run)?.filter(|_| made.what == "track") else {
            notes.push(format!(
                "run {run} ({}) began with features that were given: it is left out",
                made.what
            ));
            continue;
        };
        let mut line = with(made, Kind::Tracker, registry);
        if head.frames != (0..project.clip().clip.n_frames()) {
            line += &format!(" --frames {}..{}", head.frames.start, head.frames.end);
        }
        if let Some(every) = every {
            line += &format!(" --every {every}");
        }
        match area {
            Area::Rect([x, y, width, height]) => line += &format!(" --region {x},{y},{width},{height}"),
            Area::Mask(path) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                line += &format!(" --mask {{recipe}}/{name}");
                notes.push(format!("{name} is to lie beside the recipe"));
            }
            // Without mattes it is as usual.
            Area::Whole if document.mattes().next().is_some() => line += " --no-mask",
            Area::Whole | Area::Usual | Area::Kept(_) => {}
        }
        lines.push(line);
        runs.push(run);
    }
    if let Some(shown) = document.clustering() {
        let clustering = project.clustering(shown.id)?;
        lines.push(format!(
            "{} --groups {}",
            with(&clustering.provenance, Kind::Clusterer, registry),
            shown.k
        ));
    }
    Ok(Made { fps: project.clip().fps_override, lines, notes, runs })
}

/// The command with its plugin, and the parameters that are not as usual.
fn with(made: &Provenance, kind: Kind, registry: &Registry) -> String {
    let plugin = registry.find(kind, &made.plugin_id).ok();
    let usual = plugin.map(|plugin| Values::defaults(&plugin.params));
    let mut line =
        format!("{} --with {}", made.what, plugin.map_or(&made.plugin_id, |plugin| &plugin.short_name));
    for (id, value) in &made.params {
        let is_usual = usual.as_ref().is_some_and(|usual| usual.iter().any(|(of, v)| of == id && v == value));
        if !is_usual {
            let set = format!("{id}={value}");
            let is_plain = set.chars().all(|c| c.is_alphanumeric() || "=.,:+-_/".contains(c));
            let quoted = shlex::try_quote(&set).ok().filter(|_| !is_plain);
            line += &format!(" --set {}", quoted.as_deref().unwrap_or(&set));
        }
    }
    line
}

/// As TOML.
pub(super) fn written(Made { fps, lines, notes, .. }: &Made) -> String {
    let mut text: String = notes.iter().map(|note| format!("# {note}\n")).collect();
    if let Some(fps) = fps {
        text += &format!("fps = {fps:?}\n");
    }
    text += "steps = [\n";
    for line in lines {
        text += &format!("    {},\n", toml::Value::String(line.clone()));
    }
    text + "]\n"
}
