//! Runs checks, each in a process of its own, which a plugin may take with it.
//!
//! The process is honami itself, told to do one check and to answer at its standard input; what the plugin prints is
//! kept apart from that. It has a process group of its own, and nothing of the group outlives the check.

mod worker;

pub use worker::Asker;

use crate::{Check, Finding, Subject};
use honami_host::quoted;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

/// So many checks run at once.
const AT_ONCE: usize = 2;
/// The check that fails when nothing can be loaded: then nothing else is asked.
pub(crate) const LOADS: &str = "loading.starts";

/// What is to be checked, and where.
#[derive(Clone, Debug)]
pub struct Plan {
    /// honami.
    pub program: PathBuf,
    /// The library, or the manifest of a program.
    pub file: PathBuf,
    /// Full id of the plugin.
    pub plugin: String,
    /// Which checks, level by level.
    pub checks: Vec<Check>,
    /// Of every random choice.
    pub seed: u64,
}

/// What has come of a check, and how to do it again.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Which.
    pub check: Check,
    /// What was found.
    pub finding: Finding,
    /// How long it took.
    pub took: Duration,
    /// The command that does it again, in the process that is typed into.
    pub repeat: String,
}

impl Plan {
    /// Does the checks; `told` hears of each in their order, as soon as those before it are done. Where the plugin cannot
    /// be started at all, what lies above the file and that is left out.
    #[must_use]
    pub fn run(&self, told: &mut dyn FnMut(&Outcome)) -> Vec<Outcome> {
        let (first, rest): (Vec<_>, Vec<_>) =
            self.checks.iter().partition(|check| check.level < 2 || check.id == LOADS);
        let mut outcomes = self.share(&first, told);
        let starts = outcomes.iter().all(|o| o.check.id != LOADS || !matches!(o.finding, Finding::Fails(_)));
        if starts {
            outcomes.extend(self.share(&rest, told));
        }
        outcomes
    }

    /// Several processes at once, and their answers in the order of the checks.
    fn share(&self, checks: &[&Check], told: &mut dyn FnMut(&Outcome)) -> Vec<Outcome> {
        let n_workers = AT_ONCE.min(std::thread::available_parallelism().map_or(1, NonZero::get));
        let (next, (say, hear)) = (AtomicUsize::new(0), sync_channel(n_workers));
        let mut outcomes = Vec::new();
        std::thread::scope(|scope| {
            for k in 0..n_workers {
                let (say, next) = (say.clone(), &next);
                let work = move || {
                    loop {
                        let at = next.fetch_add(1, Ordering::Relaxed);
                        let Some(check) = checks.get(at) else { return };
                        if say.send((at, self.outcome(check))).is_err() {
                            return;
                        }
                    }
                };
                let worker = std::thread::Builder::new().name(format!("check {k}"));
                if worker.spawn_scoped(scope, work).is_err() {
                    break;
                }
            }
            drop(say);
            let mut early = BTreeMap::new();
            for (at, outcome) in hear {
                early.insert(at, outcome);
                while let Some(outcome) = early.remove(&outcomes.len()) {
                    told(&outcome);
                    outcomes.push(outcome);
                }
            }
        });
        // Where no thread could be had it is done here.
        for check in &checks[outcomes.len()..] {
            let outcome = self.outcome(check);
            told(&outcome);
            outcomes.push(outcome);
        }
        outcomes
    }

    fn outcome(&self, check: &Check) -> Outcome {
        let began = Instant::now();
        let finding = worker::ask(self, check)
            .unwrap_or_else(|error| Finding::Fails(format!("no process could be started for it: {error}")));
        Outcome { check: *check, finding, took: began.elapsed(), repeat: self.repeat(check) }
    }

    /// The command that does a check again, where somebody can look on.
    #[must_use]
    pub fn repeat(&self, check: &Check) -> String {
        let (file, plugin) = (quoted(&self.file), &self.plugin);
        format!("honami plugin check {file} --plugin-id {plugin} --reproduce {}:{}", check.id, self.seed)
    }
}

/// Does one check in this process.
#[must_use]
pub fn examine(check: &Check, subject: &Subject) -> Finding {
    (check.run)(subject).map_or_else(|fault| Finding::Fails(fault.0), Finding::from)
}
