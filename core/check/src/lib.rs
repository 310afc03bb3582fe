//! What a plugin must bear before anybody relies on it: checks in ten levels, each with a seed that repeats it.
//!
//! 1 file, 2 loading, 3 ABI, 4 parameters, 5 state, 6 frames, 7 truth of trackers, 8 truth of the other kinds, 9 running,
//! 10 stress. [`checks`] is the table of all; a [`Subject`] is the plugin under test. A check runs where it is called:
//! who calls many gives each a process of its own, because a plugin may take its process with it.

mod abi;
mod clip;
mod clusterer;
mod course;
mod crew;
mod file;
mod frames;
mod guarded;
mod ledger;
mod loading;
mod params;
mod raw;
mod report;
mod running;
mod simulator;
mod state;
mod stress;
mod structure;
mod subject;
mod truth;
mod work;

pub use crew::{Asker, Outcome, Plan, examine};
pub use ledger::Ledger;
pub use report::{Report, Status, counts, junit};
pub use subject::Subject;

use honami_host::HostError;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// One thing that a plugin must do, or must not.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// `subject.fault-or-virtue`, as typed after `--only`.
    pub id: &'static str,
    /// 1 to 10: the lower, the fewer plugins can do without.
    pub level: u8,
    /// What holds of a plugin that passes, in a sentence.
    pub claim: &'static str,
    /// After so long it has failed.
    pub deadline: Duration,
    /// Finds out.
    pub run: fn(&Subject) -> Result<Verdict, Fault>,
}

/// What a check has found, when it found no fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The claim holds; with what was measured, or nothing.
    Holds(String),
    /// It holds, and somebody should look at this all the same.
    Doubtful(String),
    /// It says nothing of this plugin, and why.
    Beside(String),
}

/// Why the claim of a check does not hold: what was wanted, and what came.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub String);

impl From<HostError> for Fault {
    fn from(error: HostError) -> Self {
        Self(error.to_string())
    }
}

/// What has come of a check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Finding {
    /// See [`Verdict`].
    Holds(String),
    /// See [`Verdict`].
    Doubtful(String),
    /// See [`Verdict`].
    Beside(String),
    /// What was wanted, and what came.
    Fails(String),
}

impl From<Verdict> for Finding {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Holds(text) => Self::Holds(text),
            Verdict::Doubtful(text) => Self::Doubtful(text),
            Verdict::Beside(text) => Self::Beside(text),
        }
    }
}

impl Finding {
    /// For reports: `passed`, `doubtful`, `beside` or `failed`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Holds(_) => "passed",
            Self::Doubtful(_) => "doubtful",
            Self::Beside(_) => "beside",
            Self::Fails(_) => "failed",
        }
    }

    /// What is said of it; nothing, when there is nothing to say.
    #[must_use]
    pub fn text(&self) -> &str {
        let (Self::Holds(text) | Self::Doubtful(text) | Self::Beside(text) | Self::Fails(text)) = self;
        text
    }
}

/// What the levels are about, from 1 on.
const LEVELS: [&str; 10] = [
    "file",
    "loading",
    "ABI",
    "parameters",
    "state",
    "frames",
    "truth of trackers",
    "truth of other kinds",
    "running",
    "stress",
];

/// What a level is about, in a word or three; nothing for none.
#[must_use]
pub fn level_name(level: u8) -> &'static str {
    usize::from(level).checked_sub(1).and_then(|k| LEVELS.get(k)).copied().unwrap_or_default()
}

/// All checks, level by level.
#[must_use]
pub fn checks() -> Vec<Check> {
    let mut checks = [
        file::CHECKS,
        loading::CHECKS,
        abi::CHECKS,
        params::CHECKS,
        state::CHECKS,
        frames::CHECKS,
        &truth::checks(),
        clusterer::CHECKS,
        structure::CHECKS,
        simulator::CHECKS,
        &running::checks(),
        stress::CHECKS,
    ]
    .concat();
    checks.sort_by_key(|check| check.level);
    checks
}
