//! `honami plugin check`: a line a check while they run, and what to type to see one again.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use honami_workbench::check::{
    Asker, Check, Finding, Ledger, Outcome, Plan, Report, Status, Subject, checks, examine, junit,
};
use honami_workbench::plugins::{
    Host, HostError, PluginInfo, Registry, SearchPath, Trust, TrustBook, file_of,
};
use serde_json::json;

use super::args::{self, Common};
use super::{help, want};

/// Passed, but somebody should look: 2 is wrong usage, here as everywhere.
const DOUBTFUL: u8 = 3;

/// Checks the plugins of a file, or does one of the checks.
pub(super) fn check(args: &args::Check, common: &Common) -> anyhow::Result<ExitCode> {
    // Taken before anything of the plugin is looked at.
    let asker = if args.answer { Some(Asker::of_stdin()?) } else { None };
    let file = file(&args.plugin, common)?;
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
        None => all(args, &file, &infos, out),
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
    let wanted = || format!("wanted a check and a seed, such as loading.starts:1, got {which}");
    let (id, seed) = which.rsplit_once(':').with_context(wanted)?;
    let seed: u64 = seed.parse().with_context(wanted)?;
    let all = checks();
    let chosen: Vec<Check> = all.iter().filter(|check| check.id == id).copied().collect();
    want(!chosen.is_empty(), || format!("there is no check {id}; {}", ids(&all)))?;
    // All that must be read is read before a check shuts this process in.
    let subjects: Vec<(&PluginInfo, Plan, String)> = infos
        .iter()
        .map(|info| Ok((*info, plan(file, info, &chosen, seed)?, info.sha256()?)))
        .collect::<anyhow::Result<_>>()?;
    let mut reports = Vec::new();
    for (info, plan, sha256) in subjects {
        let (subject, began) = (Subject::new(info.clone(), Host::new(), seed), Instant::now());
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

fn all(args: &args::Check, file: &Path, infos: &[&PluginInfo], out: Out) -> anyhow::Result<ExitCode> {
    let has =
        |check: &Check, part: &Option<String>| part.as_ref().is_some_and(|part| check.id.contains(part));
    let known = checks();
    let chosen: Vec<Check> = known
        .iter()
        .filter(|check| check.level <= args.level)
        .filter(|check| (args.only.is_none() || has(check, &args.only)) && !has(check, &args.skip))
        .copied()
        .collect();
    want(!chosen.is_empty(), || format!("no check up to level {} is chosen; {}", args.level, ids(&known)))?;
    let host = Host::new();
    let ledger = Ledger::beside(&host);
    let mut reports = Vec::new();
    for info in infos {
        let plan = plan(file, info, &chosen, args.seed)?;
        let (sha256, began) = (info.sha256()?, Instant::now());
        let mut said = Ok(());
        let outcomes = plan.run(&mut |outcome| {
            if !out.is_json && said.is_ok() {
                said = print(&line(outcome));
            }
        });
        said?;
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

/// A check in a line; of one that has failed what came, and how to see it again.
fn line(outcome: &Outcome) -> String {
    let Outcome { check, finding, took, repeat } = outcome;
    let head = format!("{:8}  {:2}  {:28}  {}", finding.word(), check.level, check.id, check.claim);
    let said = if finding.text().is_empty() { String::new() } else { format!(": {}", finding.text()) };
    let seconds = took.as_secs_f64();
    match finding {
        Finding::Fails(why) => format!("{head} ({seconds:.1} s)\n          {why}\n          {repeat}"),
        _ => format!("{head}{said} ({seconds:.1} s)"),
    }
}

fn ids(checks: &[Check]) -> String {
    format!("there are: {}", checks.iter().map(|check| check.id).collect::<Vec<_>>().join(", "))
}

/// The file of a plugin: a path, or a name of one that there is; absolute, because a bare name would be searched for.
fn file(plugin: &str, common: &Common) -> anyhow::Result<PathBuf> {
    let path = Path::new(plugin);
    if path.is_file() {
        return Ok(std::path::absolute(file_of(path))?);
    }
    let registry = super::options(common).registry();
    let info = help::named(&registry, plugin)?;
    if let Trust::No(why) = &info.trust {
        anyhow::bail!("{} is not trusted: {why}", info.library.display());
    }
    Ok(std::path::absolute(&info.library)?)
}

/// A line on standard output.
fn print(line: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}")?;
    Ok(out.flush()?)
}
