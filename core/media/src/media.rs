//! An opened clip: exact frames in any order while a thread of its own decodes ahead.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::JoinHandle;

use honami_model::clip::Clip;
use honami_model::picture::Planes;

use crate::cache::{Filling, FrameMap};
use crate::demand::OnDemand;
use crate::error::MediaError;
use crate::scale::{self, Rect};
use crate::source::{Shape, Source};

/// An opened clip. Frames may be asked for from any thread and in any order.
///
/// Dropping it stops its decoder; frames that were handed out stay valid.
pub struct Media {
    pub(crate) clip: Clip,
    pub(crate) notes: Vec<String>,
    pub(crate) sha256: String,
    pub(crate) path: PathBuf,
    shared: Arc<Shared>,
    filler: Option<JoinHandle<()>>,
}

/// What readers and the decoding thread share.
struct Shared {
    path: PathBuf,
    shape: Shape,
    n_frames: u32,
    /// Frames of `map` that are complete.
    n_ready: AtomicU32,
    map: Option<FrameMap>,
    /// Why filling ended early.
    ended: Mutex<Option<Ended>>,
    progress: Condvar,
    stop: AtomicBool,
    on_demand: Mutex<OnDemand>,
    late_note: OnceLock<String>,
    /// Where to remember that the index of this clip miscounts its frames.
    miscounted: Option<PathBuf>,
}

#[derive(Clone)]
enum Ended {
    /// Decoding failed: the frames beyond do not exist.
    Failed(MediaError),
    /// The cache cannot take more: the frames beyond are decoded on demand.
    NoRoom,
}

impl Media {
    /// A clip whose frames are all in the cache.
    pub(crate) fn cached(head: Head, source: Arc<dyn Source>, map: FrameMap) -> Self {
        let n_frames = head.clip.n_frames();
        Self::new(head, source, Some(map), n_frames)
    }

    /// A clip that is decoded on demand.
    pub(crate) fn on_demand(head: Head, source: Arc<dyn Source>) -> Self {
        Self::new(head, source, None, 0)
    }

    /// A clip whose cache file a thread begins to fill.
    pub(crate) fn filling(head: Head, source: Arc<dyn Source>, filling: Filling) -> Result<Self, MediaError> {
        let mut media = Self::new(head, Arc::clone(&source), Some(filling.map()), 0);
        let shared = Arc::clone(&media.shared);
        let filler = std::thread::Builder::new()
            .name("honami-decode".to_owned())
            .spawn(move || shared.fill(&*source, filling))
            .map_err(|e| MediaError::io("start a thread for", &media.path, e))?;
        media.filler = Some(filler);
        Ok(media)
    }

    fn new(head: Head, source: Arc<dyn Source>, map: Option<FrameMap>, n_ready: u32) -> Self {
        let Head { clip, notes, sha256, path, shape, recent_frames, miscounted } = head;
        let shared = Arc::new(Shared {
            path: path.clone(),
            shape,
            n_frames: clip.n_frames(),
            n_ready: AtomicU32::new(n_ready),
            map,
            ended: Mutex::new(None),
            progress: Condvar::new(),
            stop: AtomicBool::new(false),
            on_demand: Mutex::new(OnDemand::new(source, shape.frame_len(), recent_frames)),
            late_note: OnceLock::new(),
            miscounted,
        });
        Self { clip, notes, sha256, path, shared, filler: None }
    }

    /// Size and frame times.
    #[must_use]
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    /// What a user should know of this clip, one sentence each, as known at opening.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What has come up since opening (the disk filled up).
    #[must_use]
    pub fn late_note(&self) -> Option<&str> {
        self.shared.late_note.get().map(String::as_str)
    }

    /// Hash of the content, 64 hex digits: of the file's bytes, or of a sequence's names and bytes in order.
    #[must_use]
    pub fn sha256(&self) -> String {
        self.sha256.clone()
    }

    /// The path it was opened with.
    #[must_use]
    pub fn source(&self) -> &Path {
        &self.path
    }

