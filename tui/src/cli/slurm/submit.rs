//! What is handed to Slurm: which clips go together, and what a task may take.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use honami_model::brief::counted;
use honami_workbench::media::{self, Extent};
use serde_json::json;

use super::super::args::Common;
use super::super::args::slurm::Submit;
use super::super::recipe::plan::{Clip, plan};
use super::super::recipe::{Recipe, many};
use super::super::{Answer, options, want};
use super::{FOLDER, Submission, ended, engine, folder, write};

/// Milliseconds of work of a million pixels, where nothing better is known.
const MS_PER_MPX: f64 = 30.0;
/// So much work makes a task worth its start: a wave of tasks takes Slurm about 0.8 s.
const TASK_S: f64 = 60.0;

/// What starts a task; Slurm gives the number.
const SCRIPT: &str = "#!/bin/sh\nexec \"$1\" task \"$2\" \"$SLURM_ARRAY_TASK_ID\"\n";

pub(in crate::cli) fn submit(args: &Submit, common: &Common) -> anyhow::Result<Answer> {
    let recipe = Recipe::read(&args.recipe)?;
    let registry = options(common).registry();
    recipe.find_plugins(&registry)?;
    let into = std::path::absolute(&args.into)?;
    let mut clips = many::clips(&args.clips, &into)?;
    for clip in &mut clips {
        want(clip.name != FOLDER, || format!("a clip cannot be called {FOLDER}: say NAME=CLIP"))?;
        clip.path = std::path::absolute(&clip.path)?;
    }
    still_at_work(&into)?;
    let n_named = clips.len();
    // One that has no project yet would be read whole here only to learn that.
    clips.retain(|clip| {
        !clip.project().exists() || !plan(&recipe, clip, &registry).is_ok_and(|plan| plan.why.is_none())
    });
    let n_fresh = n_named - clips.len();
    if clips.is_empty() {
        let text = format!("nothing to submit: {} fresh", counted(n_fresh, "clip"));
        return Ok(Answer { json: json!({ "job": null, "tasks": 0, "fresh": n_fresh }), text, done: true });
    }
    let sizes: Vec<Option<Extent>> = clips.iter().map(|clip| media::size_of(&clip.path).ok()).collect();
    let tasks = tasks(args, &sizes)?;
    let mem = args.mem.clone().unwrap_or_else(|| format!("{}M", memory_mb(&sizes)));
    let submission = Submission {
        honami: env!("CARGO_PKG_VERSION").to_owned(),
        program: std::env::current_exe().context("cannot find this program")?,
        recipe: args.recipe.canonicalize()?,
        recipe_sha256: media::sha256_of_file(&args.recipe)?,
        cpus: args.cpus,
        over_edits: args.over_edits,
        plugins: common.plugins.iter().map(std::path::absolute).collect::<Result<_, _>>()?,
        dev: common.dev.iter().map(std::path::absolute).collect::<Result<_, _>>()?,
        clips: clips.iter().map(|clip| (clip.name.clone(), clip.path.clone())).collect(),
        tasks,
        job: None,
    };
    let words = words(args, &submission, &into, &mem);
    let job = if args.dry_run { None } else { Some(hand_over(submission.clone(), &into, &words, &clips)?) };
    let shown: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    let sbatch = shlex::try_join(shown.iter().map(AsRef::as_ref)).unwrap_or_default();
    let (n_clips, n_tasks) = (clips.len(), submission.tasks.len());
    let head = format!("{} in {}, {n_fresh} fresh", counted(n_clips, "clip"), counted(n_tasks, "task"));
    let text = match job {
        None => format!("would be submitted: {head}\nsbatch {sbatch}"),
        Some(job) => format!(
            "submitted as job {job}: {head}\nhonami status {into} says how they are, honami cancel {into} ends them",
            into = args.into.display()
        ),
    };
    let json = json!({ "job": job, "clips": n_clips, "tasks": submission.tasks, "fresh": n_fresh, "sbatch": sbatch });
    Ok(Answer { json, text, done: true })
}

