//! What was measured, for other programs.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

use honami_exchange::c3d::{self, Points};
use honami_exchange::foreign::{self, ForeignError, ForeignTrack, Format, Loss, Outgoing};
use honami_exchange::origin::Origin;
use honami_exchange::{AtomicFile, GroupRow, SpaceRow, TrackRow, TrackTable, Writer, is_begun_alike};
use honami_model::track::{Span, TrackId, TrackSet};
use honami_store::Project;

use crate::error::{SpaceError, WorkbenchError};
use crate::space::{self, InSpace};

/// Side of the box that stands for a point in MOTChallenge files, pixels.
pub const BOX_PX: f64 = 9.0;

/// Which tracks to write, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportRequest {
    /// The format.
    pub format: Format,
    /// Only these tracks.
    pub tracks: Option<TrackSet>,
    /// Only the tracks of these groups, numbered from 1.
    pub groups: Option<BTreeSet<u32>>,
    /// Where to count pixels from, if not where the format usually does.
    pub origin: Option<Origin>,
    /// CVAT: every frame becomes a key-frame.
    pub every_frame: bool,
    /// MOTChallenge: side of the box around a point, pixels.
    pub box_px: f64,
}

impl ExportRequest {
    /// All tracks, as the format usually is.
    #[must_use]
    pub fn of(format: Format) -> Self {
        Self { format, tracks: None, groups: None, origin: None, every_frame: false, box_px: BOX_PX }
    }
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Tracks.
    pub n_tracks: usize,
    /// Samples of these tracks.
    pub n_samples: u64,
    /// What the format could not keep.
    pub losses: Vec<Loss>,
}

/// Writes a file of text, whole or not at all.
///
/// # Errors
/// What the disk met.
pub fn text(out: &Path, text: &str) -> Result<(), WorkbenchError> {
    let mut file = AtomicFile::create(out, |head| is_begun_alike(head, text))?;
    let full = |source| WorkbenchError::Io { what: "cannot write", source, path: out.to_owned() };
    file.write_all(text.as_bytes()).map_err(full)?;
    Ok(file.finish()?)
}

/// Writes the shown tracks, corrections included; nothing is left behind when it fails.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], [`WorkbenchError::NoSuchTracks`], and what the project or the disk met.
pub fn tracks(project: &Project, out: &Path, request: &ExportRequest) -> Result<Exported, WorkbenchError> {
    let shown = chosen(project, request.tracks.as_ref(), request.groups.as_ref())?;
    let document = project.document();
    let called = |id: TrackId| document.track(id).and_then(|track| track.name.clone());
    let foreign: Vec<ForeignTrack> = shown
        .into_iter()
        .map(|(id, span)| ForeignTrack { number: Some(id.0), name: called(id), spans: vec![span] })
        .collect();
    let clip = &project.clip().clip;
    let what = Outgoing {
        tracks: &foreign,
        size: [clip.width, clip.height],
        n_frames: clip.n_frames(),
        fps: clip.times.nominal_fps(),
        variable_rate: clip.times.is_variable(),
        origin: request.origin,
        every_frame: request.every_frame,
        box_px: request.box_px,
    };
    match TrackTable::create(out, request.format)? {
        Some(table) => own(project, table, &foreign)?,
        None => {
            let is_alike = |head: &[u8]| Format::of_content(head) == Some(request.format);
            let mut file = AtomicFile::create(out, is_alike)?;
            let written = foreign::write(&mut file, request.format, &what);
            written.map_err(|source| ForeignError::File { path: out.to_owned(), source })?;
            file.finish()?;
        }
    }
    Ok(Exported {
        n_tracks: foreign.len(),
        n_samples: foreign.iter().map(|track| track.n_samples() as u64).sum(),
        losses: foreign::losses(request.format, &what),
    })
}

