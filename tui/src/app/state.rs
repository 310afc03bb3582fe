//! All that the terminal UI knows. Plain data: it is changed only by [`update`](super::update::update).

use std::collections::BTreeSet;
use std::time::Duration;

use honami_model::clip::Clip;
use honami_model::track::TrackId;
use honami_workbench::review::Review;
use honami_workbench::scale::ScaleBar;

use super::action::Context;
use super::before::Before;
use super::clock::Play;
use super::command_log::CommandLog;
use super::correcting::{Moving, Tool};
use super::dense::Dense;
use super::form::{Form, Plugin, Used};
use super::groups::Groups;
use super::history::Tree;
use super::in_space::InSpace;
use super::keymap::KeyMap;
use super::lesson::Lesson;
use super::menu::Menu;
use super::motion::Motion;
use super::painting::Painting;
use super::panel::Panel;
use super::plotted::Plotted;
use super::prints::Prints;
use super::queue::{Looked, Opened};
use super::ranging::Ranging;
use super::recovery::Recovery;
use super::scaling::Scaling;
use super::skeleton::{Shaping, Skeletal};
use super::sketching::Sketching;
use super::tracks::TrackRow;
use super::versus::Versus;
use super::view::theme::Theme;
use super::window::Window;
use crate::term::capabilities::Pixels;
use crate::term::colour::Depth;
use crate::term::glyph::Glyphs;
use crate::term::key::Key;

/// The state of the terminal UI.
#[derive(Clone, Debug)]
pub struct State {
    /// What the project is called in the title.
    pub name: String,
    /// The clip.
    pub clip: Clip,
    /// The current frame.
    pub frame: u32,
    /// Playing, or not.
    pub play: Option<Play>,
    /// Whether the last action was to leave, and something unfinished was asked about.
    pub is_leaving: bool,
    /// Rates of the two ways to play, percent of real time: as it was, and slow.
    pub rates: [u32; 2],
    /// A loop reaches this many frames to both sides.
    pub loop_frames: u32,
    /// Pictures per second that were shown and that were due, where some were dropped.
    pub dropped: Option<[u32; 2]>,
    /// The shown tracks, in order of their numbers.
    pub tracks: Vec<TrackRow>,
    /// The track that keys work on.
    pub selected: Option<TrackId>,
    /// The track that keys worked on when it went, with an edit that was undone: it is selected when it is there again.
    pub missed: Option<TrackId>,
    /// The track that was placed or moved by hand since the last run: the next run is likely for it.
    pub corrected: Option<TrackId>,
    /// Tracks that are picked for work on all of them.
    pub picked: BTreeSet<TrackId>,
    /// The range of frames to work on.
    pub range: Option<Ranging>,
    /// Whether tracks are listed by doubt, not by number.
    pub by_doubt: bool,
    /// What there is to review.
    pub review: Review,
    /// The item of the queue that is being looked at.
    pub opened: Option<Opened>,
    /// Items that were opened before it.
    pub looked: Looked,
    /// Where to go back to when the project refuses what was asked of it last.
    pub before: Option<Box<Before>>,
    /// The shown clustering.
    pub groups: Option<Groups>,
    /// Tracks in space, as two cameras see them.
    pub space: Option<InSpace>,
    /// The scale bar that says what a pixel is.
    pub scale: Option<ScaleBar>,
    /// The tracker whose run is on top, with its version.
    pub tracker: Option<String>,
    /// Trackers and clusterers that were found.
    pub plugins: Vec<Plugin>,
    /// What they were told last.
    pub used: Vec<Used>,
    /// What keys mean now.
    pub mode: Mode,
    /// The live key map.
    pub keys: KeyMap,
    /// Keys of a sequence that is not whole yet.
    pub pending: Vec<Key>,
    /// The number typed before a command.
    pub count: Option<u32>,
    /// Colours of motion over the picture.
    pub motion: Motion,
    /// Dense motion, where the colours show that; `None`: that of the tracks.
    pub dense: Option<Dense>,
    /// Two runs over the picture, instead of the tracks.
    pub versus: Option<Box<Versus>>,
    /// The skeleton of the shown groups, over the picture.
    pub skeleton: Skeletal,
    /// The viewer's window beside the terminal.
    pub window: Window,
    /// Whether all tracks are marked in the picture, not only the selected one.
    pub marks_all: bool,
    /// What the plots show.
    pub plotted: Plotted,
    /// Whether the panel lies over all of the picture.
    pub panel_is_wide: bool,
    /// What the column shows; `None` hides it.
    pub panel: Option<Panel>,
    /// Steps of magnification, each twice the last: 0 shows all of the picture. See [`Lens`](super::layout::Lens).
    pub zoom: u8,
    /// Image point in the middle when magnified, pixels.
    pub centre: [f32; 2],
    /// Cell at which the mouse last was while the view is dragged.
    pub dragged: Option<(u16, u16)>,
    /// Whether the selected track stays in the middle.
    pub follow: bool,
    /// Columns and rows of the terminal.
    pub size: (u16, u16),
    /// What happened last.
    pub notice: Option<Notice>,
    /// The job that is running.
    pub job: Option<Job>,
    /// What can be done about work that has ended early.
    pub recovery: Option<Recovery>,
    /// Who holds the project, where it can only be read.
    pub read_only: Option<String>,
    /// What is known of the link to the terminal.
    pub link: Link,
    /// Time since the session began.
    pub now: Duration,
    /// Frames that can be shown without waiting.
    pub n_ready: u32,
    /// The terminal has no colours: marks are letters.
    pub mono: bool,
    /// Which characters the user wants for the picture.
    pub glyphs: Glyphs,
    /// Whether a picture that stays is shown in the terminal's own pixels, where it has such.
    pub stills: bool,
    /// What is known of the terminal.
    pub display: Display,
    /// The undo tree.
    pub history: Tree,
    /// The themes there are.
    pub themes: Vec<Theme>,
    /// The one in use.
    pub theme: usize,
    /// Whether the mouse is ours, not the terminal's.
    pub mouse: bool,
    /// The tutorial, in a project made for it.
    pub lesson: Option<Lesson>,
    /// What plugins have printed and logged.
    pub prints: Prints,
    /// What was done in this session.
    pub log: CommandLog,
    /// Keys that wait until a correction is worked out that they keep.
    pub held: Vec<Key>,
    /// Whether corrections are worked out behind the screen.
    pub is_asking: bool,
}

