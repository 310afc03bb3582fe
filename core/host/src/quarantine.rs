//! Libraries that keep failing are not started again until somebody says so.
//!
//! Failures are counted by the hash of the library, so that a rebuilt one begins anew.

use crate::error::HostError;
use crate::registry::PluginInfo;
use std::fs;
use std::io;
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

    /// Counts a failure; with the last of too many the library is held.
    ///
    /// # Errors
    /// [`HostError::Quarantined`] then. What cannot be written is not counted.
    pub(crate) fn blame(&self, info: &PluginInfo, sha256: &str, why: &str) -> Result<(), HostError> {
        if !self.is_too_much(sha256, why) {
            return Ok(());
        }
        Err(held(info, why.to_owned()))
    }

    fn is_too_much(&self, sha256: &str, why: &str) -> bool {
        let is_too_much = self.count(sha256, SystemTime::now()).unwrap_or(FAILURES) >= FAILURES;
        if is_too_much {
            // Where nothing can be written it is not held, but this run has ended.
            fs::write(self.held(sha256), why).unwrap_or_default();
        }
        is_too_much
    }

    fn count(&self, sha256: &str, now: SystemTime) -> io::Result<usize> {
        fs::create_dir_all(&self.0)?;
        let file = self.failures(sha256);
        let seconds = |time: SystemTime| time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        let since = seconds(now).saturating_sub(WITHIN.as_secs());
        let before = fs::read_to_string(&file).unwrap_or_default();
        let recent = before.lines().filter_map(|line| line.parse().ok()).filter(|time: &u64| *time > since);
        let times: Vec<String> = recent.chain([seconds(now)]).map(|time| time.to_string()).collect();
        fs::write(&file, times.join("\n"))?;
        Ok(times.len())
    }

    /// Why a library is held.
    pub(crate) fn why(&self, sha256: &str) -> Option<String> {
        fs::read_to_string(self.held(sha256)).ok()
    }

    /// Lets a library try again.
    ///
    /// # Errors
    /// When what is known of it cannot be removed.
    pub(crate) fn release(&self, sha256: &str) -> io::Result<()> {
        for file in [self.failures(sha256), self.held(sha256)] {
            match fs::remove_file(file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    /// Beside the store of libraries.
    pub(crate) fn beside(store: &Path) -> Self {
        Self(store.with_file_name("quarantine"))
    }
}

#[cfg(test)]
mod tests;
