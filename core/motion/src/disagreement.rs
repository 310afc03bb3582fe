//! Two trackers on the same features, A and B: how far apart they are, where most, and who sees what the other does not.
//!
//! Only frames count that both have a sample in; a distance there is only where both see the feature.

use std::ops::Range;

use honami_model::track::{Sample, Span, TrackId};

use crate::accuracy::median;

/// Distances that shares are told of, pixels.
pub const LIMITS_PX: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// From here on two positions are apart, pixels.
pub const FAR_PX: f64 = 2.0;
/// Frames between two places of a track that make one of them, at most: what trembles about [`FAR_PX`] is one place.
const GAP: u32 = 5;

/// What the two say of a feature in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// Both see it, so many pixels apart.
    Both(f64),
    /// One of them does: A (0) or B (1).
    Alone(usize),
    /// Neither does.
    Neither,
}

/// What two samples of the same frame say of a feature.
#[must_use]
pub fn sight(samples: [&Sample; 2]) -> Sight {
    match samples.map(|sample| sample.status.is_seen()) {
        [true, true] => Sight::Both(apart(samples)),
        [true, false] => Sight::Alone(0),
        [false, true] => Sight::Alone(1),
        [false, false] => Sight::Neither,
    }
}

fn apart([a, b]: [&Sample; 2]) -> f64 {
    (f64::from(a.x) - f64::from(b.x)).hypot(f64::from(a.y) - f64::from(b.y))
}

/// How many of [`LIMITS_PX`] a distance has reached: 0 for agreement, 4 for the worst.
#[must_use]
pub fn class(px: f64) -> usize {
    LIMITS_PX.iter().filter(|limit| px >= **limit).count()
}

/// A track as two runs found it.
#[derive(Clone, Debug, PartialEq)]
pub struct Paired {
    /// The track.
    pub track: TrackId,
    /// Its samples in A and in B.
    pub spans: [Span; 2],
}

impl Paired {
    /// What the two say in a frame; `None` where one of them has no sample.
    #[must_use]
    pub fn sight(&self, frame: u32) -> Option<Sight> {
        let [a, b] = &self.spans;
        Some(sight([a.get(frame)?, b.get(frame)?]))
    }

    /// How far apart they are in each of the first `n_frames` frames, pixels.
    #[must_use]
    pub fn distances_px(&self, n_frames: u32) -> Vec<Option<f64>> {
        let px = |sight| if let Sight::Both(px) = sight { Some(px) } else { None };
        (0..n_frames).map(|frame| self.sight(frame).and_then(px)).collect()
    }

    /// The frames that both have samples in.
    #[must_use]
    pub fn frames(&self) -> Range<u32> {
        let [a, b] = [self.spans[0].frames(), self.spans[1].frames()];
        let start = a.start.max(b.start);
        start..a.end.min(b.end).max(start)
    }
}

/// How two runs disagree on a track.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The track.
    pub track: TrackId,
    /// Frames that both have samples in.
    pub n_frames: u32,
    /// Of these, frames in which both see it.
    pub n_both: u32,
    /// Of these, frames in which they are [`FAR_PX`] apart or more.
    pub n_far: u32,
    /// How far apart they are at most, pixels, and in which frame; `None` where they never both see it.
    pub farthest: Option<(f64, u32)>,
    /// Frames in which A does not see it, and B.
    pub n_unseen: [u32; 2],
}

/// Frames of a track in which the two are apart, or one of them alone sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The track.
    pub track: TrackId,
    /// The frames.
    pub frames: Range<u32>,
    /// The frame to look at: where they are farthest apart, or where one is left alone.
    pub worst: u32,
    /// What they say there.
    pub sight: Sight,
}

/// How two runs disagree on all their tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Tracks that both have.
    pub n_tracks: usize,
    /// Samples that both see.
    pub n_both: u64,
    /// Median distance of these, pixels.
    pub median_px: Option<f64>,
    /// Shares of these below [`LIMITS_PX`]; 0 where there are none.
    pub within: [f64; 4],
    /// Samples that A does not see, and B.
    pub n_unseen: [u64; 2],
    /// Median forward-backward error of what A sees, and B, pixels; `None` where it was not measured.
    pub fb_px: [Option<f64>; 2],
}

/// What became of a comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Disagreement {
    /// The tracks, the farthest apart first.
    pub rows: Vec<Row>,
    /// Where they disagree: the farthest apart first, then where one alone sees the feature, the longest first.
    pub places: Vec<Place>,
    /// All in all.
    pub summary: Summary,
}

