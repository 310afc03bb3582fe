//! The store of loaded libraries: copies named by content, so that what was hashed is what runs.
//!
//! The dynamic linker knows libraries by path and maps them from the file: a rebuilt plugin at the same path would be the
//! old one, and an overwritten file kills the process. Copies that never change cure both.

use crate::error::HostError;
use crate::regular::{self, LIBRARY_BYTES_MAX};
use crate::script;
use rustix::process::geteuid;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, DirBuilder, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

/// Copies that nobody has loaded for so long are removed when another comes.
const AGE_MAX: Duration = Duration::from_secs(30 * 24 * 3600);

/// A copy in the store.
#[derive(Clone, Debug)]
pub(crate) struct Stored {
    /// The copy.
    pub(crate) path: PathBuf,
    /// Of its content, lower-case hexadecimal.
    pub(crate) sha256: String,
}

impl Stored {
    /// A copy that the store has named by its content.
    pub(crate) fn named(copy: &Path) -> Self {
        let sha256 = copy.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self { path: copy.to_owned(), sha256 }
    }
}

/// What tells a file that has not been touched: device, inode, bytes, and when it was written and changed.
pub(crate) type Identity = (u64, u64, u64, [i64; 4]);

pub(crate) fn identity(path: &Path) -> io::Result<Identity> {
    let of = |path: &Path| {
        let meta = fs::metadata(path)?;
        let times = [meta.mtime(), meta.mtime_nsec(), meta.ctime(), meta.ctime_nsec()];
        io::Result::Ok((meta.dev(), meta.ino(), meta.len(), times))
    };
    if !script::is_manifest(path) {
        return of(path);
    }
    // Of several files: those of all, mixed so that none can change unseen.
    let parts = script::parts(path);
    let mut mixed = (parts.len() as u64, 0_u64, 0_u64, [0_i64; 4]);
    for (dev, ino, len, times) in parts.iter().map(|part| of(part)).collect::<io::Result<Vec<_>>>()? {
        mixed = (mixed.0 ^ dev, mixed.1.rotate_left(7) ^ ino, mixed.2.rotate_left(7) ^ len, mixed.3);
        mixed.3.iter_mut().zip(times).for_each(|(sum, time)| *sum = sum.rotate_left(7) ^ time);
    }
    Ok(mixed)
}

/// The hash of a file's content, lower-case hexadecimal.
///
/// # Errors
/// When it cannot be read.
pub(crate) fn sha256_of(path: &Path) -> Result<String, HostError> {
    if script::is_manifest(path) {
        let contents: Vec<Vec<u8>> =
            script::parts(path).iter().map(|part| read(part)).collect::<Result<_, _>>()?;
        return Ok(hex_of_parts(&contents));
    }
    read(path).map(|bytes| hex(&bytes))
}

