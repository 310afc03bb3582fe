//! How submitted clips are: what their tasks have kept, and of the others what Slurm says.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::Context as _;
use honami_model::brief::counted;
use serde_json::json;

use super::super::args::slurm::Submitted;
use super::super::recipe::told::step_words;
use super::super::{Answer, report};
use super::engine::{self, Queued};
use super::{Ended, Submission, ended, log};

pub(in crate::cli) fn status(args: &Submitted) -> anyhow::Result<Answer> {
    let into = std::path::absolute(&args.into)?;
    let submission = Submission::read(&into)?;
    let queue = submission.job.map(engine::queue).transpose()?.unwrap_or_default();
    let mut rows = vec![["clip", "task", "state", "node", "seconds", "MB", ""].map(str::to_owned).to_vec()];
    let mut told = Vec::new();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (task, numbers) in submission.tasks.iter().enumerate() {
        for number in numbers {
            let clip = submission.clip(*number, &into)?;
            let end = read(&into, &clip.name)?;
            let (state, why) = state(end.as_ref(), queue.get(&task));
            *counts.entry(state).or_default() += 1;
            let seconds = end.as_ref().map(|end| end.done.iter().fold(0.0, |sum, (_, s, _)| sum + s));
            let megabytes = end.as_ref().map(|end| end.peak_bytes as f64 / 1e6);
            let node = end.as_ref().map_or("", |end| end.node.as_str());
            rows.push(vec![
                clip.name.clone(),
                task.to_string(),
                state.to_owned(),
                node.to_owned(),
                seconds.map_or_else(String::new, |s| format!("{s:.1}")),
                megabytes.map_or_else(String::new, |mb| format!("{mb:.0}")),
                why.clone(),
            ]);
            told.push(json!({
                "clip": clip.name, "task": task, "state": state, "why": why, "node": node, "seconds": seconds,
                "peak_bytes": end.as_ref().map(|end| end.peak_bytes),
                "restarts": end.as_ref().map(|end| end.restarts),
                "fresh": end.as_ref().map(|end| end.fresh),
                "project": clip.project(), "log": log(&into, &clip.name),
            }));
        }
    }
    let parts: Vec<_> = counts.iter().map(|(state, n)| format!("{n} {state}")).collect();
    let job = submission.job.map_or_else(|| "no job".to_owned(), |job| format!("job {job}"));
    let mut text = report::table(&rows);
    text += &format!("\n{job}, {}: {}", counted(submission.clips.len(), "clip"), parts.join(", "));
    if counts.contains_key("lost") {
        text += "\nlost ones were ended before they were through: the same honami submit goes on with them";
    }
    let done = !["failed", "lost", "stopped"].iter().any(|state| counts.contains_key(state));
    Ok(Answer { json: json!({ "job": submission.job, "clips": told, "counts": counts }), text, done })
}

/// The state of a clip in a word, and why.
fn state(end: Option<&Ended>, queued: Option<&Queued>) -> (&'static str, String) {
    match (end, queued) {
        (Some(Ended { failed: Some((step, why)), .. }), _) => {
            ("failed", format!("{}: {why}", step_words(*step)))
        }
        (Some(Ended { stopped: true, .. }), None) => ("stopped", String::new()),
        (Some(Ended { stopped: false, .. }), _) => ("done", String::new()),
        (_, Some(Queued { state, at })) if state == "PENDING" => ("waiting", at.clone()),
        (_, Some(Queued { at, .. })) => ("running", at.clone()),
        (None, None) => ("lost", String::new()),
    }
}

fn read(into: &Path, clip: &str) -> anyhow::Result<Option<Ended>> {
    let file = ended(into, clip);
    let text = match fs::read(&file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        text => text.with_context(|| format!("cannot read {}", file.display()))?,
    };
    serde_json::from_slice(&text).map(Some).with_context(|| format!("{} is broken", file.display()))
}

pub(in crate::cli) fn cancel(args: &Submitted) -> anyhow::Result<Answer> {
    let into = std::path::absolute(&args.into)?;
    let submission = Submission::read(&into)?;
    let job = submission.job.with_context(|| format!("{} has no job at Slurm", into.display()))?;
    let n_left = engine::queue(job)?.len();
    if n_left > 0 {
        engine::cancel(job)?;
    }
    let text = match n_left {
        0 => format!("job {job} is through: there is nothing to cancel"),
        n => format!(
            "job {job} is cancelled, {} were left: the same honami submit goes on",
            counted(n, "task")
        ),
    };
    Ok(Answer { json: json!({ "job": job, "cancelled": n_left }), text, done: true })
}

#[cfg(test)]
mod tests {
    use super::{Ended, Queued, state};

    #[test]
    fn a_clip_is_what_its_task_has_kept_or_else_what_slurm_says() {
        let end = |failed: bool, stopped| Ended {
            node: "n1".to_owned(),
            restarts: 0,
            fresh: 0,
            done: Vec::new(),
            failed: failed.then(|| (1, "no plants".to_owned())),
            stopped,
            peak_bytes: 0,
        };
        let queued = |state: &str| Queued { state: state.to_owned(), at: String::new() };
        for (kept, slurm, wanted) in [
            (None, None, "lost"),
            (None, Some("PENDING"), "waiting"),
            (None, Some("RUNNING"), "running"),
            (Some(end(false, false)), Some("RUNNING"), "done"),
            (Some(end(false, false)), None, "done"),
            (Some(end(true, false)), None, "failed"),
            (Some(end(false, true)), None, "stopped"),
            (Some(end(false, true)), Some("PENDING"), "waiting"),
        ] {
            assert_eq!(state(kept.as_ref(), slurm.map(queued).as_ref()).0, wanted, "{slurm:?}");
        }
    }
}
