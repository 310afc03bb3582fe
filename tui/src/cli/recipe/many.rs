//! Many clips: a process each, so many at a time; one that fails holds up no other.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use rustix::process::{Pid, Signal, kill_process};

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::{Answer, ends, options, report, want};
use super::alone::Told;
use super::plan::{Clip, plan};
use super::told::{Fate, Shown, planned, summary};
use super::{Recipe, plugins};

/// How many threads a process may have: whoever has set it means it for each clip.
const THREADS: &str = "RAYON_NUM_THREADS";

/// The clips that were named, in their order, with their folders.
pub(super) fn clips(named: &[String], into: &Path) -> anyhow::Result<Vec<Clip>> {
    let mut seen: BTreeMap<String, PathBuf> = BTreeMap::new();
    let mut clips = Vec::with_capacity(named.len());
    for word in named {
        // A path that is there is one, also where it has a `=`.
        let (name, path) = match word.split_once('=') {
            Some((name, path)) if !Path::new(word).exists() => (name.to_owned(), PathBuf::from(path)),
            _ => (name_of(Path::new(word)), PathBuf::from(word)),
        };
        let is_name = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\0']);
        want(is_name, || format!("{word}: wanted NAME=CLIP, with a name that a folder can have"))?;
        if let Some(other) = seen.insert(name.clone(), path.clone()) {
            let (one, two) = (other.display(), path.display());
            want(false, || {
                format!("{one} and {two} would both be called {name}: say NAME=CLIP of one of them")
            })?;
        }
        let folder = into.join(&name);
        clips.push(Clip { name, path, folder });
    }
    Ok(clips)
}

/// What a clip's file or folder is called, without its ending; of a pattern without what stands for the number.
fn name_of(path: &Path) -> String {
    let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
    let name = stem.unwrap_or_default().to_string_lossy().into_owned();
    let name = name.split('%').next().unwrap_or_default().trim_end_matches(['_', '-']).to_owned();
    // `frame_%04d.png` in folders of their own are told apart by these.
    let folder = path.parent().and_then(Path::file_name);
    if path.to_string_lossy().contains('%')
        && let Some(folder) = folder
    {
        return folder.to_string_lossy().into_owned();
    }
    name
}

/// Follows a recipe with all clips.
pub(in crate::cli) fn run(args: &Run, common: &Common) -> anyhow::Result<Answer> {
    let recipe = Recipe::read(&args.recipe)?;
    let clips = clips(&args.clips, &args.into)?;
    let registry = options(common).registry();
    for line in &recipe.steps {
        // What no clip could do is said once, before the first.
        let cli = line.command(Path::new("clip.honami"), "clip")?;
        for (kind, name) in cli.command.iter().flat_map(plugins) {
            registry.find(kind, &name)?;
        }
    }
    if args.dry_run {
        return Ok(planned(&recipe, &clips, &registry));
    }
    let since = Instant::now();
    let fates = all(args, common, &recipe, &clips, &registry)?;
    Ok(summary(&recipe, &clips, &fates, since.elapsed().as_secs_f64()))
}

