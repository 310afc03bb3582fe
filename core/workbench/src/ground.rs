//! A track as it lies in the project, taken out of it: what a correction starts from, on any thread.

use std::collections::BTreeMap;
use std::ops::Range;

use honami_model::clip::FrameTimes;
use honami_model::correct::Shown;
use honami_model::document::{RunId, Track};
use honami_model::edit::EditError;
use honami_model::over::{Laid, Over};
use honami_model::track::{Sample, Source, Span, TrackId};
use honami_store::{Project, StoreError};

/// A track with the runs below it.
pub(crate) struct Ground {
    /// Its number.
    pub(crate) id: TrackId,
    /// The hand work on it.
    pub(crate) track: Track,
    /// Spans of its shown runs, the topmost last.
    pub(crate) runs: Vec<(RunId, Span)>,
    /// Spans of the runs by which what corrections have laid down unseen was found.
    found: BTreeMap<RunId, Vec<Span>>,
}

impl Ground {
    /// # Errors
    /// When there is no such track, and what the project met.
    pub(crate) fn of(project: &Project, id: TrackId) -> Result<Self, StoreError> {
        let document = project.document();
        let known = document.track(id).filter(|known| !known.deleted);
        let track = known.ok_or(EditError::NoSuchTrack(id))?.clone();
        let mut runs = Vec::new();
        for run in document.runs_of(id) {
            runs.extend(project.run_spans(run, id)?.into_iter().map(|span| (run, span)));
        }
        let mut found = BTreeMap::new();
        for over in track.over.values() {
            if let Over::Sample(Laid { sample, run: Some(run) }) = over
                && !sample.status.is_seen()
                && !found.contains_key(run)
            {
                found.insert(*run, project.run_spans(*run, id)?);
            }
        }
        Ok(Self { id, track, runs, found })
    }

    /// What is shown of it.
    pub(crate) fn shown<'a>(&'a self, times: &'a FrameTimes) -> Shown<'a> {
        Shown::new(self.id, &self.track, &self.runs, times)
    }

    /// The frames in which it was followed by a tracker: from the first to the last of them.
    pub(crate) fn followed(&self, times: &FrameTimes) -> Range<u32> {
        let shown = self.shown(times);
        let laid = shown.span().frames().zip(&shown.span().samples);
        let laid = laid.filter(|(_, sample)| sample.source == Source::Tracked).map(|(frame, _)| frame);
        let found = self.runs.iter().flat_map(|(_, span)| {
            let frames = span.frames();
            (frames.start < frames.end).then(|| [frames.start, frames.end - 1])
        });
        let frames: Vec<u32> = laid.chain(found.flatten()).collect();
        let end = frames.iter().max().map_or(0, |last| last + 1);
        frames.into_iter().min().unwrap_or(0)..end
    }

    /// What a run found in a frame, of those whose samples lie unseen over the track.
    pub(crate) fn found(&self, run: RunId, frame: u32) -> Option<&Sample> {
        self.found.get(&run)?.iter().find_map(|span| span.get(frame))
    }
}
