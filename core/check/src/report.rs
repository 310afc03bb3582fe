//! What a plugin's checks have come to: for people, for machines, and for the tools that read JUnit.

use crate::crew::Outcome;
use crate::file::READABLE;
use crate::{Check, Finding};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// The checks of one plugin.
#[derive(Clone, Debug)]
pub struct Report {
    /// Its short name.
    pub name: String,
    /// Its full id.
    pub plugin: String,
    /// Of its file, lower-case hexadecimal; `None` where no plugin could be read from it.
    pub sha256: Option<String>,
    /// Of every random choice.
    pub seed: u64,
    /// All checks up to this level were wanted; `None` when some of them were chosen.
    pub level: Option<u8>,
    /// What came, in the order of the checks.
    pub outcomes: Vec<Outcome>,
    /// How long it took.
    pub took: Duration,
}

/// What checks have come to, taken together; the worse, the higher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// None has failed.
    Passed,
    /// None has failed, and some want to be looked at.
    Doubtful,
    /// Some have failed.
    Failed,
}

impl Report {
    /// Of a file that no plugin can be read from, and why.
    #[must_use]
    pub fn unreadable(file: &Path, why: String) -> Self {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let repeat = format!("honami plugin check {}", file.display());
        let outcome = Outcome { check: READABLE, finding: Finding::Fails(why), took: Duration::ZERO, repeat };
        let (plugin, sha256, outcomes) = (name.clone(), None, vec![outcome]);
        Self { name, plugin, sha256, seed: 0, level: Some(1), outcomes, took: Duration::ZERO }
    }

    /// The worst of its outcomes.
    #[must_use]
    pub fn status(&self) -> Status {
        let status = |outcome: &Outcome| match outcome.finding {
            Finding::Fails(_) => Status::Failed,
            Finding::Doubtful(_) => Status::Doubtful,
            Finding::Holds(_) | Finding::Beside(_) => Status::Passed,
        };
        self.outcomes.iter().map(status).max().unwrap_or(Status::Passed)
    }

    /// The highest level at which something holds, and up to which all checks were wanted and none has failed, from 0;
    /// `None` when some were chosen. Where all stand beside (no files, no such interface) nothing is known of a plugin.
    #[must_use]
    pub fn reached(&self) -> Option<u8> {
        let failed = self.outcomes.iter().filter(|outcome| matches!(outcome.finding, Finding::Fails(_)));
        let lowest = failed.map(|outcome| outcome.check.level.saturating_sub(1)).min();
        let highest = self.level?.min(lowest.unwrap_or(u8::MAX));
        let held = self.outcomes.iter().filter(|outcome| !matches!(outcome.finding, Finding::Beside(_)));
        let held = held.map(|outcome| outcome.check.level).filter(|level| *level <= highest);
        Some(held.max().unwrap_or(0))
    }

    /// The whole in a line: `klt: level 9, 41 checks, 2 beside, 18 s`.
    #[must_use]
    pub fn line(&self) -> String {
        let mut line = format!("{}: ", self.name);
        if let Some(level) = self.reached() {
            line += &format!("level {level}, ");
        }
        format!("{line}{}, {} s", counts(&self.outcomes), self.took.as_secs_f64().round())
    }

    /// All of it for machines.
    #[must_use]
    pub fn json(&self) -> Value {
        let checks: Vec<Value> = self
            .outcomes
            .iter()
            .map(|outcome| {
                let Check { id, level, claim, .. } = outcome.check;
                json!({
                    "id": id,
                    "level": level,
                    "claim": claim,
                    "found": outcome.finding.word(),
                    "text": outcome.finding.text(),
                    "seconds": outcome.took.as_secs_f64(),
                    "repeat": outcome.repeat,
                })
            })
            .collect();
        json!({
            "plugin": self.plugin,
            "sha256": self.sha256,
            "seed": self.seed,
            "level": self.reached(),
            "seconds": self.took.as_secs_f64(),
            "checks": checks,
        })
    }
}

/// How many checks there were, and of which findings: `41 checks, 2 beside`.
#[must_use]
pub fn counts(outcomes: &[Outcome]) -> String {
    let mut text = format!("{} check{}", outcomes.len(), if outcomes.len() == 1 { "" } else { "s" });
    for word in ["failed", "doubtful", "beside"] {
        match outcomes.iter().filter(|outcome| outcome.finding.word() == word).count() {
            0 => {}
            n => text += &format!(", {n} {word}"),
        }
    }
    text
}

/// What tools that read JUnit want: a suite a plugin, a case a check. A doubt is a case that has passed and has printed.
#[must_use]
pub fn junit(reports: &[Report]) -> String {
    let mut xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n".to_owned();
    for report in reports {
        let n = |word: &str| report.outcomes.iter().filter(|outcome| outcome.finding.word() == word).count();
        writeln!(
            xml,
            "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\" time=\"{:.3}\">",
            escaped(&report.plugin),
            report.outcomes.len(),
            n("failed"),
            n("beside"),
            report.took.as_secs_f64()
        )
        .unwrap_or_default();
        report.outcomes.iter().for_each(|outcome| xml += &case(outcome));
        xml += "  </testsuite>\n";
    }
    xml + "</testsuites>\n"
}

fn case(outcome: &Outcome) -> String {
    let text = escaped(outcome.finding.text());
    let head = format!(
        "    <testcase classname=\"level {}\" name=\"{}\" time=\"{:.3}\">",
        outcome.check.level,
        outcome.check.id,
        outcome.took.as_secs_f64()
    );
    let body = match &outcome.finding {
        Finding::Fails(_) => {
            let (claim, repeat) = (escaped(outcome.check.claim), escaped(&outcome.repeat));
            format!("<failure message=\"{claim}\">{text}\n{repeat}</failure>")
        }
        Finding::Beside(_) => format!("<skipped message=\"{text}\"/>"),
        Finding::Holds(_) | Finding::Doubtful(_) => format!("<system-out>{text}</system-out>"),
    };
    format!("{head}{body}</testcase>\n")
}

/// Text as XML may hold it.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\n' | '\t' => safe.push(letter),
            letter if letter.is_control() => {}
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests;
