//! Commands about honami itself: plugins, doctor, completions, manual.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::CommandFactory as _;
use honami_workbench::check::Ledger;
use honami_workbench::doctor;
use honami_workbench::plugins::{
    self, Host, Hosting, Param, Part, PluginInfo, Prospect, Registry, SearchPath, Trust, TrustBook,
};
use serde_json::json;

use super::args::{Cli, Common, Plugin};
use super::{Answer, Outcome, Usage, begin, check, report};
use crate::app::config::Config;

/// The shell script that completes honami's words.
pub(super) fn completions(shell: clap_complete::Shell) -> Answer {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "honami", &mut script);
    let script = String::from_utf8_lossy(&script).trim_end().to_owned();
    Answer { json: json!({ "shell": shell.to_string(), "script": script }), text: script, done: true }
}

/// One manual page a command.
pub(super) fn manual(folder: &Path) -> anyhow::Result<Answer> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    clap_mangen::generate_to(Cli::command(), folder)
        .with_context(|| format!("cannot write the manual to {}", folder.display()))?;
    let text = format!("manual pages in {0}: man -l {0}/honami.1", folder.display());
    Ok(Answer { json: json!({ "folder": folder }), text, done: true })
}

/// What this machine has.
pub(super) fn doctor(common: &Common) -> Answer {
    let registry = super::options(common).registry();
    let mut findings = doctor::examine(&registry);
    findings.push(crate::viewer::finding());
    let mut rows = Vec::new();
    for finding in &findings {
        let mark = if finding.there { "ok" } else { "--" };
        let advice = match &finding.advice {
            Some(advice) if !finding.there => format!("{}; adds {}. {advice}", finding.found, finding.adds),
            _ => finding.found.clone(),
        };
        rows.push(vec![mark.to_owned(), finding.what.to_owned(), advice]);
    }
    // What became of plugins is told once: to people.
    let mut config = if common.json { Config::load() } else { Config::load().beginning() };
    config.wrong.extend(config.plugins.too_short(|| super::options(common).registry()));
    config.wrong.extend(config.plugins.strangers(&registry));
    let (mark, said) = match config.complaint() {
        None => ("ok", "config.toml is understood, or not there".to_owned()),
        Some(complaint) => ("--", complaint),
    };
    rows.push(vec![mark.to_owned(), "settings".to_owned(), said]);
    let json = json!({ "findings": findings, "settings": config.wrong });
    Answer { json, text: report::table(&rows), done: true }
}

/// Lists plugins, or describes one.
pub(super) fn plugin(command: &Plugin, common: &Common) -> anyhow::Result<Outcome> {
    let options = match command {
        Plugin::List | Plugin::Info { .. } => super::told(&Config::load(), common),
        _ => super::options(common),
    };
    let (registry, host) = (options.registry(), &options.host);
    let answer = match command {
        Plugin::Check(args) => return check::check(args, common).map(Outcome::Exit),
        Plugin::List => Ok(list(&registry, host)),
        Plugin::Info { name } => info(named(&registry, name)?, host),
        Plugin::New { name, kind, lang, command } => {
            let own = format!("org.me.{name}");
            let is_other = |plugin: &&PluginInfo| plugin.short_name == *name && plugin.id != own;
            begin::plugin(name, *kind, *lang, command, registry.plugins().iter().find(is_other))
        }
        Plugin::Allow { plugin } => allow(&file(plugin, common)?, common),
        Plugin::Deny { plugin } => deny(&file(plugin, common)?),
        Plugin::Retry { name, in_process } => retry(&file(name, common)?, *in_process, host),
    };
    answer.map(Outcome::Answer)
}

/// The file of a plugin: a path, or a name of one that there is; absolute, because a bare name would be searched for.
pub(super) fn file(plugin: &str, common: &Common) -> anyhow::Result<PathBuf> {
    let path = Path::new(plugin);
    if path.is_file() {
        return Ok(std::path::absolute(plugins::file_of(path))?);
    }
    let registry = super::options(common).registry();
    match named(&registry, plugin) {
        Ok(info) => Ok(std::path::absolute(&info.library)?),
        Err(error) => {
            let places = SearchPath::of_process(&common.plugins).with_dev(&common.dev).places();
            let places: Vec<String> = places.iter().map(|place| place.display().to_string()).collect();
            let file = std::path::absolute(path)?;
            let why =
                format!("there is no file {}, and {error}; looked in {}", file.display(), places.join(", "));
            Err(Usage(why).into())
        }
    }
}

/// The plugins in a file, as one says which they are.
fn plugins_in(library: &Path) -> Registry {
    Registry::scan_path(&SearchPath { named: vec![library.to_owned()], ..SearchPath::default() })
}

fn words(registry: &Registry) -> Vec<String> {
    registry.plugins().iter().map(|plugin| format!("{} ({})", plugin.id, plugin.kind)).collect()
}

