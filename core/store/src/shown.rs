//! The shown tracks: hand work over runs, composed when asked for and kept until an edit touches them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use honami_model::compose::compose;
use honami_model::correct::Layers;
use honami_model::document::RunId;
use honami_model::over::Over;
use honami_model::track::{Source, Span, TrackId, TrackSet};

use crate::error::StoreError;
use crate::project::Project;

/// Composed tracks; those an edit touched are missing.
#[derive(Debug, Default)]
pub(crate) struct Shown(RefCell<BTreeMap<TrackId, Arc<Span>>>);

impl Shown {
    pub(crate) fn forget(&self, tracks: &TrackSet) {
        let mut known = self.0.borrow_mut();
        if tracks.len() < known.len() / 4 {
            tracks.iter().for_each(|track| drop(known.remove(&track)));
        } else {
            known.retain(|&track, _| !tracks.contains(track));
        }
    }
}

/// Missing tracks from which on whole runs are read instead of one track after the other.
const MANY: usize = 16;

impl Project {
    /// A track as a person sees it; `None` when it is not shown or has no samples.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn shown(&self, track: TrackId) -> Result<Option<Arc<Span>>, StoreError> {
        let document = self.document();
        let Some(known) = document.track(track).filter(|_| document.shows(track)) else { return Ok(None) };
        if let Some(span) = self.shown.0.borrow().get(&track) {
            return Ok(Some(Arc::clone(span)).filter(|span| !span.samples.is_empty()));
        }
        let mut spans = Vec::new();
        for run in document.runs_of(track) {
            spans.extend(self.run_spans(run, track)?);
        }
        let span = Arc::new(compose(known, &spans.iter().collect::<Vec<_>>(), &self.clip().clip.times));
        self.shown.0.borrow_mut().insert(track, Arc::clone(&span));
        Ok(Some(span).filter(|span| !span.samples.is_empty()))
    }

    /// A track with the runs below its hand work, for corrections; `None` when it is not shown.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn layers(&self, track: TrackId) -> Result<Option<Layers>, StoreError> {
        let document = self.document();
        let Some(known) = document.track(track).filter(|_| document.shows(track)) else { return Ok(None) };
        let mut runs = Vec::new();
        for run in document.runs_of(track) {
            runs.extend(self.run_spans(run, track)?.into_iter().map(|span| (run, span)));
        }
        Ok(Some(Layers { id: track, track: known.clone(), runs }))
    }

    /// All tracks as a person sees them, in order of their numbers. Composed once, then kept until edits
    /// touch them: asking again costs little.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn shown_all(&self) -> Result<Vec<(TrackId, Arc<Span>)>, StoreError> {
        let document = self.document();
        let missing: TrackSet = {
            let known = self.shown.0.borrow();
            document.tracks().map(|(id, _)| id).filter(|id| !known.contains_key(id)).collect()
        };
        if missing.len() >= MANY {
            self.compose_many(&missing)?;
        }
        let ids: Vec<TrackId> = document.tracks().map(|(id, _)| id).collect();
        ids.into_iter()
            .filter_map(|id| self.shown(id).transpose().map(|span| span.map(|span| (id, span))))
            .collect()
    }

    /// The run that each sample of the shown track comes from, also where a correction has laid it there;
    /// `None` for hand work and interpolation.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn sample_runs(&self, track: TrackId) -> Result<Vec<Option<RunId>>, StoreError> {
        let Some(span) = self.shown(track)? else { return Ok(Vec::new()) };
        let mut runs = vec![None; span.samples.len()];
        let sql = "SELECT first_frame, n_frames FROM span WHERE run = ?1 AND track = ?2";
        let mut statement = self.conn.prepare_cached(sql)?;
        for run in self.document().runs_of(track) {
            let mut rows = statement.query([run.0, track.0])?;
            while let Some(row) = rows.next()? {
                let (first_frame, n_frames): (u32, u32) = (row.get(0)?, row.get(1)?);
                let end = first_frame.saturating_add(n_frames);
                for (frame, of) in span.frames().zip(&mut runs) {
                    if (first_frame..end).contains(&frame) {
                        *of = Some(run);
                    }
                }
            }
        }
        let over = self.document().track(track).into_iter().flat_map(|known| &known.over);
        for (frame, over) in over {
            let at = frame.checked_sub(span.first_frame).and_then(|at| runs.get_mut(at as usize));
            if let (Some(of), Over::Sample(laid)) = (at, over) {
                *of = laid.run;
            }
        }
        for (of, sample) in runs.iter_mut().zip(&span.samples) {
            if !matches!(sample.source, Source::Tracked | Source::Imported) {
                *of = None;
            }
        }
        Ok(runs)
    }

    /// The run that one shown sample comes from; for a whole track ask [`sample_runs`](Self::sample_runs).
    ///
    /// # Errors
    /// What SQLite met.
    pub fn run_at(&self, track: TrackId, frame: u32) -> Result<Option<RunId>, StoreError> {
        let Some(span) = self.shown(track)? else { return Ok(None) };
        let Some(at) = frame.checked_sub(span.first_frame) else { return Ok(None) };
        Ok(self.sample_runs(track)?.get(at as usize).copied().flatten())
    }

    /// Composes tracks in one pass over each shown run.
    fn compose_many(&self, tracks: &TrackSet) -> Result<(), StoreError> {
        let document = self.document();
        let mut spans: BTreeMap<TrackId, Vec<Span>> = BTreeMap::new();
        for shown in document.runs() {
            self.each_span(
                shown.run,
                |track| tracks.contains(track) && shown.tracks.contains(track),
                |track, span| spans.entry(track).or_default().push(span),
            )?;
        }
        let mut known = self.shown.0.borrow_mut();
        for (id, track) in document.tracks().filter(|&(id, _)| tracks.contains(id)) {
            let spans = spans.remove(&id).unwrap_or_default();
            let span = compose(track, &spans.iter().collect::<Vec<_>>(), &self.clip().clip.times);
            known.insert(id, Arc::new(span));
        }
        Ok(())
    }
}
