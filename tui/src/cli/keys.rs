//! `keys`: the live key map, and what is wrong with a user's configuration.

use serde_json::json;

use super::args::Keys;
use super::{Answer, report};
use crate::app::action::{Context, TABLE};
use crate::app::config::Config;
use crate::app::keymap::KeyMap;

/// Lists the keys, or only what is wrong.
pub(super) fn keys(args: &Keys) -> Answer {
    let config = Config::load();
    let path = Config::path().map_or_else(|| "config.toml".to_owned(), |path| path.display().to_string());
    let mut text = String::new();
    for line in &config.wrong {
        text += &format!("{path}: {line}\n");
    }
    if !args.check {
        text += &report::table(&rows(&config.keys));
    } else if config.wrong.is_empty() {
        text += &format!("{path}: nothing is wrong");
    }
    let keys: Vec<serde_json::Value> = Context::ALL
        .into_iter()
        .flat_map(|context| TABLE.iter().map(move |info| (context, info)))
        .filter(|(context, info)| info.action.word_in(*context).is_some())
        .map(|(context, info)| {
            let keys = config.keys.all_keys_of(context, info.action);
            json!({ "place": context.name(), "action": info.name, "keys": keys, "doc": info.doc })
        })
        .collect();
    let json = json!({ "config": path, "wrong": config.wrong, "keys": keys });
    Answer { json, text: text.trim_end().to_owned(), done: !args.check || config.wrong.is_empty() }
}

/// One row an action: where it works alike in several places with the same keys, it is one row.
fn rows(keys: &KeyMap) -> Vec<Vec<String>> {
    let head = ["keys", "action", "in", "what it does"].map(str::to_owned).to_vec();
    let mut rows = vec![head];
    for info in TABLE {
        let mut alike: Vec<(String, Vec<&str>)> = Vec::new();
        for (context, _) in info.places {
            let mine = keys.all_keys_of(*context, info.action).join("  ");
            match alike.iter_mut().find(|(other, _)| *other == mine) {
                Some((_, places)) => places.push(context.name()),
                None => alike.push((mine, vec![context.name()])),
            }
        }
        for (mine, places) in alike {
            rows.push(vec![mine, info.name.to_owned(), places.join(" "), info.doc.to_owned()]);
        }
    }
    rows
}