    /// Whether frames have chroma.
    #[must_use]
    pub fn has_colour(&self) -> bool {
        self.shared.shape.colour
    }

    /// Frames that [`Media::frame`] gives without waiting for the decoder to come by; all when decoded on demand.
    #[must_use]
    pub fn n_ready(&self) -> u32 {
        match *self.shared.ended() {
            Some(Ended::NoRoom) => self.shared.n_frames,
            _ if self.shared.map.is_none() => self.shared.n_frames,
            _ => self.shared.n_ready.load(Ordering::Acquire),
        }
    }

    /// Frame `n`, exactly the n-th of a sequential decode; waits until it is decoded.
    ///
    /// # Errors
    /// [`MediaError::Beyond`] past the end, else whatever stopped the decoder before this frame.
    pub fn frame(&self, n: u32) -> Result<FrameRef, MediaError> {
        self.shared.frame(n)
    }

    /// Frame `n` if it is at hand, without waiting: `None` when it is still to be decoded.
    ///
    /// # Errors
    /// As [`Media::frame`].
    pub fn try_frame(&self, n: u32) -> Result<Option<FrameRef>, MediaError> {
        self.shared.try_frame(n)
    }

    /// A part of frame `n` as RGB for a screen, see [`FrameRef::rgb_area`].
    ///
    /// # Errors
    /// As [`Media::frame`].
    pub fn rgb_area(&self, n: u32, area: Rect, width: u32, height: u32) -> Result<Vec<[u8; 3]>, MediaError> {
        Ok(self.frame(n)?.rgb_area(area, width, height))
    }
}

impl Media {
    /// Waits until the decoding thread is done with the cache file.
    #[cfg(test)]
    pub(crate) fn settle(mut self) {
        self.filler.take().map_or(Ok(()), JoinHandle::join).unwrap_or_default();
    }
}

impl Drop for Media {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Some(filler) = self.filler.take() {
            // A panic there has been reported and has nothing left to spoil.
            filler.join().unwrap_or_default();
        }
    }
}

impl std::fmt::Debug for Media {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Media")
            .field("path", &self.path)
            .field("shape", &self.shared.shape)
            .finish_non_exhaustive()
    }
}

/// All of a [`Media`] but its frames.
pub(crate) struct Head {
    pub(crate) clip: Clip,
    pub(crate) notes: Vec<String>,
    pub(crate) sha256: String,
    pub(crate) path: PathBuf,
    pub(crate) shape: Shape,
    pub(crate) recent_frames: Option<usize>,
    pub(crate) miscounted: Option<PathBuf>,
}

impl Shared {
    fn ended(&self) -> MutexGuard<'_, Option<Ended>> {
        self.ended.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn frame(&self, n: u32) -> Result<FrameRef, MediaError> {
        if let Some(frame) = self.mapped(n)? {
            return Ok(frame);
        }
        if self.map.is_some() {
            let guard = self.ended();
            let pending =
                |ended: &mut Option<Ended>| ended.is_none() && self.n_ready.load(Ordering::Acquire) <= n;
            let ended =
                self.progress.wait_while(guard, pending).unwrap_or_else(PoisonError::into_inner).clone();
            if let Some(frame) = self.mapped(n)? {
                return Ok(frame);
            }
            if let Some(Ended::Failed(error)) = ended {
                return Err(error);
            }
        }
        let mut on_demand = self.on_demand.lock().unwrap_or_else(PoisonError::into_inner);
        match on_demand.frame(n)? {
            Some(frame) => Ok(self.owned(frame)),
            None => Err(self.miscount(on_demand.n_decoded())),
        }
    }

    fn try_frame(&self, n: u32) -> Result<Option<FrameRef>, MediaError> {
        if let Some(frame) = self.mapped(n)? {
            return Ok(Some(frame));
        }
        if let Some(Ended::Failed(error)) = &*self.ended() {
            return Err(error.clone());
        }
        // Another thread that decodes holds the lock: then it is not at hand.
        let recent = self.on_demand.try_lock().ok().and_then(|on_demand| on_demand.recent(n));
        Ok(recent.map(|frame| self.owned(frame)))
    }

