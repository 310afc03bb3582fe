//! Tracks as the screen shows them.

use std::ops::Range;
use std::sync::Arc;

use honami_model::track::{Sample, Source, Span, TrackId};

/// A track on screen.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackRow {
    /// Its number.
    pub id: TrackId,
    /// What a person calls it.
    pub name: Option<String>,
    /// Its samples, hand work included.
    pub span: Arc<Span>,
    /// Frames of its key-frames, rising.
    pub keys: Vec<u32>,
}

impl TrackRow {
    /// A row of a shown track.
    #[must_use]
    pub fn new(id: TrackId, name: Option<String>, span: Arc<Span>) -> Self {
        let frames = || span.frames().zip(&span.samples);
        let keys = frames().filter(|(_, s)| s.source == Source::Key).map(|(f, _)| f).collect();
        Self { id, name, keys, span }
    }

    /// From the first to the last frame in which a tracker has followed it, if one has.
    #[must_use]
    pub fn tracked(&self) -> Option<Range<u32>> {
        let is_tracked = |sample: &Sample| sample.source == Source::Tracked;
        let first = self.span.samples.iter().position(is_tracked)?;
        let last = self.span.samples.iter().rposition(is_tracked)?;
        let frame = |at: usize| self.span.first_frame.saturating_add(u32::try_from(at).unwrap_or(u32::MAX));
        Some(frame(first)..frame(last).saturating_add(1))
    }

    /// Where it is in a frame, image pixels.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<[f32; 2]> {
        self.span.get(frame).map(|s| [s.x, s.y])
    }
}
