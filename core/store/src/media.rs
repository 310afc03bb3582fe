//! The clip's whereabouts: a path relative to the project where possible, and a hash that settles doubt.

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Component, Path, PathBuf};

use honami_model::clip::{Clip, FrameTimes};
use rusqlite::{Connection, params};

use crate::error::StoreError;
use crate::project::Project;

/// The clip of a project.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipRecord {
    /// Video, image folder or pattern; in a project relative to its folder where possible.
    pub path: PathBuf,
    /// Content hash, hexadecimal.
    pub sha256: String,
    /// Frames per second where the user knew better than the container.
    pub fps_override: Option<f64>,
    /// Size and frame times.
    pub clip: Clip,
}

impl ClipRecord {
    /// The record with its path as seen from a project's folder.
    pub(crate) fn seen_from(&self, folder: &Path) -> Self {
        Self { path: portable(folder, &self.path), ..self.clone() }
    }

    pub(crate) fn insert(&self, conn: &Connection) -> Result<(), StoreError> {
        let times: Vec<u8> = self.clip.times.as_slice().iter().flat_map(|t| t.to_le_bytes()).collect();
        let Clip { width, height, .. } = self.clip;
        conn.execute(
            "INSERT INTO clip VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6)",
            params![self.path.as_os_str().as_bytes(), self.sha256, self.fps_override, width, height, times],
        )?;
        Ok(())
    }

    pub(crate) fn load(conn: &Connection) -> Result<Self, StoreError> {
        let sql = "SELECT path, sha256, fps, width, height, times FROM clip";
        let (path, sha256, fps_override, width, height, times) = conn.query_row(sql, [], |row| {
            let path: Vec<u8> = row.get(0)?;
            Ok((path, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?, row.get::<_, Vec<u8>>(5)?))
        })?;
        let times = times.as_chunks::<8>().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
        let times = FrameTimes::new(times).map_err(StoreError::corrupt)?;
        let path = PathBuf::from(OsString::from_vec(path));
        Ok(Self { path, sha256, fps_override, clip: Clip { width, height, times } })
    }
}

impl Project {
    /// Where the clip should be; not looked at.
    #[must_use]
    pub fn media_path(&self) -> PathBuf {
        self.folder().join(&self.clip().path)
    }

    /// Where the clip is: where it should be, or under the same name in the project's folder or a folder in
    /// it. `hash` gives a file's content hash, `None` where there is no readable clip; only the right content
    /// is ever returned.
    ///
    /// # Errors
    /// [`StoreError::MediaMissing`]: ask the user and [`relink`](Self::relink);
    /// [`StoreError::MediaDiffers`] when only files of other content are found.
    pub fn find_media(&self, mut hash: impl FnMut(&Path) -> Option<String>) -> Result<PathBuf, StoreError> {
        let expected = self.media_path();
        let mut differs = None;
        for path in std::iter::once(expected.clone()).chain(self.places_for(&expected)) {
            match hash(&path) {
                Some(came) if came == self.clip().sha256 => return Ok(path),
                Some(came) => differs = differs.or(Some((came, path))),
                None => {}
            }
        }
        Err(match differs {
            Some((came, path)) => StoreError::MediaDiffers { wanted: self.clip().sha256.clone(), came, path },
            None => StoreError::MediaMissing { path: expected },
        })
    }

    /// Notes where the clip is now, given that path's content hash.
    ///
    /// # Errors
    /// [`StoreError::MediaDiffers`] when it is another clip; [`StoreError::ReadOnly`].
    pub fn relink(&mut self, path: &Path, sha256: &str) -> Result<(), StoreError> {
        let wanted = &self.clip().sha256;
        if wanted != sha256 {
            let (wanted, came) = (wanted.clone(), sha256.to_owned());
            return Err(StoreError::MediaDiffers { wanted, came, path: path.to_owned() });
        }
        let path = portable(self.folder(), path);
        self.writer()?.execute("UPDATE clip SET path = ?1", [path.as_os_str().as_bytes()])?;
        self.clip_moved(path);
        Ok(())
    }

    /// The project's folder and the folders in it, each with the clip's name.
    fn places_for(&self, expected: &Path) -> Vec<PathBuf> {
        let name = expected.file_name().unwrap_or(OsStr::new(""));
        let mut folders: Vec<PathBuf> = std::fs::read_dir(self.folder())
            .map(|entries| entries.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect())
            .unwrap_or_default();
        folders.sort();
        folders.insert(0, self.folder().to_owned());
        folders.into_iter().map(|folder| folder.join(name)).filter(|path| path != expected).collect()
    }
}

/// `media` as seen from `folder`: relative where both lie in one tree below the root, absolute otherwise.
fn portable(folder: &Path, media: &Path) -> PathBuf {
    let media = real(media);
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), media.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared <= 1 {
        return media;
    }
    std::iter::repeat_n(&Component::ParentDir, from.len() - shared).chain(&to[shared..]).collect()
}

/// The path without links; a pattern is no file, but the folder it lies in is one.
fn real(path: &Path) -> PathBuf {
    let absolute = || std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    path.canonicalize().unwrap_or_else(|_| {
        let absolute = absolute();
        match (absolute.parent().and_then(|folder| folder.canonicalize().ok()), absolute.file_name()) {
            (Some(folder), Some(name)) => folder.join(name),
            _ => absolute,
        }
    })
}
