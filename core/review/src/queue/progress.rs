//! How far the review is, and what it has taken.

use std::collections::BTreeMap;

use honami_model::document::Document;
use honami_model::judgement::{Effort, Verdict};
use honami_model::track::TrackId;

/// Segments by what was found of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Judgements in the order of [`Verdict::ALL`].
    pub verdicts: [usize; Verdict::ALL.len()],
}

impl Tally {
    /// Segments with this verdict.
    #[must_use]
    pub fn of(&self, verdict: Verdict) -> usize {
        self.verdicts[verdict as usize]
    }

    /// Segments that are done: put off is not.
    #[must_use]
    pub fn done(&self) -> usize {
        self.verdicts.iter().sum::<usize>() - self.of(Verdict::Later)
    }
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.verdicts.iter_mut().zip(other.verdicts).for_each(|(n, more)| *n += more);
    }
}

impl std::ops::SubAssign for Tally {
    fn sub_assign(&mut self, other: Self) {
        self.verdicts.iter_mut().zip(other.verdicts).for_each(|(n, less)| *n -= less);
    }
}

impl FromIterator<Verdict> for Tally {
    fn from_iter<I: IntoIterator<Item = Verdict>>(verdicts: I) -> Self {
        let mut tally = Self::default();
        verdicts.into_iter().for_each(|verdict| tally.verdicts[verdict as usize] += 1);
        tally
    }
}

/// How far the review is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Segments still to look at.
    pub open: usize,
    /// What was found of the others, where their samples are still those that were judged.
    pub judged: Tally,
}

impl Progress {
    /// All segments: open and done.
    #[must_use]
    pub fn total(&self) -> usize {
        self.open + self.judged.done()
    }
}

/// What the review of a track has taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackEffort {
    /// Segments judged.
    pub segments: usize,
    /// Their sum.
    pub effort: Effort,
}

/// What the review has taken, track by track.
#[must_use]
pub fn effort(document: &Document) -> BTreeMap<TrackId, TrackEffort> {
    let mut tracks = BTreeMap::<TrackId, TrackEffort>::new();
    let judgements =
        document.tracks().flat_map(|(id, track)| track.judgements.values().map(move |j| (id, j)));
    for (track, judgement) in judgements {
        let sum = tracks.entry(track).or_default();
        sum.segments += 1;
        sum.effort.keystrokes += judgement.effort.keystrokes;
        sum.effort.key_frames += judgement.effort.key_frames;
        sum.effort.seconds += judgement.effort.seconds;
    }
    tracks
}
