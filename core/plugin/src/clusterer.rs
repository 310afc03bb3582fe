//! Clusterers: plugins that find the branches behind the motion of tracks.

use crate::{Cx, Info, Params, Result};

/// Groups tracks into a hierarchy.
pub trait Clusterer: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;

    /// Groups the tracks. Leaf k of the result is track k of the input.
    ///
    /// # Errors
    /// Whatever keeps it from that: too few tracks in common frames, nothing moves.
    fn cluster(params: &Self::Params, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering>;
}

/// Tracks of different lengths, with the samples of all tracks one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Tracks<'a> {
    /// Id of every track.
    pub ids: &'a [u32],
    /// Frame of the first sample of every track.
    pub first_frames: &'a [i64],
    /// Number of samples of every track, one a frame.
    pub lens: &'a [u32],
    /// Where every track begins in `x`, `y` and `status`.
    pub offsets: &'a [u64],
    /// Pixels, right; all samples.
    pub x: &'a [f32],
    /// Pixels, down; all samples.
    pub y: &'a [f32],
    /// Numbers of [`honami_abi::status`]; all samples. See [`Track::seen`].
    pub status: &'a [u8],
    /// Frame of the first entry of `times_s`.
    pub first_time: i64,
    /// Presentation times of consecutive frames, seconds; covers all tracks.
    pub times_s: &'a [f64],
    /// Width of the frames, pixels.
    pub width: u32,
    /// Height of the frames, pixels.
    pub height: u32,
    /// Threads that may work at a time, at least 1.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

/// One track of [`Tracks`].
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// Its id.
    pub id: u32,
    /// Frame of the first sample.
    pub first_frame: i64,
    /// Pixels, right; one a frame.
    pub x: &'a [f32],
    /// Pixels, down; one a frame.
    pub y: &'a [f32],
    /// Numbers of [`honami_abi::status`]; one a frame.
    pub status: &'a [u8],
}

impl<'a> Tracks<'a> {
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

    /// Track k, `None` beyond the last one.
    #[must_use]
    pub fn get(&self, k: usize) -> Option<Track<'a>> {
        let start = usize::try_from(*self.offsets.get(k)?).ok()?;
        let samples = start..start.checked_add(self.lens[k] as usize)?;
        Some(Track {
            id: self.ids[k],
            first_frame: self.first_frames[k],
            x: self.x.get(samples.clone())?,
            y: self.y.get(samples.clone())?,
            status: self.status.get(samples)?,
        })
    }

    /// All tracks, in order.
    pub fn iter(&self) -> impl Iterator<Item = Track<'a>> + use<'a> {
        let tracks = *self;
        (0..self.len()).filter_map(move |k| tracks.get(k))
    }

    /// Presentation time of a frame, seconds.
    #[must_use]
    pub fn time_s(&self, frame: i64) -> Option<f64> {
        self.times_s.get(usize::try_from(frame.checked_sub(self.first_time)?).ok()?).copied()
    }
}

impl Track<'_> {
    /// Whether sample k is a measurement: tracked or newborn.
    #[must_use]
    pub fn seen(&self, k: usize) -> bool {
        matches!(self.status.get(k), Some(&(honami_abi::status::TRACKED | honami_abi::status::NEWBORN)))
    }
}

/// A hierarchy over n tracks, and what was found of frames on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clustering {
    /// The n-1 merges; leaf k is track k, merge r makes cluster n+r (SciPy's linkage).
    pub merges: Vec<Merge>,
    /// What is known of frames; empty if the method does not judge them.
    pub frames: Vec<FrameNote>,
}

/// Two clusters become one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merge {
    /// First cluster.
    pub a: u32,
    /// Second cluster.
    pub b: u32,
    /// Dissimilarity at which they merge.
    pub height: f64,
    /// Leaves below.
    pub size: u32,
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
