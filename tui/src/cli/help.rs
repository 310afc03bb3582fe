//! Commands about honami itself: plugins, doctor, completions, manual.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use clap::CommandFactory as _;
use honami_workbench::doctor;
use honami_workbench::plugins::{Param, PluginInfo, Registry};
use serde_json::json;

use super::args::{Cli, Common, Plugin};
use super::{Answer, report};

/// The shell script that completes honami's words.
pub(super) fn completions(shell: clap_complete::Shell) -> Answer {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "honami", &mut script);
    let script = String::from_utf8_lossy(&script).trim_end().to_owned();
    Answer { json: json!({ "shell": shell.to_string(), "script": script }), text: script }
}

/// One manual page a command.
pub(super) fn manual(folder: &Path) -> anyhow::Result<Answer> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    clap_mangen::generate_to(Cli::command(), folder)
        .with_context(|| format!("cannot write the manual to {}", folder.display()))?;
    let text = format!("manual pages in {0}: man -l {0}/honami.1", folder.display());
    Ok(Answer { json: json!({ "folder": folder }), text })
}

/// What this machine has.
pub(super) fn doctor(common: &Common) -> Answer {
    let findings = doctor::examine(&Registry::scan(&common.plugins));
    let mut rows = Vec::new();
    for finding in &findings {
        let mark = if finding.there { "ok" } else { "--" };
        let advice = match &finding.advice {
            Some(advice) if !finding.there => format!("{}; adds {}. {advice}", finding.found, finding.adds),
            _ => finding.found.clone(),
        };
        rows.push(vec![mark.to_owned(), finding.what.to_owned(), advice]);
    }
    Answer { json: json!({ "findings": findings }), text: report::table(&rows) }
}

/// Lists plugins, or describes one.
pub(super) fn plugin(command: &Plugin, common: &Common) -> anyhow::Result<Answer> {
    let registry = Registry::scan(&common.plugins);
    match command {
        Plugin::List => Ok(list(&registry)),
        Plugin::Info { name } => Ok(info(registry.find_any(name)?)),
    }
}
