//! Tracks that are functions of track and frame, so that their groups are known.

use std::ops::Range;

use honami_abi::status::{LOST, TRACKED};

use crate::clusterer::{Clustering, Tracks};

/// Tracks over the same frames, all samples tracked at first; at 25 frames per second, of pictures of 800 x 600 px.
#[derive(Clone, Debug)]
pub struct Samples {
    ids: Vec<u32>,
    first_frames: Vec<i64>,
    lens: Vec<u32>,
    offsets: Vec<u64>,
    x: Vec<f32>,
    y: Vec<f32>,
    status: Vec<u8>,
    times_s: Vec<f64>,
}

impl Samples {
    /// So many tracks from a frame on, for so many frames, at `position(track, frame)`, which is asked track by track;
    /// both count from 0. Ids begin with 100.
    #[must_use]
    pub fn new(
        n_tracks: u32,
        first_frame: u32,
        n_frames: u32,
        mut position: impl FnMut(u32, u32) -> [f64; 2],
    ) -> Self {
        let each = (0..n_tracks).flat_map(|track| (0..n_frames).map(move |frame| (track, frame)));
        let at: Vec<[f64; 2]> = each.map(|(track, frame)| position(track, frame)).collect();
        Self {
            ids: (100..100 + n_tracks).collect(),
            first_frames: vec![i64::from(first_frame); n_tracks as usize],
            lens: vec![n_frames; n_tracks as usize],
            offsets: (0..n_tracks).map(|track| u64::from(track) * u64::from(n_frames)).collect(),
            x: at.iter().map(|at| at[0] as f32).collect(),
            y: at.iter().map(|at| at[1] as f32).collect(),
            status: vec![TRACKED; at.len()],
            times_s: (0..first_frame + n_frames).map(|frame| f64::from(frame) / 25.0).collect(),
        }
    }

    /// Loses a track in some of its frames, counted from its first; there its samples say that it is at `at`.
    ///
    /// # Panics
    /// When there is no such track, or no such frame.
    #[track_caller]
    pub fn lose(&mut self, track: u32, frames: Range<u32>, at: [f32; 2]) {
        assert!(frames.end <= self.lens[track as usize], "{frames:?} of {}", self.lens[track as usize]);
        let start = self.offsets[track as usize] as usize;
        for k in start + frames.start as usize..start + frames.end as usize {
            ([self.x[k], self.y[k]], self.status[k]) = (at, LOST);
        }
    }

    /// As a clusterer is given them: two threads, seed 0.
    #[must_use]
    pub fn tracks(&self) -> Tracks<'_> {
        Tracks {
            ids: &self.ids,
            first_frames: &self.first_frames,
            lens: &self.lens,
            offsets: &self.offsets,
            x: &self.x,
            y: &self.y,
            status: &self.status,
            first_time: 0,
            times_s: &self.times_s,
            width: 800,
            height: 600,
            max_threads: 2,
            seed: 0,
        }
    }
}

/// The groups that are left when the last `n_groups - 1` merges are undone: their tracks, ascending, the group of the
/// first track first.
///
/// # Panics
/// When there are not as many tracks.
#[must_use]
#[track_caller]
pub fn groups(found: &Clustering, n_groups: usize) -> Vec<Vec<u32>> {
    let n_tracks = found.merges.len() + 1;
    let mut groups: Vec<Option<Vec<u32>>> = (0..n_tracks as u32).map(|track| Some(vec![track])).collect();
    for merge in &found.merges[..n_tracks - n_groups] {
        let parts = [merge.a, merge.b].map(|part| groups[part as usize].take().unwrap_or_default());
        groups.push(Some(parts.concat()));
    }
    let mut groups: Vec<Vec<u32>> = groups.into_iter().flatten().collect();
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups.sort();
    groups
}
