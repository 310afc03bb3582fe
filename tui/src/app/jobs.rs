//! Work behind the screen: one job at a time, on a thread of its own, with progress and a stop.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use honami_workbench::WorkbenchError;
use honami_workbench::cluster::{ClusterDone, ClusterJob};
use honami_workbench::matte::{self, MatteRequest, Matted};
use honami_workbench::media::Still;
use honami_workbench::progress::{Flow, Level, Patience, Progress, Silence};
use honami_workbench::retrack::{RetrackJob, Retracked};
use honami_workbench::track::{TrackDone, TrackJob};

use super::prints::{N_KEPT, Print};
use super::state::Quiet;
use crate::term::signals::Waker;

/// Progress wakes the screen this often at most.
const TICK: Duration = Duration::from_millis(100);

/// A job that can be run on any thread.
pub(super) enum Work {
    Track(Box<TrackJob>),
    Retrack(Box<RetrackJob>),
    Cluster(Box<ClusterJob>),
    Matte(Box<MatteJob>),
}

/// The matte of a frame that is to be found.
pub(super) struct MatteJob {
    pub(super) frame: u32,
    /// Of so many strokes.
    pub(super) n_strokes: usize,
    pub(super) still: Still,
    pub(super) request: MatteRequest,
}

/// What a job has come to.
pub(super) enum Done {
    Track(Box<Result<TrackDone, WorkbenchError>>),
    Retrack(Box<Result<Retracked, WorkbenchError>>),
    Cluster(Box<Result<ClusterDone, WorkbenchError>>),
    Matte(Box<MatteJob>, Box<Result<Matted, WorkbenchError>>),
}

/// How far a job is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Step {
    pub(super) done: u64,
    pub(super) total: u64,
    pub(super) what: String,
    /// The frame of the clip that its plugin is at.
    pub(super) frame: Option<u32>,
}

/// A job that runs.
pub(super) struct Running {
    shared: Arc<Shared>,
    thread: JoinHandle<Done>,
    /// Says nothing: it is closed when the thread ends.
    alive: Receiver<()>,
}

struct Shared {
    step: Mutex<(Step, Option<Instant>)>,
    /// What plugins have printed and nobody has asked for yet.
    prints: Mutex<VecDeque<Print>>,
    watch: Mutex<Watch>,
    stop: AtomicBool,
    ended: Arc<AtomicBool>,
    waker: Waker,
    /// What has become of it on its way, and was not told yet.
    said: Mutex<Vec<String>>,
}

impl Progress for Shared {
    fn report(&self, done: u64, total: u64, what: &str) -> Flow {
        let mut step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        step.0 = Step { done, total, what: what.to_owned(), frame: step.0.frame };
        if step.1.is_none_or(|last| last.elapsed() >= TICK) {
            step.1 = Some(Instant::now());
            self.waker.wake();
        }
        if self.stop.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Continue }
    }

    fn at(&self, frame: u32) {
        self.step.lock().unwrap_or_else(PoisonError::into_inner).0.frame = Some(frame);
    }

    fn silent(&self, plugin: &str, frame: Option<u32>, at: &str, silence: Option<Silence>) -> Patience {
        self.watch.lock().unwrap_or_else(PoisonError::into_inner).look(plugin, frame, at, silence)
    }

    fn say(&self, line: &str) {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_owned());
        self.waker.wake();
    }

    fn hear(&self, plugin: &str, frame: Option<u32>, level: Level, line: &str) {
        let print = Print { frame, plugin: plugin.to_owned(), level, text: line.to_owned() };
        let mut prints = self.prints.lock().unwrap_or_else(PoisonError::into_inner);
        prints.push_back(print);
        if prints.len() > N_KEPT {
            prints.pop_front();
        }
    }

    fn died(&self, plugin: &str, frame: u32, how: &str, then: Option<&str>) {
        self.hear(plugin, Some(frame), Level::Error, how);
        if let Some(then) = then {
            self.hear(plugin, Some(frame), Level::Warning, then);
            self.say(&format!("{plugin}, frame {frame}: {how}; {then}"));
        }
    }
}

