//! Runs that were made in memory: written whole, as nobody can watch or lose them halfway.

use honami_model::document::RunId;
use honami_model::track::{Span, TrackId};
use rusqlite::TransactionBehavior;

use super::{RunHead, RunState, compact};
use crate::error::StoreError;
use crate::project::Project;

impl Project {
    /// Keeps complete runs, all in one transaction; spans of a track must not overlap.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], [`StoreError::NotFinite`], or what SQLite met; nothing is kept then.
    pub fn keep_runs(&mut self, runs: &[(RunHead, Vec<(TrackId, Span)>)]) -> Result<Vec<RunId>, StoreError> {
        for (track, span) in runs.iter().flat_map(|(_, spans)| spans) {
            let broken = |at: &usize| {
                let sample = &span.samples[*at];
                !(sample.x.is_finite() && sample.y.is_finite())
            };
            if let Some(at) = (0..span.samples.len()).find(broken) {
                let frame = span.first_frame + u32::try_from(at).unwrap_or(u32::MAX);
                return Err(StoreError::NotFinite { track: *track, frame });
            }
        }
        let tx = self.writer()?.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let mut ids = Vec::with_capacity(runs.len());
        for (head, spans) in runs {
            let run = super::insert(&tx, head, &RunState::Complete)?;
            spans.iter().try_for_each(|(track, span)| compact::insert(&tx, run, *track, span))?;
            ids.push(run);
        }
        tx.commit()?;
        Ok(ids)
    }
}
