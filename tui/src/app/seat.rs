//! Where a user is in a project: found again when they come back, also after a dropped connection.

use std::f64::consts::PI;

use honami_model::track::TrackId;
use honami_workbench::overlay::Dial;
use serde::{Deserialize, Serialize};

use super::layout::ZOOM_MAX;
use super::panel::Panel;
use super::state::State;
use super::update::{LOOP_MAX, RATES};
use crate::term::glyph::Glyphs;

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
    loop_frames: Option<u32>,
    /// Name of the characters that show the picture.
    glyphs: Option<String>,
    no_stills: bool,
    motion: bool,
    skeleton: bool,
    /// Speed that has its full colour, px/s.
    full_px_s: Option<f64>,
    /// Middle and half width of the directions that are shown, radians.
    dial_rad: Option<[f64; 2]>,
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
            loop_frames: Some(state.loop_frames),
            glyphs: Some(state.glyphs.name().to_owned()),
            no_stills: !state.stills,
            motion: state.motion.is_on,
            skeleton: state.skeleton.is_on,
            full_px_s: state.motion.full_px_s,
            dial_rad: Some([state.motion.dial.centre_rad, state.motion.dial.half_width_rad]),
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
        if let Some(frames) = self.loop_frames {
            state.loop_frames = frames.clamp(1, LOOP_MAX);
        }
        state.glyphs = self.glyphs.as_deref().and_then(Glyphs::named).unwrap_or_default();
        state.stills = !self.no_stills;
        state.motion.is_on = self.motion;
        state.skeleton.is_on = self.skeleton;
        state.motion.full_px_s = self.full_px_s.filter(|speed| speed.is_finite() && *speed > 0.0);
        if let Some([centre_rad, half_width_rad]) =
            self.dial_rad.filter(|dial| dial.iter().all(|x| x.is_finite()))
        {
            state.motion.dial = Dial { centre_rad, half_width_rad: half_width_rad.clamp(0.0, PI) };
        }
        if let Some(centre) = self.centre.filter(|at| at.iter().all(|x| x.is_finite())) {
            state.centre = centre;
        }
    }
}

#[cfg(test)]
mod tests;