/// The hash of several files, lower-case hexadecimal.
pub(crate) fn hex_of_parts(contents: &[Vec<u8>]) -> String {
    let mut hasher = Sha256::new();
    for bytes in contents {
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Reads a library once and keeps that content in the store, or where that cannot be written (a full quota, a home
/// that is read-only) in a folder for temporary files.
///
/// # Errors
/// When it cannot be read, or neither folder can be written.
pub(crate) fn keep(path: &Path, folder: &Path) -> Result<Stored, HostError> {
    static KEPT: Mutex<BTreeMap<Identity, Stored>> = Mutex::new(BTreeMap::new());
    let before = identity(path).ok();
    let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let known = before.as_ref().and_then(|identity| kept().get(identity).cloned());
    if let Some(stored) = known.filter(|stored| stored.path.starts_with(folder) && stored.path.exists()) {
        return Ok(stored);
    }
    let stored = keep_now(path, folder)?;
    // Of a file that was written meanwhile nobody knows which content was read.
    if let Some(identity) = before.filter(|before| identity(path).ok().as_ref() == Some(before)) {
        kept().insert(identity, stored.clone());
    }
    Ok(stored)
}

fn keep_now(path: &Path, folder: &Path) -> Result<Stored, HostError> {
    let bytes = read(path)?;
    let sha256 = hex(&bytes);
    let keep_in = |folder: &Path| {
        let copy = copy_in(folder, &sha256);
        make_room(folder, &copy);
        keep_bytes(folder, &copy, &bytes).map(|()| copy)
    };
    let kept = keep_in(folder).or_else(|first| keep_in(&temporary_folder()).map_err(|_second| first));
    let copy = kept.map_err(|e| HostError::File {
        path: path.to_owned(),
        why: format!(
            "cannot be copied to {}, from where it is loaded: {e}; set XDG_CACHE_HOME to a folder you may write",
            folder.display()
        ),
    })?;
    Ok(Stored { path: copy, sha256 })
}

fn copy_in(folder: &Path, sha256: &str) -> PathBuf {
    folder.join(format!("{sha256}.so"))
}

/// Where a library was copied to that has been loaded.
pub(crate) fn copy_of(folder: &Path, sha256: &str) -> PathBuf {
    let copy = copy_in(folder, sha256);
    if copy.exists() { copy } else { copy_in(&temporary_folder(), sha256) }
}

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, HostError> {
    let why = |e: io::Error| HostError::File { path: path.to_owned(), why: format!("cannot be read: {e}") };
    regular::read(path, LIBRARY_BYTES_MAX).map_err(why)
}

/// The hash of bytes, lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// `$XDG_CACHE_HOME/honami/store`.
pub(crate) fn folder_of_user() -> PathBuf {
    let absolute = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let cache = absolute("XDG_CACHE_HOME").or_else(|| absolute("HOME").map(|home| home.join(".cache")));
    cache.map_or_else(temporary_folder, |cache| cache.join("honami/store"))
}

/// For those whose cache folder cannot be written; ours alone, like the store.
fn temporary_folder() -> PathBuf {
    std::env::temp_dir().join(format!("honami-{}", geteuid().as_raw()))
}

/// Keeps a copy in a folder of this user alone, whole or not at all.
pub(crate) fn keep_bytes(folder: &Path, copy: &Path, bytes: &[u8]) -> io::Result<()> {
    DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    let owner = fs::symlink_metadata(folder)?;
    if !owner.is_dir() || owner.uid() != geteuid().as_raw() {
        return Err(io::Error::other("the folder is not yours"));
    }
    if owner.mode() & 0o077 != 0 {
        fs::set_permissions(folder, Permissions::from_mode(0o700))?;
    }
    if fs::read(copy).is_ok_and(|kept| kept == bytes) {
        still_used(copy);
        return Ok(());
    }
    // A name of our own until it is whole: two programs may come to keep the same library.
    let half = folder.join(format!("half-{}-{}", std::process::id(), thread_number()));
    let mut file = OpenOptions::new().write(true).create(true).truncate(true).mode(0o600).open(&half)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| file.set_permissions(Permissions::from_mode(0o400)))
        .and_then(|()| fs::rename(&half, copy));
    if written.is_err() {
        fs::remove_file(&half)?;
    }
    written
}

/// A number that no other thread of this process has now.
fn thread_number() -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    std::thread::current().id().hash(&mut hasher);
    hasher.finish()
}

/// Removes what is old from the store before a copy comes into it that is not there: libraries, folders of programs, and
/// what was never whole. Best effort: what cannot be removed is only in the way. Libraries in use stay mapped.
pub(crate) fn make_room(store: &Path, copy: &Path) {
    if copy.exists() {
        return;
    }
    for entry in fs::read_dir(store).into_iter().flatten().flatten() {
        let Ok(meta) = entry.metadata() else { continue };
        let age = meta.modified().ok().and_then(|time| time.elapsed().ok());
        if age.is_some_and(|age| age > AGE_MAX) {
            let path = entry.path();
            let is_program = path.extension().is_some_and(|extension| extension == "program");
            drop(if meta.is_dir() && is_program { fs::remove_dir_all(path) } else { fs::remove_file(path) });
        }
    }
}

/// Notes that a copy was loaded now. Best effort: one that is forgotten too early is made again.
pub(crate) fn still_used(copy: &Path) {
    drop(File::open(copy).and_then(|file| file.set_modified(SystemTime::now())));
}

#[cfg(test)]
mod tests;
