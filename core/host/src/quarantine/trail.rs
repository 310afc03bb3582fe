//! Trails: files that say which libraries of others work in this process, for whoever comes after its end.
//!
//! A trail is locked as long as its process lives, whatever becomes of that; it goes with the last instance of its
//! library, or at an orderly end. The trail of a dead process keeps its library out of honami's own.

use super::{Quarantine, remove};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

/// How the names of trails end.
const INSIDE: &str = "inside";

/// Those of this process: locked, and how many instances work on each.
static OWN: Mutex<BTreeMap<PathBuf, (File, usize)>> = Mutex::new(BTreeMap::new());

/// An instance works in this process as long as this is there.
#[derive(Debug)]
pub(crate) struct Trail(PathBuf);

impl Drop for Trail {
    fn drop(&mut self) {
        let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((_, instances)) = own.get_mut(&self.0) else { return };
        *instances -= 1;
        if *instances == 0 {
            own.remove(&self.0);
            // One that stays costs its library the place in honami's process, no more.
            fs::remove_file(&self.0).unwrap_or_default();
        }
    }
}

impl Quarantine {
    /// The file of a library that is kept out of honami's process.
    pub(super) fn kept_out(&self, sha256: &str) -> PathBuf {
        self.0.join(format!("{sha256}.out"))
    }

    /// Whether a library was in honami's process when that ended.
    pub(crate) fn is_kept_out(&self, sha256: &str) -> bool {
        self.kept_out(sha256).exists()
    }

    /// Lets a library work in honami's process again; whether it was kept out.
    ///
    /// # Errors
    /// When what is known of it cannot be removed.
    pub(crate) fn let_in(&self, sha256: &str) -> io::Result<bool> {
        let was_out = self.is_kept_out(sha256);
        remove(&self.kept_out(sha256))?;
        Ok(was_out)
    }

    /// Leaves the trail of a plugin's library, for one instance.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn leave_trail(&self, sha256: &str, plugin: &str, library: &Path) -> io::Result<Trail> {
        let trail = self.0.join(format!("{sha256}.{}.{INSIDE}", process::id()));
        let mut own = OWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, instances)) = own.get_mut(&trail) {
            *instances += 1;
            return Ok(Trail(trail));
        }
        fs::create_dir_all(&self.0)?;
        // Under its name it is locked already: nobody takes it for that of a dead process.
        let new = trail.with_extension("new");
        let mut file = File::create(&new)?;
        file.lock()?;
        write!(file, "{plugin}\n{}", std::path::absolute(library)?.display())?;
        fs::rename(&new, &trail)?;
        own.insert(trail.clone(), (file, 1));
        Ok(Trail(trail))
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
        fs::remove_file(trail).unwrap_or_default();
    }
}
