//! The viewer's window beside the terminal: how far it is, and where the terminal was when both were last in step.

use honami_workbench::scene::control::Chosen;

use super::panel::Panel;
use super::state::{Mode, State};

/// What is known of the viewer's window.
#[derive(Clone, Debug, Default)]
pub struct Window {
    /// How far it is.
    pub stage: Stage,
    /// Whether it plays by itself.
    pub is_playing: bool,
    /// How often what it shows has changed.
    revision: u64,
    /// The revision that it was last to be shown.
    asked: u64,
    /// Where the terminal was when both were last in step; `None` before they ever were.
    seen: Option<Seen>,
}

/// How far a window is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stage {
    /// There is none.
    #[default]
    Shut,
    /// Its skeleton grows, or its program starts.
    Opening,
    /// It is there.
    Open,
}

/// Where the terminal is, of what a window can be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// The frame that is shown.
    pub frame: u32,
    /// The bone that is chosen among those listed, else the selected track.
    pub chosen: Option<Chosen>,
}

impl Seen {
    /// As things stand.
    #[must_use]
    pub fn of(state: &State) -> Self {
        let is_listed = state.panel == Some(Panel::Skeleton) || matches!(state.mode, Mode::Shape(_));
        let bone = state.skeleton.chosen.filter(|_| is_listed).map(Chosen::Bone);
        let track = || state.selected.map(|track| Chosen::Track(u64::from(track.0)));
        Self { frame: state.shown_frame(), chosen: bone.or_else(track) }
    }
}

impl Window {
    /// It is opened, on what there is to show now.
    pub fn open(&mut self) {
        *self =
            Self { stage: Stage::Opening, revision: self.revision, asked: self.revision, ..Self::default() };
    }

    /// It is gone.
    pub fn shut(&mut self) {
        *self = Self { revision: self.revision, ..Self::default() };
    }

    /// What it shows is another now.
    pub fn outdate(&mut self) {
        self.revision += 1;
    }

    /// Whether it is to be shown what has changed; once.
    pub fn is_outdated(&mut self) -> bool {
        self.stage != Stage::Shut && std::mem::replace(&mut self.asked, self.revision) != self.revision
    }

    /// Where the terminal is now; returns where it was when both were last in step.
    pub fn step(&mut self, now: Seen) -> Option<Seen> {
        self.seen.replace(now)
    }
}