/// Denies a library, also one that came with honami.
fn deny(library: &Path) -> anyhow::Result<Answer> {
    TrustBook::of_user().deny(library)?;
    let names = words(&plugins_in(library));
    let text = format!(
        "{} is never loaded, until you allow it\n  plugins  {}",
        library.display(),
        if names.is_empty() { "none can be read".to_owned() } else { names.join(", ") }
    );
    Ok(Answer { json: json!({ "denied": library, "plugins": names }), text, done: true })
}

/// Lets a library start again; also in honami's own process, where that was asked for.
fn retry(library: &Path, in_process: bool, host: &Host) -> anyhow::Result<Answer> {
    let again = plugins_in(library);
    let plugin = again.plugins().first().with_context(|| format!("{} is no plugin", library.display()))?;
    let was_held = host.retry(plugin)?;
    let was_out = in_process && host.let_in(plugin)?;
    let words = match (was_held, was_out) {
        (_, true) => "may start again, also in honami's own process",
        (true, false) => "may start again",
        (false, false) => "was not held: nothing to do",
    };
    let json = json!({ "plugin": plugin.id, "was_held": was_held, "was_kept_out": was_out });
    Ok(Answer { json, text: format!("{} {words}", plugin.short_name), done: true })
}

/// Allows a library, and says what was allowed.
fn allow(library: &Path, common: &Common) -> anyhow::Result<Answer> {
    let needed = plugins::needed(library)?;
    let registry = plugins_in(library);
    if let Some(problem) = registry.problems().first() {
        anyhow::bail!("{problem}");
    }
    let sha256 = TrustBook::of_user().allow(library)?;
    let parts = plugins::parts_of(library)?;
    let (names, owner) = (words(&registry), fs::metadata(library)?.uid());
    let file = |part: &Part| {
        let name = part.path.file_name().unwrap_or_default().to_string_lossy();
        format!("  file     {name}, {} bytes, of user {owner}, sha256 {}\n", part.n_bytes, part.sha256)
    };
    let text = format!(
        "allowed as it is now: {}\n  plugins  {}\n{}  sha256   {sha256}\n  needs    {}\n{}{}",
        library.display(),
        names.join(", "),
        parts.iter().map(file).collect::<String>(),
        if needed.is_empty() { "no libraries".to_owned() } else { needed.join(", ") },
        registry.plugins().first().map_or_else(String::new, may),
        where_it_works(library, common),
    );
    let files: Vec<_> = parts
        .iter()
        .map(|part| json!({ "path": part.path, "bytes": part.n_bytes, "sha256": part.sha256 }))
        .collect();
    let json =
        json!({ "allowed": library, "sha256": sha256, "plugins": names, "needs": needed, "files": files });
    Ok(Answer { json, text, done: true })
}

/// Where what was just allowed comes to work.
fn where_it_works(library: &Path, common: &Common) -> &'static str {
    let registry = super::options(common).registry();
    let is_it = |plugin: &&PluginInfo| plugin.library.canonicalize().ok() == library.canonicalize().ok();
    match registry.plugins().iter().find(is_it).map(|plugin| &plugin.trust) {
        Some(Trust::Shipped) => "It came with honami, and is loaded again.",
        _ => "It works in a process of its own. When its files change it asks again.",
    }
}

/// The plugin of that name, whatever its kind.
pub(super) fn named<'r>(registry: &'r Registry, name: &str) -> anyhow::Result<&'r PluginInfo> {
    if let Some(plugin) = registry.plugins().iter().find(|plugin| plugin.id == name) {
        return Ok(plugin);
    }
    let alike: Vec<_> = registry.plugins().iter().filter(|plugin| plugin.short_name == name).collect();
    let list = |plugins: &mut dyn Iterator<Item = &str>| plugins.collect::<Vec<_>>().join(", ");
    match alike.as_slice() {
        [plugin] => Ok(plugin),
        [] => {
            let known = list(&mut registry.plugins().iter().map(|plugin| plugin.short_name.as_str()));
            // What was named and could not be read is why it is not there.
            let problems: String = registry.problems().iter().map(|problem| format!("; {problem}")).collect();
            Err(Usage(format!("there is no plugin {name:?}; there are: {known}{problems}")).into())
        }
        several => {
            let ids = list(&mut several.iter().map(|plugin| plugin.id.as_str()));
            Err(Usage(format!("{name:?} may be any of {ids}: say the full id")).into())
        }
    }
}

/// The plugins there are, as text.
pub(super) fn listed(common: &Common) -> String {
    let options = super::options(common);
    list(&options.registry(), &options.host).text
}

/// What this machine has, in a few words.
pub(super) fn machine() -> String {
    match honami_workbench::media::ffmpeg_version() {
        Some(_) => "ffmpeg found".to_owned(),
        None => "ffmpeg not installed (adds every video format: doctor)".to_owned(),
    }
}

