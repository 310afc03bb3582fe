//! Those who follow a recipe: a process for each clip, so many at a time; one that fails holds up no other.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::os::unix::process::CommandExt as _;
use std::path::PathBuf;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use anyhow::Context as _;
use honami_workbench::plugins::Registry;
use rustix::process::{Pid, Signal, kill_process};

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::{ends, report};
use super::alone::Told;
use super::plan::{Clip, plan};
use super::told::Fate;
use super::{Recipe, memory};

/// How many threads a process may have: whoever has set it means it for each clip.
const THREADS: &str = "RAYON_NUM_THREADS";
/// So often the processes are looked at.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Who is told how the clips are getting on, from any thread.
pub(in crate::cli) trait Listener: Sync {
    /// A worker begins with a clip.
    fn begins(&self, _clip: &Clip) {}

    /// What the process of a clip tells.
    fn told(&self, worker: usize, clip: &Clip, told: &Told);

    /// What the process of a clip says on standard error.
    fn said(&self, _clip: &Clip, _line: &str) {}

    /// A worker is through with a clip.
    fn through(&self, worker: usize, clip: &Clip, fate: &Fate);
}

/// Shares the clips out to processes, and waits for them all.
pub(in crate::cli) fn all(
    (args, common): (&Run, &Common),
    recipe: &Recipe,
    clips: &[Clip],
    registry: &Registry,
    listener: &dyn Listener,
) -> anyhow::Result<Vec<Fate>> {
    let n_jobs = usize::from(args.jobs).min(clips.len());
    let stop = Arc::new(AtomicBool::new(false));
    ends::stops(&stop);
    let n_cores = thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let crew = Crew {
        args,
        common,
        recipe,
        clips,
        registry,
        program: std::env::current_exe().context("cannot find this program")?,
        n_threads: args.threads.unwrap_or(n_cores / n_jobs).max(1),
        next: AtomicUsize::new(0),
        stop: &stop,
        children: Mutex::default(),
        listener,
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
            crew.weigh();
            thread::park_timeout(LOOK_EVERY);
        }
        Ok(())
    })
    .context("cannot start a thread")?;
    Ok(fates.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// A process at work on a clip.
struct Working {
    pid: Pid,
    /// The most memory that it and those that it has started had at once, of what was seen.
    peak_bytes: u64,
}

/// Those who follow the recipe, each with one clip at a time.
struct Crew<'a> {
    args: &'a Run,
    common: &'a Common,
    recipe: &'a Recipe,
    clips: &'a [Clip],
    registry: &'a Registry,
    program: PathBuf,
    /// Threads that each process may have.
    n_threads: usize,
    next: AtomicUsize,
    stop: &'a AtomicBool,
    /// Processes at work, by worker.
    children: Mutex<BTreeMap<usize, Working>>,
    listener: &'a dyn Listener,
}

impl Crew<'_> {
    /// Does the next clip; `None` when there is none, or all is to stop.
    fn one(&self, worker: usize) -> Option<(usize, Fate)> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        if number >= self.clips.len() || self.stop.load(Ordering::Relaxed) {
            return None;
        }
        let clip = &self.clips[number];
        self.listener.begins(clip);
        let fate = match plan(self.recipe, clip, self.registry) {
            Err(error) => Fate::failed(0, report::chain(&error)),
            Ok(plan) if plan.why.is_none() => Fate { n_fresh: plan.n_fresh, ..Fate::default() },
            Ok(plan) => {
                let begun = Fate { n_fresh: plan.n_fresh, ..Fate::default() };
                self.follow(worker, clip, begun)
                    .unwrap_or_else(|error| Fate::failed(0, report::chain(&error)))
            }
        };
        self.listener.through(worker, clip, &fate);
        Some((number, fate))
    }

    /// Follows the recipe with a clip in a process, and listens to it.
    fn follow(&self, worker: usize, clip: &Clip, mut fate: Fate) -> anyhow::Result<Fate> {
        let mut child = self.start(clip)?;
        let pid = Pid::from_child(&child);
        lock(&self.children).insert(worker, Working { pid, peak_bytes: 0 });
        if self.stop.load(Ordering::Relaxed) {
            self.end();
        }
        let said = child.stderr.take();
        let (lines, errors) = thread::scope(|scope| {
            let errors = thread::Builder::new()
                .name("errors".to_owned())
                .spawn_scoped(scope, || self.last_line(clip, said));
            let out = child.stdout.take().map(BufReader::new);
            for line in out.into_iter().flat_map(BufReader::lines).map_while(Result::ok) {
                let Ok(told) = serde_json::from_str(&line) else { continue };
                self.listener.told(worker, clip, &told);
                match told {
                    Told::At { .. } => {}
                    Told::Fresh { n } => fate.n_fresh = n,
                    Told::Done { step, seconds, answer } => fate.done.push((step, seconds, answer)),
                    Told::Failed { step, why } => fate.failed = Some((step, why)),
                    Told::Peak { bytes } => fate.peak_bytes = bytes,
                }
            }
            (fate, errors.ok().and_then(|errors| errors.join().ok()).unwrap_or_default())
        });
        let mut fate = lines;
        let status = child.wait().context("cannot wait for a process")?;
        let seen = lock(&self.children).remove(&worker).map_or(0, |working| working.peak_bytes);
        fate.peak_bytes = fate.peak_bytes.max(seen);
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
        command.arg("--patience").arg(self.args.patience.to_string());
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
        lock(&self.children)
            .values()
            .for_each(|working| kill_process(working.pid, Signal::INT).unwrap_or_default());
    }

    /// Looks how much memory every process has, with those that it has started.
    fn weigh(&self) {
        for working in lock(&self.children).values_mut() {
            working.peak_bytes = working.peak_bytes.max(memory::of_tree(working.pid));
        }
    }

    /// Hears what a process says on standard error, whatever its bytes are; the last line is for the one about its end.
    fn last_line(&self, clip: &Clip, said: Option<ChildStderr>) -> String {
        let mut last = String::new();
        let said = said.map(BufReader::new).into_iter().flat_map(|said| said.split(b'\n'));
        for line in said.map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            if !line.trim().is_empty() {
                self.listener.said(clip, line.trim_end());
                last = format!(": {}", line.trim());
            }
        }
        last
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
