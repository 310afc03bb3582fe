//! What a skeleton grows from: the shown tracks and the tree of their groups, as a plugin is given them.

#[cfg(test)]
mod tests;

use std::ops::Range;

use honami_host::{GroupTree, Tracks};
use honami_model::clip::FrameTimes;
use honami_model::document::ClusteringId;
use honami_model::shape::Bone;
use honami_model::track::{Span, TrackId};
use honami_store::Project;
use honami_structure::StructureError;
use honami_structure::follow::Path;
use honami_structure::tree::{Group, tree_of};

use super::hand::named;
use crate::error::WorkbenchError;
use crate::scarce::scarce;
use crate::stamp::SEED;
use crate::track::threads;

/// Tracks and their groups.
pub(super) struct Gathered {
    /// As a plugin is given them.
    pub(super) tracks: Tracks,
    /// From the first to the last frame of the clip in which any feature of a group is seen.
    pub(super) frames: Range<u32>,
    /// When these were.
    pub(super) times: FrameTimes,
    /// The longest run of them in which something is seen in every one, from their first on: loops are of these.
    pub(super) unbroken: Range<u32>,
    /// Where each is seen, in these frames.
    pub(super) paths: Vec<Path>,
    /// The tree of their groups, as the hierarchy is cut and as hands have changed it.
    pub(super) groups: Vec<Group>,
    /// What these are groups of.
    pub(super) clustering: ClusteringId,
    /// The bones that they are known by, a group each.
    pub(super) bones: Vec<Bone>,
    /// What whoever uses it should know, a sentence each.
    pub(super) notes: Vec<String>,
}

/// Gathers what the shown clustering is of, cut into so many groups, or as it is cut.
///
/// # Errors
/// [`WorkbenchError::NoGroups`], [`WorkbenchError::Groups`], [`StructureError::NothingSeen`], and what the project met.
pub(super) fn gather(project: &Project, groups: Option<u32>) -> Result<Gathered, WorkbenchError> {
    let shown = project.document().clustering().ok_or(WorkbenchError::NoGroups)?;
    let clustering = project.clustering(shown.id)?;
    let (dendrogram, n_tracks) = (&clustering.dendrogram, clustering.tracks.len());
    let k = groups.unwrap_or(shown.k);
    if k == 0 || k as usize > n_tracks.max(1) {
        return Err(WorkbenchError::Groups { groups: k, n_tracks });
    }
    let clip = &project.clip().clip;
    let mut spans = Vec::with_capacity(n_tracks);
    for &track in &clustering.tracks {
        spans.push((track, project.shown(track)?));
    }
    let is_anything = seen_in(spans.iter().filter_map(|(_, span)| span.as_deref()), clip.times.len());
    let frames = whole(&is_anything).ok_or(StructureError::NothingSeen)?;
    let within = &is_anything[frames.start as usize..frames.end as usize];
    let times = clip.times.as_slice()[frames.start as usize..frames.end as usize].to_vec();
    let mut tracks = Tracks::new(clip.width, clip.height, i64::from(frames.start), times.clone());
    (tracks.max_threads, tracks.seed) = (threads(), SEED);
    let mut paths = Vec::with_capacity(n_tracks);
    for (track, span) in &spans {
        let span = span.as_deref();
        let kept = span.map_or(frames.start..frames.start, |span| cut(&span.frames(), &frames));
        let samples = kept.clone().filter_map(|frame| span?.get(frame)).map(|s| (s.x, s.y, s.status));
        tracks.push(track.0, i64::from(kept.start), samples);
        paths.push(path(*track, span, frames.clone()));
    }
    let mut notes = Vec::new();
    if let Some(stale) = project.is_stale(shown.id)? {
        notes.push(format!("the groups are {stale}"));
    }
    let is_seen: Vec<bool> = paths.iter().map(Path::is_seen).collect();
    let n_lost = is_seen.iter().filter(|is_seen| !**is_seen).count();
    if n_lost > 0 {
        notes.push(format!("{n_lost} of {n_tracks} tracks are seen in no frame now and are left out"));
    }
    notes.extend(blind(within, frames.start));
    notes.extend(scarce(n_tracks - n_lost, frames.len()));
    let document = project.document();
    let groups = dendrogram.groups(k, document.held_groups(shown.id));
    let groups = tree_of(dendrogram, &groups, &is_seen);
    if groups.is_empty() {
        return Err(StructureError::NothingSeen.into());
    }
    let (unbroken, times) = (unbroken(within), FrameTimes::new(times).map_err(StructureError::from)?);
    let bones = named(shown.id, &groups, |node| document.group_name(shown.id, node));
    Ok(Gathered { tracks, frames, times, unbroken, paths, groups, clustering: shown.id, bones, notes })
}

