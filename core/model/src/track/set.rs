//! Sets of tracks, kept and written as ranges: a run of 10,000 tracks is one pair of numbers.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::TrackId;

/// A set of tracks, in order of their numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<(u32, u64)>", into = "Vec<(u32, u64)>")]
pub struct TrackSet(Vec<RangeInclusive<u32>>);

/// Why pairs of numbers are no set of tracks.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("tracks {start} to {end}: the last track there can be is {}", u32::MAX)]
pub struct TrackSetError {
    start: u32,
    end: u64,
}

impl TrackSet {
    /// Whether the track is in it.
    #[must_use]
    pub fn contains(&self, track: TrackId) -> bool {
        let after = self.0.partition_point(|range| *range.start() <= track.0);
        after > 0 && self.0[after - 1].contains(&track.0)
    }

    /// The tracks in order.
    pub fn iter(&self) -> impl Iterator<Item = TrackId> + '_ {
        self.0.iter().cloned().flatten().map(TrackId)
    }

    /// Joins ranges that are not empty and come in any order.
    fn of(mut all: Vec<RangeInclusive<u32>>) -> Self {
        all.sort_unstable_by_key(|range| *range.start());
        let mut joined: Vec<RangeInclusive<u32>> = Vec::new();
        for range in all {
            match joined.last_mut() {
                Some(last) if range.start().saturating_sub(1) <= *last.end() => {
                    *last = *last.start()..=*range.end().max(last.end());
                }
                _ => joined.push(range),
            }
        }
        Self(joined)
    }

    /// Number of tracks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.iter().map(|range| (range.end() - range.start()) as usize + 1).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromIterator<TrackId> for TrackSet {
    fn from_iter<I: IntoIterator<Item = TrackId>>(tracks: I) -> Self {
        Self::of(tracks.into_iter().map(|track| track.0..=track.0).collect())
    }
}

/// All tracks that are in one of the sets.
impl FromIterator<Self> for TrackSet {
    fn from_iter<I: IntoIterator<Item = Self>>(sets: I) -> Self {
        Self::of(sets.into_iter().flat_map(|set| set.0).collect())
    }
}

impl From<TrackId> for TrackSet {
    fn from(track: TrackId) -> Self {
        Self::from_iter([track])
    }
}

/// From pairs `(first, one past the last)`, in any order, overlapping or empty.
impl TryFrom<Vec<(u32, u64)>> for TrackSet {
    type Error = TrackSetError;

    fn try_from(pairs: Vec<(u32, u64)>) -> Result<Self, TrackSetError> {
        let range = |(start, end): (u32, u64)| match u32::try_from(end.saturating_sub(1)) {
            Ok(last) => Ok(start..=last),
            Err(_) => Err(TrackSetError { start, end }),
        };
        let is_full = |&(start, end): &(u32, u64)| u64::from(start) < end;
        pairs.into_iter().filter(is_full).map(range).collect::<Result<_, _>>().map(Self::of)
    }
}

impl From<TrackSet> for Vec<(u32, u64)> {
    fn from(set: TrackSet) -> Self {
        set.0.into_iter().map(|range| (*range.start(), u64::from(*range.end()) + 1)).collect()
    }
}

impl std::fmt::Display for TrackSet {
    /// As a person would say it: `track 42`, `135 tracks`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.len() {
            1 => write!(f, "track {}", self.0[0].start()),
            n => write!(f, "{n} tracks"),
        }
    }
}

#[cfg(test)]
mod tests;
