//! What of a recipe is done, what is stale and why: by hashes of the clip, the lines, plugins, files, and what was before.

use std::path::{Component, Path, PathBuf};
use std::time::UNIX_EPOCH;

use anyhow::Context as _;
use honami_model::history::{EntryId, Step as Way};
use honami_workbench::media::{self, MediaError};
use honami_workbench::plugins::Registry;
use honami_workbench::store::{Access, KeptFile, Project, Step};

use super::{Recipe, Usage, first_line, plugins};

/// Why a step is to be done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Why {
    /// It never was.
    New,
    /// Something that it was made of is another now.
    Stale(String),
}

impl std::fmt::Display for Why {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::New => f.write_str("not done yet"),
            Self::Stale(why) => write!(f, "stale: {why}"),
        }
    }
}

/// One clip of many.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Clip {
    /// What its folder and its project are called.
    pub(in crate::cli) name: String,
    /// The clip.
    pub(in crate::cli) path: PathBuf,
    /// The folder of all that is made of it.
    pub(in crate::cli) folder: PathBuf,
}

impl Clip {
    pub(in crate::cli) fn project(&self) -> PathBuf {
        self.folder.join(format!("{}.honami", self.name))
    }

    /// Where a file is that a step has written; projects come from elsewhere, and are not believed that it is in here.
    pub(in crate::cli) fn output(&self, file: &KeptFile) -> anyhow::Result<PathBuf> {
        let path = Path::new(&file.path);
        let is_inside = path.components().all(|part| matches!(part, Component::Normal(_)));
        anyhow::ensure!(
            is_inside,
            "{} says that a step has written {}, which is not in its folder",
            self.project().display(),
            file.path
        );
        Ok(self.folder.join(path))
    }
}

/// What is to be done with a clip.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct Plan {
    /// Steps that are done as they stand, from the first.
    pub(in crate::cli) n_fresh: usize,
    /// Why the next one is to be done; `None`: all are done.
    pub(in crate::cli) why: Option<Why>,
    /// Whether the project is to be made, or made anew.
    pub(in crate::cli) makes_project: bool,
    /// Edits by hand since the tracks were found.
    pub(in crate::cli) n_edits: usize,
    /// What every step is made of; the clip is the first.
    pub(in crate::cli) made_of: Vec<String>,
    /// What every step reads; the clip is the first.
    pub(in crate::cli) inputs: Vec<Vec<KeptFile>>,
}

/// Compares what there is with what the recipe wants.
pub(in crate::cli) fn plan(recipe: &Recipe, clip: &Clip, registry: &Registry) -> anyhow::Result<Plan> {
    let file = clip.project();
    let project = if file.exists() { Some(Project::open(&file, Access::Read)?) } else { None };
    let done = project.as_ref().map(Project::steps).transpose()?.unwrap_or_default();
    let (made_of, inputs) = wanted(recipe, clip, registry, &done)?;
    let plan = Plan { n_fresh: 0, why: None, makes_project: true, n_edits: 0, made_of, inputs };
    let Some(project) = project else { return Ok(Plan { why: Some(Why::New), ..plan }) };
    let Some(first) = done.first() else {
        // A run that was killed just after it had made the project: nothing is in it but that it was made.
        if project.log()?.len() == 1 {
            return Ok(Plan { why: Some(Why::New), ..plan });
        }
        anyhow::bail!(
            "{} is a project that no recipe has made: let --into name another folder, or take it away first",
            file.display()
        );
    };
    let plan = Plan { n_edits: foreign(&project, &done, first.after), ..plan };
    if first.made_of != plan.made_of[0] {
        let is_rate = first.inputs.first().is_some_and(|film| film.sha256 == plan.inputs[0][0].sha256);
        let why = if is_rate { "the frame rate is another" } else { "the clip is another" };
        return Ok(Plan { why: Some(Why::Stale(why.to_owned())), ..plan });
    }
    for (number, line) in (1..).zip(&recipe.steps) {
        let why = match done.get(number) {
            None => Some(Why::New),
            Some(step) if step.made_of != plan.made_of[number] => {
                Some(Why::Stale(changed(step, line, &plan.inputs[number])))
            }
            Some(step) => stale(&project, &done[number..], step, clip)?.map(Why::Stale),
        };
        if why.is_some() {
            // Tracks are found in a project without any, so that a second time is like the first.
            let tracks = recipe.steps[number - 1..].iter().any(|line| line.words[0] == "track");
            let makes_project = tracks && !project.runs()?.is_empty();
            return Ok(Plan {
                n_fresh: if makes_project { 0 } else { number - 1 },
                why,
                makes_project,
                ..plan
            });
        }
    }
    Ok(Plan { n_fresh: recipe.steps.len(), makes_project: false, ..plan })
}

