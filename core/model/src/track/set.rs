//! Sets of tracks, kept and written as ranges: a run of 10,000 tracks is one pair of numbers.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::TrackId;

/// A set of tracks, in order of their numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<(u32, u32)>", into = "Vec<(u32, u32)>")]
pub struct TrackSet(Vec<Range<u32>>);

impl TrackSet {
    /// Whether the track is in it.
    #[must_use]
    pub fn contains(&self, track: TrackId) -> bool {
        let after = self.0.partition_point(|range| range.start <= track.0);
        after > 0 && self.0[after - 1].contains(&track.0)
    }

    /// The tracks in order.
    pub fn iter(&self) -> impl Iterator<Item = TrackId> + '_ {
        self.0.iter().cloned().flatten().map(TrackId)
    }

    /// Number of tracks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.iter().map(ExactSizeIterator::len).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromIterator<TrackId> for TrackSet {
    fn from_iter<I: IntoIterator<Item = TrackId>>(tracks: I) -> Self {
        tracks.into_iter().map(|track| (track.0, track.0.saturating_add(1))).collect::<Vec<_>>().into()
    }
}

impl From<TrackId> for TrackSet {
    fn from(track: TrackId) -> Self {
        Self::from_iter([track])
    }
}

/// From pairs `(first, one past the last)`, in any order, overlapping or empty.
impl From<Vec<(u32, u32)>> for TrackSet {
    fn from(mut pairs: Vec<(u32, u32)>) -> Self {
        pairs.retain(|(start, end)| start < end);
        pairs.sort_unstable();
        let mut ranges: Vec<Range<u32>> = Vec::new();
        for (start, end) in pairs {
            match ranges.last_mut() {
                Some(last) if start <= last.end => last.end = last.end.max(end),
                _ => ranges.push(start..end),
            }
        }
        Self(ranges)
    }
}

impl From<TrackSet> for Vec<(u32, u32)> {
    fn from(set: TrackSet) -> Self {
        set.0.into_iter().map(|range| (range.start, range.end)).collect()
    }
}

impl std::fmt::Display for TrackSet {
    /// As a person would say it: `track 42`, `135 tracks`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.len() {
            1 => write!(f, "track {}", self.0[0].start),
            n => write!(f, "{n} tracks"),
        }
    }
}

#[cfg(test)]
mod tests;
