//! The lock beside a project: one session writes, and the others learn who.
//!
//! `.NAME.honami.lock` holds the holder as JSON and an advisory lock of the operating system, which a killed
//! session loses: a lock file left behind is taken over without asking.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::error::StoreError;

/// Who has a project open for writing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// Log-in name.
    pub user: String,
    /// Name of the machine.
    pub host: String,
    /// Process on that machine.
    pub pid: u32,
    /// Since when, RFC 3339.
    pub since: String,
}

impl std::fmt::Display for Holder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}@{} (pid {}) since {}", self.user, self.host, self.pid, self.since)
    }
}

/// The held lock; dropping it removes the file and lets the next session in.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    file: File,
    pub(crate) holder: Holder,
}

/// What one process alone works on while this is held, besides projects.
#[derive(Debug)]
pub struct Claim {
    _lock: Lock,
}

impl Claim {
    /// Claims a place by a file beside it, `.NAME.lock`, that names the holder.
    ///
    /// # Errors
    /// [`StoreError::Locked`] when another process has it, [`StoreError::Io`] when the folder refuses.
    pub fn of(path: &Path) -> Result<Self, StoreError> {
        Ok(Self { _lock: Lock::acquire(path)? })
    }
}

/// A reader that looks for the holder has the lock for a moment; so often a writer tries again.
const TRIES: u32 = 10;
const PAUSE: Duration = Duration::from_millis(10);

impl Lock {
    /// Takes the lock of a project.
    ///
    /// # Errors
    /// [`StoreError::Locked`] when another session has it, [`StoreError::Io`] when the folder refuses.
    pub(crate) fn acquire(project: &Path) -> Result<Self, StoreError> {
        let path = lock_path(project);
        let io = |source| StoreError::Io { what: "cannot lock the project", source, path: path.clone() };
        let mut refused = 0;
        loop {
            let mut file = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&path)
                .map_err(io)?;
            match file.try_lock() {
                // The last holder unlinks the file before it lets go: a lock on a file without a name is none.
                Ok(()) if !is_at(&file, &path) => {}
                Ok(()) => {
                    let holder = Holder::me(&file);
                    write_holder(&mut file, &holder).map_err(io)?;
                    return Ok(Self { path, file, holder });
                }
                Err(TryLockError::WouldBlock) if refused < TRIES => {
                    refused += 1;
                    std::thread::sleep(PAUSE);
                }
                Err(TryLockError::WouldBlock) => {
                    return Err(StoreError::Locked {
                        holder: read_holder(&mut file),
                        path: project.to_owned(),
                    });
                }
                Err(TryLockError::Error(source)) => return Err(io(source)),
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While the lock is held nobody else can have made a new file of this name.
        if is_at(&self.file, &self.path) {
            // A file that stays behind is taken over by the next session.
            drop(std::fs::remove_file(&self.path));
        }
    }
}

/// Who has the project open for writing just now, if anybody.
pub(crate) fn holder_of(project: &Path) -> Option<Holder> {
    let mut file = File::open(lock_path(project)).ok()?;
    match file.try_lock_shared() {
        Err(TryLockError::WouldBlock) => Some(read_holder(&mut file).unwrap_or_else(|| Holder {
            user: "somebody".to_owned(),
            host: "unknown".to_owned(),
            pid: 0,
            since: "just now".to_owned(),
        })),
        _ => None,
    }
}

/// The log-in name, where the environment says it.
pub(crate) fn user_name() -> Option<String> {
    let named = ["USER", "LOGNAME"].iter().find_map(|name| std::env::var(name).ok());
    named.filter(|name| !name.is_empty())
}

impl Holder {
    fn me(file: &File) -> Self {
        let uid =
            || file.metadata().map_or_else(|_| "unknown".to_owned(), |meta| format!("uid {}", meta.uid()));
        let host = std::fs::read_to_string("/proc/sys/kernel/hostname")
            .or_else(|_| std::fs::read_to_string("/etc/hostname"));
        Self {
            user: user_name().unwrap_or_else(uid),
            host: host.map_or_else(|_| "localhost".to_owned(), |name| name.trim().to_owned()),
            pid: std::process::id(),
            since: crate::now(),
        }
    }
}

fn lock_path(project: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(project.file_name().unwrap_or_default());
    name.push(".lock");
    project.with_file_name(name)
}

fn is_at(file: &File, path: &Path) -> bool {
    let inode = |meta: std::fs::Metadata| (meta.dev(), meta.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(held), Ok(named)) => inode(held) == inode(named),
        _ => false,
    }
}

fn write_holder(file: &mut File, holder: &Holder) -> std::io::Result<()> {
    let mut json = serde_json::to_vec(holder)?;
    json.push(b'\n');
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(&json)
}

fn read_holder(file: &mut File) -> Option<Holder> {
    let mut json = String::new();
    file.read_to_string(&mut json).ok()?;
    serde_json::from_str(&json).ok()
}

#[cfg(test)]
mod tests;
