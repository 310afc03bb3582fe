//! Verdicts of plugins that are one content or another.

use super::*;
use crate::Report;
use honami_host::{Registry, SearchPath};
use std::path::Path;
use std::time::Duration;

const MANIFEST: &str = r#"{"honami":1,"abi":[1,1],"library":{"id":"org.me.mine","version":"1"},"exec":["python3","mine.py"],
    "plugins":[{"id":"org.me.mine","kind":"tracker","name":"Mine"}]}"#;

/// A plugin in Python in a folder, with this script.
fn plugin(folder: &Path, script: &str) -> PluginInfo {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("mine.honami.json"), MANIFEST).unwrap();
    fs::write(folder.join("mine.py"), script).unwrap();
    let named = vec![folder.join("mine.honami.json")];
    Registry::scan_path(&SearchPath { named, ..SearchPath::default() }).plugins()[0].clone()
}

fn report(info: &PluginInfo, level: Option<u8>) -> Report {
    let (name, plugin, sha256) = (info.short_name.clone(), info.id.clone(), info.sha256().unwrap());
    Report { name, plugin, sha256, seed: 1, level, outcomes: Vec::new(), took: Duration::ZERO }
}

#[test]
fn a_verdict_is_for_a_content_wherever_it_lies_and_for_no_other() {
    let home = tempfile::tempdir().unwrap();
    let ledger = Ledger::beside(&Host::with_store(home.path().join("store")));
    let mine = plugin(&home.path().join("a"), "first");
    assert_eq!(ledger.level(&mine), None);
    ledger.keep(&mine, &report(&mine, Some(9))).unwrap();
    assert_eq!(ledger.level(&mine), Some(9));
    let copy = plugin(&home.path().join("b"), "first");
    let other = plugin(&home.path().join("c"), "other");
    assert_eq!(ledger.levels(&[copy, other]), [Some(9), None]);
    let rebuilt = plugin(&home.path().join("a"), "later");
    assert_eq!(ledger.level(&rebuilt), None);
}

#[test]
fn chosen_checks_say_nothing_of_a_level() {
    let home = tempfile::tempdir().unwrap();
    let ledger = Ledger::beside(&Host::with_store(home.path().join("store")));
    let mine = plugin(&home.path().join("a"), "first");
    ledger.keep(&mine, &report(&mine, None)).unwrap();
    assert_eq!(ledger.level(&mine), None);
}
