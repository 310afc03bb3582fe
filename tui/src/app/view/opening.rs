//! What is seen before a project is there.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{put, style};
use crate::app::action::{Action, Context};
use crate::app::keymap::KeyMap;
use crate::term::encode::Frame;

/// The screen while something is opened: what, how far it is, and how to go back, where that leads somewhere, or leave.
#[must_use]
pub fn opening(
    name: &str,
    what: &str,
    keys: &KeyMap,
    has_way_back: bool,
    (columns, rows): (u16, u16),
) -> Frame {
    let mut frame = Frame::new(columns, rows);
    let all = Rect::new(0, 0, columns, rows);
    let title = vec![Span::styled(name.to_owned(), style::BOLD), Span::styled("  opening …", style::DIM)];
    put(&mut frame, all, 0, &Line::from(title));
    put(&mut frame, all, rows / 2, &Line::styled(what.to_owned(), style::DIM).centered());
    let hint = [(Action::Back, " back  ", has_way_back), (Action::Quit, " leave", true)];
    let hint = hint.into_iter().filter(|(.., is_there)| *is_there).flat_map(|(action, word, _)| {
        let keys = keys.keys_of(Context::Review, action).unwrap_or_default();
        [Span::styled(keys, style::ACCENT), Span::styled(word, style::DIM)]
    });
    let hint: Vec<Span<'_>> = hint.collect();
    put(&mut frame, all, rows.saturating_sub(1), &Line::from(hint).right_aligned());
    frame
}
