//! What goes to plugins and comes back from them, in Rust's own types.

use honami_model::hierarchy::Dendrogram;
use honami_model::picture::{Chroma, Gray, Range};
use honami_model::track::Status;

/// A frame on its way to a plugin.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    /// The picture.
    pub gray: Gray<'a>,
    /// Its colour, where the clip has it.
    pub chroma: Option<Chroma<'a>>,
    /// Meaning of the bytes, if known.
    pub range: Option<Range>,
    /// Frame number in the clip.
    pub index: i64,
    /// Presentation time, seconds.
    pub time_s: f64,
}

impl FrameView<'_> {
    /// Whether all pixels are there that its numbers promise.
    pub(crate) fn is_whole(&self) -> bool {
        let Gray { width, height, .. } = self.gray;
        self.gray.is_whole() && self.chroma.is_none_or(|chroma| chroma.fits(width, height))
    }
}

/// What is known of a stream before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamInfo {
    /// Width of every frame, pixels.
    pub width: u32,
    /// Height of every frame, pixels.
    pub height: u32,
    /// Nominal frames per second, if known.
    pub fps: Option<f64>,
    /// Frames to come, if known.
    pub n_frames: Option<u64>,
    /// Whether index and time fall from frame to frame.
    pub reversed: bool,
    /// Threads that the plugin may use.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
    /// Ids that the plugin may give to points of its own; empty: no births.
    pub births: std::ops::Range<u32>,
}

/// A point to follow, or to keep a distance from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Number of its track.
    pub id: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
}

/// A point in a frame, checked: known id, once a frame, finite numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// Number of its track.
    pub id: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// What is known of it.
    pub status: Status,
    /// Forward-backward error of the step that led here, pixels, if measured.
    pub fb: Option<f32>,
    /// Normalised cross-correlation with the template, -1..=1, if measured.
    pub ncc: Option<f32>,
}

/// The points of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Frame number in the clip.
    pub frame: i64,
    /// One row a live point, in the plugin's order.
    pub rows: Vec<PointRow>,
    /// Points that the tracker follows no longer: their last row was an earlier frame's.
    pub ended: Vec<u32>,
}

/// Where features are wanted.
#[derive(Clone, Copy, Debug)]
pub struct DetectRequest<'a> {
    /// The frame to look at.
    pub frame: FrameView<'a>,
    /// At most so many.
    pub max_features: u32,
    /// Non-zero where features may be, of the frame's size; `None`: everywhere.
    pub mask: Option<Gray<'a>>,
    /// Points that are there already.
    pub points: &'a [Point],
    /// Threads that the plugin may use.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

/// A place worth following.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// Larger is better.
    pub score: f32,
}

/// Dense motion: displacements at the nodes of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Position of node (0,0), pixels.
    pub origin: [f32; 2],
    /// Distance between nodes, pixels.
    pub step: f32,
    /// Nodes in x.
    pub nx: u32,
    /// Nodes in y.
    pub ny: u32,
    /// Displacements right and down, pixels, `(ny, nx)` row-major; `None` where nothing could be measured.
    pub vectors: Vec<Option<[f32; 2]>>,
}

/// Tracks to group or to grow from: samples of all tracks one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracks {
    pub(crate) ids: Vec<u32>,
    pub(crate) first_frames: Vec<i64>,
    pub(crate) lens: Vec<u32>,
    pub(crate) offsets: Vec<u64>,
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) status: Vec<u8>,
    pub(crate) frames: Vec<i64>,
    pub(crate) times_s: Vec<f64>,
    /// Width of the frames, pixels.
    pub width: u32,
    /// Height of the frames, pixels.
    pub height: u32,
    /// Threads that the plugin may use.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

impl Tracks {
    /// No tracks yet, over frames of this size; `times_s` are those of consecutive frames from `first_frame` on.
    #[must_use]
    pub fn new(width: u32, height: u32, first_frame: i64, times_s: Vec<f64>) -> Self {
        let frames = (first_frame..).take(times_s.len()).collect();
        Self { width, height, frames, times_s, max_threads: 1, ..Self::default() }
    }

    /// Adds a track with one sample a frame: x, y, status. It becomes leaf number `len()` of a clustering.
    pub fn push(&mut self, id: u32, first_frame: i64, samples: impl IntoIterator<Item = (f32, f32, Status)>) {
        let start = self.x.len();
        for (x, y, status) in samples {
            self.x.push(x);
            self.y.push(y);
            self.status.push(status as u8);
        }
        self.ids.push(id);
        self.first_frames.push(first_frame);
        self.offsets.push(start as u64);
        self.lens.push(u32::try_from(self.x.len() - start).unwrap_or(u32::MAX));
    }

    /// Number of tracks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Ids in the order of the leaves.
    #[must_use]
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// Why a plugin must not be given these; `None` when it may.
    pub(crate) fn fault(&self) -> Option<String> {
        let (first, n) = (self.frames.first().copied().unwrap_or(0), self.frames.len() as i64);
        for (k, (&start, &len)) in self.first_frames.iter().zip(&self.lens).enumerate() {
            if start < first || start + i64::from(len) > first + n {
                return Some(format!("track {} has samples in frames without a time", self.ids[k]));
            }
        }
        let finite =
            self.x.iter().chain(&self.y).all(|v| v.is_finite()) && self.times_s.iter().all(|t| t.is_finite());
        (!finite).then(|| "a position or time is not finite".into())
    }
}

