//! Listening to a plugin at work: its progress and its words go on to whoever watches, its warnings are kept.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use honami_host::{CallContext, Level};

use crate::progress::{Flow, Progress};

/// More different warnings than a person reads.
const MAX_WARNINGS: usize = 20;

/// What was warned of, and how much more there was.
#[derive(Default)]
struct Warnings {
    told: Vec<String>,
    n_more: usize,
}

/// Listens to the calls of one job.
pub(crate) struct Ear<'a> {
    /// Short name of the plugin.
    plugin: String,
    progress: &'a dyn Progress,
    warnings: Mutex<Warnings>,
    /// The frame that it is at; below 0 where it is at none.
    frame: AtomicI64,
    /// How long whoever watches took while it was at work.
    busy: Mutex<Duration>,
}

impl<'a> Ear<'a> {
    /// Listens to the plugin of this id.
    pub(crate) fn new(plugin: &str, progress: &'a dyn Progress) -> Self {
        let plugin = plugin.rsplit('.').next().unwrap_or(plugin).to_owned();
        let (warnings, frame, busy) = (Mutex::default(), AtomicI64::new(-1), Mutex::default());
        Self { plugin, progress, warnings, frame, busy }
    }

    /// From now on it is at this frame of the clip.
    pub(crate) fn at(&self, frame: u32) {
        self.frame.store(i64::from(frame), Ordering::Relaxed);
        self.progress.at(frame);
    }

    /// The frame that it is at, where it is at one.
    fn frame(&self) -> Option<u32> {
        u32::try_from(self.frame.load(Ordering::Relaxed)).ok()
    }

    /// Its process has ended in this frame, and how; then what became of it.
    pub(crate) fn died(&self, frame: u32, how: &str, then: Option<&str>) {
        self.progress.died(&self.plugin, frame, how, then);
    }

    /// For how long whoever watches has been busy while a plugin was at work, all calls together.
    pub(crate) fn busy(&self) -> Duration {
        *self.busy.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes one call while `done` of `total` steps are done.
    pub(crate) fn call<R>(&self, done: u64, total: u64, work: impl FnOnce(&CallContext<'_>) -> R) -> R {
        self.listen(|_| self.progress.report(done, total, "frame"), work)
    }

    /// Whether the job is to stop, between two calls.
    pub(crate) fn is_told_to_stop(&self, done: u64, total: u64) -> bool {
        self.progress.report(done, total, "frame") == Flow::Stop
    }

    /// Makes the only call of a job; its progress is the plugin's own.
    pub(crate) fn whole<R>(&self, what: &str, work: impl FnOnce(&CallContext<'_>) -> R) -> R {
        self.listen(|share| self.progress.report((share.clamp(0.0, 1.0) * 1000.0) as u64, 1000, what), work)
    }

    fn listen<R>(&self, report: impl Fn(f64) -> Flow + Sync, work: impl FnOnce(&CallContext<'_>) -> R) -> R {
        let at = Mutex::new(String::new());
        let progress = |share: f64, words: &str| {
            words.clone_into(&mut at.lock().unwrap_or_else(PoisonError::into_inner));
            let begun = Instant::now();
            let flow = report(share);
            *self.busy.lock().unwrap_or_else(PoisonError::into_inner) += begun.elapsed();
            flow
        };
        let silent = |silence| {
            let at = at.lock().unwrap_or_else(PoisonError::into_inner);
            self.progress.silent(&self.plugin, self.frame(), &at, silence)
        };
        let done = work(&CallContext {
            progress: &progress,
            log: &|level, text| self.hear(level, text),
            silent: &silent,
        });
        // It has answered.
        silent(None);
        done
    }

    fn hear(&self, level: Level, text: &str) {
        self.progress.hear(&self.plugin, self.frame(), level, text);
        let mut warnings = self.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        if level < Level::Warning || warnings.told.iter().any(|known| known == text) {
            return;
        }
        match warnings.told.len() < MAX_WARNINGS {
            true => warnings.told.push(text.to_owned()),
            false => warnings.n_more += 1,
        }
    }

    /// Warns of what became of the plugin itself, however much it has warned of.
    pub(crate) fn warn(&self, text: String) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).told.push(text);
    }

    /// What the plugin warned of, each once, in the order it came, and how often it warned beyond what is kept.
    pub(crate) fn warnings(self) -> Vec<String> {
        let Warnings { mut told, n_more } =
            self.warnings.into_inner().unwrap_or_else(PoisonError::into_inner);
        if n_more > 0 {
            told.push(format!("and {n_more} warnings more, which are told with -v"));
        }
        told
    }
}

#[cfg(test)]
mod tests;
