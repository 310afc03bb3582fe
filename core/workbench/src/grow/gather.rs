//! What a skeleton grows from: the shown tracks and the tree of their groups, as a plugin is given them.

use honami_host::{GroupTree, Tracks};
use honami_model::track::{Span, TrackId};
use honami_store::Project;
use honami_structure::StructureError;
use honami_structure::follow::Path;
use honami_structure::tree::{Group, tree_of};

use crate::error::WorkbenchError;
use crate::stamp::SEED;
use crate::track::threads;

/// Tracks and their groups.
pub(super) struct Gathered {
    /// As a plugin is given them.
    pub(super) tracks: Tracks,
    /// Where each is seen.
    pub(super) paths: Vec<Path>,
    /// The tree of their groups, as the hierarchy is cut and as hands have changed it.
    pub(super) groups: Vec<Group>,
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
    let mut tracks = Tracks::new(clip.width, clip.height, 0, clip.times.as_slice().to_vec());
    (tracks.max_threads, tracks.seed) = (threads(), SEED);
    let mut paths = Vec::with_capacity(n_tracks);
    for &track in &clustering.tracks {
        let span = project.shown(track)?;
        let span = span.as_deref();
        let samples = span.iter().flat_map(|span| &span.samples).map(|s| (s.x, s.y, s.status));
        tracks.push(track.0, span.map_or(0, |span| i64::from(span.first_frame)), samples);
        paths.push(path(track, span, clip.times.len()));
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
    let shown = dendrogram.groups(k, project.document().held_groups(shown.id));
    let groups = tree_of(dendrogram, &shown, &is_seen);
    if groups.is_empty() {
        return Err(StructureError::NothingSeen.into());
    }
    Ok(Gathered { tracks, paths, groups, notes })
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

/// Where a track is seen.
pub(super) fn path(track: TrackId, span: Option<&Span>, n_frames: u32) -> Path {
    let at = |frame: u32| {
        let sample = span?.get(frame).filter(|sample| sample.status.is_seen())?;
        Some([f64::from(sample.x), f64::from(sample.y)])
    };
    Path { track, at: (0..n_frames).map(at).collect() }
}
