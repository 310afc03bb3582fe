//! The samples that can be relied on: key-frames, and where a tracker was given or found the feature.

use honami_model::track::{Source, Span};

/// A frame, and where the feature is in it.
pub(super) type Anchor = (u32, [f32; 2]);

/// The anchors of a track, rising.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Anchors(Vec<Anchor>);

impl Anchors {
    /// Its key-frames; and its first seen sample, unless that was reached by tracking backwards from one.
    pub(super) fn of(span: &Span) -> Self {
        let seen = || span.frames().zip(&span.samples).filter(|(_, sample)| sample.status.is_seen());
        let at = |(frame, sample): (u32, &honami_model::track::Sample)| (frame, [sample.x, sample.y]);
        let keys: Vec<Anchor> = seen().filter(|(_, sample)| sample.source == Source::Key).map(at).collect();
        // No step led to the sample that a tracker started from, so it has no forward-backward error.
        let born = seen()
            .next()
            .filter(|(_, s)| s.source != Source::Key && (keys.is_empty() || s.quality.fb_px.is_none()));
        Self(born.map(at).into_iter().chain(keys).collect())
    }

    /// The last one at or before a frame, and the first after it.
    pub(super) fn around(&self, frame: u32) -> (Option<Anchor>, Option<Anchor>) {
        let after = self.0.partition_point(|(at, _)| *at <= frame);
        (after.checked_sub(1).map(|before| self.0[before]), self.0.get(after).copied())
    }

    pub(super) fn as_slice(&self) -> &[Anchor] {
        &self.0
    }
}
