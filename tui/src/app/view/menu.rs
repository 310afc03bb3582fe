//! Lists over the picture: palette, help, tracks; and what may follow a prefix.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{fill, padded, panel, put, style};
use crate::app::keymap::shown;
use crate::app::menu::Menu;
use crate::app::state::State;
use crate::term::encode::Frame;

/// Cells of the panel, at most: what every action does can be read in full.
const WIDTH: u16 = 140;
/// Cells of the names.
const LABEL: usize = 20;
/// Cells of the keys.
const KEYS: usize = 14;
/// Cells of what a row does, least: fewer say nothing.
const DETAIL: usize = 16;

/// Rows of the panel: the head, and the list.
fn n_rows(menu: &Menu) -> u16 {
    u16::try_from(menu.rows().len()).unwrap_or(u16::MAX).max(1).saturating_add(1)
}

/// The row of the list that lies in a row of the screen.
pub(super) fn row_at(menu: &Menu, area: Rect, row: u16) -> Option<usize> {
    let height = n_rows(menu).min(area.height);
    let y = row.checked_sub(area.bottom() - height)?.checked_sub(1)?;
    let first = menu.at.saturating_sub(usize::from(height.saturating_sub(1)).max(1) - 1);
    Some(first + usize::from(y)).filter(|at| row < area.bottom() && *at < menu.rows().len())
}

pub(super) fn draw(menu: &Menu, area: Rect, frame: &mut Frame) {
    let inside = panel(frame, area, WIDTH, n_rows(menu));
    // What the chosen row does, in full; before anything is chosen by typing, what the list is.
    let about = match menu.chosen().filter(|_| !menu.typed.is_empty() || menu.at > 0) {
        Some(row) => row.detail.clone(),
        None => format!("{}: type a part of a name", menu.title),
    };
    let head = Line::from(vec![
        Span::styled(":", style::ACCENT),
        Span::styled(format!("{}▏", menu.typed), style::BOLD),
        Span::styled(format!("  {about}"), style::DIM),
    ]);
    put(frame, inside, 0, &head);
    let n_listed = usize::from(inside.height.saturating_sub(1)).max(1);
    let first = menu.at.saturating_sub(n_listed - 1);
    let keys_width = if menu.rows().any(|row| !row.keys.is_empty()) { KEYS } else { 0 };
    let is_detailed = usize::from(inside.width) >= LABEL + keys_width + DETAIL;
    for (y, (i, row)) in (1..inside.height).zip(menu.rows().enumerate().skip(first).take(n_listed)) {
        let line = Line::from(vec![
            Span::raw(format!("{} ", padded(&row.label, LABEL))),
            Span::styled(padded(&row.keys, keys_width + 1), style::ACCENT),
            Span::styled(if is_detailed { row.detail.as_str() } else { "" }, style::DIM),
        ]);
        put(frame, inside, y, &line);
        if i == menu.at {
            let bar = Rect { x: inside.x, y: inside.y + y, width: inside.width, height: 1 };
            frame.cells.set_style(bar, style::CHOSEN);
        }
    }
    if menu.rows().len() == 0 {
        put(frame, inside, 1, &Line::styled("nothing matches; Backspace takes letters back", style::DIM));
    }
}

/// What may follow the keys typed so far, at once. Where the rows do not suffice, names stand in columns.
pub(super) fn which_key(state: &State, area: Rect, frame: &mut Frame) {
    let context = state.mode.context();
    let follow: Vec<_> = state.keys.after(context, &state.pending).collect();
    let n_columns = follow.len().div_ceil(usize::from(area.height.max(1))).max(1);
    let n_rows = follow.len().div_ceil(n_columns);
    let height = u16::try_from(n_rows).unwrap_or(u16::MAX).min(area.height);
    let rows = Rect { y: area.bottom() - height, height, ..area };
    fill(frame, rows, style::PANEL);
    let width = rows.width.saturating_sub(2) / u16::try_from(n_columns).unwrap_or(u16::MAX);
    let gap = u16::from(n_columns > 1);
    let columns =
        (0..).map(|column| Rect { x: rows.x + 1 + column * width, width: width.saturating_sub(gap), ..rows });
    for (column, bindings) in columns.zip(follow.chunks(n_rows.max(1))) {
        for (y, binding) in (0..).zip(bindings) {
            let rest =
                Span::styled(format!("{:<4}", shown(&binding.keys[state.pending.len()..])), style::ACCENT);
            let info = binding.action.info();
            let line = if n_columns == 1 {
                let typed = Span::styled(format!("{:<3} ", shown(&state.pending)), style::DIM);
                Line::from(vec![typed, rest, Span::raw(info.doc)])
            } else {
                Line::from(vec![rest, Span::raw(info.name.replace('-', " "))])
            };
            put(frame, column, y, &line);
        }
    }
}
