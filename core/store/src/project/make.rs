//! Making a project file: whole or not at all, and never over another.

use std::path::{Path, PathBuf};

use super::folder_of;
use crate::error::StoreError;
use crate::media::ClipRecord;
use crate::{journal, schema};

/// Makes the file under another name first; the caller holds the lock, so that name is ours, whatever a
/// killed session left there.
pub(super) fn make(path: &Path, record: &ClipRecord, author: &str) -> Result<(), StoreError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let new = path.with_file_name(format!(".{name}.new"));
    let made = remove_if_there(&new)
        .and_then(|()| fill(&new, &record.seen_from(folder_of(path)), author))
        .and_then(|()| give_name(&new, path));
    if made.is_err() {
        // The first error is the one to tell; what cannot be removed is replaced by the next attempt.
        drop(remove_if_there(&new));
    }
    made
}

/// The path of a file that is not there yet, in a folder that is, without links: one name for the lock.
pub(super) fn real_path(path: &Path) -> Result<PathBuf, StoreError> {
    let io = |source| StoreError::Io { what: "cannot make a project", source, path: path.to_owned() };
    let absolute = std::path::absolute(path).map_err(io)?;
    let name = absolute.file_name().ok_or_else(|| io(std::io::ErrorKind::InvalidFilename.into()))?;
    Ok(folder_of(&absolute).canonicalize().map_err(io)?.join(name))
}

/// Whether nothing has this name, not even a link to nowhere.
pub(super) fn check_free(path: &Path) -> Result<(), StoreError> {
    if path.symlink_metadata().is_ok() { Err(StoreError::Exists(path.to_owned())) } else { Ok(()) }
}

fn remove_if_there(path: &Path) -> Result<(), StoreError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(StoreError::Io { what: "cannot remove a half-made project", source, path: path.to_owned() })
        }
        _ => Ok(()),
    }
}

fn fill(path: &Path, record: &ClipRecord, author: &str) -> Result<(), StoreError> {
    let mut conn = schema::create(path)?;
    let tx = conn.transaction()?;
    record.insert(&tx)?;
    journal::create(&tx, author)?;
    tx.commit()?;
    conn.close().map_err(|(_, error)| error.into())
}

/// Gives the finished file its name, unless somebody has taken it meanwhile.
fn give_name(new: &Path, path: &Path) -> Result<(), StoreError> {
    let io = |source| StoreError::Io { what: "cannot make a project", source, path: path.to_owned() };
    match std::fs::hard_link(new, path) {
        Ok(()) => remove_if_there(new)?,
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
            return Err(StoreError::Exists(path.to_owned()));
        }
        // A file system without hard links: the lock keeps other sessions away between look and rename.
        Err(_) => {
            check_free(path)?;
            std::fs::rename(new, path).map_err(io)?;
        }
    }
    std::fs::File::open(folder_of(path)).and_then(|folder| folder.sync_all()).map_err(io)
}
