//! What is seen before a project is there.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{put, style};
use crate::app::action::{Action, Context};
use crate::app::keymap::KeyMap;
use crate::term::encode::Frame;

/// The screen while something is opened: what, how far it is, and how to leave.
#[must_use]
pub fn opening(name: &str, what: &str, keys: &KeyMap, (columns, rows): (u16, u16)) -> Frame {
    let mut frame = Frame::new(columns, rows);
    let all = Rect::new(0, 0, columns, rows);
    let title = vec![Span::styled(name.to_owned(), style::BOLD), Span::styled("  opening …", style::DIM)];
    put(&mut frame, all, 0, &Line::from(title));
    put(&mut frame, all, rows / 2, &Line::styled(what.to_owned(), style::DIM).centered());
    let leave = keys.keys_of(Context::Review, Action::Quit).unwrap_or_default();
    let hint = vec![Span::styled(leave, style::ACCENT), Span::styled(" leave", style::DIM)];
    put(&mut frame, all, rows.saturating_sub(1), &Line::from(hint).right_aligned());
    frame
}
