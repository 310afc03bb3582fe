//! Trails: files that say which libraries of others work in this process, for whoever comes after its death.
//!
//! A trail is locked as long as its process lives, whatever becomes of that; an orderly end takes it away. The trail of
//! a dead process keeps its library out of honami's own.

use super::Quarantine;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

/// How the names of trails end.
const INSIDE: &str = "inside";

/// Those of this process, locked.
static OWN: Mutex<BTreeMap<PathBuf, File>> = Mutex::new(BTreeMap::new());

impl Quarantine {
    /// The file of a library that is kept out of honami's process.
    pub(super) fn kept_out(&self, sha256: &str) -> PathBuf {
        self.0.join(format!("{sha256}.out"))
    }

    /// Whether a library has been in honami's process when that died.
    pub(crate) fn is_kept_out(&self, sha256: &str) -> bool {
        self.kept_out(sha256).exists()
    }

    /// Leaves the trail of a plugin's library until [`ended_well`].
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn leave_trail(&self, sha256: &str, plugin: &str, library: &Path) -> io::Result<()> {
        let trail = self.0.join(format!("{sha256}.{}.{INSIDE}", process::id()));
        let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
        if own.contains_key(&trail) {
            return Ok(());
        }
        fs::create_dir_all(&self.0)?;
        // Under its name it is locked already: nobody takes it for that of a dead process.
        let new = trail.with_extension("new");
        let mut file = File::create(&new)?;
        file.lock()?;
        write!(file, "{plugin}\n{}", std::path::absolute(library)?.display())?;
        fs::rename(&new, &trail)?;
        own.insert(trail, file);
        Ok(())
    }

    /// Keeps those libraries out from now on whose trails dead processes have left; names of their plugins, and the
    /// files that these were in. Each trail is told of once.
    pub(crate) fn follow_trails(&self) -> Vec<(String, PathBuf)> {
        let Ok(entries) = fs::read_dir(&self.0) else { return Vec::new() };
        let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let mut plugins: Vec<_> = files
            .filter(|path| path.extension() == Some(OsStr::new(INSIDE)))
            .filter_map(|p| self.follow(&p))
            .collect();
        plugins.sort();
        plugins.dedup();
        plugins
    }

    fn follow(&self, trail: &Path) -> Option<(String, PathBuf)> {
        File::open(trail).ok()?.try_lock_shared().ok()?;
        let (sha256, _) = trail.file_name()?.to_str()?.split_once('.')?;
        let out = self.kept_out(sha256);
        // Of several that find it one succeeds.
        fs::rename(trail, &out).ok()?;
        let text = fs::read_to_string(out).ok()?;
        text.split_once('\n').map(|(plugin, library)| (plugin.to_owned(), library.into()))
    }
}

/// This process ends in an orderly way: what works in it has not brought it down, and its trails go.
pub fn ended_well() {
    let own = std::mem::take(&mut *OWN.lock().unwrap_or_else(PoisonError::into_inner));
    for trail in own.keys() {
        // One that stays costs its library the place in honami's process, no more.
        fs::remove_file(trail).unwrap_or_default();
    }
}
