//! The document: what a person sees and corrects, as the edits so far have made it.
//!
//! It holds hand work and *which* immutable results are shown, never their samples: those stay in the
//! runs, and [`compose`](crate::compose) lays the hand work over them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::judgement::Judgement;
use crate::over::Over;
use crate::scale::ScaleBar;
use crate::shape::Shape;
use crate::space::SpaceId;
use crate::track::{Sample, Status, TrackId, TrackSet};

/// Number of a run: one use of a tracker. Runs never change once they have ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RunId(pub u32);

/// Number of a clustering: one use of a clusterer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ClusteringId(pub u32);

impl std::fmt::Display for RunId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Number of a matte: how much of every pixel of one frame is plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MatteId(pub u32);

impl std::fmt::Display for MatteId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl std::fmt::Display for ClusteringId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Who made a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A person placed it.
    Hand,
    /// It was born in this run.
    Run(RunId),
}

/// How a key-frame came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Made {
    /// A person placed it.
    Set,
    /// A person looked at the sample there and found it right.
    Confirmed,
}

/// A sample a person has set or confirmed; no tracker changes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// Pixels, right; finite.
    pub x: f32,
    /// Pixels, down; finite.
    pub y: f32,
    /// Set or confirmed.
    pub made: Made,
    /// What the person says of the feature here; the position counts unless it is lost or outside.
    #[serde(default = "tracked", skip_serializing_if = "is_tracked")]
    pub status: Status,
}

impl Key {
    /// A person places the feature here.
    #[must_use]
    pub fn set(x: f32, y: f32) -> Self {
        Self { x, y, made: Made::Set, status: Status::Tracked }
    }

    /// A person finds the sample here right.
    #[must_use]
    pub fn confirmed(x: f32, y: f32) -> Self {
        Self { made: Made::Confirmed, ..Self::set(x, y) }
    }

    /// A person finds this sample right: a hidden feature stays hidden. `None` where it is lost, outside or rejected,
    /// for no place was found there.
    #[must_use]
    pub fn confirming(shown: &Sample) -> Option<Self> {
        let status = match shown.status {
            Status::Tracked | Status::Newborn => Status::Tracked,
            Status::Occluded => Status::Occluded,
            _ => return None,
        };
        Some(Self { status, ..Self::confirmed(shown.x, shown.y) })
    }

    /// Whether its position says where the feature is.
    #[must_use]
    pub fn is_placed(&self) -> bool {
        !matches!(self.status, Status::Lost | Status::Outside | Status::Rejected)
    }
}

fn tracked() -> Status {
    Status::Tracked
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_tracked(status: &Status) -> bool {
    *status == Status::Tracked
}

/// A track as edits know it: where it came from, and the hand work on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Who made it.
    pub origin: Origin,
    /// What a person calls it.
    pub name: Option<String>,
    /// Its key-frames by frame.
    pub keys: BTreeMap<u32, Key>,
    /// What corrections have laid over its runs, by frame.
    pub over: BTreeMap<u32, Over>,
    /// What reviewers have found, by the first frame of the segment.
    pub judgements: BTreeMap<u32, Judgement>,
    /// Whether it was deleted; its work is kept for the day it is restored.
    pub deleted: bool,
}

impl Track {
    pub(crate) fn new(origin: Origin) -> Self {
        let (keys, over, judgements) = Default::default();
        Self { origin, name: None, keys, over, judgements, deleted: false }
    }

    /// Whether a person has done anything to it but place it.
    #[must_use]
    pub fn has_work(&self) -> bool {
        let is_bare = self.keys.is_empty() && self.over.is_empty() && self.judgements.is_empty();
        self.deleted || self.name.is_some() || !is_bare
    }
}

/// A run that is shown, and the tracks it has samples of.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownRun {
    /// The run.
    pub run: RunId,
    /// The tracks it has samples of.
    pub tracks: TrackSet,
}

/// The clustering that is shown, cut into k groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShownClustering {
    /// The clustering.
    pub id: ClusteringId,
    /// Number of groups, at least 1.
    pub k: u32,
}

/// What the edits so far have made of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    pub(crate) n_frames: u32,
    pub(crate) tracks: BTreeMap<TrackId, Track>,
    pub(crate) runs: Vec<ShownRun>,
    pub(crate) clustering: Option<ShownClustering>,
    pub(crate) group_names: BTreeMap<(ClusteringId, u32), String>,
    pub(crate) held: BTreeMap<ClusteringId, Vec<Vec<u32>>>,
    pub(crate) root: Option<[f64; 2]>,
    pub(crate) scale: Option<ScaleBar>,
    pub(crate) shapes: BTreeMap<(ClusteringId, u32), Shape>,
    pub(crate) mattes: BTreeMap<u32, MatteId>,
    pub(crate) space: Option<SpaceId>,
}

