//! The log of a session: what its user did and what was said to it, a line each, to be read, saved and done again.
//!
//! Lines name actions, not keys, so they mean the same under every key map. docs/replay.md describes the format.

mod file;

use std::collections::VecDeque;

use honami_model::correct::Stroke;
use honami_workbench::scene::control::Event;
use serde::{Deserialize, Serialize};

use super::seat::Seat;
use super::state::{Notice, State};
use super::update::Judge;
use crate::term::input::MouseKind;

pub(super) use file::{LogFile, save};

/// Version of the format.
pub const FORMAT: u32 = 1;
/// So many lines are kept in memory; older ones go.
const N_KEPT: usize = 50_000;

/// The first line: where the session began.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Head {
    /// Version of the format.
    pub honami_log: u32,
    /// Version of the program.
    pub honami: String,
    #[serde(flatten)]
    pub(super) origin: Origin,
    /// Columns and rows of the terminal.
    pub screen: (u16, u16),
    /// The terminal had no colours.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mono: bool,
    /// Where the user was.
    pub(super) seat: Seat,
    /// Lines that were too many to be kept, and are not in the log.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<u64>,
}

/// Which project, in which state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Origin {
    /// What the project was called.
    pub(super) project: String,
    /// SHA-256 of the clip.
    pub(super) clip: String,
    /// The edit at which the document stood.
    pub(super) revision: u32,
}

impl Head {
    /// The first line of a session that begins in this state.
    pub(super) fn of(state: &State, origin: Origin) -> Self {
        Self {
            honami_log: FORMAT,
            honami: env!("CARGO_PKG_VERSION").to_owned(),
            origin,
            screen: state.size,
            mono: state.mono,
            seat: Seat::of(state),
            missing: None,
        }
    }
}

/// A line after the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// When, seconds since the session began.
    pub t_s: f64,
    /// What happened.
    #[serde(flatten)]
    pub what: What,
    /// Where the user was, if it was the user.
    #[serde(flatten)]
    pub here: Option<Here>,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum What {
    /// An action, by its name.
    Action(String),
    /// Text was typed or pasted.
    Text(String),
    /// The mouse did something.
    Mouse(Touch),
    /// Something was chosen in the viewer's window, or asked for there.
    Window(Event),
    /// Something was said.
    Notice(String),
    /// It was said that something failed.
    Error(String),
    /// The job of this plugin ended.
    Ended(String),
    /// The terminal had another size: columns and rows.
    Screen(u16, u16),
}

/// Where the user was when something was done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Here {
    /// Where keys were read.
    #[serde(rename = "in")]
    pub place: String,
    /// The current frame.
    pub frame: u32,
    /// The selected track.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub track: Option<u32>,
    /// Steps of magnification: nudges go by them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zoom: Option<u8>,
    /// The number before the action.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// The row of a list that was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<String>,
    /// The verdict that was given: which item was open was up to a queue that is filled while people work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub judged: Option<Judge>,
    /// What was drawn, and how late that was: links are as they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sketched: Option<Vec<Stroke>>,
    /// The skeleton was not there yet: how long it takes to grow is up to the machine.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub growing: bool,
}

/// What the mouse did, and where.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// What it did.
    pub kind: MouseKind,
    /// The cell of the screen.
    pub cell: (u16, u16),
    /// The image point there, pixels; none beside the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f32; 2]>,
}

impl Line {
    /// The line of something that was said.
    pub(super) fn said(t_s: f64, notice: &Notice) -> Self {
        let text = notice.text.clone();
        Self { t_s, what: if notice.is_error { What::Error(text) } else { What::Notice(text) }, here: None }
    }

    /// What was said, if something was.
    pub(super) fn notice(&self) -> Option<Notice> {
        match &self.what {
            What::Notice(text) => Some(Notice { text: text.clone(), is_error: false }),
            What::Error(text) => Some(Notice { text: text.clone(), is_error: true }),
            _ => None,
        }
    }
}

/// What was done in a session, the last `N_KEPT` lines of it.
#[derive(Clone, Debug, Default)]
pub struct CommandLog {
    head: Head,
    lines: VecDeque<Line>,
    n_gone: u64,
}

impl CommandLog {
    /// An empty log of a session that begins so.
    pub(super) fn new(head: Head) -> Self {
        Self { head, ..Self::default() }
    }

    pub(super) fn push(&mut self, line: Line) {
        if self.lines.len() == N_KEPT {
            self.lines.pop_front();
            self.n_gone += 1;
        }
        self.lines.push_back(line);
    }

    /// Adds to the last action what came of it.
    pub(super) fn judged(&mut self, judge: &Judge) {
        let is_action = |line: &&mut Line| matches!(line.what, What::Action(_));
        let last = self.lines.iter_mut().rev().find(is_action).and_then(|line| line.here.as_mut());
        last.into_iter().for_each(|here| here.judged = Some(judge.clone()));
    }

    /// The lines that are kept.
    #[must_use]
    pub fn lines(&self) -> &VecDeque<Line> {
        &self.lines
    }

    /// Number of lines so far, also those that are not kept any more.
    #[must_use]
    pub fn n(&self) -> u64 {
        self.n_gone + self.lines.len() as u64
    }

    /// The kept lines after the first `n` of all.
    pub fn since(&self, n: u64) -> impl Iterator<Item = &Line> {
        self.lines.iter().skip(usize::try_from(n.saturating_sub(self.n_gone)).unwrap_or(usize::MAX))
    }

    /// All of it as it is saved.
    #[must_use]
    pub fn text(&self) -> String {
        let missing = Some(self.n_gone).filter(|n| *n > 0);
        let mut text = json(&Head { missing, ..self.head.clone() });
        self.lines.iter().for_each(|line| text += &json(line));
        text
    }
}

/// A value as a line of its own.
fn json(value: &impl Serialize) -> String {
    // Numbers, words and names of fields: there is nothing that JSON cannot hold.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

/// Reads a saved log: its first line, and the others with their numbers.
///
/// A last line that was cut off, because the session was killed, is left out.
///
/// # Errors
/// A line that says which line is wrong, and how.
pub fn read(text: &str) -> Result<(Head, Vec<(usize, Line)>), String> {
    #[derive(Deserialize)]
    #[serde(rename_all = "kebab-case")]
    struct Tag {
        honami_log: u32,
    }
    let first = text.lines().next().unwrap_or_default();
    let tag: Tag = serde_json::from_str(first)
        .map_err(|error| format!("line 1: wanted the first line of a log of honami: {error}"))?;
    if tag.honami_log != FORMAT {
        return Err(format!("line 1: wanted a log of format {FORMAT}, got format {}", tag.honami_log));
    }
    let head: Head = serde_json::from_str(first).map_err(|error| format!("line 1: {error}"))?;
    if let Some(n) = head.missing {
        return Err(format!(
            "line 1: its first {n} lines were too many to be kept; honami PROJECT --log FILE writes them all"
        ));
    }
    let mut lines = Vec::new();
    for (number, piece) in (1..).zip(text.split_inclusive('\n')).skip(1) {
        match serde_json::from_str(piece) {
            Ok(line) => lines.push((number, line)),
            Err(_) if piece.trim().is_empty() || !piece.ends_with('\n') => {}
            Err(error) => return Err(format!("line {number}: {error}")),
        }
    }
    Ok((head, lines))
}

#[cfg(test)]
mod tests;