/// What keys mean.
#[derive(Clone, Debug)]
pub enum Mode {
    /// Looking at the clip and its tracks.
    Review,
    /// Choosing where a new feature goes; image pixels.
    Place([f32; 2]),
    /// Choosing where the root of the skeleton is; image pixels.
    Root([f32; 2]),
    /// Shaping a bone of the skeleton.
    Shape(Box<Shaping>),
    /// Moving a sample of the selected track.
    Move(Box<Moving>),
    /// Drawing the selected track.
    Sketch(Box<Sketching>),
    /// Painting what is plant and what lies behind it.
    Paint(Box<Painting>),
    /// Setting a scale bar.
    Scale(Box<Scaling>),
    /// Setting the parameters of a plugin.
    Form(Box<Form>),
    /// Choosing from a list.
    Menu(Box<Menu>),
    /// Setting which directions of motion are shown: what was set before.
    Dial(Motion),
    /// Typing a frame number.
    Prompt(String),
    /// Typing a name for the selected track.
    Name(String),
    /// Typing a name for the selected track's group.
    GroupName(String),
    /// Typing the letters on a track.
    Label(String),
    /// Going about in the undo tree.
    History {
        /// The chosen row.
        at: usize,
        /// The panel that was shown before.
        below: Option<Panel>,
    },
}

impl Mode {
    /// Where keys are read.
    #[must_use]
    pub fn context(&self) -> Context {
        match self {
            Self::Review => Context::Review,
            Self::Place(_) | Self::Root(_) => Context::Place,
            Self::Shape(_) => Context::Shape,
            Self::Move(moving) => match moving.tool {
                Tool::Place { .. } => Context::Move,
                Tool::Slide(_) => Context::Slide,
            },
            Self::Sketch(_) => Context::Sketch,
            Self::Paint(_) => Context::Paint,
            Self::Scale(scaling) if scaling.is_typing() => Context::Prompt,
            Self::Scale(_) => Context::Scale,
            Self::Form(form) if form.typed.is_some() => Context::Prompt,
            Self::Form(_) => Context::Form,
            Self::Menu(_) => Context::Menu,
            Self::Dial(_) => Context::Dial,
            Self::Prompt(_) | Self::Name(_) | Self::GroupName(_) => Context::Prompt,
            Self::Label(_) => Context::Label,
            Self::History { .. } => Context::History,
        }
    }
}

/// One line that says what happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// The line.
    pub text: String,
    /// Whether something failed.
    pub is_error: bool,
}

/// A job that is running.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Short name of the plugin.
    pub plugin: String,
    /// What is being done now.
    pub what: String,
    /// Steps done, and in all (0 while unknown).
    pub done: (u64, u64),
    /// The frame of the clip that is its first step, where its steps are frames; else 0.
    pub first: u64,
    /// When it began.
    pub since: Duration,
    /// What stopping it keeps: the frames so far, or nothing.
    pub keeps_frames: bool,
    /// Whether it has been told to stop.
    pub is_stopping: bool,
    /// The frame of the clip that its plugin is at; what is written may be less.
    pub frame: Option<u32>,
    /// A plugin of it that gives no sign of life.
    pub quiet: Option<Quiet>,
}

/// A plugin that gives no sign of life.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quiet {
    /// Its short name.
    pub plugin: String,
    /// The frame of the clip that it is at, where it is at one.
    pub frame: Option<u32>,
    /// For how long, seconds.
    pub seconds: u64,
    /// After so many seconds its user is asked.
    pub limit_s: u64,
    /// What it last said that it was at.
    pub at: String,
    /// Whether it is asked what is to become of it.
    pub is_asked: bool,
}

