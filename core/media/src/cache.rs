//! The folder of decoded frames: one file per clip, bounded, deletable at any time.
//!
//! A file is a 4096-byte head, then every frame's planes one after the other. It grows under a name of its own
//! (`*.part`, locked by the process that fills it) and is renamed to `*.frames` when the last frame is in, so a
//! complete name always means complete frames and several processes may fill the same clip at once. Readers hold
//! a shared lock: the oldest file that nobody holds is deleted first. A crash leaves an unlocked `*.part`, which
//! the next opening removes. Nothing here is needed to open a clip again: without a folder, with a full disk or a
//! clip above the bound, frames are decoded on demand.
//!
//! What remains: pixels are not checksummed, and another program that truncates a file in use can still stop this
//! one (SIGBUS); deleting it does no harm.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use crate::source::Shape;

mod map;

pub(crate) use map::FrameMap;

/// Bytes before the first frame; a page, so that frames start aligned.
const HEAD_LEN: u64 = 4096;
/// Changes with the layout of the file.
const MAGIC: &[u8; 16] = b"honami frames 1\n";
/// Bound of the folder unless the caller or `HONAMI_CACHE_BYTES` gives one.
const DEFAULT_BOUND: u64 = 4 << 30;

const COMPLETE: &str = "frames";
const PARTIAL: &str = "part";

/// A cache folder and its bound.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    pub(crate) dir: PathBuf,
    bound: u64,
}

/// What a file must hold to serve a clip.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// Hex digits that name content, decoder and layout.
    pub(crate) key: String,
    pub(crate) shape: Shape,
    pub(crate) n_frames: u32,
}

impl Wanted {
    pub(crate) fn file_len(&self) -> u64 {
        HEAD_LEN + u64::from(self.n_frames) * self.shape.frame_len() as u64
    }

    /// The head of a file in which `n_valid` frames are.
    fn head(&self, n_valid: u32) -> Vec<u8> {
        let Shape { width, height, colour, range } = self.shape;
        let mut head = MAGIC.to_vec();
        for number in [width, height, u32::from(colour), range as u32, self.n_frames, n_valid] {
            head.extend(number.to_le_bytes());
        }
        head.extend(self.key.as_bytes());
        head.resize(HEAD_LEN as usize, 0);
        head
    }
}

impl Folder {
    /// `dir`, else `$XDG_CACHE_HOME/honami/frames`, else the same under `~/.cache`; `None` without any.
    pub(crate) fn find(dir: Option<&Path>, bound: Option<u64>) -> Option<Self> {
        let set = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
        let dir = dir.map(Path::to_path_buf).or_else(|| {
            let base = set("XDG_CACHE_HOME").or_else(|| Some(set("HOME")?.join(".cache")))?;
            Some(base.join("honami/frames"))
        })?;
        let from_env = || std::env::var("HONAMI_CACHE_BYTES").ok()?.parse().ok();
        Some(Self { dir, bound: bound.or_else(from_env).unwrap_or(DEFAULT_BOUND) })
    }

    /// The file whose existence says that the index of this content miscounts its frames.
    pub(crate) fn mark_of(&self, sha256: &str) -> PathBuf {
        self.dir.join(format!("{sha256}.recount"))
    }

    /// The complete frames of a clip, if they are there and sound; what is not sound is removed.
    pub(crate) fn complete(&self, wanted: &Wanted) -> Option<FrameMap> {
        let path = self.path_of(wanted);
        let file = File::open(&path).ok()?;
        file.lock_shared().ok()?;
        let mut head = vec![0; HEAD_LEN as usize];
        let sound = file.metadata().is_ok_and(|m| m.len() == wanted.file_len())
            && file.read_exact_at(&mut head, 0).is_ok()
            && head == wanted.head(wanted.n_frames);
        if !sound {
            std::fs::remove_file(&path).unwrap_or_default();
            return None;
        }
        // Only the order of deletion suffers where the date cannot be set.
        file.set_modified(SystemTime::now()).unwrap_or_default();
        FrameMap::new(Arc::new(file), wanted.file_len(), HEAD_LEN, wanted.shape.frame_len()).ok()
    }