/// What the clip and every step are made of, and the files that they read.
fn wanted(
    recipe: &Recipe,
    clip: &Clip,
    registry: &Registry,
    done: &[Step],
) -> anyhow::Result<(Vec<String>, Vec<Vec<KeptFile>>)> {
    let seen = |number: usize| done.get(number).map_or(&[][..], |step| &step.inputs);
    let film = look(&clip.path, seen(0))?;
    let fps = recipe.fps.map_or_else(String::new, |fps| format!(" {fps}"));
    let (mut made_of, mut inputs) = (vec![hash(&[&film.sha256, &fps])], vec![vec![film]]);
    for (number, line) in (1..).zip(&recipe.steps) {
        let cli = line.command(&clip.project(), &clip.name).map_err(|error| Usage(first_line(&error)))?;
        let mut parts =
            vec![made_of[number - 1].clone(), env!("CARGO_PKG_VERSION").to_owned(), line.text.clone()];
        for (kind, name) in cli.command.iter().flat_map(plugins) {
            parts.push(registry.find(kind, &name)?.sha256()?);
        }
        let files = line.inputs(&clip.name).into_iter().map(|path| look(&path, seen(number)));
        let files = files.collect::<Result<Vec<_>, _>>()?;
        parts.extend(files.iter().map(|file| file.sha256.clone()));
        made_of.push(hash(&parts.iter().map(String::as_str).collect::<Vec<_>>()));
        inputs.push(files);
    }
    Ok((made_of, inputs))
}

/// What differs, in words.
fn changed(step: &Step, line: &super::Line, files: &[KeptFile]) -> String {
    let sha256 = |files: &[KeptFile]| files.iter().map(|file| file.sha256.clone()).collect::<Vec<_>>();
    if step.made_of.is_empty() {
        "it was not finished".to_owned()
    } else if step.line != line.text {
        format!("it was {:?}", step.line)
    } else if sha256(&step.inputs) != sha256(files) {
        "a file that it reads is another".to_owned()
    } else {
        "a plugin, honami or a step before it is another".to_owned()
    }
}

/// Why a step that was made of the same is stale all the same; `since` are the steps from it on.
fn stale(project: &Project, since: &[Step], step: &Step, clip: &Clip) -> anyhow::Result<Option<String>> {
    let is_track = step.line.starts_with("track");
    if !is_track && foreign(project, since, step.after) > 0 {
        return Ok(Some("the project was edited since".to_owned()));
    }
    for file in &step.outputs {
        let path = clip.output(file)?;
        if !path.exists() {
            return Ok(Some(format!("{} is gone", file.path)));
        }
        if look(&path, std::slice::from_ref(file))?.sha256 != file.sha256 {
            anyhow::bail!(
                "{} was changed since it was written: take it away, and it is written anew",
                path.display()
            );
        }
    }
    Ok(None)
}

/// Edits by hand since a recipe has made a project.
pub(in crate::cli) fn edits(project: &Project) -> anyhow::Result<usize> {
    let done = project.steps()?;
    Ok(done.first().map_or(0, |first| foreign(project, &done, first.after)))
}

/// Edits on the way from a revision to now that none of these steps has made.
fn foreign(project: &Project, steps: &[Step], since: EntryId) -> usize {
    let way = project.history().path(since, project.revision()).unwrap_or_default();
    // What a step had found when it was killed is its own, though it could not say so any more.
    let is_found = |id| project.shows_results(id).unwrap_or(false);
    let by_step = |id: EntryId| {
        let is_of =
            |step: &Step| step.before < id && (id <= step.after || step.made_of.is_empty() && is_found(id));
        steps.iter().any(is_of)
    };
    way.iter().filter(|way| !matches!(way, Way::Forward(id) if by_step(*id))).count()
}

/// A file as it is now: its hash is that of before where neither its size nor its time has changed.
pub(in crate::cli) fn look(path: &Path, before: &[KeptFile]) -> anyhow::Result<KeptFile> {
    let shown = path.to_string_lossy().into_owned();
    let (size, changed_ns) = seen(path)?;
    let same = before.iter().find(|file| file.size == size && file.changed_ns == changed_ns);
    let sha256 = match same {
        Some(file) => file.sha256.clone(),
        None => content(path).with_context(|| format!("cannot read {shown}"))?,
    };
    Ok(KeptFile { path: shown, size, changed_ns, sha256 })
}

/// Hash of a file, or of a folder of images or a pattern as of a clip.
fn content(path: &Path) -> Result<String, MediaError> {
    if path.is_file() { media::sha256_of_file(path) } else { media::sha256_of_clip(path) }
}

/// Bytes and time of the last change: of a folder or a pattern those of all files in it.
fn seen(path: &Path) -> anyhow::Result<(u64, i128)> {
    let read = |path: &Path| -> std::io::Result<(u64, i128)> {
        let data = path.metadata()?;
        let since = data.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
        Ok((data.len(), i128::try_from(since.as_nanos()).unwrap_or_default()))
    };
    let context = || format!("there is no clip {}", path.display());
    if path.is_file() {
        return read(path).with_context(context);
    }
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(path) };
    let mut all = (0_u64, 0_i128);
    for entry in folder.read_dir().with_context(context)? {
        let (size, changed) = read(&entry?.path())?;
        // A sum changes also where one file takes another's place.
        all = (all.0 + size, all.1.wrapping_add(changed));
    }
    Ok(all)
}

fn hash(parts: &[&str]) -> String {
    // Lengths keep parts apart that would read alike when joined.
    let text: String = parts.iter().map(|part| format!("{} {part}\n", part.len())).collect();
    media::sha256_of_bytes(text.as_bytes())
}
