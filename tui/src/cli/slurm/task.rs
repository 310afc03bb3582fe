//! One task of an array job: the recipe is followed with its clips, one after the other; what becomes of them is kept.

use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use anyhow::Context as _;
use honami_workbench::media;
use honami_workbench::store;
use serde_json::json;

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::args::slurm::Task;
use super::super::recipe::Recipe;
use super::super::recipe::alone::Told;
use super::super::recipe::crew::{self, Listener};
use super::super::recipe::plan::Clip;
use super::super::recipe::told::{Fate, words};
use super::super::{Answer, options, report};
use super::{Ended, Submission, ended, log, write};

/// A lock of a node that has died may be held by the file server for so long: NFS 4 has leases of 90 s.
const PATIENCE_S: u64 = 180;

pub(in crate::cli) fn task(args: &Task) -> anyhow::Result<Answer> {
    let into = std::path::absolute(&args.into)?;
    let submission = Submission::read(&into)?;
    let numbers = submission
        .tasks
        .get(args.number)
        .with_context(|| format!("there is no task {}, there are {}", args.number, submission.tasks.len()))?;
    let clips =
        numbers.iter().map(|number| submission.clip(*number, &into)).collect::<Result<Vec<_>, _>>()?;
    let recipe_file = &submission.recipe;
    anyhow::ensure!(
        media::sha256_of_file(recipe_file)? == submission.recipe_sha256,
        "{} was changed since it was submitted: cancel, and submit again",
        recipe_file.display()
    );
    let recipe = Recipe::read(recipe_file)?;
    let common =
        Common { plugins: submission.plugins.clone(), dev: submission.dev.clone(), ..Common::default() };
    let run = Run {
        recipe: recipe_file.clone(),
        clips: Vec::new(),
        into: into.clone(),
        jobs: 1,
        dry_run: false,
        over_edits: submission.over_edits,
        alone: false,
        patience: PATIENCE_S,
        threads: Some(usize::from(submission.cpus)),
    };
    let keeper = Keeper::new(&into);
    let fates = crew::all((&run, &common), &recipe, &clips, &options(&common).registry(), &keeper)?;
    keeper.trouble()?;
    let n_failed = fates.iter().filter(|fate| fate.failed.is_some() || fate.stopped).count();
    let text = format!("{} of {} clips done", clips.len() - n_failed, clips.len());
    Ok(Answer { json: json!({ "clips": clips.len(), "failed": n_failed }), text, done: n_failed == 0 })
}

/// Keeps a log of every clip, and how it has ended.
struct Keeper<'a> {
    into: &'a Path,
    node: String,
    restarts: u32,
    /// The first thing that could not be written.
    trouble: Mutex<Option<anyhow::Error>>,
}

impl<'a> Keeper<'a> {
    fn new(into: &'a Path) -> Self {
        let of = |name: &str| std::env::var(name).unwrap_or_default();
        Self {
            into,
            node: of("SLURMD_NODENAME"),
            restarts: of("SLURM_RESTART_COUNT").parse().unwrap_or(0),
            trouble: Mutex::default(),
        }
    }

    fn note(&self, clip: &Clip, line: &str) {
        let path = log(self.into, &clip.name);
        let mut open = OpenOptions::new();
        let written = open
            .create(true)
            .append(true)
            .open(&path)
            .and_then(|mut file: File| writeln!(file, "{} {}: {line}", store::now(), self.node));
        self.keep(written.with_context(|| format!("cannot write {}", path.display())));
    }

    fn keep(&self, result: anyhow::Result<()>) {
        if let Err(error) = result {
            self.trouble.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        }
    }

    fn trouble(self) -> anyhow::Result<()> {
        self.trouble.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
    }
}

impl Listener for Keeper<'_> {
    fn begins(&self, clip: &Clip) {
        // A task that Slurm begins anew says again how its clips have ended.
        fs::remove_file(ended(self.into, &clip.name)).unwrap_or_default();
        let again =
            if self.restarts > 0 { format!(", begun anew {} times", self.restarts) } else { String::new() };
        self.note(clip, &format!("begins{again}"));
    }

    fn told(&self, _worker: usize, clip: &Clip, told: &Told) {
        if let Told::Done { step, seconds, .. } = told {
            self.note(clip, &format!("step {step} done in {seconds:.1} s"));
        }
    }

    fn said(&self, clip: &Clip, line: &str) {
        self.note(clip, line);
    }

    fn through(&self, _worker: usize, clip: &Clip, fate: &Fate) {
        self.note(clip, &words(fate));
        report::say(&format!("{}: {}", clip.name, words(fate)));
        let kept = Ended {
            node: self.node.clone(),
            restarts: self.restarts,
            fresh: fate.n_fresh,
            done: fate.done.clone(),
            failed: fate.failed.clone(),
            stopped: fate.stopped,
            peak_bytes: fate.peak_bytes,
        };
        self.keep(write(&ended(self.into, &clip.name), &kept));
    }
}
