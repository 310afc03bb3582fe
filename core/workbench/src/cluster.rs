//! Clustering: a clusterer plugin finds what moves together, and the hierarchy is kept.

use std::ops::Range;

use honami_host::{CallContext, Clusterer, Flow, HostError, Kind, Tracks, Values};
use honami_model::brief::counted;
use honami_model::document::ClusteringId;
use honami_model::edit::Transaction;
use honami_model::provenance::Provenance;
use honami_model::track::{Span, TrackId};
use honami_store::Clustering;

use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::Progress;
use crate::scarce::scarce;
use crate::session::Session;
use crate::stamp::{SEED, stamp};
use crate::track::threads;

/// More groups than a person looks at when none were asked for.
const MAX_GUESS: u32 = 12;

/// What the work is called while it goes on.
const WHAT: &str = "comparing movements";

/// What to cluster with.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusterRequest {
    /// The clusterer: short name or full id.
    pub plugin: String,
    /// Its parameters; the rest take their defaults.
    pub params: Values,
    /// Groups to cut the hierarchy into; `None`: where it is cut most clearly.
    pub groups: Option<u32>,
}

/// A clustering that is ready to go.
pub struct ClusterJob {
    clusterer: Clusterer,
    tracks: Tracks,
    /// Tracks that are seen too briefly to be among them.
    n_brief: usize,
    /// From the first in which a track is seen to the last.
    n_frames: usize,
    provenance: Provenance,
    groups: Option<u32>,
    plugin: String,
}

/// A clustering that has ended; give it to [`finish`].
pub struct ClusterDone {
    clustering: Clustering,
    plugin: String,
    seconds: f64,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusterOutcome {
    /// The clustering.
    pub clustering: ClusteringId,
    /// Tracks that were grouped.
    pub n_tracks: usize,
    /// Tracks in each group, numbered from 0 in the order of their first tracks.
    pub group_sizes: Vec<usize>,
    /// Frames that were left out as outliers.
    pub outlier_frames: Vec<u32>,
    /// Time it took.
    pub seconds: f64,
    /// What the clusterer warned of, and whether there was little to go by.
    pub warnings: Vec<String>,
    /// All of that in one line.
    pub line: String,
}

/// Loads the clusterer and gathers the shown tracks.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], [`WorkbenchError::NoMovement`], [`WorkbenchError::Groups`], and when the plugin or its parameters are not what they must be.
pub fn prepare(session: &Session, request: &ClusterRequest) -> Result<ClusterJob, WorkbenchError> {
    let plugin = session.registry.find(Kind::Clusterer, &request.plugin)?;
    let shown = session.project.shown_all()?;
    // A track that is never seen twice has no movement.
    let moving = |span: &Span| span.samples.iter().filter(|s| s.status.is_seen()).nth(1).is_some();
    let clip = session.media.clip();
    let mut tracks = Tracks::new(clip.width, clip.height, 0, clip.times.as_slice().to_vec());
    tracks.max_threads = threads();
    tracks.seed = SEED;
    let mut frames: Option<(u32, u32)> = None;
    for (track, span) in shown.iter().filter(|(_, span)| moving(span)) {
        let Range { start, end } = span.frames();
        frames = Some(frames.map_or((start, end), |(first, last)| (first.min(start), last.max(end))));
        let samples = span.samples.iter().map(|sample| (sample.x, sample.y, sample.status));
        tracks.push(track.0, i64::from(span.first_frame), samples);
    }
    let n_tracks = tracks.len();
    if n_tracks == 0 {
        return Err(if shown.is_empty() { WorkbenchError::NoTracks } else { WorkbenchError::NoMovement });
    }
    let n_brief = shown.len() - n_tracks;
    if let Some(groups) = request.groups.filter(|&k| k == 0 || k as usize > n_tracks) {
        return Err(WorkbenchError::Groups { groups, n_tracks });
    }
    let (clusterer, origin) =
        session.options.host.clusterer(plugin, &request.params, &CallContext::silent())?;
    let provenance = stamp(session.project.revision(), "cluster", plugin, &request.params, origin);
    let plugin = plugin.short_name.clone();
    let n_frames = frames.map_or(0, |(first, last)| (last - first) as usize);
    Ok(ClusterJob { clusterer, tracks, n_brief, n_frames, provenance, groups: request.groups, plugin })
}

impl ClusterJob {
    /// Clusters; stopped, it keeps nothing.
    ///
    /// # Errors
    /// What the plugin says, [`WorkbenchError::Stopped`].
    pub fn run(mut self, progress: &dyn Progress) -> Result<ClusterDone, WorkbenchError> {
        let begun = std::time::Instant::now();
        if progress.report(0, 1000, WHAT) == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let ear = Ear::new(&self.plugin, progress);
        let found = match ear.whole(WHAT, |call| self.clusterer.run(&self.tracks, call)) {
            Err(HostError::Cancelled { .. }) => return Err(WorkbenchError::Stopped),
            other => other?,
        };
        let dendrogram = found.dendrogram;
        let little = scarce(self.tracks.len(), self.n_frames);
        let left_out = left_out(self.n_brief);
        let outliers = found.frames.iter().filter(|note| note.outlier);
        let clustering = Clustering {
            provenance: self.provenance,
            tracks: self.tracks.ids().iter().map(|&id| TrackId(id)).collect(),
            cut: self.groups.unwrap_or_else(|| dendrogram.clearest_cut(MAX_GUESS)),
            dendrogram,
            outlier_frames: outliers.filter_map(|note| u32::try_from(note.frame).ok()).collect(),
            notes: ear.warnings().into_iter().chain(left_out).chain(little).collect(),
        };
        Ok(ClusterDone { clustering, plugin: self.plugin, seconds: begun.elapsed().as_secs_f64() })
    }
}

/// A sentence where tracks are seen too briefly to be grouped.
fn left_out(n_brief: usize) -> Option<String> {
    match n_brief {
        0 => None,
        1 => Some("1 track is seen in fewer than two frames and is in no group".to_owned()),
        n => Some(format!("{n} tracks are seen in fewer than two frames and are in no group")),
    }
}

/// Keeps the clustering and shows it: one edit, which undo takes back.
///
/// # Errors
/// What the project met.
pub fn finish(session: &mut Session, done: ClusterDone) -> Result<ClusterOutcome, WorkbenchError> {
    let ClusterDone { clustering, plugin, seconds } = done;
    let id = session.project.save_clustering(&clustering)?;
    session.project.commit(Transaction::show_clustering(id, clustering.cut))?;
    let groups = clustering.dendrogram.cut(clustering.cut);
    let mut group_sizes = vec![0; groups.iter().max().map_or(0, |&last| last as usize + 1)];
    for group in groups {
        group_sizes[group as usize] += 1;
    }
    let (n_tracks, n_groups) = (clustering.tracks.len(), group_sizes.len());
    let n_outliers = clustering.outlier_frames.len();
    let [tracks, groups, outliers] =
        [(n_tracks, "track"), (n_groups, "group"), (n_outliers, "outlier frame")]
            .map(|(n, one)| counted(n, one));
    let line = format!("{plugin}: {tracks} in {groups}, {outliers}, {seconds:.1} s");
    Ok(ClusterOutcome {
        clustering: id,
        n_tracks,
        group_sizes,
        outlier_frames: clustering.outlier_frames,
        warnings: clustering.notes,
        seconds,
        line,
    })
}