/// Whether anything is seen, a frame of the clip each.
fn seen_in<'a>(spans: impl Iterator<Item = &'a Span>, n_frames: u32) -> Vec<bool> {
    let mut is_seen = vec![false; n_frames as usize];
    for (frame, sample) in spans.flat_map(|span| span.frames().zip(&span.samples)) {
        if let Some(is_seen) = is_seen.get_mut(frame as usize) {
            *is_seen |= sample.status.is_seen();
        }
    }
    is_seen
}

/// From the first to the last that is true; `None` where none is.
fn whole(is_seen: &[bool]) -> Option<Range<u32>> {
    let first = is_seen.iter().position(|is_seen| *is_seen)?;
    let last = is_seen.iter().rposition(|is_seen| *is_seen)?;
    Some(first as u32..last as u32 + 1)
}

/// The longest run of what is true, the first of those as long.
fn unbroken(is_seen: &[bool]) -> Range<u32> {
    let (mut longest, mut first) = (0..0, 0);
    for (frame, is_seen) in (1..).zip(is_seen) {
        if !is_seen {
            first = frame;
        } else if frame - first > longest.end - longest.start {
            longest = first..frame;
        }
    }
    longest
}

/// What is to be said of frames in which nothing is seen, the first of which is numbered so.
fn blind(is_seen: &[bool], first: u32) -> Option<String> {
    let n = is_seen.iter().filter(|is_seen| !**is_seen).count();
    let begin = is_seen.iter().position(|is_seen| !is_seen)?;
    let len = is_seen[begin..].iter().take_while(|is_seen| !**is_seen).count();
    let (from, to) = (first + begin as u32, first + (begin + len) as u32 - 1);
    let gap = if from == to { format!("frame {from}") } else { format!("frames {from}-{to}") };
    let more = if n > len { format!(" and in {} more", n - len) } else { String::new() };
    Some(format!(
        "nothing of any group is seen in {gap}{more}: groups go straight there from the frame before to the frame after"
    ))
}

/// The part of some frames that is of others, too; empty and among those where there is none.
fn cut(some: &Range<u32>, others: &Range<u32>) -> Range<u32> {
    let inside = |frame: u32| frame.clamp(others.start, others.end);
    inside(some.start)..inside(some.end)
}

impl Gathered {
    /// The tree, as a plugin is given it.
    pub(super) fn tree(&self) -> GroupTree {
        let mut tree = GroupTree::new(self.tracks.len());
        for group in &self.groups {
            tree.push(group.parent, group.number, &group.leaves);
        }
        tree
    }

    /// The tracks of each group that has such.
    pub(super) fn members(&self) -> Vec<Vec<TrackId>> {
        let of = |group: &Group| group.leaves.iter().map(|&leaf| self.paths[leaf].track).collect();
        self.groups.iter().filter(|group| group.children.is_empty()).map(of).collect()
    }
}

/// Where a track is seen in these frames.
pub(super) fn path(track: TrackId, span: Option<&Span>, frames: Range<u32>) -> Path {
    let at = |frame: u32| {
        let sample = span?.get(frame).filter(|sample| sample.status.is_seen())?;
        Some([f64::from(sample.x), f64::from(sample.y)])
    };
    Path { track, at: frames.map(at).collect() }
}
