//! `honami plugin check`: what checks found while they run, and what to type to see one again.

mod shown;

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use honami_workbench::check::{
    Asker, Check, Ledger, Outcome, Plan, Report, Status, Subject, checks, examine, junit,
};
use honami_workbench::plugins::{Host, HostError, PluginInfo, Registry, SearchPath, Trust, TrustBook};
use serde_json::json;

use shown::{Shown, line};

use super::args::{self, Common};
use super::{Usage, help, report, want};

/// Passed, but somebody should look: 2 is wrong usage, here as everywhere.
const DOUBTFUL: u8 = 3;

/// Checks the plugins of a file, or does one of the checks. Where it could not begin machines are told so, too.
pub(super) fn check(args: &args::Check, common: &Common) -> anyhow::Result<ExitCode> {
    let done = examined(args, common);
    if let Err(error) = &done
        && common.json
    {
        let text = serde_json::to_string_pretty(&json!({ "plugins": [], "error": report::chain(error) }))?;
        print(&text)?;
    }
    done
}

fn examined(args: &args::Check, common: &Common) -> anyhow::Result<ExitCode> {
    // Taken before anything of the plugin is looked at.
    let asker = if args.answer { Some(Asker::of_stdin()?) } else { None };
    let file = help::file(&args.plugin, common)?;
    // Opened before minutes are spent on what then cannot be written.
    let out = Out { xml: args.junit.as_deref().map(writable).transpose()?, is_json: common.json };
    let path = SearchPath { named: vec![file.clone()], book: TrustBook::of_user(), ..SearchPath::default() };
    let registry = Registry::scan_path(&path);
    // A broken list of what a lab trusts is no fault of this file.
    let is_of_file = |problem: &&HostError| !matches!(problem, HostError::File { path, .. } if *path != file);
    if let Some(problem) = registry.problems().iter().find(is_of_file) {
        let report = Report::unreadable(&file, problem.to_string());
        if !out.is_json {
            report.outcomes.iter().try_for_each(|outcome| print(&line(outcome)))?;
            print(&report.line())?;
        }
        return out.end(&[report]);
    }
    let is_wanted = |info: &&PluginInfo| args.plugin_id.as_ref().is_none_or(|id| *id == info.id);
    let infos: Vec<&PluginInfo> = registry.plugins().iter().filter(is_wanted).collect();
    want(!infos.is_empty(), || {
        let ids: Vec<&str> = registry.plugins().iter().map(|info| info.id.as_str()).collect();
        format!("{} has no such plugin; it has: {}", file.display(), ids.join(", "))
    })?;
    if let Some(Trust::No(why)) = infos.first().map(|info| &info.trust) {
        anyhow::bail!("{} is not trusted: {why}", file.display());
    }
    match &args.reproduce {
        Some(which) => one(which, &file, &infos, asker, out),
        None => all(args, &file, &infos, common.verbose, out),
    }
}

/// Where reports go.
struct Out {
    xml: Option<File>,
    is_json: bool,
}

/// A file of which nothing is lost before there is something to write into it.
fn writable(path: &Path) -> anyhow::Result<File> {
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(path);
    file.with_context(|| format!("cannot write {}", path.display()))
}

/// Does one check in this process, and says what came to whoever asked: a person, or honami itself.
fn one(
    which: &str,
    file: &Path,
    infos: &[&PluginInfo],
    mut asker: Option<Asker>,
    out: Out,
) -> anyhow::Result<ExitCode> {
    let all = checks();
    let wanted = || {
        let near = near(which.split(':').next().unwrap_or(which), &all);
        Usage(format!("wanted a check and a seed, such as loading.starts:1, got {which}; {near}"))
    };
    let (id, seed) = which.rsplit_once(':').ok_or_else(wanted)?;
    let seed: u64 = seed.parse().map_err(|_no_number| wanted())?;
    let chosen: Vec<Check> = all.iter().filter(|check| check.id == id).copied().collect();
    want(!chosen.is_empty(), || format!("there is no check {id}; {}", near(id, &all)))?;
    // All that must be read is read before a check shuts this process in.
    let subjects: Vec<(&PluginInfo, Plan, String)> = infos
        .iter()
        .map(|info| Ok((*info, plan(file, info, &chosen, seed)?, info.sha256()?)))
        .collect::<anyhow::Result<_>>()?;
    let mut reports = Vec::new();
    for (info, plan, sha256) in subjects {
        // One that is held, since it has died too often, is just the one to look at.
        let host = Host::new().without_quarantine();
        let (subject, began) = (Subject::new(info.clone(), host, seed), Instant::now());
        let outcomes: Vec<Outcome> = chosen
            .iter()
            .map(|check| {
                let finding = examine(check, &subject);
                Outcome { check: *check, finding, took: began.elapsed(), repeat: plan.repeat(check) }
            })
            .collect();
        if let [outcome] = outcomes.as_slice()
            && let Some(asker) = asker.take()
        {
            asker.tell(&outcome.finding)?;
            return Ok(ExitCode::SUCCESS);
        }
        for Outcome { check, finding, .. } in outcomes.iter().filter(|_| !out.is_json) {
            print(&format!("{}: {} {}: {}", info.short_name, check.id, finding.word(), finding.text()))?;
        }
        let (name, plugin, took) = (info.short_name.clone(), info.id.clone(), began.elapsed());
        reports.push(Report { name, plugin, sha256: Some(sha256), seed, level: None, outcomes, took });
    }
    out.end(&reports)
}

