//! `honami plugin check`: a line a check while they run, and what to type to see one again.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use honami_workbench::check::{
    Asker, Check, Finding, Ledger, Outcome, Plan, Report, Status, Subject, checks, examine, junit,
};
use honami_workbench::plugins::{Host, PluginInfo, Registry, SearchPath, Trust, TrustBook, file_of};
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
    let path = SearchPath { named: vec![file.clone()], book: TrustBook::of_user(), ..SearchPath::default() };
    let registry = Registry::scan_path(&path);
    if let Some(problem) = registry.problems().first() {
        return end(&[Report::unreadable(&file, problem.to_string())], args, common.json);
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
        Some(which) => one(which, &infos, asker),
        None => all(args, &file, &infos, common.json),
    }
}

/// Does one check in this process, and says what came to whoever asked: a person, or honami itself.
fn one(which: &str, infos: &[&PluginInfo], asker: Option<Asker>) -> anyhow::Result<ExitCode> {
    let wanted = || format!("wanted a check and a seed, such as loading.starts:1, got {which}");
    let (id, seed) = which.rsplit_once(':').with_context(wanted)?;
    let seed: u64 = seed.parse().with_context(wanted)?;
    let all = checks();
    want(all.iter().any(|check| check.id == id), || format!("there is no check {id}; {}", ids(&all)))?;
    let mut status = ExitCode::SUCCESS;
    for info in infos {
        let subject = Subject::new(PluginInfo::clone(info), Host::new(), seed);
        let Some(check) = all.iter().find(|check| check.id == id) else { continue };
        let finding = examine(check, &subject);
        if let Some(asker) = asker {
            asker.tell(&finding)?;
            return Ok(ExitCode::SUCCESS);
        }
        print(&format!("{}: {} {}: {}", info.short_name, check.id, finding.word(), finding.text()))?;
        if matches!(finding, Finding::Fails(_)) {
            status = ExitCode::FAILURE;
        }
    }
    Ok(status)
}

fn all(args: &args::Check, file: &Path, infos: &[&PluginInfo], is_json: bool) -> anyhow::Result<ExitCode> {
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
        let plan = Plan {
            program: std::env::current_exe()?,
            file: file.to_owned(),
            plugin: info.id.clone(),
            checks: chosen.clone(),
            seed: args.seed,
        };
        let (sha256, began) = (info.sha256()?, Instant::now());
        let mut said = Ok(());
        let outcomes = plan.run(&mut |outcome| {
            if !is_json && said.is_ok() {
                said = print(&line(outcome));
            }
        });
        said?;
        let level = (args.only.is_none() && args.skip.is_none()).then_some(args.level);
        let (name, plugin) = (info.short_name.clone(), info.id.clone());
        let (seed, took) = (args.seed, began.elapsed());
        let report = Report { name, plugin, sha256, seed, level, outcomes, took };
        anyhow::ensure!(
            info.sha256()? == report.sha256,
            "{} was written anew while it was checked: check it again",
            file.display()
        );
        ledger.keep(info, &report).context("the verdict cannot be kept")?;
        reports.push(report);
    }
    end(&reports, args, is_json)
}

/// Says what it has come to, and with which status to end.
fn end(reports: &[Report], args: &args::Check, is_json: bool) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.junit {
        fs::write(path, junit(reports)).with_context(|| format!("cannot write {}", path.display()))?;
    }
    if is_json {
        let reports: Vec<_> = reports.iter().map(Report::json).collect();
        print(&serde_json::to_string_pretty(&json!({ "plugins": reports }))?)?;
    } else {
        for report in reports {
            if report.sha256.is_empty() {
                report.outcomes.iter().try_for_each(|outcome| print(&line(outcome)))?;
            }
            print(&report.line())?;
        }
    }
    let worst = reports.iter().map(Report::status).max();
    Ok(match worst {
        Some(Status::Failed) => ExitCode::FAILURE,
        Some(Status::Doubtful) => ExitCode::from(DOUBTFUL),
        Some(Status::Passed) | None => ExitCode::SUCCESS,
    })
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