    /// The frame in the cache file, if it is there yet.
    fn mapped(&self, n: u32) -> Result<Option<FrameRef>, MediaError> {
        if n >= self.n_frames {
            return Err(MediaError::Beyond { frame: n, n_frames: self.n_frames });
        }
        let ready = n < self.n_ready.load(Ordering::Acquire);
        let map = self.map.as_ref().filter(|_| ready);
        Ok(map.map(|map| FrameRef { bytes: Bytes::Mapped(map.clone(), n), shape: self.shape }))
    }

    fn owned(&self, frame: Arc<[u8]>) -> FrameRef {
        FrameRef { bytes: Bytes::Owned(frame), shape: self.shape }
    }

    /// The decoding thread.
    fn fill(&self, source: &dyn Source, filling: Filling) {
        let result = self.fill_all(source, &filling);
        // Before anybody is told: whoever hears of the end finds the file complete, or gone.
        match result {
            // The frames are mapped and stay so; without its final name the next opening decodes again.
            Ok(true) => filling.finish().unwrap_or_default(),
            Ok(false) | Err(_) => drop(filling),
        }
        *self.ended() = result.err();
        self.progress.notify_all();
    }

    /// Decodes and publishes every frame; `false` when told to stop.
    fn fill_all(&self, source: &dyn Source, filling: &Filling) -> Result<bool, Ended> {
        let mut frame = vec![0; self.shape.frame_len()];
        let (_, mut running) = source.decode(0).map_err(Ended::Failed)?;
        for n in 0..self.n_frames {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(false);
            }
            if !running.next(&mut frame).map_err(Ended::Failed)? {
                return Err(Ended::Failed(self.miscount(n)));
            }
            filling.write(n, &frame).map_err(|error| {
                let note = format!(
                    "frames cannot be kept any more ({error}): the rest is decoded on demand, slower"
                );
                self.late_note.get_or_init(|| note);
                Ended::NoRoom
            })?;
            // Under the lock, so that a reader which has just found the frame missing is woken.
            let guard = self.ended();
            self.n_ready.store(n + 1, Ordering::Release);
            drop(guard);
            self.progress.notify_all();
        }
        if running.next(&mut frame).map_err(Ended::Failed)? {
            return Err(Ended::Failed(self.miscount(self.n_frames + 1)));
        }
        Ok(true)
    }

    /// The stream holds another number of frames than its index says: remembers that for the next opening.
    fn miscount(&self, found: u32) -> MediaError {
        // Where nothing can be remembered the next opening ends here again.
        self.miscounted.as_ref().and_then(|mark| std::fs::write(mark, []).ok()).unwrap_or_default();
        MediaError::FrameCount { path: self.path.clone(), found, promised: self.n_frames }
    }
}

/// A decoded frame, borrowed from the cache or owned. Cheap to clone; outlives its [`Media`].
#[derive(Clone, Debug)]
pub struct FrameRef {
    bytes: Bytes,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Bytes {
    Mapped(FrameMap, u32),
    Owned(Arc<[u8]>),
}

impl FrameRef {
    /// Luma as coded and, where the clip has colour, both chroma planes.
    #[must_use]
    pub fn planes(&self) -> Planes<'_> {
        self.shape.planes(self.bytes())
    }

    /// All planes one after the other: Y, then U and V.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        match &self.bytes {
            Bytes::Mapped(map, n) => map.frame(*n),
            Bytes::Owned(bytes) => bytes,
        }
    }

    /// A part of the frame as `width` x `height` RGB pixels, row-major, for a screen.
    ///
    /// Each is the mean of the source pixels under it, at least one; black where `area` lies outside the frame.
    #[must_use]
    pub fn rgb_area(&self, area: Rect, width: u32, height: u32) -> Vec<[u8; 3]> {
        scale::rgb_area(&self.planes(), area, width, height)
    }
}
