//! Verdicts and effort as tables for other programs.

use std::path::Path;

use honami_exchange::{EffortRow, VerdictRow, Writer};
use honami_store::Project;

use super::effort;
use crate::error::WorkbenchError;

/// Writes every judgement: who found what, when, what it took, and whether the samples are still those that were
/// judged. Returns their number.
///
/// # Errors
/// [`WorkbenchError::NoVerdicts`], and what the disk met.
pub fn verdicts(project: &Project, out: &Path) -> Result<usize, WorkbenchError> {
    let mut rows = Vec::new();
    for (track, known) in project.document().tracks() {
        let span = project.shown(track)?.unwrap_or_default();
        rows.extend(known.judgements.iter().map(|(&first_frame, judgement)| VerdictRow {
            track,
            first_frame,
            judgement: judgement.clone(),
            stands: judgement.seal.map(|seal| seal == span.seal(first_frame..judgement.end_frame)),
        }));
    }
    write(&rows, out)
}

/// Writes what the review of each track has taken; returns the number of tracks.
///
/// # Errors
/// [`WorkbenchError::NoVerdicts`], and what the disk met.
pub fn efforts(project: &Project, out: &Path) -> Result<usize, WorkbenchError> {
    let row = |(track, sum): (_, honami_review::queue::TrackEffort)| EffortRow {
        track,
        segments: u32::try_from(sum.segments).unwrap_or(u32::MAX),
        effort: sum.effort,
    };
    write(&effort(project.document()).into_iter().map(row).collect::<Vec<_>>(), out)
}

fn write<R: honami_exchange::Row>(rows: &[R], out: &Path) -> Result<usize, WorkbenchError> {
    if rows.is_empty() {
        return Err(WorkbenchError::NoVerdicts);
    }
    let mut table = Writer::create(out)?;
    for row in rows {
        table.write(row)?;
    }
    table.finish()?;
    Ok(rows.len())
}