/// The tree that a hierarchy of tracks was cut into.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GroupTree {
    /// Rows, -1 for the whole.
    pub(crate) parents: Vec<i32>,
    /// A row a track, -1 for none.
    pub(crate) of: Vec<i32>,
    /// By which its groups are known.
    pub(crate) numbers: Vec<u32>,
}

impl GroupTree {
    /// No groups yet, of so many tracks.
    #[must_use]
    pub fn new(n_tracks: usize) -> Self {
        Self { of: vec![-1; n_tracks], ..Self::default() }
    }

    /// Adds a group, which is known by this number: a part of an earlier one, or the whole. Rows of the tracks are only in
    /// groups without parts.
    pub fn push(&mut self, parent: Option<usize>, number: u32, tracks: &[usize]) {
        let row = |row: usize| i32::try_from(row).unwrap_or(i32::MAX);
        let own = row(self.parents.len());
        self.parents.push(parent.map_or(-1, row));
        self.numbers.push(number);
        for &track in tracks {
            if let Some(group) = self.of.get_mut(track) {
                *group = own;
            }
        }
    }

    /// Number of groups, those with parts counted.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Row of the group that a group is part of; `None` for the whole.
    #[must_use]
    pub fn parent(&self, group: usize) -> Option<usize> {
        self.parents.get(group).and_then(|&parent| usize::try_from(parent).ok())
    }

    /// Rows of the tracks of a group without parts.
    pub fn tracks(&self, group: usize) -> impl Iterator<Item = usize> {
        let is_in = move |of: i32| usize::try_from(of).is_ok_and(|of| of == group);
        self.of.iter().enumerate().filter(move |(_, of)| is_in(**of)).map(|(track, _)| track)
    }

    /// Why a plugin must not be given these groups of so many tracks; `None` when it may.
    pub(crate) fn fault(&self, n_tracks: usize) -> Option<String> {
        let n = self.len();
        if n == 0 || self.of.len() != n_tracks {
            return Some(format!("cannot grow from {n} groups of {} of {n_tracks} tracks", self.of.len()));
        }
        let is_placed = |(row, &parent): (usize, &i32)| match usize::try_from(parent) {
            Ok(parent) => parent < row,
            Err(_) => row == 0 && parent == -1,
        };
        if let Some(row) = self.parents.iter().enumerate().position(|group| !is_placed(group)) {
            return Some(format!(
                "group {row} is part of {}, which does not come before it",
                self.parents[row]
            ));
        }
        let mut has_tracks = vec![false; n];
        for (track, &group) in self.of.iter().enumerate().filter(|(_, group)| **group >= 0) {
            if group as usize >= n || self.parents.contains(&group) {
                return Some(format!("track {track} is in group {group}, which has parts or is none"));
            }
            has_tracks[group as usize] = true;
        }
        let is_empty = |row: &usize| !has_tracks[*row] && !self.parents.contains(&(*row as i32));
        (0..n).find(is_empty).map(|row| format!("group {row} has neither tracks nor parts"))
    }
}

/// What a structure builder draws on.
#[derive(Clone, Copy, Debug)]
pub struct Filmed<'a> {
    /// The tracks.
    pub tracks: &'a Tracks,
    /// Their groups.
    pub groups: &'a GroupTree,
    /// Where the plant leaves the ground, pixels (right, down); `None`: nobody has said.
    pub root: Option<[f64; 2]>,
    /// Non-zero where branches may be, of the frames' size; `None`: everywhere.
    pub mask: Option<Gray<'a>>,
}

impl Filmed<'_> {
    /// Why a plugin must not be given this; `None` when it may.
    pub(crate) fn fault(&self) -> Option<String> {
        if let Some(root) = self.root.filter(|root| !root.iter().all(|v| v.is_finite())) {
            return Some(format!("was given a root at {root:?}"));
        }
        let size = (self.tracks.width, self.tracks.height);
        let is_off = |mask: &Gray<'_>| !mask.is_whole() || (mask.width, mask.height) != size;
        if let Some(mask) = self.mask.as_ref().filter(|mask| is_off(mask)) {
            let (width, height) = size;
            return Some(format!(
                "was given a mask of {}x{} for frames of {width}x{height}",
                mask.width, mask.height
            ));
        }
        self.tracks.fault().or_else(|| self.groups.fault(self.tracks.len()))
    }
}

/// What was found of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameNote {
    /// Frame number in the clip.
    pub frame: i64,
    /// Whether it was left out.
    pub outlier: bool,
    /// How far it lies from the other frames, at least 0.
    pub distance: f64,
}

/// A hierarchy over n tracks, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Clustering {
    /// The tree.
    pub dendrogram: Dendrogram,
    /// What is known of frames; empty if the plugin does not judge them.
    pub frames: Vec<FrameNote>,
}

/// A node of a skeleton at rest, or of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Row of its parent, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Metres.
    pub position: [f32; 3],
    /// Metres.
    pub radius: f32,
    /// Row of the track it was grown from.
    pub track: Option<u32>,
}
