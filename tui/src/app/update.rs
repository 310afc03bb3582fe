//! What happens to the state: pure, from one state and one message to the next and the effects it asks for.

mod actions;
mod edit;
mod facts;
mod mouse;
mod time;

use std::time::Duration;

use honami_model::edit::Transaction;
use honami_workbench::plugins::Values;

use super::action::{Action, Context};
use super::form::Task;
use super::keymap::Found;
use super::menu::{Choice, Menu};
use super::state::{Mode, Notice, State};
use crate::term::input::Mouse;
use crate::term::key::Key;

pub use facts::Fact;

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

/// Something that the state wants done in the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Commit an edit.
    Commit(Transaction),
    /// Place a new track here; its number is the project's to give.
    AddFeature {
        /// Frame of its first key-frame.
        frame: u32,
        /// Where, image pixels.
        at: [f32; 2],
    },
    /// Take back the last edit.
    Undo,
    /// Do it again.
    Redo,
    /// Run a plugin.
    Run {
        /// What for.
        task: Task,
        /// Its short name.
        plugin: String,
        /// Its parameters.
        values: Values,
        /// Follow the tracks that are there instead of looking for features.
        existing: bool,
        /// Look for new features every so many frames.
        every: Option<u32>,
    },
    /// Stop the running job; it keeps what it has.
    StopJob,
    /// Paint the screen anew.
    Redraw,
    /// Stop the program until it is continued.
    Suspend,
    /// Leave.
    Leave,
}

/// The next state, and what is to be done.
pub fn update(state: &mut State, msg: Msg) -> Vec<Effect> {
    match msg {
        Msg::Key(key) => on_key(state, key),
        Msg::Mouse(mouse) => mouse::on_mouse(state, mouse),
        Msg::Paste(text) => {
            text.chars().filter(|c| !c.is_control()).for_each(|c| on_text(state, c));
            Vec::new()
        }
        Msg::Resize(columns, rows) => {
            state.size = (columns, rows);
            Vec::new()
        }
        Msg::Clock(now) => {
            time::on_clock(state, now);
            Vec::new()
        }
        Msg::Fact(fact) => {
            facts::on_fact(state, fact);
            Vec::new()
        }
    }
}

/// Largest number before a command.
const COUNT_MAX: u32 = 999_999;

fn on_key(state: &mut State, key: Key) -> Vec<Effect> {
    let context = state.mode.context();
    state.pending.push(key);
    match state.keys.find(context, &state.pending) {
        Found::Prefix => Vec::new(),
        Found::Action(action) => {
            state.pending.clear();
            state.notice = None;
            let effects = actions::act(state, action);
            state.count = None;
            effects
        }
        Found::Nothing => {
            let is_whole = state.pending.len() == 1;
            state.pending.clear();
            if let Some(c) = key.text().filter(|_| is_whole) {
                on_text(state, c);
            } else {
                state.count = None;
            }
            Vec::new()
        }
    }
}

/// A character that is no command here: text, or a digit of a count.
fn on_text(state: &mut State, c: char) {
    match &mut state.mode {
        Mode::Menu(menu) => menu.retype(|typed| typed.push(c)),
        Mode::Prompt(typed) if c.is_ascii_digit() && typed.len() < 9 => typed.push(c),
        Mode::Form(form) => match &mut form.typed {
            Some(typed) => typed.push(c),
            None => form.type_first(c),
        },
        Mode::Review | Mode::Place(_) | Mode::Move { .. } => {
            state.count = c.to_digit(10).map(|digit| {
                state.count.unwrap_or(0).saturating_mul(10).saturating_add(digit).min(COUNT_MAX)
            });
        }
        Mode::Prompt(_) => {}
    }
}

/// Calls an action as the palette, the help and the mouse do.
fn call(state: &mut State, action: Action) -> Vec<Effect> {
    let effects = actions::act(state, action);
    state.count = None;
    effects
}

/// Says something in one line.
fn say(state: &mut State, text: impl Into<String>) {
    state.notice = Some(Notice { text: text.into(), is_error: false });
}

/// Says that something cannot be done.
fn complain(state: &mut State, text: impl Into<String>) {
    state.notice = Some(Notice { text: text.into(), is_error: true });
}

/// Closes the menu and does what was chosen in it.
fn choose(state: &mut State) -> Vec<Effect> {
    let Mode::Menu(menu) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let choice = menu.chosen().map(|row| row.choice);
    state.mode = menu.below;
    match choice {
        Some(Choice::Action(action)) => call(state, action),
        Some(Choice::Track(track)) => {
            time::select(state, track);
            Vec::new()
        }
        None => Vec::new(),
    }
}

/// Opens a menu over what is open.
fn open_menu(state: &mut State, title: &'static str) {
    let below = std::mem::replace(&mut state.mode, Mode::Review);
    debug_assert!(below.context() != Context::Menu, "a menu lists no menus");
    state.mode = Mode::Menu(Box::new(Menu::of_actions(title, &state.keys, below)));
}

#[cfg(test)]
mod tests;
