//! Scene files: what `honami view` writes for the viewer beside it. Of one version of honami, for as long as they are shown.
//!
//! Eight letters, the length of what follows and its SHA-256, and then the scene (postcard). So one that was cut short or
//! changed is told from one of another version.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use honami_exchange::atomic::AtomicFile;
use honami_exchange::table::TableError;
use sha2::{Digest as _, Sha256};

use crate::Scene;

/// The last two letters are the version.
const MAGIC: [u8; 8] = *b"HONAMI01";
const HEAD_BYTES: usize = 8 + 8 + 32;

/// Why a scene file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// The disk.
    #[error("cannot {doing} {}: {source}", path.display())]
    Io {
        /// Read or write.
        doing: &'static str,
        /// Which.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file that nobody means to lose, or the disk.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Something else.
    #[error("{} is no scene: `honami view PROJECT` makes and shows one", .0.display())]
    Other(PathBuf),
    /// Written by another honami.
    #[error("{} is a scene of another version of honami: show it with `honami view` anew", .0.display())]
    Version(PathBuf),
    /// Not all of it.
    #[error("{} is a scene cut short: {came} bytes of {wanted}; show it with `honami view` anew", path.display())]
    Short {
        /// Which.
        path: PathBuf,
        /// Bytes that are there.
        came: u64,
        /// Bytes that should be.
        wanted: u64,
    },
    /// Not as it was written.
    #[error("{} is a scene that was changed since it was written; show it with `honami view` anew", .0.display())]
    Changed(PathBuf),
    /// Of parts that do not go together.
    #[error("{} is a scene that cannot be drawn: {what}", path.display())]
    Odd {
        /// Which.
        path: PathBuf,
        /// What does not.
        what: String,
    },
}

/// Writes a scene, all of it or nothing; in place of a scene only.
///
/// # Errors
/// [`SceneFileError::Io`] and [`SceneFileError::Table`].
pub fn write(path: &Path, scene: &Scene) -> Result<(), SceneFileError> {
    let fail = |source| SceneFileError::Io { doing: "write", path: path.to_owned(), source };
    let body = postcard::to_allocvec(scene).map_err(std::io::Error::other).map_err(fail)?;
    let mut file = AtomicFile::create(path, |head| head.starts_with(&MAGIC[..6]))?;
    let head = [&MAGIC[..], &(body.len() as u64).to_le_bytes(), &Sha256::digest(&body)].concat();
    file.write_all(&head).and_then(|()| file.write_all(&body)).map_err(fail)?;
    Ok(file.finish()?)
}

/// Reads a scene, and checks that it can be drawn.
///
/// # Errors
/// [`SceneFileError`].
pub fn read(path: &Path) -> Result<Scene, SceneFileError> {
    let bytes = std::fs::read(path).map_err(|source| SceneFileError::Io {
        doing: "read",
        path: path.to_owned(),
        source,
    })?;
    let Some((head, body)) = bytes.split_at_checked(HEAD_BYTES).filter(|(head, _)| head[..6] == MAGIC[..6])
    else {
        let is_begun =
            !bytes.is_empty() && bytes.len() < HEAD_BYTES && bytes.starts_with(&MAGIC[..6.min(bytes.len())]);
        let (came, wanted) = (bytes.len() as u64, HEAD_BYTES as u64);
        return Err(match is_begun {
            true => SceneFileError::Short { path: path.to_owned(), came, wanted },
            false => SceneFileError::Other(path.to_owned()),
        });
    };
    if head[..8] != MAGIC {
        return Err(SceneFileError::Version(path.to_owned()));
    }
    let wanted = head[8..16].iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte));
    if (body.len() as u64) < wanted {
        let came = bytes.len() as u64;
        return Err(SceneFileError::Short {
            path: path.to_owned(),
            came,
            wanted: wanted.saturating_add(HEAD_BYTES as u64),
        });
    }
    if body.len() as u64 != wanted || Sha256::digest(body)[..] != head[16..] {
        return Err(SceneFileError::Changed(path.to_owned()));
    }
    let scene: Scene =
        postcard::from_bytes(body).map_err(|_garbled| SceneFileError::Version(path.to_owned()))?;
    match scene.odd() {
        Some(what) => Err(SceneFileError::Odd { path: path.to_owned(), what }),
        None => Ok(scene),
    }
}

#[cfg(test)]
mod tests;
