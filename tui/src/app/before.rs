//! Where the user was before an edit was asked for: the project may refuse it, and then nothing that was placed, typed or
//! opened is lost.

use honami_model::track::TrackId;
use honami_workbench::review::Item;

use super::action::Action;
use super::queue::Opened;
use super::state::{Mode, State};

/// What an edit that is asked for changes before it is known to be kept.
#[derive(Clone, Debug)]
pub struct Before {
    mode: Option<Mode>,
    frame: u32,
    selected: Option<TrackId>,
    corrected: Option<TrackId>,
    opened: Option<Opened>,
    /// The selected track's items of the queue.
    items: Vec<Item>,
}

impl Before {
    /// As things stand, before an action that may ask for an edit and gives something up for it; `None` before others.
    #[must_use]
    pub fn doing(action: Action, state: &State) -> Option<Self> {
        use Action::{Accept, DeleteTrack, Later, Reject};
        matches!(action, Accept | Reject | Later | DeleteTrack).then(|| Self::of(state))
    }

    fn of(state: &State) -> Self {
        let items = state.selected.map(|track| state.review.queue.of_track(track).cloned().collect());
        // What was chosen from a list is chosen again in no time; the list would hide what went wrong.
        let mode = Some(&state.mode).filter(|mode| !matches!(mode, Mode::Menu(_))).cloned();
        Self {
            mode,
            frame: state.frame,
            selected: state.selected,
            corrected: state.corrected,
            opened: state.opened.clone(),
            items: items.unwrap_or_default(),
        }
    }

    /// Goes back there.
    pub fn put_back(self, state: &mut State) {
        if let Some(track) = self.selected {
            state.review.queue.set(track, self.items);
        }
        state.looked.is_refused();
        state.mode = self.mode.unwrap_or(Mode::Review);
        if let Mode::Move(moving) = &mut state.mode {
            moving.refused(&state.clip.times);
        }
        state.frame = self.frame;
        state.selected = self.selected;
        state.corrected = self.corrected;
        state.opened = self.opened;
    }
}
