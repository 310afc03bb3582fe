//! The content hash that names a clip.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::error::MediaError;

/// SHA-256 of a file's bytes, 64 hex digits.
///
/// # Errors
/// [`MediaError::Missing`] or [`MediaError::Io`].
pub fn sha256_of_file(path: &Path) -> Result<String, MediaError> {
    let mut hash = Sha256::new();
    feed(&mut hash, path)?;
    Ok(hex(&hash.finalize()))
}

/// SHA-256 over the names and contents of a sequence in order: for each file its name's length (8 bytes, little
/// endian), its name, and the SHA-256 of its bytes. Renaming a frame changes it, moving the folder does not.
pub(crate) fn sha256_of_sequence(files: &[PathBuf]) -> Result<String, MediaError> {
    let mut hash = Sha256::new();
    for path in files {
        let name = path.file_name().unwrap_or_default().as_encoded_bytes();
        hash.update((name.len() as u64).to_le_bytes());
        hash.update(name);
        let mut content = Sha256::new();
        feed(&mut content, path)?;
        hash.update(content.finalize());
    }
    Ok(hex(&hash.finalize()))
}

/// SHA-256 of bytes in memory, 64 hex digits.
#[must_use]
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn feed(hash: &mut Sha256, path: &Path) -> Result<(), MediaError> {
    let mut file = File::open(path).map_err(|e| MediaError::io("read", path, e))?;
    let mut buffer = vec![0; 1 << 20];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(n) => hash.update(&buffer[..n]),
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(MediaError::io("read", path, e)),
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