fn plan(file: &Path, info: &PluginInfo, checks: &[Check], seed: u64) -> anyhow::Result<Plan> {
    Ok(Plan {
        program: std::env::current_exe()?,
        file: file.to_owned(),
        plugin: info.id.clone(),
        checks: checks.to_vec(),
        seed,
    })
}

fn all(
    args: &args::Check,
    file: &Path,
    infos: &[&PluginInfo],
    is_whole: bool,
    out: Out,
) -> anyhow::Result<ExitCode> {
    let has =
        |check: &Check, part: &Option<String>| part.as_ref().is_some_and(|part| check.id.contains(part));
    let known = checks();
    let chosen: Vec<Check> = known
        .iter()
        .filter(|check| check.level <= args.level)
        .filter(|check| (args.only.is_none() || has(check, &args.only)) && !has(check, &args.skip))
        .copied()
        .collect();
    want(!chosen.is_empty(), || {
        format!(
            "no check up to level {} is chosen; {}",
            args.level,
            near(args.only.as_deref().unwrap_or_default(), &known)
        )
    })?;
    let host = Host::new();
    let ledger = Ledger::beside(&host);
    let mut reports = Vec::new();
    for info in infos {
        let plan = plan(file, info, &chosen, args.seed)?;
        let (sha256, began) = (info.sha256()?, Instant::now());
        let (mut said, mut shown) = (Ok(()), Shown::new(is_whole));
        let outcomes = plan.run(&mut |outcome| {
            if !out.is_json && said.is_ok() {
                said = shown.hear(outcome);
            }
        });
        said.and_then(|()| shown.end())?;
        let level = (args.only.is_none() && args.skip.is_none()).then_some(args.level);
        let (name, plugin) = (info.short_name.clone(), info.id.clone());
        let (seed, took) = (args.seed, began.elapsed());
        let report = Report { name, plugin, sha256: Some(sha256), seed, level, outcomes, took };
        anyhow::ensure!(
            report.sha256 == Some(info.sha256()?),
            "{} was written anew while it was checked: check it again",
            file.display()
        );
        ledger.keep(info, &report).context("the verdict cannot be kept")?;
        if !out.is_json {
            print(&report.line())?;
        }
        reports.push(report);
    }
    out.end(&reports)
}

impl Out {
    /// Writes what is for machines; with which status to end.
    fn end(self, reports: &[Report]) -> anyhow::Result<ExitCode> {
        if let Some(mut xml) = self.xml {
            let written = xml.set_len(0).and_then(|()| xml.write_all(junit(reports).as_bytes()));
            written.context("the report for JUnit cannot be written")?;
        }
        if self.is_json {
            let reports: Vec<_> = reports.iter().map(Report::json).collect();
            print(&serde_json::to_string_pretty(&json!({ "plugins": reports }))?)?;
        }
        Ok(match reports.iter().map(Report::status).max() {
            Some(Status::Failed) => ExitCode::FAILURE,
            Some(Status::Doubtful) => ExitCode::from(DOUBTFUL),
            Some(Status::Passed) | None => ExitCode::SUCCESS,
        })
    }
}

/// So many names are told of those that may have been meant.
const N_NEAR: usize = 5;

/// The checks whose names are nearest to a word.
fn near(word: &str, checks: &[Check]) -> String {
    let mut ids: Vec<&str> = checks.iter().map(|check| check.id).collect();
    ids.sort_by_key(|id| (!id.contains(word), strsim::damerau_levenshtein(word, id)));
    ids.truncate(N_NEAR);
    format!("the nearest of {} are: {}", checks.len(), ids.join(", "))
}

/// A line on standard output.
fn print(line: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}
