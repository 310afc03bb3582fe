//! Verdicts of plugins that are one content or another.

use super::*;
use crate::{Check, Finding, Outcome, Report, checks};
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

/// Checks up to a level that hold, and perhaps one that fails.
fn report(info: &PluginInfo, level: Option<u8>, fails: Option<u8>) -> Report {
    let (name, plugin, sha256) = (info.short_name.clone(), info.id.clone(), Some(info.sha256().unwrap()));
    let outcome = |(level, finding)| Outcome {
        check: Check { level, ..checks()[0] },
        finding,
        took: Duration::ZERO,
        repeat: String::new(),
    };
    let held = (1..=level.unwrap_or(9)).filter(|level| fails != Some(*level));
    let found = held.map(|level| (level, Finding::Holds(String::new())));
    let outcomes =
        found.chain(fails.map(|level| (level, Finding::Fails(String::new())))).map(outcome).collect();
    Report { name, plugin, sha256, seed: 1, level, outcomes, took: Duration::ZERO }
}

#[test]
fn a_verdict_is_for_a_content_wherever_it_lies_and_for_no_other() {
    let home = tempfile::tempdir().unwrap();
    let ledger = Ledger::beside(&Host::with_store(home.path().join("store")));
    let mine = plugin(&home.path().join("a"), "first");
    assert_eq!(ledger.level(&mine), None);
    ledger.keep(&mine, &report(&mine, Some(9), None)).unwrap();
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
    ledger.keep(&mine, &report(&mine, None, None)).unwrap();
    assert_eq!(ledger.level(&mine), None);
}

#[test]
fn a_level_that_was_reached_is_taken_back_by_a_failure_alone() {
    let home = tempfile::tempdir().unwrap();
    let ledger = Ledger::beside(&Host::with_store(home.path().join("store")));
    let mine = plugin(&home.path().join("a"), "first");
    for (wanted, fails, level) in
        [(3, None, 3), (1, None, 3), (9, None, 9), (9, Some(7), 6), (3, None, 6), (3, Some(2), 1)]
    {
        ledger.keep(&mine, &report(&mine, Some(wanted), fails)).unwrap();
        assert_eq!(ledger.level(&mine), Some(level), "up to {wanted}, failed at {fails:?}");
    }
}