/// Shares the clips out to processes, and waits for them all.
fn all(
    args: &Run,
    common: &Common,
    recipe: &Recipe,
    clips: &[Clip],
    registry: &honami_workbench::plugins::Registry,
) -> anyhow::Result<Vec<Fate>> {
    let n_jobs = usize::from(args.jobs).min(clips.len());
    let stop = Arc::new(AtomicBool::new(false));
    ends::stops(&stop);
    let shown = Shown::new(clips.len(), n_jobs);
    let crew = Crew {
        args,
        common,
        recipe,
        clips,
        registry,
        program: std::env::current_exe().context("cannot find this program")?,
        n_threads: (thread::available_parallelism().map_or(1, std::num::NonZero::get) / n_jobs).max(1),
        next: AtomicUsize::new(0),
        stop: &stop,
        children: Mutex::default(),
        shown: &shown,
    };
    let fates = Mutex::new(vec![Fate { stopped: true, ..Fate::default() }; clips.len()]);
    let left = AtomicUsize::new(n_jobs);
    thread::scope(|scope| -> std::io::Result<()> {
        for worker in 0..n_jobs {
            let (crew, fates, left) = (&crew, &fates, &left);
            thread::Builder::new().name(format!("clip-{worker}")).spawn_scoped(scope, move || {
                while let Some((number, fate)) = crew.one(worker) {
                    lock(fates)[number] = fate;
                }
                left.fetch_sub(1, Ordering::Relaxed);
            })?;
        }
        let mut told = false;
        while left.load(Ordering::Relaxed) > 0 {
            if stop.load(Ordering::Relaxed) && !told {
                told = true;
                crew.end();
            }
            thread::park_timeout(Duration::from_millis(50));
        }
        Ok(())
    })
    .context("cannot start a thread")?;
    drop(shown);
    Ok(fates.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Those who follow the recipe, each with one clip at a time.
struct Crew<'a> {
    args: &'a Run,
    common: &'a Common,
    recipe: &'a Recipe,
    clips: &'a [Clip],
    registry: &'a honami_workbench::plugins::Registry,
    program: PathBuf,
    /// Threads that each process may have.
    n_threads: usize,
    next: AtomicUsize,
    stop: &'a AtomicBool,
    /// Processes at work, by worker.
    children: Mutex<BTreeMap<usize, Pid>>,
    shown: &'a Shown,
}

impl Crew<'_> {
    /// Does the next clip; `None` when there is none, or all is to stop.
    fn one(&self, worker: usize) -> Option<(usize, Fate)> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        if number >= self.clips.len() || self.stop.load(Ordering::Relaxed) {
            return None;
        }
        let clip = &self.clips[number];
        let fate = match plan(self.recipe, clip, self.registry) {
            Err(error) => Fate::failed(0, report::chain(&error)),
            Ok(plan) if plan.why.is_none() => Fate { n_fresh: plan.n_fresh, ..Fate::default() },
            Ok(plan) => {
                let begun = Fate { n_fresh: plan.n_fresh, ..Fate::default() };
                self.follow(worker, clip, begun)
                    .unwrap_or_else(|error| Fate::failed(0, report::chain(&error)))
            }
        };
        self.shown.through(worker, clip, &fate);
        Some((number, fate))
    }

    /// Follows the recipe with a clip in a process, and listens to it.
    fn follow(&self, worker: usize, clip: &Clip, mut fate: Fate) -> anyhow::Result<Fate> {
        let mut child = self.start(clip)?;
        let pid = Pid::from_child(&child);
        lock(&self.children).insert(worker, pid);
        if self.stop.load(Ordering::Relaxed) {
            self.end();
        }
        let said = child.stderr.take();
        let (lines, errors) = thread::scope(|scope| {
            let errors =
                thread::Builder::new().name("errors".to_owned()).spawn_scoped(scope, || last_line(said));
            let out = child.stdout.take().map(BufReader::new);
            for line in out.into_iter().flat_map(BufReader::lines).map_while(Result::ok) {
                match serde_json::from_str(&line) {
                    Ok(Told::At { step, done, total, what }) => {
                        self.shown.at(worker, clip, self.recipe, (step, done, total, &what));
                    }
                    Ok(Told::Fresh { n }) => fate.n_fresh = n,
                    Ok(Told::Done { step, seconds, answer }) => fate.done.push((step, seconds, answer)),
                    Ok(Told::Failed { step, why }) => fate.failed = Some((step, why)),
                    Err(_) => {}
                }
            }
            (fate, errors.ok().and_then(|errors| errors.join().ok()).unwrap_or_default())
        });
        let mut fate = lines;
        let status = child.wait().context("cannot wait for a process")?;
        lock(&self.children).remove(&worker);
        if self.stop.load(Ordering::Relaxed) && !status.success() {
            fate.stopped = true;
            fate.failed = None;
        } else if !status.success() && fate.failed.is_none() {
            let at = fate.done.last().map_or(0, |(step, ..)| step + 1);
            fate.failed = Some((at, format!("its process ended with {status}{errors}")));
        }
        Ok(fate)
    }

    fn start(&self, clip: &Clip) -> anyhow::Result<Child> {
        let mut command = Command::new(&self.program);
        command.arg("run").arg(&self.args.recipe).arg("--alone").arg("--into").arg(&self.args.into);
        command.args(self.args.over_edits.then_some("--over-edits"));
        for (option, paths) in [("--plugin", &self.common.plugins), ("--dev", &self.common.dev)] {
            for path in paths {
                // It works in the folder of the clip.
                command.arg(option).arg(std::path::absolute(path)?);
            }
        }
        let mut named = std::ffi::OsString::from(format!("{}=", clip.name));
        named.push(&clip.path);
        command.arg("--").arg(named);
        if std::env::var_os(THREADS).is_none() {
            command.env(THREADS, self.n_threads.to_string());
        }
        // In a group of its own: Ctrl-C is for this process, which tells the others.
        command.process_group(0).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().with_context(|| format!("cannot start {}", self.program.display()))
    }

    /// Asks every process to stop and keep what it has.
    fn end(&self) {
        // One that has ended meanwhile has nothing to stop.
        lock(&self.children).values().for_each(|pid| kill_process(*pid, Signal::INT).unwrap_or_default());
    }
}

/// The last line of what a process says on standard error, for the line about its end; whatever its bytes are.
fn last_line(said: Option<std::process::ChildStderr>) -> String {
    let lines = said.map(BufReader::new).into_iter().flat_map(|said| said.split(b'\n')).map_while(Result::ok);
    let last = lines.filter(|line| !line.trim_ascii().is_empty()).last();
    last.map_or_else(String::new, |line| format!(": {}", String::from_utf8_lossy(&line).trim()))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
