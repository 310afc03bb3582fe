//! What readers of a clip and its decoding thread share: the frames so far, and why there will be no more.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};

use super::{Bytes, FrameRef, Head};
use crate::cache::{Filling, FrameMap};
use crate::demand::OnDemand;
use crate::error::MediaError;
use crate::source::{Shape, Source, contained};

/// What readers and the decoding thread share.
pub(super) struct Shared {
    path: PathBuf,
    pub(super) shape: Shape,
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

impl Shared {
    pub(super) fn new(head: &Head, source: Arc<dyn Source>, map: Option<FrameMap>, n_ready: u32) -> Self {
        Self {
            path: head.path.clone(),
            shape: head.shape,
            n_frames: head.clip.n_frames(),
            n_ready: AtomicU32::new(n_ready),
            map,
            ended: Mutex::new(None),
            progress: Condvar::new(),
            stop: AtomicBool::new(false),
            on_demand: Mutex::new(OnDemand::new(source, head.shape.frame_len(), head.recent_frames)),
            late_note: OnceLock::new(),
            miscounted: head.miscounted.clone(),
        }
    }

    /// Frames that need no waiting for the decoder to come by.
    pub(super) fn n_ready(&self) -> u32 {
        match *self.ended() {
            Some(Ended::NoRoom) => self.n_frames,
            _ if self.map.is_none() => self.n_frames,
            _ => self.n_ready.load(Ordering::Acquire),
        }
    }

    pub(super) fn late_note(&self) -> Option<&str> {
        self.late_note.get().map(String::as_str)
    }

    /// The decoding thread ends before its next frame.
    pub(super) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn ended(&self) -> MutexGuard<'_, Option<Ended>> {
        self.ended.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn frame(&self, n: u32) -> Result<FrameRef, MediaError> {
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
        match contained(&self.path, || on_demand.frame(n))?? {
            Some(frame) => Ok(self.owned(frame)),
            None => Err(self.miscount(on_demand.n_decoded())),
        }
    }

    pub(super) fn try_frame(&self, n: u32) -> Result<Option<FrameRef>, MediaError> {
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

    /// The decoding thread. Readers hear of its end however it ends.
    pub(super) fn fill(&self, source: &dyn Source, filling: Filling) {
        let filled = contained(&self.path, || self.fill_all(source, &filling));
        let result = filled.unwrap_or_else(|broken| Err(Ended::Failed(broken)));
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
