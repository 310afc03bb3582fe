//! One clip, in a process of its own: what is stale is done, and told in a line of JSON each to the process that started it.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use honami_workbench::export;
use honami_workbench::store::{self, Access, Claim, KeptFile, Project, Step, StoreError};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::{Outcome, options, project, report, run, want};
use super::plan::{Clip, Plan, Why, edits, look, plan};
use super::{Line, Recipe, memory};

/// What is told of a clip, a line of JSON each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(in crate::cli) enum Told {
    /// So many steps stand as they are.
    Fresh {
        /// From the first.
        n: usize,
    },
    /// A step is at work.
    At {
        /// Its number, from 1; 0 is the clip itself.
        step: usize,
        /// How far it is, of how much, of what.
        done: u64,
        total: u64,
        what: String,
    },
    /// A step is done.
    Done {
        /// Its number.
        step: usize,
        /// How long it took.
        seconds: f64,
        /// What it said.
        answer: Value,
    },
    /// The most memory that the process had, at its end.
    Peak { bytes: u64 },
    /// It could not be done, or was stopped.
    Failed {
        /// The step, or 0.
        step: usize,
        /// Why, in a line.
        why: String,
    },
}

fn tell(told: &Told) -> bool {
    let Ok(line) = serde_json::to_string(told) else { return true };
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").and_then(|()| out.flush()).is_ok()
}

/// Follows the recipe with the one clip that was named.
pub(in crate::cli) fn follow(args: &Run, common: &Common) -> anyhow::Result<ExitCode> {
    let recipe = Recipe::read(&args.recipe)?;
    let [clip] = &super::many::clips(&args.clips, &args.into)?[..] else {
        want(false, || "--alone is for one clip".to_owned())?;
        return Ok(ExitCode::from(2));
    };
    // Whoever waits is gone: then nobody wants the rest.
    report::relay(Box::new(|step, done, total, what| {
        tell(&Told::At { step, done, total, what: what.to_owned() })
    }));
    let mut step = 0;
    let result = all(&recipe, clip, args, common, &mut step);
    tell(&Told::Peak { bytes: memory::peak_of_self() });
    match result {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(error) => {
            tell(&Told::Failed { step, why: report::chain(&error) });
            Ok(ExitCode::FAILURE)
        }
    }
}

fn all(recipe: &Recipe, clip: &Clip, args: &Run, common: &Common, at: &mut usize) -> anyhow::Result<()> {
    fs::create_dir_all(&clip.folder).with_context(|| format!("cannot make {}", clip.folder.display()))?;
    let folder =
        clip.folder.canonicalize().with_context(|| format!("cannot find {}", clip.folder.display()))?;
    let path = clip.path.canonicalize().unwrap_or_else(|_| clip.path.clone());
    let clip = &Clip { name: clip.name.clone(), path, folder };
    // No other process works on this clip meanwhile, on whatever machine.
    let _claim = claim(clip, Duration::from_secs(args.patience))?;
    // So what killed ones had begun to write is nobody's.
    export::remove_parts(&clip.folder).with_context(|| format!("cannot tidy {}", clip.folder.display()))?;
    let registry = options(common).registry();
    let plan = plan(recipe, clip, &registry)?;
    // Who has planned it may have done so before another honami was through.
    tell(&Told::Fresh { n: plan.n_fresh });
    let Some(why) = &plan.why else { return Ok(()) };
    // All that may refuse comes before anything is taken away.
    let old = if plan.makes_project { replaced(clip, why, args.over_edits)? } else { None };
    take_away(clip, plan.n_fresh + 1)?;
    if plan.makes_project {
        if let Some(old) = old {
            old.leave(clip)?;
        }
        make(recipe, clip, &plan, common)?;
    }
    std::env::set_current_dir(&clip.folder)?;
    for number in plan.n_fresh + 1..plan.made_of.len() {
        *at = number;
        report::step(number);
        do_step(&recipe.steps[number - 1], number, clip, &plan, common)?;
    }
    Ok(())
}

