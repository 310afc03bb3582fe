//! Where a user is in a project: found again when they come back, also after a dropped connection.

use honami_model::track::TrackId;
use serde::{Deserialize, Serialize};

use super::layout::ZOOM_MAX;
use super::panel::Panel;
use super::state::State;
use super::update::RATES;

/// What is found again. Fields may come and go: unknown ones are ignored, missing ones are as in a new session.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, rename_all = "kebab-case")]
pub(super) struct Seat {
    frame: u32,
    selected: Option<u32>,
    by_doubt: bool,
    marks_one: bool,
    /// Name of the panel.
    panel: Option<String>,
    zoom: u8,
    centre: Option<[f32; 2]>,
    follow: bool,
    rates: Option<[u32; 2]>,
}

impl Seat {
    /// Where the user of a state is.
    pub(super) fn of(state: &State) -> Self {
        Self {
            frame: state.frame,
            selected: state.selected.map(|track| track.0),
            by_doubt: state.by_doubt,
            marks_one: !state.marks_all,
            panel: state.panel.map(|panel| panel.name().to_owned()),
            zoom: state.zoom,
            centre: Some(state.centre),
            follow: state.follow,
            rates: Some(state.rates),
        }
    }

    /// Takes the user there, as far as it still exists.
    pub(super) fn take(&self, state: &mut State) {
        state.frame = self.frame.min(state.last_frame());
        state.selected = self.selected.map(TrackId).filter(|&track| state.row(track).is_some());
        state.by_doubt = self.by_doubt;
        state.marks_all = !self.marks_one;
        state.panel = Panel::ALL.iter().copied().find(|panel| self.panel.as_deref() == Some(panel.name()));
        state.zoom = self.zoom.min(ZOOM_MAX);
        state.follow = self.follow && state.selected.is_some();
        if let Some(rates) = self.rates {
            state.rates = rates.map(|rate| rate.clamp(RATES.0, RATES.1));
        }
        if let Some(centre) = self.centre.filter(|at| at.iter().all(|x| x.is_finite())) {
            state.centre = centre;
        }
    }
}

#[cfg(test)]
mod tests;