impl Document {
    /// The document before the first edit, on a clip of this many frames.
    #[must_use]
    pub fn new(n_frames: u32) -> Self {
        Self {
            n_frames,
            tracks: BTreeMap::new(),
            runs: Vec::new(),
            clustering: None,
            group_names: BTreeMap::new(),
            held: BTreeMap::new(),
            root: None,
            scale: None,
            shapes: BTreeMap::new(),
            mattes: BTreeMap::new(),
            space: None,
        }
    }

    /// Frames of the clip.
    #[must_use]
    pub fn n_frames(&self) -> u32 {
        self.n_frames
    }

    /// What is known of a track, deleted ones and those of hidden runs included.
    #[must_use]
    pub fn track(&self, track: TrackId) -> Option<&Track> {
        self.tracks.get(&track)
    }

    /// Whether the track is seen: not deleted, and placed by hand, keyed, or in a shown run.
    #[must_use]
    pub fn shows(&self, track: TrackId) -> bool {
        self.tracks.get(&track).is_some_and(|known| self.is_seen(track, known))
    }

    /// The tracks that are seen, in order of their numbers.
    pub fn tracks(&self) -> impl Iterator<Item = (TrackId, &Track)> {
        self.tracks.iter().map(|(&id, track)| (id, track)).filter(|&(id, track)| self.is_seen(id, track))
    }

    /// The deleted tracks, in order of their numbers.
    pub fn deleted(&self) -> impl Iterator<Item = TrackId> {
        self.tracks.iter().filter(|(_, track)| track.deleted).map(|(&id, _)| id)
    }

    /// The shown runs; a later one lies over the earlier ones.
    #[must_use]
    pub fn runs(&self) -> &[ShownRun] {
        &self.runs
    }

    /// The shown runs that have samples of a track, the topmost last.
    pub fn runs_of(&self, track: TrackId) -> impl DoubleEndedIterator<Item = RunId> {
        self.runs.iter().filter(move |shown| shown.tracks.contains(track)).map(|shown| shown.run)
    }

    /// The shown clustering and its cut.
    #[must_use]
    pub fn clustering(&self) -> Option<ShownClustering> {
        self.clustering
    }

    /// The tracks in space that are shown.
    #[must_use]
    pub fn space(&self) -> Option<SpaceId> {
        self.space
    }

    /// What a person calls a group: a node of a clustering's dendrogram, numbered as in its merges, so that
    /// the name stays with the group when the cut moves.
    #[must_use]
    pub fn group_name(&self, clustering: ClusteringId, node: u32) -> Option<&str> {
        self.group_names.get(&(clustering, node)).map(String::as_str)
    }

    /// The groups of a clustering that a person has made by hand, each the nodes of its dendrogram that it consists
    /// of: they stay as they are wherever the cut is.
    #[must_use]
    pub fn held_groups(&self, clustering: ClusteringId) -> &[Vec<u32>] {
        self.held.get(&clustering).map_or(&[], Vec::as_slice)
    }

    /// Where a person has placed the root of skeletons, pixels (right, down).
    #[must_use]
    pub fn root(&self) -> Option<[f64; 2]> {
        self.root
    }

    /// How a person has shaped the bone that ends at a group or fork, a node of a clustering's dendrogram.
    #[must_use]
    pub fn shape(&self, clustering: ClusteringId, node: u32) -> Option<Shape> {
        self.shapes.get(&(clustering, node)).copied()
    }

    /// The bones of a clustering that a person has shaped, in order of their nodes.
    pub fn shapes(&self, clustering: ClusteringId) -> impl Iterator<Item = (u32, Shape)> {
        let all = (clustering, 0)..=(clustering, u32::MAX);
        self.shapes.range(all).map(|(&(_, node), &shape)| (node, shape))
    }

    /// What says how many metres a pixel is, if a person has said it.
    #[must_use]
    pub fn scale(&self) -> Option<ScaleBar> {
        self.scale
    }

    /// The mattes that are kept, in order of their frames.
    pub fn mattes(&self) -> impl Iterator<Item = (u32, MatteId)> {
        self.mattes.iter().map(|(&frame, &matte)| (frame, matte))
    }

    /// The matte that counts in a frame, and whose it is: the frame's own, else that of the nearest frame before, else the
    /// first.
    #[must_use]
    pub fn matte_at(&self, frame: u32) -> Option<(u32, MatteId)> {
        let at = self.mattes.range(..=frame).next_back().or_else(|| self.mattes.first_key_value());
        at.map(|(&of, &matte)| (of, matte))
    }

    fn is_seen(&self, id: TrackId, track: &Track) -> bool {
        let placed = track.origin == Origin::Hand || !track.keys.is_empty() || !track.over.is_empty();
        !track.deleted && (placed || self.runs_of(id).next().is_some())
    }
}
