//! What the plots show: of which tracks, and what has come of them so far.

use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::track::{Span, TrackId};
use honami_workbench::plots::Plots;

use super::panel::Panel;
use super::state::State;

/// Curves, of what and in which state of the tracks.
pub type Lot = ((Subject, u64), Arc<Plots>);

/// What is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A track.
    Track(TrackId),
    /// A group of the shown clustering, from 0.
    Group(u32),
}

/// Curves that are to be worked out, behind the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotRequest {
    /// Of what, and in which state of the tracks.
    pub subject: (Subject, u64),
    /// Its tracks.
    pub tracks: Vec<Arc<Span>>,
    /// Frame times of the clip.
    pub times: FrameTimes,
}

/// The plots of a state.
#[derive(Clone, Debug, Default)]
pub struct Plotted {
    /// The selected track's group is plotted, not the track.
    pub of_group: bool,
    /// How often the tracks or their groups have changed.
    pub revision: u64,
    /// What was last asked for.
    pub asked: Option<(Subject, u64)>,
    /// What has come.
    pub plots: Option<Lot>,
}

impl Plotted {
    /// What is to be plotted in a state: the selected track, or its group where that is wanted and there is one, as
    /// among the groups.
    #[must_use]
    pub fn subject(state: &State) -> Option<Subject> {
        let track = state.selected_row()?.id;
        let group = state.groups.as_ref().and_then(|groups| groups.of(track));
        let is_wanted = state.plotted.of_group || state.panel == Some(Panel::Groups);
        Some(group.filter(|_| is_wanted).map_or(Subject::Track(track), Subject::Group))
    }

    /// The curves, if they are of what is to be plotted; those of an earlier state of it until then.
    #[must_use]
    pub fn shown(state: &State) -> Option<&Plots> {
        let ((subject, _), plots) = state.plotted.plots.as_ref()?;
        (Some(*subject) == Self::subject(state)).then_some(&**plots)
    }

    /// What is to be worked out now, once.
    pub fn request(state: &mut State) -> Option<PlotRequest> {
        let wanted = (Self::subject(state)?, state.plotted.revision);
        if state.plotted.asked.replace(wanted) == Some(wanted) {
            return None;
        }
        let groups = state.groups.as_ref();
        let is_meant = |id: TrackId| match wanted.0 {
            Subject::Track(track) => id == track,
            Subject::Group(group) => groups.and_then(|groups| groups.of(id)) == Some(group),
        };
        let rows = state.tracks.iter().filter(|row| is_meant(row.id));
        let tracks = rows.map(|row| Arc::clone(&row.span)).collect();
        Some(PlotRequest { subject: wanted, tracks, times: state.clip.times.clone() })
    }
}
