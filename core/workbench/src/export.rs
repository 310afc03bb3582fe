//! What was measured, for other programs.

use std::path::Path;

use honami_exchange::{GroupRow, TrackRow, Writer};
use honami_store::Project;

use crate::error::WorkbenchError;

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Tracks.
    pub n_tracks: usize,
    /// Rows, one a sample.
    pub n_rows: u64,
}

/// Writes the shown tracks as one long table; nothing is left behind when it fails.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], and what the project or the disk met.
pub fn tracks(project: &Project, out: &Path) -> Result<Exported, WorkbenchError> {
    let shown = project.shown_all()?;
    if shown.is_empty() {
        return Err(WorkbenchError::NoTracks);
    }
    let times = &project.clip().clip.times;
    let mut table = Writer::create(out)?;
    let mut n_rows = 0;
    for (track, span) in &shown {
        let runs = project.sample_runs(*track)?;
        for ((frame, &sample), run) in span.frames().zip(&span.samples).zip(runs) {
            let run = run.map(|run| u64::from(run.0));
            table.write(&TrackRow { track: *track, frame, time_s: times.get(frame), sample, run })?;
            n_rows += 1;
        }
    }
    table.finish()?;
    Ok(Exported { n_tracks: shown.len(), n_rows })
}

/// Writes the group of every track of the shown clustering; returns their number.
///
/// # Errors
/// [`WorkbenchError::NoGroups`], and what the project or the disk met.
pub fn groups(project: &Project, out: &Path) -> Result<usize, WorkbenchError> {
    let grouping = project.grouping()?.ok_or(WorkbenchError::NoGroups)?;
    let mut table = Writer::create(out)?;
    for (&track, &group) in &grouping.group_of {
        let node = grouping.nodes.get(group as usize);
        let name = node.and_then(|&node| project.document().group_name(grouping.clustering, node));
        table.write(&GroupRow { track, group: group + 1, name: name.unwrap_or_default().to_owned() })?;
    }
    table.finish()?;
    Ok(grouping.group_of.len())
}