/// Waits so long for whoever has the clip: on other machines the lock of one that has died is held for a while.
fn claim(clip: &Clip, patience: Duration) -> anyhow::Result<Claim> {
    let since = Instant::now();
    loop {
        match Claim::of(&clip.folder.join("steps")) {
            Err(StoreError::Locked { holder, .. }) => {
                let who = holder.map_or_else(|| "nobody says who".to_owned(), |holder| holder.to_string());
                anyhow::ensure!(since.elapsed() < patience, "another honami is at work on it: {who}");
                let (waited, of) = (since.elapsed().as_secs(), patience.as_secs());
                let what = format!("waiting for {who}");
                anyhow::ensure!(tell(&Told::At { step: 0, done: waited, total: of, what }), "nobody waits");
                std::thread::park_timeout(Duration::from_secs(1));
            }
            other => return Ok(other?),
        }
    }
}

/// Removes what steps from this one on have written, so that nothing stale lies about.
fn take_away(clip: &Clip, from: usize) -> anyhow::Result<()> {
    let file = clip.project();
    let done = if file.exists() { Project::open(&file, Access::Read)?.steps()? } else { Vec::new() };
    let outputs = done.iter().skip(from).flat_map(|step| &step.outputs);
    let there = outputs.map(|file| Ok((clip.output(file)?, file))).collect::<anyhow::Result<Vec<_>>>()?;
    let there: Vec<_> = there.into_iter().filter(|(path, _)| path.exists()).collect();
    for (path, file) in &there {
        anyhow::ensure!(
            look(path, std::slice::from_ref(*file))?.sha256 == file.sha256,
            "{} was changed since it was written, and is to be written anew: take it away first",
            path.display()
        );
    }
    there.iter().try_for_each(|(path, _)| {
        fs::remove_file(path).with_context(|| format!("cannot remove {}", path.display()))
    })
}

/// A project in whose place another is to be made. It is held, so that nobody can edit it meanwhile.
struct Replaced {
    _held: Project,
    /// Where it is kept, where it was edited by hand.
    before: Option<PathBuf>,
}

/// The project that is there, held; refused where it was edited by hand and nobody has said that this does not matter.
fn replaced(clip: &Clip, why: &Why, over_edits: bool) -> anyhow::Result<Option<Replaced>> {
    let file = clip.project();
    if !file.exists() {
        return Ok(None);
    }
    let held = Project::open(&file, Access::Write)?;
    // Counted now: since it was planned somebody may have gone on.
    let n_edits = edits(&held)?;
    if n_edits == 0 {
        return Ok(Some(Replaced { _held: held, before: None }));
    }
    anyhow::ensure!(
        over_edits,
        "{} was edited {} by hand, and its tracks are to be found anew ({why}): --over-edits does so, and keeps the project \
         as it is now beside it",
        file.display(),
        honami_model::brief::counted(n_edits, "time"),
    );
    let before = file.with_file_name(format!("{}.before.honami", clip.name));
    anyhow::ensure!(
        !before.exists(),
        "{} is there already: take it away, or keep it elsewhere",
        before.display()
    );
    Ok(Some(Replaced { _held: held, before: Some(before) }))
}

impl Replaced {
    /// Makes room for the new one.
    fn leave(self, clip: &Clip) -> anyhow::Result<()> {
        let file = clip.project();
        match &self.before {
            Some(before) => {
                fs::rename(&file, before).with_context(|| format!("cannot rename {}", file.display()))
            }
            None => fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display())),
        }
    }
}

/// Makes the project.
fn make(recipe: &Recipe, clip: &Clip, plan: &Plan, common: &Common) -> anyhow::Result<()> {
    let file = clip.project();
    let since = Instant::now();
    let mut session = project::make(&file, &clip.path, recipe.fps, common)?;
    let revision = session.project.revision();
    let seconds = since.elapsed().as_secs_f64();
    let answer =
        serde_json::json!({ "frames": session.media.clip().n_frames(), "notes": session.media.notes() });
    let step = Step {
        line: "new".to_owned(),
        made_of: plan.made_of[0].clone(),
        before: revision,
        after: revision,
        inputs: plan.inputs[0].clone(),
        outputs: Vec::new(),
        answer: answer.clone(),
        seconds,
        time: store::now(),
    };
    session.project.keep_step(0, &step)?;
    tell(&Told::Done { step: 0, seconds, answer });
    Ok(())
}

