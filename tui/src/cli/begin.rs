//! `honami plugin new`: a folder with a plugin that works, and what to type next.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use honami_workbench::plugins::PluginInfo;
use honami_workbench::plugins::sdk::{self, Language};
use serde_json::json;

use super::args::{Kind, Lang};
use super::{Answer, Usage, want};

/// Writes the files of a new plugin into a folder of its name. Where `other` has the same short name its whole id is said.
pub(super) fn plugin(
    name: &str,
    kind: Kind,
    lang: Lang,
    command: &[String],
    other: Option<&PluginInfo>,
) -> anyhow::Result<Answer> {
    let of = match kind {
        Kind::Tracker => honami_workbench::plugins::Kind::Tracker,
        Kind::Clusterer => honami_workbench::plugins::Kind::Clusterer,
        Kind::Structure => honami_workbench::plugins::Kind::Structure,
    };
    let language = language(lang);
    let begun = match language {
        Some(language) => {
            want(command.is_empty(), || "a command line belongs to --lang trax".to_owned())?;
            sdk::begin(name, of, language)
        }
        None => {
            let is_tracker = of == honami_workbench::plugins::Kind::Tracker;
            want(is_tracker, || "what speaks TraX is a tracker".to_owned())?;
            sdk::adapt(name, command)
        }
    };
    let begun = begun.map_err(Usage)?;
    write(name, &begun.files)?;
    let plugin = &begun.plugin;
    let called = other.map_or_else(|| name.to_owned(), |_| format!("org.me.{name}"));
    let tried = match kind {
        Kind::Tracker => {
            format!("honami compare calm.y4m --truth calm.truth.csv --with {called} --plugin {plugin}")
        }
        Kind::Clusterer => format!(
            "honami new calm.honami calm.y4m && honami track calm.honami && \
             honami cluster calm.honami --with {called} --plugin {plugin}"
        ),
        Kind::Structure => format!(
            "honami new calm.honami calm.y4m && honami track calm.honami && honami cluster calm.honami && \
             honami grow calm.honami calm.bvh --truth calm.truth.csv --with {called} --plugin {plugin}"
        ),
    };
    // Each of its points has a process of its own.
    let few = if language.is_none() { " --leaves 20" } else { "" };
    let next = json!({
        "build": begun.build,
        "look": format!("honami plugin info {called} --plugin {plugin}"),
        "check": format!("honami plugin check {plugin}"),
        "try": format!("honami synth calm.y4m --wind calm{few} && {tried}"),
    });
    let line = |what: &str| format!("\n  {what:<6} {}", next[what].as_str().unwrap_or_default());
    let when = match lang {
        Lang::Python | Lang::Trax => {
            "Write its manifest before the first run, and anew when its parameters change"
        }
        Lang::Rust | Lang::C | Lang::Cpp => "Build it before the first run and after each change",
    };
    let also = other.map_or_else(String::new, |other| {
        format!("\n{name} is also the short name of {}: this one is called {called}", other.id)
    });
    let text = format!(
        "{name}/{}: a {of} that works, to be changed. {when}:{}{}{}{}{also}",
        begun.files[0].0,
        line("build"),
        line("look"),
        line("check"),
        line("try"),
    );
    let files: Vec<&str> = begun.files.iter().map(|(file, _)| file.as_str()).collect();
    Ok(Answer {
        json: json!({ "folder": name, "files": files, "plugin": plugin, "next": next }),
        text,
        done: true,
    })
}

/// What it is written in; `None` where a command of another's is.
fn language(lang: Lang) -> Option<Language> {
    match lang {
        Lang::Python => Some(Language::Python),
        Lang::Rust => Some(Language::Rust),
        Lang::C => Some(Language::C),
        Lang::Cpp => Some(Language::Cpp),
        Lang::Trax => None,
    }
}

/// Makes the folder with these files, each a path in it and a text.
fn write(folder: &str, files: &[(String, String)]) -> anyhow::Result<()> {
    let is_there = fs::symlink_metadata(folder).is_ok();
    anyhow::ensure!(!is_there, "there is {folder} already: choose another name, or take it away first");
    fs::create_dir(folder).with_context(|| format!("cannot make the folder {folder}"))?;
    for (file, text) in files {
        let path = Path::new(folder).join(file);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}
