//! An opened clip: exact frames in any order while a thread of its own decodes ahead.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;

use honami_model::clip::Clip;
use honami_model::picture::Planes;

use crate::cache::{Filling, FrameMap};
use crate::error::MediaError;
use crate::scale::{self, Rect};
use crate::source::{Shape, Source};
use shared::Shared;

mod shared;

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
        let shared = Arc::new(Shared::new(&head, source, map, n_ready));
        let Head { clip, notes, sha256, path, .. } = head;
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
        self.shared.late_note()
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
        self.shared.n_ready()
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
        self.shared.stop();
        if let Some(filler) = self.filler.take() {
            // It ends by itself, and whoever waited for a frame has been told why.
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
