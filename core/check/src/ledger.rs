//! Up to which level a plugin has passed, kept for exactly the content that was checked.
//!
//! A file for each content, named by its hash, beside the store of libraries: it may be deleted at any time.

use crate::report::{Report, Status};
use honami_host::{Host, PluginInfo};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::PathBuf;

/// The folder of verdicts.
#[derive(Clone, Debug)]
pub struct Ledger(PathBuf);

/// What is kept of a content.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Entry {
    /// Of the honami whose checks they were: those of another say nothing.
    honami: String,
    /// Of the file: one of another length has another content, one with the same stamp has the same.
    bytes: u64,
    stamp: String,
    /// By plugin.
    levels: BTreeMap<String, u8>,
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Ledger {
    /// Beside the store of a host.
    #[must_use]
    pub fn beside(host: &Host) -> Self {
        Self(host.beside("checks"))
    }

    fn file(&self, sha256: &str) -> PathBuf {
        self.0.join(format!("{sha256}.json"))
    }

    fn entry(&self, sha256: &str) -> Option<Entry> {
        let entry: Entry = serde_json::from_slice(&fs::read(self.file(sha256)).ok()?).ok()?;
        (entry.honami == VERSION).then_some(entry)
    }

    /// Keeps a verdict, if all checks up to its level were done. What a content has reached only a failure takes back.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&self, info: &PluginInfo, report: &Report) -> io::Result<()> {
        let (Some(level), Some(sha256)) = (report.reached(), &report.sha256) else { return Ok(()) };
        let mut entry = self.entry(sha256).unwrap_or_default();
        VERSION.clone_into(&mut entry.honami);
        (entry.bytes, entry.stamp) = (fs::metadata(&info.library)?.len(), info.stamp()?);
        let before = entry.levels.get(&info.id).copied().filter(|_| report.status() != Status::Failed);
        entry.levels.insert(info.id.clone(), before.map_or(level, |before| level.max(before)));
        fs::create_dir_all(&self.0)?;
        // Whole or not at all.
        let half = self.0.join(format!("half-{}", std::process::id()));
        fs::write(&half, serde_json::to_vec(&entry)?)?;
        fs::rename(half, self.file(sha256))
    }

    /// The level that a plugin has reached as its file is now; `None` where its content was never checked.
    #[must_use]
    pub fn level(&self, info: &PluginInfo) -> Option<u8> {
        self.levels(std::slice::from_ref(info)).pop().flatten()
    }

    /// The levels of several. Files are read only where a content of their length was checked under another name.
    #[must_use]
    pub fn levels(&self, infos: &[PluginInfo]) -> Vec<Option<u8>> {
        let names = fs::read_dir(&self.0).into_iter().flatten().flatten().map(|entry| entry.file_name());
        let names = names.filter_map(|name| name.to_string_lossy().strip_suffix(".json").map(str::to_owned));
        let entries: BTreeMap<String, Entry> =
            names.filter_map(|sha256| Some((sha256.clone(), self.entry(&sha256)?))).collect();
        infos.iter().map(|info| level(&entries, info)).collect()
    }
}

fn level(entries: &BTreeMap<String, Entry>, info: &PluginInfo) -> Option<u8> {
    let stamp = info.stamp().ok()?;
    let bytes = fs::metadata(&info.library).ok()?.len();
    let entry = match entries.values().find(|entry| entry.stamp == stamp) {
        Some(entry) => entry,
        None if entries.values().any(|entry| entry.bytes == bytes) => entries.get(&info.sha256().ok()?)?,
        None => return None,
    };
    entry.levels.get(&info.id).copied()
}

#[cfg(test)]
mod tests;