/// Does one step, and keeps what it was made of and what it wrote; one that fails is kept as not finished.
fn do_step(line: &Line, number: usize, clip: &Clip, plan: &Plan, common: &Common) -> anyhow::Result<()> {
    let file = clip.project();
    let cli = line.command(&file, &clip.name).map_err(|error| super::Usage(super::first_line(&error)))?;
    let Some(command) = cli.command else { anyhow::bail!("a step is a command") };
    let mut project = Project::open(&file, Access::Write)?;
    let (revision, others) = (project.revision(), project.steps()?);
    // Not finished, until it says so: what it shows before a kill is known to be its own.
    let mut step = Step {
        line: line.text.clone(),
        made_of: String::new(),
        before: revision,
        after: revision,
        inputs: plan.inputs[number].clone(),
        outputs: Vec::new(),
        answer: serde_json::json!({ "error": "killed" }),
        seconds: 0.0,
        time: store::now(),
    };
    project.keep_step(number, &step)?;
    drop(project);
    let was = files(&clip.folder, &file)?;
    let since = Instant::now();
    let ran = match run(command, common) {
        Ok(Outcome::Answer(answer)) if answer.done => Ok(answer),
        Ok(Outcome::Answer(answer)) => Err(anyhow::anyhow!("not all was done: {}", answer.text)),
        Ok(Outcome::Exit(_)) => Err(anyhow::anyhow!("a step has an answer")),
        Err(error) => Err(error),
    };
    let seconds = since.elapsed().as_secs_f64();
    let outputs = written(&clip.folder, &was, &files(&clip.folder, &file)?)?;
    let mine = |path: &str| outputs.iter().any(|file| file.path == path);
    let earlier = others.iter().take(number).flat_map(|step| &step.outputs).find(|file| mine(&file.path));
    if let Some(both) = earlier {
        anyhow::bail!("two steps write {}: let one name another file", both.path);
    }
    let mut project = Project::open(&file, Access::Write)?;
    (step.made_of, step.answer) = match &ran {
        Ok(answer) => (plan.made_of[number].clone(), answer.json.clone()),
        Err(error) => (String::new(), serde_json::json!({ "error": report::chain(error) })),
    };
    step = Step { after: project.revision(), outputs, seconds, time: store::now(), ..step };
    project.keep_step(number, &step)?;
    let answer = ran?.json;
    tell(&Told::Done { step: number, seconds, answer });
    Ok(())
}

/// The files of a folder, with size and time of the last change; without projects and what lies hidden.
fn files(folder: &Path, project: &Path) -> anyhow::Result<BTreeMap<PathBuf, (u64, std::time::SystemTime)>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().with_context(|| format!("cannot read {}", folder.display()))? {
            let entry = entry?;
            let (path, data) = (entry.path(), entry.metadata()?);
            let name = entry.file_name();
            let is_project = path == project || path.extension().is_some_and(|e| e == "honami");
            if is_project || name.as_encoded_bytes().starts_with(b".") {
                continue;
            }
            if data.is_dir() {
                folders.push(path);
            } else {
                found.insert(path, (data.len(), data.modified()?));
            }
        }
    }
    Ok(found)
}

/// What is there now and was not, or was another.
fn written(
    folder: &Path,
    was: &BTreeMap<PathBuf, (u64, std::time::SystemTime)>,
    is: &BTreeMap<PathBuf, (u64, std::time::SystemTime)>,
) -> anyhow::Result<Vec<KeptFile>> {
    let new = is.iter().filter(|(path, seen)| was.get(*path) != Some(seen));
    new.map(|(path, _)| {
        let mut file = look(path, &[])?;
        file.path = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned();
        Ok(file)
    })
    .collect()
}
