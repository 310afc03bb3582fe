//! A project made again from its recipe, and what differs then.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::Context as _;
use honami_model::brief::counted;
use honami_model::track::{Sample, Span, TrackId};
use honami_workbench::store::{KeptFile, Project};
use serde_json::{Value, json};

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::{Answer, look, options};
use super::plan::look as seen;
use super::save::{Made, made, written};
use super::{Recipe, many};

/// Makes a project again in a folder for the time being, and compares what came of it.
pub(in crate::cli) fn rerun(path: &Path, common: &Common) -> anyhow::Result<Answer> {
    let project = look(path)?;
    let registry = options(common).registry();
    let before = made(&project, &registry)?;
    let clip = project.media_path();
    anyhow::ensure!(
        clip.exists(),
        "there is no clip {}: say where it is with `honami relink`",
        clip.display()
    );
    let folder = tempfile::tempdir().context("cannot make a folder for the time being")?;
    let recipe = folder.path().join("recipe.toml");
    fs::write(&recipe, written(&before)).context("cannot write the recipe")?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    bring_inputs(&Recipe::read(&recipe)?, &project, &name)?;
    let into = folder.path().join("again");
    let args = Run {
        recipe,
        clips: vec![format!("{name}={}", clip.display())],
        into: into.clone(),
        jobs: 1,
        dry_run: false,
        over_edits: false,
        alone: false,
        patience: 0,
        threads: None,
    };
    let ran = many::run(&args, common)?;
    anyhow::ensure!(ran.done, "{} could not be made again:\n{}", path.display(), ran.text);
    let again = look(&into.join(&name).join(format!("{name}.honami")))?;
    compare((&project, &before), (&again, &made(&again, &registry)?), &into.join(&name))
}

/// Brings the files that lay beside the recipe.
fn bring_inputs(recipe: &Recipe, project: &Project, name: &str) -> anyhow::Result<()> {
    let steps = project.steps()?;
    for (line, step) in recipe.steps.iter().zip(steps.iter().skip(1)) {
        for (to, kept) in line.inputs(name).iter().zip(&step.inputs) {
            let from = Path::new(&kept.path);
            let is = seen(from, std::slice::from_ref(kept))?;
            anyhow::ensure!(is.sha256 == kept.sha256, "{} is another file since", from.display());
            to.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::copy(from, to).with_context(|| format!("cannot copy {}", from.display()))?;
        }
    }
    Ok(())
}

/// How far two runs are apart.
#[derive(Default)]
struct Apart {
    n_samples: u64,
    /// Samples that one alone has, or whose status differs.
    n_other: u64,
    /// Samples that lie elsewhere, if only in the last bit, and the farthest of them, pixels.
    n_moved: u64,
    most_px: f64,
}

impl Apart {
    fn add(&mut self, one: Option<&Sample>, two: Option<&Sample>) {
        self.n_samples += 1;
        match (one, two) {
            (Some(one), Some(two)) if one.status == two.status => {
                if [one.x.to_bits(), one.y.to_bits()] != [two.x.to_bits(), two.y.to_bits()] {
                    self.n_moved += 1;
                    let px = f64::from(one.x - two.x).hypot(f64::from(one.y - two.y));
                    self.most_px = self.most_px.max(if px.is_finite() { px } else { 0.0 });
                }
            }
            _ => self.n_other += 1,
        }
    }

    fn spans(&mut self, one: &Span, two: &Span) {
        let (a, b) = (one.frames(), two.frames());
        (a.start.min(b.start)..a.end.max(b.end)).for_each(|frame| self.add(one.get(frame), two.get(frame)));
    }

    fn runs(one: Vec<(TrackId, Span)>, two: Vec<(TrackId, Span)>) -> Self {
        let mut apart = Self::default();
        let mut two: BTreeMap<TrackId, Span> = two.into_iter().collect();
        for (track, span) in one {
            apart.spans(&span, &two.remove(&track).unwrap_or_default());
        }
        two.values().for_each(|span| apart.spans(&Span::default(), span));
        apart
    }

    fn is_none(&self) -> bool {
        self.n_other + self.n_moved == 0
    }

    fn words(&self) -> String {
        if self.is_none() {
            return format!("the same, bit for bit, in {}", counted(self.n_samples as usize, "sample"));
        }
        format!(
            "of {} {} lie elsewhere, at most {:.2e} px, and {} are seen by one alone",
            counted(self.n_samples as usize, "sample"),
            self.n_moved,
            self.most_px,
            self.n_other
        )
    }
}

fn compare(
    (one, before): (&Project, &Made),
    (two, after): (&Project, &Made),
    folder: &Path,
) -> anyhow::Result<Answer> {
    let (mut lines, mut runs) = (before.notes.clone(), Vec::new());
    let mut is_same = before.runs.len() == after.runs.len();
    for (&a, &b) in before.runs.iter().zip(&after.runs) {
        let apart = Apart::runs(one.run_tracks(a)?, two.run_tracks(b)?);
        is_same &= apart.is_none();
        lines.push(format!("run {a}: {}", apart.words()));
        let Apart { n_samples, n_other, n_moved, most_px } = apart;
        runs.push(
            json!({ "run": a, "samples": n_samples, "other": n_other, "moved": n_moved, "most_px": most_px }),
        );
    }
    let groups = groups(one, two)?;
    if let Some(are_same) = groups {
        is_same &= are_same;
        lines.push(format!("clustering: {}", if are_same { "the same" } else { "another hierarchy" }));
    }
    let mut files = Vec::new();
    for file in one.steps()?.iter().flat_map(|step| &step.outputs) {
        let same = is_same_file(file, folder)?;
        is_same &= same;
        lines.push(format!("{}: {}", file.path, if same { "the same bytes" } else { "other bytes" }));
        files.push(json!({ "file": file.path, "same": same }));
    }
    lines.push(if is_same { "it repeats".to_owned() } else { "it differs".to_owned() });
    let json: Value = json!({ "same": is_same, "runs": runs, "clustering_same": groups, "files": files, "notes": before.notes });
    Ok(Answer { json, text: lines.join("\n"), done: is_same })
}

/// Whether both clusterings are one, apart from when they were made; `None`: there is none.
fn groups(one: &Project, two: &Project) -> anyhow::Result<Option<bool>> {
    let read = |project: &Project| {
        project.document().clustering().map(|shown| project.clustering(shown.id)).transpose()
    };
    Ok(match (read(one)?, read(two)?) {
        (None, None) => None,
        (Some(a), Some(b)) => Some(a.tracks == b.tracks && a.dendrogram == b.dendrogram),
        _ => Some(false),
    })
}

/// Whether a file was written with the same content again.
fn is_same_file(file: &KeptFile, folder: &Path) -> anyhow::Result<bool> {
    let path = folder.join(&file.path);
    Ok(path.exists() && seen(&path, &[])?.sha256 == file.sha256)
}
