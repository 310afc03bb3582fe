//! `honami plugin new`: a folder with a plugin that works, and what to type next.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use honami_workbench::plugins::sdk::{self, Language};
use serde_json::json;

use super::Answer;
use super::args::{Kind, Lang};

/// Writes the files of a new plugin into a folder of its name.
pub(super) fn plugin(name: &str, kind: Kind, lang: Lang) -> anyhow::Result<Answer> {
    let language = match lang {
        Lang::Python => Language::Python,
        Lang::Rust => Language::Rust,
        Lang::C => Language::C,
        Lang::Cpp => Language::Cpp,
    };
    let of = match kind {
        Kind::Tracker => honami_workbench::plugins::Kind::Tracker,
        Kind::Clusterer => honami_workbench::plugins::Kind::Clusterer,
    };
    let begun = sdk::begin(name, of, language).map_err(anyhow::Error::msg)?;
    fs::create_dir(name).with_context(|| format!("cannot make the folder {name}"))?;
    for (file, text) in &begun.files {
        let path = Path::new(name).join(file);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    let plugin = &begun.plugin;
    let tried = match kind {
        Kind::Tracker => {
            format!("honami compare calm.y4m --truth calm.truth.csv --with {name} --plugin {plugin}")
        }
        Kind::Clusterer => format!(
            "honami new calm.honami calm.y4m && honami track calm.honami && \
             honami cluster calm.honami --with {name} --plugin {plugin}"
        ),
    };
    let next = json!({
        "build": begun.build,
        "look": format!("honami plugin info {name} --plugin {plugin}"),
        "try": format!("honami synth calm.y4m --wind calm && {tried}"),
    });
    let line = |what: &str| format!("\n  {what:<6} {}", next[what].as_str().unwrap_or_default());
    let text = format!(
        "{name}/{}: a {of} that works, to be changed. Build it before the first run and after each change:{}{}{}",
        begun.files[0].0,
        line("build"),
        line("look"),
        line("try"),
    );
    let files: Vec<&str> = begun.files.iter().map(|(file, _)| file.as_str()).collect();
    Ok(Answer {
        json: json!({ "folder": name, "files": files, "plugin": plugin, "next": next }),
        text,
        done: true,
    })
}