fn list(registry: &Registry, host: &Host) -> Answer {
    let head = ["name", "kind", "version", "", "", "", "what it is"].map(str::to_owned).to_vec();
    let levels = Ledger::beside(host).levels(registry.plugins());
    let row = |(plugin, level): (&PluginInfo, &Option<u8>)| {
        let (kind, checked, apart) =
            (plugin.kind.to_string(), checked(*level), apart(&host.prospect(plugin)));
        let cells =
            [&plugin.short_name, &kind, &plugin.version, trust(plugin), &apart, &checked, &plugin.name];
        cells.map(ToString::to_string).to_vec()
    };
    let rows = registry.plugins().iter().zip(&levels).map(row);
    let mut text = report::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>());
    if registry.plugins().is_empty() {
        text =
            "no plugins found: `cargo build --release` builds the shipped ones beside the program".to_owned();
    }
    for plugin in registry.plugins() {
        if let Trust::No(why) = &plugin.trust {
            text += &format!("\n{}: {why}", plugin.short_name);
        }
    }
    for (why, names) in not_full(host, registry) {
        text += &format!("\n{}: {why}", names.join(", "));
    }
    for problem in registry.problems() {
        text += &format!("\n{problem}");
    }
    let json = json!({
        "plugins": registry.plugins().iter().zip(levels).map(|(p, level)| described(p, level, host)).collect::<Vec<_>>(),
        "problems": registry.problems().iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    Answer { json, text, done: registry.problems().is_empty() }
}

fn trust(plugin: &PluginInfo) -> &'static str {
    match plugin.trust {
        Trust::Shipped => "shipped",
        Trust::Named => "named by you",
        Trust::Dev => "in your build tree",
        Trust::Allowed { .. } => "allowed by you",
        Trust::Lab => "allowed by your lab",
        Trust::No(_) => "not trusted",
    }
}

/// The level of `honami plugin check` that was reached, for people.
fn checked(level: Option<u8>) -> String {
    level.map_or_else(String::new, |level| format!("checked {level}"))
}

/// Where it will work and how far it will be shut in there, in a cell.
fn apart(prospect: &Prospect) -> String {
    match prospect.hosting {
        Hosting::InProcess if prospect.is_bare => "⚠ in-process".to_owned(),
        Hosting::InProcess => "in-process".to_owned(),
        Hosting::Isolated => format!("sandbox {}", prospect.sandbox),
    }
}

/// Why plugins are not shut in fully that did not come with honami, or do not work where it was wished, each reason with
/// their names.
fn not_full<'r>(host: &Host, registry: &'r Registry) -> BTreeMap<String, Vec<&'r str>> {
    let mut reasons = BTreeMap::<String, Vec<&str>>::new();
    for plugin in registry.plugins() {
        let told = host.prospect(plugin);
        if !told.why.is_empty() && (told.is_bare || told.hosting == Hosting::Isolated) {
            reasons.entry(format!("{}: {}", apart(&told), told.why)).or_default().push(&plugin.short_name);
        }
    }
    reasons
}

fn described(plugin: &PluginInfo, level: Option<u8>, host: &Host) -> serde_json::Value {
    let told = host.prospect(plugin);
    json!({
        "id": plugin.id,
        "short_name": plugin.short_name,
        "kind": plugin.kind,
        "name": plugin.name,
        "version": plugin.version,
        "license": plugin.license,
        "abi": [plugin.abi.0, plugin.abi.1],
        "library": plugin.library,
        "trust": trust(plugin),
        "checked": level,
        "hosting": told.hosting.word(),
        "sandbox": told.sandbox,
        "sandbox_why": (!told.why.is_empty()).then_some(told.why),
        "interfaces": plugin.interfaces,
        "params": plugin.params,
        "cite": plugin.cite,
        "needs": plugin.needs,
    })
}

fn info(plugin: &PluginInfo, host: &Host) -> anyhow::Result<Answer> {
    let sha256 = plugin.sha256()?;
    let mut text = format!("{} {} · {} · {}\n", plugin.name, plugin.version, plugin.kind, trust(plugin));
    text += &format!(
        "{}\nid {} · ABI {}.{} · {}\n",
        plugin.doc, plugin.id, plugin.abi.0, plugin.abi.1, plugin.license
    );
    let level = Ledger::beside(host).level(plugin);
    let kept = level.map_or_else(String::new, |level| format!(" · {}", checked(Some(level))));
    text += &format!("{} sha256 {}{kept}\n", plugin.library.display(), &sha256[..16]);
    for source in &plugin.cite {
        text += &format!("from {source}\n");
    }
    let told = host.prospect(plugin);
    let why = if told.why.is_empty() { String::new() } else { format!(": {}", told.why) };
    text += &format!("here {}{why}\n", apart(&told));
    text += &may(plugin);
    text += "\n";
    let head = ["parameter", "default", "takes", ""].map(str::to_owned).to_vec();
    let row = |param: &Param| {
        vec![param.id.clone(), param.default().to_string(), param.wanted(), first_line(&param.doc)]
    };
    text += &report::table(&std::iter::once(head).chain(plugin.params.iter().map(row)).collect::<Vec<_>>());
    let mut json = described(plugin, level, host);
    json["sha256"] = sha256.into();
    json["doc"] = plugin.doc.clone().into();
    Ok(Answer { json, text, done: true })
}

/// What a program is given beside what every plugin has, as a line; nothing for most.
fn may(plugin: &PluginInfo) -> String {
    let needs = plugin.needs.to_string();
    if needs.is_empty() { needs } else { format!("it also {needs}\n") }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}