/// A silent plugin, and what its user has answered.
#[derive(Default)]
struct Watch {
    quiet: Option<Quiet>,
    /// It is not asked again before so long a silence.
    waits: Duration,
    is_to_end: bool,
}

impl Watch {
    /// Somebody is there to be asked: nothing is ended unless they say so.
    fn look(&mut self, plugin: &str, frame: Option<u32>, at: &str, silence: Option<Silence>) -> Patience {
        let Some(Silence { since, is_too_long, at_most, .. }) = silence else {
            *self = Self::default();
            return Patience::Usual;
        };
        let is_asked = is_too_long && since >= self.waits;
        let (plugin, at) = (plugin.to_owned(), at.to_owned());
        let (seconds, limit_s) = (since.as_secs(), at_most.as_secs());
        self.quiet = Some(Quiet { plugin, frame, seconds, limit_s, at, is_asked });
        if std::mem::take(&mut self.is_to_end) { Patience::End } else { Patience::Wait }
    }

    fn answer(&mut self, patience: Patience) {
        let Some(quiet) = &self.quiet else { return };
        match patience {
            Patience::End => self.is_to_end = true,
            _ => self.waits = Duration::from_secs(quiet.again_s()),
        }
    }
}

impl Running {
    pub(super) fn start(work: Work, waker: Waker) -> std::io::Result<Self> {
        Self::spawn(waker, move |progress| match work {
            Work::Track(job) => Done::Track(Box::new(job.run(progress))),
            Work::Retrack(job) => Done::Retrack(Box::new(job.run(progress))),
            Work::Cluster(job) => Done::Cluster(Box::new(job.run(progress))),
            Work::Matte(job) => {
                let found = matte::run(&job.still, &job.request, progress);
                Done::Matte(job, Box::new(found))
            }
        })
    }

    fn spawn(
        waker: Waker,
        work: impl FnOnce(&dyn Progress) -> Done + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            step: Mutex::default(),
            prints: Mutex::default(),
            watch: Mutex::default(),
            said: Mutex::default(),
            stop: AtomicBool::new(false),
            ended: Arc::default(),
            waker,
        });
        let progress = Arc::clone(&shared);
        let (end, alive) = sync_channel(1);
        let thread = std::thread::Builder::new().name("job".to_owned()).spawn(move || {
            // Woken also when the job panics: the thread has ended, however.
            let _end = (progress.waker.at_end(&progress.ended), end);
            work(&*progress)
        })?;
        Ok(Self { shared, thread, alive })
    }

    pub(super) fn stop(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn step(&self) -> Step {
        self.shared.step.lock().unwrap_or_else(PoisonError::into_inner).0.clone()
    }

    /// The plugin of it that gives no sign of life.
    pub(super) fn quiet(&self) -> Option<Quiet> {
        self.shared.watch.lock().unwrap_or_else(PoisonError::into_inner).quiet.clone()
    }

    /// What its user says of that one.
    pub(super) fn answer(&self, patience: Patience) {
        self.shared.watch.lock().unwrap_or_else(PoisonError::into_inner).answer(patience);
    }

    /// What plugins have printed since it was asked last.
    pub(super) fn prints(&self) -> Vec<Print> {
        self.shared.prints.lock().unwrap_or_else(PoisonError::into_inner).drain(..).collect()
    }

    /// What has become of the job on its way, told once.
    pub(super) fn said(&self) -> Vec<String> {
        std::mem::take(&mut *self.shared.said.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(super) fn is_finished(&self) -> bool {
        self.shared.ended.load(Ordering::Acquire)
    }

    /// Waits for the end, but no longer than this; whether it came.
    pub(super) fn ends_within(&self, patience: Duration) -> bool {
        self.alive.recv_timeout(patience) == Err(RecvTimeoutError::Disconnected)
    }

    /// Waits for the end; `None` when the job panicked.
    pub(super) fn join(self) -> Option<Done> {
        self.thread.join().ok()
    }
}

#[cfg(test)]
mod tests;
