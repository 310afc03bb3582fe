//! Tracks and groups as the screen shows them.

use std::collections::BTreeMap;
use std::sync::Arc;

use honami_model::hierarchy::Dendrogram;
use honami_model::track::{Sample, Source, Span, Status, TrackId};

/// So many doubtful frames of a track are worth a look, at most.
const N_WORST: usize = 9;
/// The worst frame is worth a look in any case, others from this doubt on: 0.25 px forward-backward, or NCC .8.
const DOUBTFUL: f32 = 0.2;
/// Doubtful frames worth a look are so far apart.
const APART: usize = 5;

/// A track on screen.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackRow {
    /// Its number.
    pub id: TrackId,
    /// What a person calls it.
    pub name: Option<String>,
    /// Its samples, hand work included.
    pub span: Arc<Span>,
    /// Frames of its key-frames, rising.
    pub keys: Vec<u32>,
    /// Its most doubtful frames, the worst first, none near another; empty where nothing is doubtful.
    pub worst: Vec<u32>,
    /// How doubtful it is: the sum over its samples. Only good for comparing.
    pub doubt: f32,
}

impl TrackRow {
    /// A row of a shown track.
    #[must_use]
    pub fn new(id: TrackId, name: Option<String>, span: Arc<Span>) -> Self {
        let frames = || span.frames().zip(&span.samples);
        let keys = frames().filter(|(_, s)| s.source == Source::Key).map(|(f, _)| f).collect();
        let doubts: Vec<f32> = span.samples.iter().map(doubt).collect();
        let worst = worst(&span, &doubts);
        Self { id, name, keys, worst, doubt: doubts.iter().sum(), span }
    }

    /// Where it is in a frame, image pixels.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<[f32; 2]> {
        self.span.get(frame).map(|s| [s.x, s.y])
    }
}

/// Doubtful frames of a track that are worth a look: the worst first, at least so far apart. Of frames in a row
/// in which it is lost only the first counts.
fn worst(span: &Span, doubts: &[f32]) -> Vec<u32> {
    let is_lost = |i: usize| doubts[i] >= 1.0;
    let mut ranked: Vec<usize> =
        (0..doubts.len()).filter(|&i| doubts[i] > 0.0 && !(is_lost(i) && i > 0 && is_lost(i - 1))).collect();
    ranked.sort_by(|&a, &b| doubts[b].total_cmp(&doubts[a]).then(a.cmp(&b)));
    let mut worst: Vec<usize> = Vec::new();
    for i in ranked {
        if !worst.is_empty() && doubts[i] < DOUBTFUL {
            break;
        }
        if worst.iter().all(|&other| other.abs_diff(i) >= APART) {
            worst.push(i);
        }
        if worst.len() == N_WORST {
            break;
        }
    }
    worst.into_iter().filter_map(|i| Some(span.first_frame + u32::try_from(i).ok()?)).collect()
}

/// How doubtful a sample is, 0 (a person's word) to 1 (lost).
#[must_use]
pub fn doubt(sample: &Sample) -> f32 {
    match (sample.source, sample.status) {
        (Source::Key | Source::Sketch, _) => 0.0,
        (_, Status::Lost | Status::Rejected) => 1.0,
        _ => {
            // Half in doubt at 1 px forward-backward error, or at a correlation of .5.
            let fb = sample.quality.fb_px.map_or(0.0, |fb| fb / (fb + 1.0));
            let ncc = sample.quality.ncc.map_or(0.0, |ncc| (1.0 - ncc).clamp(0.0, 0.99));
            fb.max(ncc)
        }
    }
}

/// The shown clustering at its cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    /// How it was made, as the title says it.
    pub what: String,
    /// Its tracks, in the dendrogram's order of leaves.
    pub tracks: Vec<TrackId>,
    /// The hierarchy.
    pub dendrogram: Dendrogram,
    /// Number of groups.
    pub k: u32,
    /// Frames that were left out as outliers, rising.
    pub outlier_frames: Vec<u32>,
    of: BTreeMap<TrackId, u32>,
}

impl Groups {
    /// A clustering cut into `k` groups.
    #[must_use]
    pub fn new(
        what: String,
        tracks: Vec<TrackId>,
        dendrogram: Dendrogram,
        k: u32,
        outlier_frames: Vec<u32>,
    ) -> Self {
        let of = tracks.iter().copied().zip(dendrogram.cut(k)).collect();
        Self { what, tracks, dendrogram, k, outlier_frames, of }
    }

    /// The group of a track, from 0.
    #[must_use]
    pub fn of(&self, track: TrackId) -> Option<u32> {
        self.of.get(&track).copied()
    }

    /// Number of tracks of every group.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = Vec::new();
        for &group in self.of.values() {
            let group = group as usize;
            sizes.resize(sizes.len().max(group + 1), 0);
            sizes[group] += 1;
        }
        sizes
    }
}
