//! `bench accuracy`: every tracker there is on every clip whose answer is known, and docs/accuracy.md from it.
//!
//! A row that was measured is kept in the target folder under the content hash of its plugin: a run that is stopped goes
//! on where it was, and a plugin that has changed is measured again.

mod cases;
mod lab;
mod numbers;
mod page;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use anyhow::{Context as _, bail};

use crate::BUILD;
use crate::shell::{Step, cargo, root};
use cases::{Case, SETS};
use lab::{Lab, Tracker};

/// What was asked for.
struct Wanted {
    /// Sets of cases; none: all of them.
    sets: Vec<String>,
    /// Trackers; none: all of them.
    with: Vec<String>,
    /// How many trackers are measured side by side.
    n_jobs: usize,
    /// Whether nothing is measured: the page is made from the rows that there are.
    is_kept_enough: bool,
}

/// Measures what has not been measured; all of it becomes docs/accuracy.md, a part of it is only printed.
pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let wanted = parse(args)?;
    let begun = Instant::now();
    cargo(BUILD).run()?;
    let lab = Lab::new()?;
    let cases = cases::prepare(&lab, &wanted.sets)?;
    let (trackers, left_out) = lab.able(lab.trackers(&wanted.with)?);
    let failures = match wanted.is_kept_enough {
        true => Vec::new(),
        false => measure(&lab, &cases, &trackers, wanted.n_jobs)?,
    };
    let page = page::write(&lab, &cases, &trackers, &left_out);
    println!("\n{page}");
    eprintln!("measured in {:.0} s", begun.elapsed().as_secs_f64());
    if wanted.sets.is_empty() && wanted.with.is_empty() {
        let path = root().join("docs/accuracy.md");
        std::fs::write(&path, page).with_context(|| format!("cannot write {}", path.display()))?;
        eprintln!("written: {}", path.display());
    }
    if failures.is_empty() { Ok(()) } else { bail!("some rows are missing:\n{}", failures.join("\n")) }
}

fn parse(args: &[&str]) -> anyhow::Result<Wanted> {
    let mut wanted = Wanted { sets: Vec::new(), with: Vec::new(), n_jobs: 2, is_kept_enough: false };
    let mut words = args.iter();
    while let Some(&word) = words.next() {
        let mut value =
            || words.next().map(|v| (*v).to_owned()).with_context(|| format!("{word} wants a value"));
        match word {
            "--kept" => wanted.is_kept_enough = true,
            "--with" => wanted.with.push(value()?),
            "--jobs" => wanted.n_jobs = value()?.parse().context("--jobs wants a number")?,
            set if SETS.iter().any(|(known, _)| *known == set) => wanted.sets.push(set.to_owned()),
            other => {
                let sets: Vec<String> =
                    SETS.iter().map(|(name, what)| format!("  {name:10} {what}")).collect();
                bail!(
                    "wanted [SET…] [--with TRACKER…] [--jobs N] [--kept], got {other}; the sets:\n{}",
                    sets.join("\n")
                )
            }
        }
    }
    Ok(wanted)
}

/// Runs what there is to run, some side by side; what failed is told and does not stop the rest.
fn measure(lab: &Lab, cases: &[Case], trackers: &[Tracker], n_jobs: usize) -> anyhow::Result<Vec<String>> {
    // A tracker's cases stay together: what the first of them takes says how much the others are given.
    let next = AtomicUsize::new(0);
    let failures = Mutex::new(Vec::new());
    let work = || {
        while let Some(tracker) = trackers.get(next.fetch_add(1, Ordering::Relaxed)) {
            for case in cases {
                let begun = Instant::now();
                let told = match lab.row(case, tracker) {
                    Ok(None) => continue,
                    Ok(Some(_)) => format!("{:.1} s", begun.elapsed().as_secs_f64()),
                    Err(error) => {
                        let line = format!("{} on {}: {error:#}", tracker.name(), case.name);
                        failures.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(line.clone());
                        line
                    }
                };
                eprintln!("{:14} {:16} {told}", tracker.name(), case.name);
            }
        }
    };
    thread::scope(|scope| {
        for number in 0..n_jobs.max(1) {
            let worker = thread::Builder::new().name(format!("tracker {number}"));
            worker.spawn_scoped(scope, work).context("cannot start a thread")?;
        }
        anyhow::Ok(())
    })?;
    Ok(failures.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// A command that prints JSON.
fn json(step: Step) -> anyhow::Result<serde_json::Value> {
    let text = step.output()?;
    serde_json::from_str(&text).with_context(|| format!("this is no JSON: {text}"))
}