impl Quiet {
    /// Whoever waits for it is asked again after so many seconds of silence: twice as many as now, and as is usual.
    #[must_use]
    pub fn again_s(&self) -> u64 {
        2 * self.seconds.max(self.limit_s)
    }
}

/// What is known of the terminal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Display {
    /// How many colours it shows.
    pub depth: Depth,
    /// How pixels get to it, if they do.
    pub pixels: Option<Pixels>,
}

/// What is known of the link to the terminal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// Delay there and back, milliseconds.
    pub delay_ms: Option<u32>,
    /// What it carries, kB/s.
    pub rate_kbs: Option<u32>,
    /// The terminal does not answer.
    pub is_silent: bool,
    /// How long pictures take that wait for others on the way, milliseconds, and the bytes of one; `None` while none
    /// waits longer than another delay.
    pub late: Option<[u32; 2]>,
}

impl State {
    /// Whether a sample is moved whose correction is still being worked out.
    #[must_use]
    pub fn awaits_ghost(&self) -> bool {
        matches!(&self.mode, Mode::Move(moving) if moving.is_pending())
    }

    /// The state before anything is known of the project.
    #[must_use]
    pub fn new(name: String, clip: Clip, size: (u16, u16)) -> Self {
        let centre = [clip.width as f32 / 2.0, clip.height as f32 / 2.0];
        Self {
            name,
            clip,
            frame: 0,
            play: None,
            is_leaving: false,
            rates: [100, 50],
            loop_frames: 8,
            dropped: None,
            tracks: Vec::new(),
            selected: None,
            missed: None,
            corrected: None,
            picked: BTreeSet::new(),
            range: None,
            by_doubt: false,
            review: Review::default(),
            opened: None,
            looked: Looked::default(),
            before: None,
            groups: None,
            space: None,
            scale: None,
            tracker: None,
            plugins: Vec::new(),
            used: Vec::new(),
            mode: Mode::Review,
            keys: KeyMap::default(),
            pending: Vec::new(),
            count: None,
            motion: Motion::default(),
            dense: None,
            versus: None,
            skeleton: Skeletal::default(),
            window: Window::default(),
            marks_all: true,
            plotted: Plotted::default(),
            panel_is_wide: false,
            panel: None,
            zoom: 0,
            centre,
            dragged: None,
            follow: false,
            size,
            notice: None,
            job: None,
            recovery: None,
            read_only: None,
            link: Link::default(),
            now: Duration::ZERO,
            n_ready: 0,
            mono: false,
            glyphs: Glyphs::default(),
            stills: true,
            display: Display::default(),
            history: Tree::default(),
            themes: Theme::all(),
            theme: 0,
            mouse: true,
            lesson: None,
            prints: Prints::default(),
            log: CommandLog::default(),
            held: Vec::new(),
            is_asking: false,
        }
    }

    /// Number of the last frame.
    #[must_use]
    pub fn last_frame(&self) -> u32 {
        self.clip.n_frames().saturating_sub(1)
    }

    /// The selected track.
    #[must_use]
    pub fn selected_row(&self) -> Option<&TrackRow> {
        self.row(self.selected?)
    }

    /// The characters that show the picture: without colours, one brightness a cell.
    #[must_use]
    pub fn shown_glyphs(&self) -> Glyphs {
        if self.mono { Glyphs::Halves } else { self.glyphs }
    }

    /// The shown tracks, in the order of lists.
    #[must_use]
    pub fn listed(&self) -> Vec<&TrackRow> {
        let mut rows: Vec<&TrackRow> = self.tracks.iter().collect();
        if self.by_doubt {
            let suspicion =
                |row: &TrackRow| self.review.track(row.id).map_or(0.0, |standing| standing.suspicion);
            rows.sort_by(|a, b| suspicion(b).total_cmp(&suspicion(a)));
        }
        rows
    }

    /// The row of a track.
    #[must_use]
    pub fn row(&self, track: TrackId) -> Option<&TrackRow> {
        self.tracks.binary_search_by_key(&track, |row| row.id).ok().map(|i| &self.tracks[i])
    }

    /// Where the selected track is shown in the current frame, image pixels.
    #[must_use]
    pub fn selected_at(&self) -> Option<[f32; 2]> {
        self.selected_row()?.at(self.frame)
    }

    /// The frame to be shown: in a loop not the current one, which stays where it is.
    #[must_use]
    pub fn shown_frame(&self) -> u32 {
        match self.play {
            Some(play) if play.around.is_some() => play.frame(self.clip.times.as_slice(), self.now),
            _ => self.frame,
        }
    }

    /// When the next frame is due while playing; `None` at the end.
    #[must_use]
    pub fn next_tick(&self) -> Option<Duration> {
        self.play?.next(self.clip.times.as_slice(), self.now)
    }
}
