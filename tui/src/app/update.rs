//! What happens to the state: pure, from one state and one message to the next and the effects it asks for.

mod actions;
mod edit;
mod facts;
mod groups;
mod history;
mod logged;
mod look;
mod motion;
mod mouse;
mod moving;
mod offers;
mod paint;
mod pick;
mod queue;
mod ranges;
mod recovery;
mod scale;
mod shaping;
mod skeleton;
mod sketch;
mod time;
mod tracks;
mod versus;
mod window;

use std::ops::Range;
use std::time::Duration;

use honami_model::document::RunId;
use honami_model::edit::Transaction;
use honami_model::history::EntryId;
use honami_model::track::TrackId;
use honami_workbench::cluster::ClusterRequest;
use honami_workbench::correct::Step;
use honami_workbench::offer::Wish;
use honami_workbench::progress::Patience;
use honami_workbench::regroup;
use honami_workbench::retrack;
use honami_workbench::scale::ScaleBar;
use honami_workbench::scene::control;
use honami_workbench::shape;
use honami_workbench::track::TrackRequest;

use super::action::{Action, Context};
use super::correcting::Ask;
use super::files::Lead;
use super::keymap::Found;
use super::lesson;
use super::menu::{Choice, Menu};
use super::painting::Plane;
use super::state::{Mode, Notice, State};
use super::typing::{self, TYPED_MAX, append};
use crate::term::input::{Mouse, MouseKind};
use crate::term::key::Key;

pub use facts::Fact;
pub use logged::{again, stand_by};
pub use queue::Judge;
pub(super) use time::{LOOP_MAX, RATES};

/// Something that happens to the state.
#[derive(Debug)]
pub enum Msg {
    /// A key was pressed.
    Key(Key),
    /// The mouse did something.
    Mouse(Mouse),
    /// Text was pasted.
    Paste(String),
    /// The terminal has another size.
    Resize(u16, u16),
    /// It is so late.
    Clock(Duration),
    /// The world has changed.
    Fact(Fact),
}

/// What may be done after an edit, as its line says it.
pub type Hint = &'static str;

/// The usual one.
const UNDO: Hint = "u undoes";

/// Something that the state wants done in the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Commit an edit, and say what may be done next.
    Commit(Transaction, Hint),
    /// Correct whole tracks or ranges of them, and say what may be done next.
    Correct(Step, Hint),
    /// Change the shown groups by hand, and say what may be done next.
    Regroup(regroup::Step, Hint),
    /// Do hand work on the skeleton of the shown groups, and say what may be done next.
    Shape(shape::Step, Hint),
    /// Tell what a track is made from, now and after every change until an edit is committed.
    Study(TrackId),
    /// Work something out behind the screen for the studied track.
    Offer(Ask),
    /// Keep what was found for a wish, and say what may be done next.
    Keep(Wish, Hint),
    /// Place a new track here; its number is the project's to give.
    AddFeature {
        /// Frame of its first key-frame.
        frame: u32,
        /// Where, image pixels.
        at: [f32; 2],
    },
    /// Keep a verdict on a segment.
    Judge(Judge),
    /// Take back so many edits.
    Undo(u32),
    /// Do so many again.
    Redo(u32),
    /// Go to an entry of the undo tree.
    Jump(EntryId),
    /// Run a tracker.
    Track(TrackRequest),
    /// Track again from the key-frames round a frame.
    Retrack {
        /// The track.
        track: TrackId,
        /// The direction.
        way: retrack::Way,
        /// Where the cursor is.
        frame: u32,
        /// The marked range: nothing outside it changes.
        within: Option<Range<u32>>,
    },
    /// Measure dense motion with the tracker of this track.
    Measure(Option<TrackId>),
    /// Put these two runs beside each other; `None`: the newest two.
    Versus(Option<[RunId; 2]>),
    /// List the runs that can be beside each other; with the first of them chosen, those that can be beside it.
    Entrants(Option<RunId>),
    /// Run a clusterer.
    Cluster(ClusterRequest),
    /// Tell what the project keeps of the matte of this frame.
    LookAtMatte(u32),
    /// Find the matte of a frame, of so many strokes, by these marks.
    FindMatte(u32, usize, Plane),
    /// Keep the matte that was found of this frame, and say what may be done next.
    KeepMatte(u32, Hint),
    /// Keep this scale bar, or take the one away that there is, and say what may be done next.
    Scale(Option<ScaleBar>, Hint),
    /// Go on with this run, or with the newest that has ended early.
    Resume(Option<RunId>),
    /// Let the plugin of this id start again.
    Release(String),
    /// Wait for the silent plugin of the running job, or end its process.
    Silent(Patience),
    /// Stop the running job; it keeps what it has.
    StopJob,
    /// Follow a lead among files: to another project or clip, or to what there is in a folder.
    Follow(Lead),
    /// Leave for the tutorial.
    Teach,
    /// Save this log beside the project.
    SaveLog(String),
    /// Take the mouse, or leave it to the terminal.
    Mouse(bool),
    /// Paint the screen anew.
    Redraw,
    /// Stop the program until it is continued.
    Suspend,
    /// Open the viewer's window on the skeleton of the shown groups.
    OpenWindow,
    /// Show it what has become of that skeleton.
    ShowWindow,
    /// Tell it.
    Tell(control::Command),
    /// Change the project as was asked for there, and say what may be done next.
    Edit(control::Event, Hint),
    /// Close it.
    CloseWindow,
    /// Leave.
    Leave,
}

