//! The review of all tracks as it stands: the queue, the suspicion of every track, the progress.

use std::collections::BTreeMap;
use std::sync::Arc;

use honami_model::judgement::Judgement;
use honami_model::track::TrackId;

use crate::evidence::Evidence;
use crate::queue::{Progress, Queue, Segments, Tally, segments};
use crate::suspicion;

/// What is known of a track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Standing {
    /// Frame of the first of `suspicions`.
    pub first_frame: u32,
    /// Suspicion of every sample.
    pub suspicions: Arc<[f32]>,
    /// Suspicion of the track: what is left of it, judged segments aside.
    pub suspicion: f32,
    /// What was found of its judged segments.
    pub judged: Tally,
}

impl Standing {
    /// Suspicion of the sample in a frame, if the track has one there.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<f32> {
        self.suspicions.get(frame.checked_sub(self.first_frame)? as usize).copied()
    }
}

/// The review of all tracks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Review {
    /// Segments to look at.
    pub queue: Queue,
    tracks: BTreeMap<TrackId, Standing>,
    judged: Tally,
}

impl Review {
    /// Replaces what is known of a track; `None` when it is no longer shown.
    pub fn set(&mut self, track: TrackId, segments: Option<Segments>) {
        if let Some(old) = self.tracks.remove(&track) {
            self.judged -= old.judged;
        }
        let Segments { items, first_frame, suspicions, judged } = segments.unwrap_or_default();
        if !suspicions.is_empty() {
            let open: Vec<f32> = items.iter().map(|item| item.suspicion).collect();
            let kind = items.first().map(|item| item.parts.kind).unwrap_or_default();
            let suspicion = suspicion::of_track(kind, &open);
            self.judged += judged;
            self.tracks
                .insert(track, Standing { first_frame, suspicions: suspicions.into(), suspicion, judged });
        }
        self.queue.set(track, items);
    }

    /// What is known of a track.
    #[must_use]
    pub fn track(&self, track: TrackId) -> Option<&Standing> {
        self.tracks.get(&track)
    }

    /// How far the review is.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { open: self.queue.len(), judged: self.judged }
    }
}

impl Evidence {
    /// What there is to review in a track, given what reviewers have said of it by first frame; `None` for a track that
    /// was not measured.
    #[must_use]
    pub fn segments(&self, track: TrackId, judgements: &BTreeMap<u32, Judgement>) -> Option<Segments> {
        let (span, parts) = (self.span(track)?, self.parts(track)?);
        let evidence = (&parts[..], self.unseen(track));
        let judgements = judgements.iter().map(|(&frame, judgement)| (frame, judgement));
        let mut found = segments(track, span, evidence, judgements);
        for item in &mut found.items {
            item.opponent = self.subject(track)?.opponent(item.measured, &item.parts);
        }
        Some(found)
    }
}
