//! Two runs over the picture, A and B, and how they disagree.

use std::sync::Arc;

use honami_model::document::RunId;
use honami_model::track::{TrackId, TrackSet};
use honami_workbench::versus::{AtKeys, Compared, Entrant, Place};

use super::state::State;
use super::tracks::TrackRow;

/// Letters of the two.
pub const LETTERS: [char; 2] = ['A', 'B'];

/// Which of the two are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both, joined where they differ.
    #[default]
    Both,
    /// This one: A (0) or B (1).
    One(usize),
}

impl Sides {
    /// The next of both, A, B.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Both => Self::One(0),
            Self::One(0) => Self::One(1),
            Self::One(_) => Self::Both,
        }
    }

    /// Whether this one is drawn.
    #[must_use]
    pub fn shows(self, side: usize) -> bool {
        self == Self::Both || self == Self::One(side)
    }
}

/// Two runs over the picture.
#[derive(Clone, Debug)]
pub struct Versus {
    /// A and B.
    pub runs: [Entrant; 2],
    /// Which of them are drawn.
    pub sides: Sides,
    /// Their samples, and how they disagree; `None` while that is worked out.
    pub compared: Option<Arc<Compared>>,
    /// How far both are from the key-frames.
    pub at_keys: AtKeys,
    /// The place of disagreement that was gone to last.
    pub place: Option<usize>,
    /// The place that was taken last, and from which of the two.
    pub taken: Option<(usize, usize)>,
    /// The track that was selected when they were put beside each other.
    began_at: Option<TrackId>,
    /// The tracks that were asked for last, and in which state of the tracks that was.
    asked: Option<(TrackSet, u64)>,
}

/// Two runs that are to be compared behind the screen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VersusRequest {
    /// A and B.
    pub runs: [RunId; 2],
    /// The tracks.
    pub tracks: TrackSet,
}

impl Versus {
    /// Two runs of which nothing more is known yet.
    #[must_use]
    pub fn new(runs: [Entrant; 2], selected: Option<TrackId>) -> Self {
        let (sides, at_keys) = Default::default();
        let (compared, place, taken, asked) = Default::default();
        Self { runs, sides, compared, at_keys, place, taken, began_at: selected, asked }
    }

    /// A place of disagreement by its rank.
    #[must_use]
    pub fn place_at(&self, rank: usize) -> Option<&Place> {
        self.compared.as_ref()?.found.places.get(rank)
    }

    /// Whether this track was selected since they are beside each other: until then the list begins with the worst.
    #[must_use]
    pub fn was_chosen(&self, track: TrackId) -> bool {
        self.place.is_some() || self.began_at != Some(track)
    }

    /// Numbers of A and B.
    #[must_use]
    pub fn numbers(&self) -> [RunId; 2] {
        [self.runs[0].run, self.runs[1].run]
    }

    /// What is to be worked out now, once for these runs and the tracks that are shown.
    pub fn request(state: &mut State) -> Option<VersusRequest> {
        let revision = state.plotted.revision;
        let versus = state.versus.as_deref_mut()?;
        if versus.asked.as_ref().is_some_and(|(_, at)| *at == revision) {
            return None;
        }
        let tracks: TrackSet = state.tracks.iter().map(|row| row.id).collect();
        let before = versus.asked.replace((tracks.clone(), revision));
        let is_new = before.is_none_or(|(before, _)| before != tracks);
        is_new.then(|| VersusRequest { runs: versus.numbers(), tracks })
    }

    /// Looks at the key-frames of these tracks anew.
    pub fn look_at_keys(&mut self, tracks: &[TrackRow]) {
        let Some(compared) = &self.compared else { return };
        let keys = |row: &TrackRow| {
            let placed = |frame: &u32| {
                let sample = row.span.get(*frame).filter(|sample| sample.status.is_seen())?;
                Some((row.id, *frame, [sample.x, sample.y]))
            };
            row.keys.iter().filter_map(placed).collect::<Vec<_>>()
        };
        self.at_keys = compared.at_keys(tracks.iter().flat_map(keys));
    }

    /// Where the drawn ones have their tracks in a frame, image pixels.
    #[must_use]
    pub fn points(&self, frame: u32) -> Vec<(TrackId, [f32; 2])> {
        let tracks = self.compared.iter().flat_map(|compared| &compared.tracks);
        let of = |paired: &honami_workbench::versus::Paired| {
            let spans = paired.spans.iter().enumerate().filter(|(side, _)| self.sides.shows(*side));
            let at = spans.filter_map(|(_, span)| span.get(frame).map(|sample| [sample.x, sample.y]));
            at.map(|at| (paired.track, at)).collect::<Vec<_>>()
        };
        tracks.flat_map(of).collect()
    }
}