/// The next state, and what is to be done.
pub fn update(state: &mut State, msg: Msg) -> Vec<Effect> {
    let is_key = matches!(msg, Msg::Key(_));
    let is_led = matches!(msg, Msg::Fact(Fact::Window(_)));
    let mut effects = match msg {
        Msg::Key(key) => {
            pressed(state);
            on_key(state, key)
        }
        Msg::Mouse(mouse) => {
            if matches!(mouse.kind, MouseKind::Press(_)) {
                pressed(state);
            }
            logged::mouse(state, mouse);
            mouse::on_mouse(state, mouse)
        }
        Msg::Paste(text) => {
            on_text(state, &typing::pasted(&text));
            Vec::new()
        }
        Msg::Resize(columns, rows) => {
            state.size = (columns, rows);
            logged::screen(state);
            Vec::new()
        }
        Msg::Clock(now) => {
            time::on_clock(state, now);
            Vec::new()
        }
        Msg::Fact(Fact::Window(heard)) => window::on_heard(state, heard),
        Msg::Fact(fact) => {
            facts::on_fact(state, fact);
            Vec::new()
        }
    };
    if !is_key {
        effects.extend(offers::release(state));
    }
    effects.extend(offers::asks(state));
    effects.extend(window::keep_step(state, is_led));
    lesson::follow(state);
    effects
}

/// A key counts for the open item, as long as its track is the selected one; else for that of the track which is.
fn pressed(state: &mut State) {
    let (now, is_its) = (state.now, state.opened().is_some());
    if let Some(opened) = &mut state.opened {
        if is_its { opened.pressed(now) } else { opened.waited(now) }
    }
    queue::visit(state);
}

/// Largest number before a command.
const COUNT_MAX: u32 = 999_999;
/// Longest name of a track or a group, characters.
const NAME_MAX: usize = 60;

fn on_key(state: &mut State, key: Key) -> Vec<Effect> {
    if !state.held.is_empty() {
        offers::hold_more(state, key);
        return Vec::new();
    }
    let context = state.mode.context();
    state.pending.push(key);
    match state.keys.find(context, &state.pending) {
        found if offers::hold(state, found) => Vec::new(),
        Found::Prefix => Vec::new(),
        Found::Action(action) => {
            state.pending.clear();
            state.notice = None;
            call(state, action)
        }
        Found::Nothing => {
            let is_whole = state.pending.len() == 1;
            state.pending.clear();
            if let Some(c) = key.text().filter(|_| is_whole) {
                on_text(state, c.encode_utf8(&mut [0; 4]));
            } else {
                state.count = None;
            }
            Vec::new()
        }
    }
}

