//! Point caches (PC2): where points are in every frame, as modellers and animation programs read them.
//!
//! `POINTCACHE2\0`, version 1, points, first frame, frames a sample, samples; then x, y, z of every point, sample by
//! sample; all little-endian, whole numbers and floats of 32 bits. Lengths are metres, z up.

#[cfg(test)]
mod tests;

use std::io::Write as _;
use std::path::Path;

use crate::atomic::AtomicFile;
use crate::table::TableError;

const MAGIC: &[u8] = b"POINTCACHE2\0";
/// The first frame, where the format has a number for it. It is 0 to whoever reads it, and has a sign, which others do not
/// write: caches of others are not to be lost.
const FIRST: f32 = -0.0;
/// Where that stands, bytes.
const AT: usize = 20;
/// Bytes of samples that are handed on at a time.
const CHUNK: usize = 1 << 16;

/// A cache being written; it takes its name in [`PointCache::finish`] and leaves nothing behind before that.
#[derive(Debug)]
pub struct PointCache {
    file: AtomicFile,
    chunk: Vec<u8>,
}

/// A cache cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PointCacheError {
    /// The disk says no.
    #[error(transparent)]
    File(#[from] TableError),
    /// More points than the format counts.
    #[error("a point cache has 2147483647 points at most, not {0}")]
    Points(usize),
}

impl PointCache {
    /// Begins a cache of so many points and frames.
    ///
    /// # Errors
    /// [`PointCacheError`].
    pub fn create(path: &Path, n_points: usize, n_frames: u32) -> Result<Self, PointCacheError> {
        let points = i32::try_from(n_points).map_err(|_too_many| PointCacheError::Points(n_points))?;
        let mut chunk = MAGIC.to_vec();
        chunk.extend(1_i32.to_le_bytes());
        chunk.extend(points.to_le_bytes());
        chunk.extend(FIRST.to_le_bytes());
        chunk.extend(1_f32.to_le_bytes());
        chunk.extend(n_frames.to_le_bytes());
        let is_own = |head: &[u8]| {
            head.starts_with(MAGIC) && head.get(AT..AT + 4).is_some_and(|first| first == FIRST.to_le_bytes())
        };
        Ok(Self { file: AtomicFile::create(path, is_own)?, chunk })
    }

    /// Where a point is: one call a point, frame by frame.
    ///
    /// # Errors
    /// [`PointCacheError::File`].
    pub fn push(&mut self, place: [f32; 3]) -> Result<(), PointCacheError> {
        self.chunk.extend(place.iter().flat_map(|v| v.to_le_bytes()));
        if self.chunk.len() >= CHUNK { self.hand_on() } else { Ok(()) }
    }

    fn hand_on(&mut self) -> Result<(), PointCacheError> {
        let path = self.file.path().to_owned();
        self.file.write_all(&self.chunk).map_err(|source| TableError::File { path, source })?;
        self.chunk.clear();
        Ok(())
    }

    /// Puts the whole cache on the disk under its name.
    ///
    /// # Errors
    /// [`PointCacheError::File`].
    pub fn finish(mut self) -> Result<(), PointCacheError> {
        self.hand_on()?;
        Ok(self.file.finish()?)
    }
}
