//! The review queue: doubtful segments of all tracks, the most doubtful first.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use honami_model::track::TrackId;

use crate::evidence::Parts;

mod progress;
mod segments;

pub use progress::{Progress, Tally, TrackEffort, effort};
pub use segments::{DOUBTFUL, Reasons, Segments, segments};

/// A segment of a track that is worth a look.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The track.
    pub track: TrackId,
    /// The segment.
    pub frames: Range<u32>,
    /// Its most doubtful frame.
    pub worst: u32,
    /// What speaks against it.
    pub reasons: Reasons,
    /// The frame that the reasons are of: the most doubtful one in which the feature is said to be seen, if any.
    pub measured: u32,
    /// What was measured there.
    pub parts: Parts,
    /// What the run is called that is farthest from what is shown there.
    pub opponent: Option<Arc<str>>,
    /// Probability that it is bad, 0..=1: that of its most doubtful frame.
    pub suspicion: f32,
    /// Whether a reviewer has put it off: it comes after all others.
    pub later: bool,
}

/// The place of an item in the queue; smaller comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rank {
    later: bool,
    /// Falls as suspicion rises; suspicions are positive, so their bits are in their order.
    trust: u32,
    track: TrackId,
    first_frame: u32,
}

impl Item {
    /// Its place in the queue.
    #[must_use]
    pub fn rank(&self) -> Rank {
        let trust = u32::MAX - self.suspicion.max(0.0).to_bits();
        Rank { later: self.later, trust, track: self.track, first_frame: self.frames.start }
    }

    /// Which run is elsewhere, and how far, in a reviewer's words.
    #[must_use]
    pub fn disagreement(&self) -> Option<String> {
        let (name, px) = (self.opponent.as_ref()?, self.parts.farthest_px()?);
        Some(format!("disagrees with {name} by {px:.0} px"))
    }
}

/// Items of all tracks in the order in which they are to be looked at. All it does takes O(log n), or O(m log n) for
/// a track of m items.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Queue {
    items: BTreeMap<Rank, Item>,
    of_track: BTreeMap<TrackId, BTreeSet<Rank>>,
}

impl Queue {
    /// A queue of these items.
    #[must_use]
    pub fn new(items: impl IntoIterator<Item = Item>) -> Self {
        let mut queue = Self::default();
        for item in items {
            queue.insert(item);
        }
        queue
    }

    /// Replaces the items of a track.
    pub fn set(&mut self, track: TrackId, items: impl IntoIterator<Item = Item>) {
        for rank in self.of_track.remove(&track).into_iter().flatten() {
            self.items.remove(&rank);
        }
        for item in items {
            debug_assert_eq!(item.track, track, "an item of another track");
            self.insert(item);
        }
    }

    fn insert(&mut self, item: Item) {
        let rank = item.rank();
        self.of_track.entry(item.track).or_default().insert(rank);
        self.items.insert(rank, item);
    }

    /// Number of items.
    #[must_use]
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there is nothing to look at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The items, most doubtful first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Item> {
        self.items.values()
    }

    /// The most doubtful item.
    #[must_use]
    pub fn first(&self) -> Option<&Item> {
        self.items.values().next()
    }

    /// The item at this place; `None` when it has left the queue or moved in it.
    #[must_use]
    pub fn get(&self, rank: Rank) -> Option<&Item> {
        self.items.get(&rank)
    }

    /// The next item after a place, whether or not an item is there any more.
    #[must_use]
    pub fn after(&self, rank: Rank) -> Option<&Item> {
        use std::ops::Bound::{Excluded, Unbounded};
        self.items.range((Excluded(rank), Unbounded)).next().map(|(_, item)| item)
    }

    /// The last item before a place.
    #[must_use]
    pub fn before(&self, rank: Rank) -> Option<&Item> {
        self.items.range(..rank).next_back().map(|(_, item)| item)
    }

    /// The items about a place in their order: so many before it, and so many from it on.
    #[must_use]
    pub fn about(&self, rank: Rank, reach: usize) -> Vec<&Item> {
        let mut about: Vec<&Item> =
            self.items.range(..rank).rev().take(reach).map(|(_, item)| item).collect();
        about.reverse();
        about.extend(self.items.range(rank..).take(reach).map(|(_, item)| item));
        about
    }

    /// The items of a track, most doubtful first.
    pub fn of_track(&self, track: TrackId) -> impl Iterator<Item = &Item> {
        self.of_track.get(&track).into_iter().flatten().filter_map(|rank| self.items.get(rank))
    }
}

#[cfg(test)]
mod tests;