/// The shown tracks, or those of them that are wanted, by their numbers or by their groups', which count from 1.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], [`WorkbenchError::NoSuchTracks`], [`WorkbenchError::NoGroups`], and what the project met.
pub(crate) fn chosen(
    project: &Project,
    tracks: Option<&TrackSet>,
    groups: Option<&BTreeSet<u32>>,
) -> Result<Vec<(TrackId, Arc<Span>)>, WorkbenchError> {
    let mut shown = project.shown_all()?;
    if shown.is_empty() {
        return Err(WorkbenchError::NoTracks);
    }
    if let Some(groups) = groups {
        let grouping = project.grouping()?.ok_or(WorkbenchError::NoGroups)?;
        shown.retain(|(id, _)| grouping.group_of.get(id).is_some_and(|group| groups.contains(&(group + 1))));
    }
    shown.retain(|(id, _)| tracks.is_none_or(|wanted| wanted.contains(*id)));
    if shown.is_empty() { Err(WorkbenchError::NoSuchTracks) } else { Ok(shown) }
}

/// Writes the own long table, which alone says when every frame was and which run a sample is of.
fn own(project: &Project, mut table: TrackTable, tracks: &[ForeignTrack]) -> Result<(), WorkbenchError> {
    let times = &project.clip().clip.times;
    for foreign in tracks {
        let Some(track) = foreign.number.map(TrackId) else { continue };
        let runs = project.sample_runs(track)?;
        for ((frame, &sample), run) in foreign.samples().zip(runs) {
            let run = run.map(|run| u64::from(run.0));
            table.write(&TrackRow { track, frame, time_s: times.get(frame), sample, run })?;
        }
    }
    Ok(table.finish()?)
}

/// What was written of tracks in space.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InSpaceWritten {
    /// Tracks.
    pub n_tracks: usize,
    /// Their fixes.
    pub n_fixes: usize,
    /// Why they no longer speak of what the projects show, a line each.
    pub stale: Vec<String>,
    /// What the format could not keep, a line each.
    pub losses: Vec<String>,
}

/// Writes the shown tracks in space, as a table (.csv) or for programs of motion capture (.c3d).
///
/// # Errors
/// [`SpaceError::NoSpace`], [`SpaceError::C3d`], and what the project or the disk met.
pub fn space(project: &Project, out: &Path) -> Result<InSpaceWritten, WorkbenchError> {
    let shown = space::shown(project)?;
    let is_c3d = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("c3d"));
    let losses = if is_c3d { space_c3d(&shown, out)? } else { space_table(&shown, out)? };
    let n_fixes = shown.tracks.iter().map(|track| track.fixes.len()).sum();
    Ok(InSpaceWritten { n_tracks: shown.tracks.len(), n_fixes, stale: shown.stale, losses })
}

fn space_table(shown: &InSpace, out: &Path) -> Result<Vec<String>, WorkbenchError> {
    let mut table = Writer::create(out)?;
    for track in &shown.tracks {
        for &fix in &track.fixes {
            let time_s = shown.times.get(fix.frame).unwrap_or_default();
            table.write(&SpaceRow { track: track.track, time_s, fix })?;
        }
    }
    table.finish()?;
    Ok(Vec::new())
}

fn space_c3d(shown: &InSpace, out: &Path) -> Result<Vec<String>, WorkbenchError> {
    let named = shown.tracks.iter().zip(&shown.names);
    let points = named.map(|(track, name)| {
        let label = name.clone().unwrap_or_else(|| format!("T{}", track.track));
        (label, track.fixes.as_slice())
    });
    // A single frame has no rate, and readers want one.
    let fps = shown.times.nominal_fps().unwrap_or(1.0);
    c3d::write(out, &Points { points: points.collect(), fps }).map_err(SpaceError::from)?;
    let uneven = shown
        .times
        .is_variable()
        .then(|| format!("times of frames: they are taken to be 1/{fps:.4} s apart"));
    Ok(uneven.into_iter().collect())
}

/// Removes the half-written files that killed processes have left in a folder; the caller has it for itself.
///
/// # Errors
/// What the disk met.
pub fn remove_parts(folder: &Path) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if AtomicFile::is_part(&entry.file_name()) {
            std::fs::remove_file(entry.path())?;
        }
    }
    Ok(())
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
