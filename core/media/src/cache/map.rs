//! The memory-mapped side of a cache file: frames that are complete, shared by any number of readers.
#![allow(unsafe_code, reason = "reading mapped memory; nothing else in this crate does")]

use std::fs::File;
use std::io;
use std::sync::Arc;

use memmap2::{MmapOptions, MmapRaw};

/// A mapped cache file. Cheap to clone; keeps the file open (and so its lock) and mapped.
#[derive(Clone, Debug)]
pub(crate) struct FrameMap {
    mapped: Arc<Mapped>,
    head_len: usize,
    frame_len: usize,
}

#[derive(Debug)]
struct Mapped {
    memory: MmapRaw,
    /// Holds the lock that keeps other processes from deleting the file.
    _file: Arc<File>,
}

impl FrameMap {
    /// Maps a file that has been checked to be `file_len` bytes long.
    pub(crate) fn new(file: Arc<File>, file_len: u64, head_len: u64, frame_len: usize) -> io::Result<Self> {
        let too_long = |_| io::Error::new(io::ErrorKind::FileTooLarge, "more frames than can be mapped");
        let len = usize::try_from(file_len).map_err(too_long)?;
        let memory = MmapOptions::new().len(len).map_raw_read_only(&*file)?;
        Ok(Self { mapped: Arc::new(Mapped { memory, _file: file }), head_len: head_len as usize, frame_len })
    }

    /// The bytes of frame `n`, which must have been written before: see [`Filling`](super::Filling).
    ///
    /// # Panics
    /// When the file has no frame `n`.
    #[track_caller]
    pub(crate) fn frame(&self, n: u32) -> &[u8] {
        let start = self.head_len + n as usize * self.frame_len;
        assert!(start + self.frame_len <= self.mapped.memory.len(), "frame {n} lies in the file");
        // SAFETY: the range lies in the mapping, which lives as long as `self`. Callers ask only for frames that the
        // decoder has published (an acquire load of its counter) and that nobody writes again; other processes write
        // only files of their own name. A shorter file cannot come from honami; see the module above for others.
        unsafe { std::slice::from_raw_parts(self.mapped.memory.as_ptr().add(start), self.frame_len) }
    }
}