/// Refuses where an earlier job is not through: no two tasks work on one file.
fn still_at_work(into: &Path) -> anyhow::Result<()> {
    if !Submission::file(into).exists() {
        return Ok(());
    }
    let Some(job) = Submission::read(into)?.job else { return Ok(()) };
    let n_left = engine::queue(job)?.len();
    anyhow::ensure!(
        n_left == 0,
        "job {job} of {} is not through, {n_left} tasks are left: wait for it, or end it with honami cancel",
        into.display()
    );
    Ok(())
}

/// Which clips go together: in their order, until there is work enough.
fn tasks(args: &Submit, sizes: &[Option<Extent>]) -> anyhow::Result<Vec<Vec<usize>>> {
    let most = if args.dry_run && args.per_task.is_some() { usize::MAX } else { engine::most_tasks()? };
    let least = sizes.len().div_ceil(most.saturating_sub(1).max(1));
    let mut tasks: Vec<Vec<usize>> = Vec::new();
    let mut work_s = f64::INFINITY;
    for (number, size) in sizes.iter().enumerate() {
        let in_task = tasks.last().map_or(usize::MAX, Vec::len);
        let is_full = match args.per_task {
            Some(n) => in_task >= usize::from(n),
            None => work_s >= TASK_S,
        };
        if in_task == usize::MAX || is_full && in_task >= least {
            tasks.push(Vec::new());
            work_s = 0.0;
        }
        work_s += size.map_or(TASK_S, work_of);
        if let Some(task) = tasks.last_mut() {
            task.push(number);
        }
    }
    Ok(tasks)
}

/// Seconds of work, about.
fn work_of(size: Extent) -> f64 {
    f64::from(size.width) * f64::from(size.height) * size.n_frames as f64 / 1e6 * MS_PER_MPX / 1e3
}

/// What a task may have, megabytes: the program, and frames of the largest clip.
fn memory_mb(sizes: &[Option<Extent>]) -> u64 {
    let most = sizes.iter().flatten().map(|size| u64::from(size.width) * u64::from(size.height)).max();
    800 + most.unwrap_or(0) * 200 / 1_000_000
}

fn words(args: &Submit, submission: &Submission, into: &Path, mem: &str) -> Vec<OsString> {
    let name = args.recipe.file_stem().unwrap_or_default().to_string_lossy();
    // Slurm reads `%` in names of files as its own.
    let logs = folder(into).join("logs").to_string_lossy().replace('%', "%%");
    let mut words = vec![
        "--parsable".into(),
        "--requeue".into(),
        "--open-mode=append".into(),
        format!("--job-name=honami-{name}").into(),
        format!("--array=0-{}%{}", submission.tasks.len() - 1, args.at_once).into(),
        format!("--cpus-per-task={}", args.cpus).into(),
        format!("--mem={mem}").into(),
        format!("--output={logs}/task-%a.out").into(),
    ];
    words.extend(args.partition.iter().map(|name| OsString::from(format!("--partition={name}"))));
    words.extend(args.sbatch.iter().map(OsString::from));
    words.push(script(into).into());
    words.push(submission.program.clone().into());
    words.push(into.to_owned().into());
    words
}

fn script(into: &Path) -> PathBuf {
    folder(into).join("task.sh")
}

/// Writes down what is to be done, and gives it to Slurm.
fn hand_over(
    mut submission: Submission,
    into: &Path,
    words: &[OsString],
    clips: &[Clip],
) -> anyhow::Result<u64> {
    for part in ["logs", "clips"] {
        let folder = folder(into).join(part);
        fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    for clip in clips {
        // How it ended another time says nothing of this one.
        let old = ended(into, &clip.name);
        if old.exists() {
            fs::remove_file(&old).with_context(|| format!("cannot remove {}", old.display()))?;
        }
    }
    let script = script(into);
    fs::write(&script, SCRIPT).with_context(|| format!("cannot write {}", script.display()))?;
    // Before the job: a task may begin at once.
    write(&Submission::file(into), &submission)?;
    let job = engine::submit(words)?;
    submission.job = Some(job);
    write(&Submission::file(into), &submission)?;
    Ok(job)
}
