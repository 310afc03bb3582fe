//! A file that is being read: how far, for those who wait, and an end to it before its own.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use parquet::file::reader::{ChunkReader, Length};

/// How far a file has been read. Clones watch the same one, from any thread.
#[derive(Clone, Debug, Default)]
pub struct Watch(Arc<Marks>);

#[derive(Debug, Default)]
struct Marks {
    n_bytes: AtomicU64,
    is_stopped: AtomicBool,
}

impl Watch {
    /// Bytes read so far; those read twice count twice.
    #[must_use]
    pub fn n_bytes(&self) -> u64 {
        self.0.n_bytes.load(Ordering::Relaxed)
    }

    /// Ends the reading: it fails as soon as it wants more of the file.
    pub fn stop(&self) {
        self.0.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Whether it was stopped.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.0.is_stopped.load(Ordering::Relaxed)
    }

    fn read<T>(&self, read: impl FnOnce() -> std::io::Result<T>, n: fn(&T) -> usize) -> std::io::Result<T> {
        if self.is_stopped() {
            return Err(std::io::Error::other("stopped"));
        }
        let done = read()?;
        self.0.n_bytes.fetch_add(n(&done) as u64, Ordering::Relaxed);
        Ok(done)
    }
}

/// A file under watch.
#[derive(Debug)]
pub(crate) struct Watched {
    pub(crate) file: File,
    pub(crate) watch: Watch,
}

impl Read for Watched {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.watch.read(|| self.file.read(buffer), |n| *n)
    }
}

impl Seek for Watched {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

impl Length for Watched {
    fn len(&self) -> u64 {
        self.file.len()
    }
}

impl ChunkReader for Watched {
    type T = BufReader<Self>;

    fn get_read(&self, start: u64) -> parquet::errors::Result<Self::T> {
        let mut file = self.file.try_clone()?;
        file.seek(SeekFrom::Start(start))?;
        Ok(BufReader::new(Self { file, watch: self.watch.clone() }))
    }

    fn get_bytes(&self, start: u64, length: usize) -> parquet::errors::Result<bytes::Bytes> {
        let read = || self.file.get_bytes(start, length).map_err(std::io::Error::other);
        Ok(self.watch.read(read, bytes::Bytes::len)?)
    }
}

#[cfg(test)]
mod tests;
