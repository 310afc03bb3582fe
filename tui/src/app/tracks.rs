//! Tracks and groups as the screen shows them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use honami_model::hierarchy::{self, Dendrogram};
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

/// The shown clustering at its cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    /// How it was made, as the title says it.
    pub what: String,
    /// Its tracks, in the dendrogram's order of leaves.
    pub tracks: Vec<TrackId>,
    /// The hierarchy.
    pub dendrogram: Dendrogram,
    /// The groups of its leaves.
    pub shown: hierarchy::Groups,
    /// The clusters of each group that was made by hand: a cut leaves them.
    pub held: Vec<Vec<u32>>,
    /// Frames that were left out as outliers, rising.
    pub outlier_frames: Vec<u32>,
    of: BTreeMap<TrackId, u32>,
}

impl Groups {
    /// A clustering cut into `k` groups, some of which are held by hand.
    #[must_use]
    pub fn new(
        what: String,
        (tracks, dendrogram): (Vec<TrackId>, Dendrogram),
        (k, held): (u32, &[Vec<u32>]),
        outlier_frames: Vec<u32>,
    ) -> Self {
        let shown = dendrogram.groups(k, held);
        let of = tracks.iter().copied().zip(shown.of.iter().copied()).collect();
        Self { what, tracks, dendrogram, shown, held: held.to_vec(), outlier_frames, of }
    }

    /// The groups at another cut.
    #[must_use]
    pub fn at(&self, k: u32) -> hierarchy::Groups {
        self.dendrogram.groups(k, &self.held)
    }

    /// The group of a track, from 0.
    #[must_use]
    pub fn of(&self, track: TrackId) -> Option<u32> {
        self.of.get(&track).copied()
    }

    /// Number of tracks of every group.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = Vec::new();
        for &group in self.of.values() {
            let group = group as usize;
            sizes.resize(sizes.len().max(group + 1), 0);
            sizes[group] += 1;
        }
        sizes
    }
}
