//! Libraries that keep failing are not started again until somebody says so.
//!
//! Failures are counted by the hash of the library, so that a rebuilt one begins anew. What was inside honami when that
//! ended (`trail.rs`) works in a process of its own from then on, until somebody lets it in again.

mod trail;

pub(crate) use trail::Trail;
pub use trail::ended_well;

use crate::error::{HostError, after};
use crate::isolated::Ended;
use crate::registry::PluginInfo;
use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// So many failures
const FAILURES: usize = 3;
/// within so long are too many.
const WITHIN: Duration = Duration::from_secs(600);

/// A plugin is not started, for this reason.
pub(crate) fn held(info: &PluginInfo, why: String) -> HostError {
    HostError::Quarantined { plugin: info.id.clone(), library: info.library.clone(), why }
}

/// Counts the deaths of one library, wherever it is at work.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    quarantine: Quarantine,
    sha256: String,
    is_paused: bool,
}

impl Tally {
    pub(crate) fn new(quarantine: Quarantine, sha256: String) -> Self {
        Self { quarantine, sha256, is_paused: false }
    }

    /// Whether deaths from now on are another's fault, or have been counted already.
    pub(crate) fn pause(&mut self, is_paused: bool) {
        self.is_paused = is_paused;
    }

    /// Why it is not started, when it has died too often.
    pub(crate) fn held(&self) -> Option<String> {
        self.quarantine.why(&self.sha256)
    }

    /// Its process has ended; who was asked to stop has not died.
    pub(crate) fn ended(&self, how: &Ended, last_words: &str) {
        if *how != Ended::Stopped && !self.is_paused {
            self.quarantine.blame(&self.sha256, &format!("{how}{}", after(last_words)));
        }
    }
}

/// Removes a file, if it is there.
fn remove(file: &Path) -> io::Result<()> {
    match fs::remove_file(file) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The folder of what is known of failures.
#[derive(Clone, Debug)]
pub(crate) struct Quarantine(pub(crate) PathBuf);

impl Quarantine {
    fn failures(&self, sha256: &str) -> PathBuf {
        self.0.join(format!("{sha256}.failures"))
    }

    fn held(&self, sha256: &str) -> PathBuf {
        self.0.join(format!("{sha256}.held"))
    }

    /// Counts a death; after the last of too many the library is held. Where nothing can be written it never is.
    fn blame(&self, sha256: &str, why: &str) {
        if self.count(sha256, SystemTime::now()).is_ok_and(|n| n >= FAILURES) {
            fs::write(self.held(sha256), why).unwrap_or_default();
        }
    }

    fn count(&self, sha256: &str, now: SystemTime) -> io::Result<usize> {
        fs::create_dir_all(&self.0)?;
        let path = self.failures(sha256);
        let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        // Other sessions count, too.
        file.lock()?;
        let mut before = Vec::new();
        file.read_to_end(&mut before)?;
        let now = now.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        let since = now.saturating_sub(WITHIN.as_secs());
        // What lies ahead was counted by a clock that has been put back since.
        let is_recent = |time: &u64| (since + 1..=now).contains(time);
        let before = String::from_utf8_lossy(&before);
        let recent = before.lines().filter_map(|line| line.parse().ok()).filter(is_recent);
        let times: Vec<String> = recent.chain([now]).map(|time| time.to_string()).collect();
        file.rewind()?;
        file.set_len(0)?;
        file.write_all(times.join("\n").as_bytes())?;
        Ok(times.len())
    }

    /// Whether any library is held: if not, none need be read to tell.
    pub(crate) fn holds_any(&self) -> bool {
        let files = fs::read_dir(&self.0).into_iter().flatten().flatten();
        files.map(|file| file.path()).any(|file| file.extension().is_some_and(|kind| kind == "held"))
    }

    /// Why a library is held.
    pub(crate) fn why(&self, sha256: &str) -> Option<String> {
        fs::read_to_string(self.held(sha256)).ok()
    }

    /// Lets a library try again, where it works now: what is kept out stays out.
    ///
    /// # Errors
    /// When what is known of it cannot be removed.
    pub(crate) fn release(&self, sha256: &str) -> io::Result<()> {
        remove(&self.failures(sha256))?;
        remove(&self.held(sha256))
    }

    /// What is known of a library cannot be removed.
    pub(crate) fn unchanged(&self, error: &io::Error) -> HostError {
        HostError::File { path: self.0.clone(), why: format!("cannot be changed: {error}") }
    }

    /// Beside the store of libraries.
    pub(crate) fn beside(store: &Path) -> Self {
        Self(store.with_file_name("quarantine"))
    }
}

#[cfg(test)]
mod tests;