    /// Makes room and starts a file for a clip.
    ///
    /// Says in a few words why frames cannot be kept, where they cannot.
    pub(crate) fn begin(&self, wanted: &Wanted) -> Result<Filling, String> {
        self.remove_abandoned();
        let needed = wanted.file_len();
        if needed > self.bound {
            return Err(format!("{} MB of frames exceed its bound of {} MB", needed >> 20, self.bound >> 20));
        }
        if !self.make_room(needed) {
            return Err("it is full of clips in use".to_owned());
        }
        self.create(wanted).map_err(|e| e.to_string())
    }

    fn create(&self, wanted: &Wanted) -> io::Result<Filling> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        std::fs::create_dir_all(&self.dir)?;
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let partial = self.dir.join(format!("{}.{}-{number}.{PARTIAL}", wanted.key, std::process::id()));
        let file = OpenOptions::new().read(true).write(true).create_new(true).open(&partial)?;
        let (file, partial) = (Arc::new(file), Partial(partial));
        file.lock()?;
        file.set_len(wanted.file_len())?;
        file.write_all_at(&wanted.head(0), 0)?;
        let frame_len = wanted.shape.frame_len();
        let map = FrameMap::new(Arc::clone(&file), wanted.file_len(), HEAD_LEN, frame_len)?;
        Ok(Filling { partial, complete: self.path_of(wanted), file, wanted: wanted.clone(), map })
    }

    fn path_of(&self, wanted: &Wanted) -> PathBuf {
        self.dir.join(format!("{}.{COMPLETE}", wanted.key))
    }

    /// Removes what killed processes left: partial files that nobody has locked.
    fn remove_abandoned(&self) {
        for (path, _, _) in self.files(PARTIAL) {
            if File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) {
                std::fs::remove_file(&path).unwrap_or_default();
            }
        }
    }

    /// Deletes the oldest files that nobody reads until `needed` bytes fit; whether they do.
    fn make_room(&self, needed: u64) -> bool {
        let mut complete = self.files(COMPLETE);
        complete.sort_by_key(|&(_, _, used)| used);
        let partial = self.files(PARTIAL);
        let mut total: u64 = complete.iter().chain(&partial).map(|(_, len, _)| len).sum();
        for (path, len, _) in complete {
            if total + needed <= self.bound {
                break;
            }
            let idle = File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
            if idle && std::fs::remove_file(&path).is_ok() {
                total -= len;
            }
        }
        total + needed <= self.bound
    }

    /// Path, length and date of the files with this extension.
    fn files(&self, extension: &str) -> Vec<(PathBuf, u64, SystemTime)> {
        let Ok(entries) = std::fs::read_dir(&self.dir) else { return Vec::new() };
        let known = |path: PathBuf| {
            let meta = path.metadata().ok()?;
            (path.extension()? == extension).then_some((path, meta.len(), meta.modified().ok()?))
        };
        entries.filter_map(|entry| known(entry.ok()?.path())).collect()
    }
}

/// A file that is being filled; removed if it never becomes complete.
pub(crate) struct Filling {
    partial: Partial,
    complete: PathBuf,
    file: Arc<File>,
    wanted: Wanted,
    map: FrameMap,
}

/// Removes the file it names; there is none any more once that has got its final name.
struct Partial(PathBuf);

impl Drop for Partial {
    fn drop(&mut self) {
        std::fs::remove_file(&self.0).unwrap_or_default();
    }
}

impl Filling {
    /// The view that readers share.
    pub(crate) fn map(&self) -> FrameMap {
        self.map.clone()
    }

    /// Writes frame `n`. Through the file, not the map: a full disk is then an error and no SIGBUS.
    pub(crate) fn write(&self, n: u32, frame: &[u8]) -> io::Result<()> {
        self.file.write_all_at(frame, HEAD_LEN + u64::from(n) * frame.len() as u64)
    }

    /// From here on writing fails, as on a full disk.
    #[cfg(test)]
    pub(crate) fn refuse_writes(&mut self) -> io::Result<()> {
        self.file = Arc::new(File::open(&self.partial.0)?);
        Ok(())
    }

    /// All frames are in: makes the file the one that later openings find.
    pub(crate) fn finish(self) -> io::Result<()> {
        self.file.sync_data()?;
        self.file.write_all_at(&self.wanted.head(self.wanted.n_frames), 0)?;
        self.file.sync_data()?;
        std::fs::rename(&self.partial.0, &self.complete)?;
        // From exclusive to shared: it may be read by others now, and deleted when nobody does.
        self.file.unlock()?;
        self.file.lock_shared()
    }
}