/// Characters that are no command here: text, or digits of a count.
fn on_text(state: &mut State, text: &str) {
    logged::text(state, text);
    let mut chars = text.chars();
    match &mut state.mode {
        Mode::Menu(menu) => menu.type_in(chars),
        Mode::Prompt(typed) => append(typed, chars.filter(char::is_ascii_digit), 9),
        Mode::Name(typed) | Mode::GroupName(typed) => append(typed, chars, NAME_MAX),
        Mode::Scale(scaling) if scaling.is_typing() => append(&mut scaling.typed, chars, NAME_MAX),
        Mode::Form(form) => {
            if form.typed.is_none()
                && let Some(first) = chars.next()
            {
                form.type_first(first);
            }
            if let Some(typed) = &mut form.typed {
                append(typed, chars, TYPED_MAX);
            }
        }
        Mode::Label(_) => chars.for_each(|c| pick::type_label(state, c)),
        Mode::Review
        | Mode::Place(_)
        | Mode::Root(_)
        | Mode::Shape(_)
        | Mode::Move(_)
        | Mode::Sketch(_)
        | Mode::Paint(_)
        | Mode::Scale(_)
        | Mode::Dial(_)
        | Mode::History { .. } => {
            for c in chars {
                state.count = c.to_digit(10).map(|digit| {
                    state.count.unwrap_or(0).saturating_mul(10).saturating_add(digit).min(COUNT_MAX)
                });
            }
        }
    }
}

/// Does an action and forgets its count.
fn call(state: &mut State, action: Action) -> Vec<Effect> {
    let action = queue::meant(state, action);
    logged::action(state, action);
    let effects = actions::act(state, action);
    state.is_leaving &= action == Action::Leave;
    state.count = None;
    effects
}

/// Says something in one line.
fn say(state: &mut State, text: impl Into<String>) {
    tell(state, Notice { text: text.into(), is_error: false });
}

/// Says that something cannot be done.
fn complain(state: &mut State, text: impl Into<String>) {
    tell(state, Notice { text: text.into(), is_error: true });
}

fn tell(state: &mut State, notice: Notice) {
    logged::said(state, &notice);
    state.notice = Some(notice);
}

/// Closes the menu and does what was chosen in it.
fn choose(state: &mut State) -> Vec<Effect> {
    let Mode::Menu(menu) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let choice = menu.choice();
    state.mode = menu.below;
    match choice {
        Some(Choice::Action(action)) => call(state, action),
        Some(Choice::Track(track)) => {
            time::select(state, track);
            Vec::new()
        }
        Some(Choice::Swap(track)) => tracks::swap(state, track),
        Some(Choice::Join(track)) => tracks::join(state, track),
        Some(Choice::MergeGroup(group)) => groups::merge(state, group),
        Some(Choice::TakeInto(group)) => groups::take(state, group),
        Some(Choice::Frame(frame)) => {
            time::go(state, frame);
            Vec::new()
        }
        Some(Choice::Plugin(at)) => {
            actions::open_plugin(state, at);
            Vec::new()
        }
        Some(Choice::First(a)) => vec![Effect::Entrants(Some(a))],
        Some(Choice::Second(a, b)) => vec![Effect::Versus(Some([a, b]))],
        Some(Choice::File(lead)) => vec![Effect::Follow(lead)],
        None => Vec::new(),
    }
}

/// Opens a menu over what is open.
fn open_menu(state: &mut State, asked: Action) {
    let below = std::mem::replace(&mut state.mode, Mode::Review);
    debug_assert!(below.context() != Context::Menu, "a menu lists no menus");
    let menu = Menu::of_actions(asked, &state.keys, below.context());
    state.mode = Mode::Menu(Box::new(menu.over(below)));
}

#[cfg(test)]
mod bindings_tests;
#[cfg(test)]
mod groups_tests;
#[cfg(test)]
mod keys_tests;
#[cfg(test)]
mod offers_tests;
#[cfg(test)]
mod paint_tests;
#[cfg(test)]
mod queue_tests;
#[cfg(test)]
mod scale_tests;
#[cfg(test)]
mod skeleton_tests;
#[cfg(test)]
mod sketch_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tracks_tests;
#[cfg(test)]
mod versus_tests;
#[cfg(test)]
mod window_tests;
