//! Reads files that others may have put there: never a pipe that nobody writes, a device, or more than can be meant.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;

/// No manifest is larger: what claims to be is not read.
pub(crate) const MANIFEST_BYTES_MAX: u64 = 1 << 20;
/// No library and no file of a program is larger.
pub(crate) const LIBRARY_BYTES_MAX: u64 = 2 << 30;

/// Opens a regular file of at most so many bytes for reading; it never waits.
///
/// # Errors
/// When it cannot be opened, is something else, or is larger.
pub(crate) fn open(path: &Path, bytes_max: u64) -> io::Result<File> {
    let flags = rustix::fs::OFlags::NONBLOCK.union(rustix::fs::OFlags::CLOEXEC).bits().cast_signed();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    let meta = file.metadata()?;
    if !meta.is_file() {
        return Err(io::Error::other("wanted a file, got a folder, a pipe or a device"));
    }
    if meta.len() > bytes_max {
        return Err(too_large(bytes_max));
    }
    Ok(file)
}

/// The whole content of such a file.
///
/// # Errors
/// The same, and when it cannot be read.
pub(crate) fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // It may grow meanwhile, and some systems say that a file is empty until it is read.
    open(path, bytes_max)?.take(bytes_max + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > bytes_max { Err(too_large(bytes_max)) } else { Ok(bytes) }
}

fn too_large(bytes_max: u64) -> io::Error {
    io::Error::other(format!("wanted at most {bytes_max} bytes, it has more"))
}

#[cfg(test)]
mod tests;