/// Compares two runs on the tracks of both. O(samples).
#[must_use]
pub fn disagreement(tracks: &[Paired]) -> Disagreement {
    let mut found = Disagreement::default();
    let (mut distances, mut errors) = (Vec::new(), [Vec::new(), Vec::new()]);
    for paired in tracks {
        let row = look(paired, &mut distances, &mut errors, &mut found.places);
        let summary = &mut found.summary;
        summary.n_tracks += 1;
        for (sum, n) in summary.n_unseen.iter_mut().zip(row.n_unseen) {
            *sum += u64::from(n);
        }
        found.rows.push(row);
    }
    found.rows.sort_by(|a, b| {
        let px = |row: &Row| row.farthest.map_or(-1.0, |(px, _)| px);
        let alone = |row: &Row| row.n_unseen[0].abs_diff(row.n_unseen[1]);
        px(b).total_cmp(&px(a)).then(alone(b).cmp(&alone(a))).then(a.track.cmp(&b.track))
    });
    found.places.sort_by(|a, b| {
        let px = |place: &Place| if let Sight::Both(px) = place.sight { px } else { -1.0 };
        let order = px(b).total_cmp(&px(a)).then(b.frames.len().cmp(&a.frames.len()));
        order.then((a.track, a.worst).cmp(&(b.track, b.worst)))
    });
    let n = distances.len();
    found.summary.n_both = n as u64;
    found.summary.within =
        LIMITS_PX.map(|limit| distances.iter().filter(|px| **px < limit).count() as f64 / n.max(1) as f64);
    found.summary.median_px = median(distances);
    found.summary.fb_px = errors.map(median);
    found
}

/// One track: its row, and what it adds to the distances, the forward-backward errors and the places.
fn look(
    paired: &Paired,
    distances: &mut Vec<f64>,
    errors: &mut [Vec<f64>; 2],
    places: &mut Vec<Place>,
) -> Row {
    let (track, frames) = (paired.track, paired.frames());
    let mut row =
        Row { track, n_frames: frames.len() as u32, n_both: 0, n_far: 0, farthest: None, n_unseen: [0; 2] };
    let first = places.len();
    for frame in frames {
        let Some(sight) = paired.sight(frame) else { continue };
        for (i, span) in paired.spans.iter().enumerate() {
            let seen = span.get(frame).filter(|sample| sample.status.is_seen());
            row.n_unseen[i] += u32::from(seen.is_none());
            errors[i].extend(seen.and_then(|sample| sample.quality.fb_px).map(f64::from));
        }
        if let Sight::Both(px) = sight {
            row.n_both += 1;
            row.n_far += u32::from(px >= FAR_PX);
            row.farthest = row.farthest.filter(|(most, _)| *most >= px).or(Some((px, frame)));
            distances.push(px);
        }
        let is_place = match sight {
            Sight::Both(px) => px >= FAR_PX,
            Sight::Alone(_) => true,
            Sight::Neither => false,
        };
        if is_place {
            add(places, first, Place { track, frames: frame..frame + 1, worst: frame, sight });
        }
    }
    row
}

/// Adds a frame to the place that it goes on, or begins another; those of this track are the last, from `first` on.
fn add(places: &mut Vec<Place>, first: usize, new: Place) {
    let goes_on = |old: &Place| {
        let is_alike = match (old.sight, new.sight) {
            (Sight::Both(_), Sight::Both(_)) => true,
            (old, new) => old == new,
        };
        is_alike && new.frames.start - old.frames.end <= GAP
    };
    let Some(old) = places.get_mut(first..).and_then(<[Place]>::last_mut).filter(|old| goes_on(old)) else {
        return places.push(new);
    };
    old.frames.end = new.frames.end;
    if let (Sight::Both(most), Sight::Both(px)) = (old.sight, new.sight)
        && px > most
    {
        (old.sight, old.worst) = (new.sight, new.worst);
    }
}

/// How far A and B are from where a person has put features.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AtKeys {
    /// Key-frames that neither of them was given: only these say anything of both.
    pub n_new: usize,
    /// Median distance of A and of B from these, pixels, where what is not seen is farther than anything; `None` where
    /// half of them or more are not seen.
    pub median_px: [Option<f64>; 2],
    /// Key-frames at which A is exactly where the person put it, and B: it was given them, or they were found right as
    /// it has them.
    pub n_given: [usize; 2],
}

/// Compares A and B with key-frames: where each has a sample, and where a person has put the feature, pixels.
#[must_use]
pub fn at_keys<'a>(keys: impl IntoIterator<Item = ([&'a Sample; 2], [f32; 2])>) -> AtKeys {
    let mut found = AtKeys::default();
    let mut errors = [Vec::new(), Vec::new()];
    for (samples, at) in keys {
        let is_given = samples.map(|sample| [sample.x, sample.y].map(f32::to_bits) == at.map(f32::to_bits));
        for (n, is_given) in found.n_given.iter_mut().zip(is_given) {
            *n += usize::from(is_given);
        }
        if is_given == [false, false] {
            found.n_new += 1;
            for (errors, sample) in errors.iter_mut().zip(samples) {
                let key = Sample { x: at[0], y: at[1], ..*sample };
                errors.push(if sample.status.is_seen() { apart([sample, &key]) } else { f64::INFINITY });
            }
        }
    }
    found.median_px = errors.map(|errors| median(errors).filter(|px| px.is_finite()));
    found
}

#[cfg(test)]
mod tests;
