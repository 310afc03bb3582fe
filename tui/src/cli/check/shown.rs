//! What is shown of checks while they are done: a line a level and what was found wrong, or a line a check.

use std::time::Instant;

use honami_workbench::check::{Finding, Outcome, counts, level_name};

use super::print;

/// The checks of the level that is at work.
pub(super) struct Shown {
    is_whole: bool,
    outcomes: Vec<Outcome>,
    since: Instant,
}

impl Shown {
    /// Nothing yet; `is_whole` gives a line a check.
    pub(super) fn new(is_whole: bool) -> Self {
        Self { is_whole, outcomes: Vec::new(), since: Instant::now() }
    }

    /// A check is done; they come level by level.
    pub(super) fn hear(&mut self, outcome: &Outcome) -> anyhow::Result<()> {
        if self.is_whole {
            return print(&line(outcome));
        }
        if self.outcomes.last().is_some_and(|last| last.check.level != outcome.check.level) {
            self.end()?;
        }
        self.outcomes.push(outcome.clone());
        Ok(())
    }

    /// The level is done.
    pub(super) fn end(&mut self) -> anyhow::Result<()> {
        let Some(level) = self.outcomes.first().map(|outcome| outcome.check.level) else { return Ok(()) };
        let (name, counts) = (level_name(level), counts(&self.outcomes));
        print(&format!("{level:2}  {name:20}  {counts}, {:.1} s", self.since.elapsed().as_secs_f64()))?;
        self.since = Instant::now();
        let is_wrong =
            |outcome: &Outcome| matches!(outcome.finding, Finding::Fails(_) | Finding::Doubtful(_));
        self.outcomes.drain(..).filter(is_wrong).try_for_each(|outcome| print(&line(&outcome)))
    }
}

/// A check in a line; of one that has failed what came, and how to see it again.
pub(super) fn line(outcome: &Outcome) -> String {
    let Outcome { check, finding, took, repeat } = outcome;
    let head = format!("{:8}  {:2}  {:28}  {}", finding.word(), check.level, check.id, check.claim);
    let said = if finding.text().is_empty() { String::new() } else { format!(": {}", finding.text()) };
    let seconds = took.as_secs_f64();
    match finding {
        Finding::Fails(why) => format!("{head} ({seconds:.1} s)\n          {why}\n          {repeat}"),
        _ => format!("{head}{said} ({seconds:.1} s)"),
    }
}
