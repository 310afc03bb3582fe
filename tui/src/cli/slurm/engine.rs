//! Slurm's own programs, asked in the forms that all their versions know.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::process::Command;

use anyhow::{Context as _, bail};

/// What Slurm says of a task that it has not done with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Queued {
    /// `PENDING`, `RUNNING`, …
    pub(super) state: String,
    /// Why it waits, or on which node it is.
    pub(super) at: String,
}

fn ask(program: &str, words: &[OsString]) -> anyhow::Result<String> {
    let wanted = || format!("cannot start {program}: honami submit, status and cancel want Slurm's commands");
    let output = Command::new(program).args(words).output().with_context(wanted)?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!("{program}: {}", said.trim().replace('\n', " "));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Submits a script, and says which job it is.
pub(super) fn submit(words: &[OsString]) -> anyhow::Result<u64> {
    let said = ask("sbatch", words)?;
    // `--parsable`: the job, and where there are several clusters the cluster.
    let job = said.trim().split(';').next().unwrap_or_default();
    job.parse().with_context(|| format!("sbatch said {said:?} and not which job it is"))
}

/// The tasks of an array job that are not through, by number.
pub(super) fn queue(job: u64) -> anyhow::Result<BTreeMap<usize, Queued>> {
    let words = ["--noheader", "--array", "--format=%K|%T|%R", "--jobs"].map(OsString::from);
    let said = ask("squeue", &[&words[..], &[job.to_string().into()]].concat());
    match said {
        Ok(said) => Ok(said.lines().filter_map(queued).collect()),
        // So it says of jobs that have ended a while ago.
        Err(error) if error.to_string().contains("Invalid job id") => Ok(BTreeMap::new()),
        Err(error) => Err(error),
    }
}

/// `3|PENDING|(Resources)` or `3|RUNNING|n1`.
fn queued(line: &str) -> Option<(usize, Queued)> {
    let mut parts = line.trim().splitn(3, '|');
    let number = parts.next()?.parse().ok()?;
    let (state, at) = (parts.next()?.to_owned(), parts.next().unwrap_or_default());
    // So it says before it has looked for a reason.
    let at = at.trim_matches(['(', ')']).replace("None", "");
    Some((number, Queued { state, at }))
}

/// How many tasks an array may have.
pub(super) fn most_tasks() -> anyhow::Result<usize> {
    let said = ask("scontrol", &["show".into(), "config".into()])?;
    let most = said.lines().find_map(|line| line.trim().strip_prefix("MaxArraySize"));
    // The largest index is one less; 1001 is what Slurm has where nobody has set it.
    Ok(most.and_then(|line| line.split('=').nth(1)?.trim().parse().ok()).unwrap_or(1001))
}

pub(super) fn cancel(job: u64) -> anyhow::Result<()> {
    ask("scancel", &[job.to_string().into()]).map(drop)
}

#[cfg(test)]
mod tests {
    use super::{Queued, queued};

    #[test]
    fn lines_of_the_queue() {
        let of = |state: &str, at: &str| Queued { state: state.to_owned(), at: at.to_owned() };
        for (line, wanted) in [
            ("3|PENDING|(JobArrayTaskLimit)", Some((3, of("PENDING", "JobArrayTaskLimit")))),
            ("4|PENDING|(None)", Some((4, of("PENDING", "")))),
            ("0|RUNNING|n1", Some((0, of("RUNNING", "n1")))),
            ("12|COMPLETING|", Some((12, of("COMPLETING", "")))),
            ("N/A|RUNNING|n1", None),
            ("", None),
        ] {
            assert_eq!(queued(line), wanted, "{line}");
        }
    }
}
