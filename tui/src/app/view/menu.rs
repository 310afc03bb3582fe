//! Lists over the picture: palette, help, tracks; and what may follow a prefix.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::lines::wrapped;
use super::{fill, padded, panel, put, style, width};
use crate::app::action::Context;
use crate::app::keymap::{KeyMap, shown};
use crate::app::menu::{Menu, Row};
use crate::term::encode::Frame;
use crate::term::key::Key;

/// Cells of the panel, at most: what every action does can be read in full.
const WIDTH: u16 = 140;
/// Cells of the names.
const LABEL: usize = 20;
/// Cells of the keys.
const KEYS: usize = 14;
/// Cells of what a row does, least: fewer say nothing.
const DETAIL: usize = 16;

/// Cells of the keys' column: none in a list without keys.
fn keys_width(menu: &Menu) -> usize {
    if menu.rows().any(|row| !row.keys.is_empty()) { KEYS } else { 0 }
}

/// The rows of the list that stand in so many lines of so many cells, the chosen one among them: each with its place,
/// and what it does in the lines that this takes.
fn listed(menu: &Menu, columns: usize, n_lines: usize) -> Vec<(usize, Vec<String>)> {
    let rows: Vec<&Row> = menu.rows().collect();
    let room = columns.saturating_sub(LABEL + keys_width(menu) + 2);
    let lines = |at: usize| match rows[at].detail.as_str() {
        _ if room < DETAIL => vec![String::new()],
        detail if width(detail) <= room => vec![detail.to_owned()],
        detail => wrapped(detail, room),
    };
    let mut shown = Vec::new();
    let mut free = n_lines;
    for at in (0..rows.len().min(menu.at + 1)).rev() {
        let lines = lines(at);
        // The chosen row is seen as far as there is room.
        if lines.len() > free && !shown.is_empty() {
            break;
        }
        free = free.saturating_sub(lines.len());
        shown.insert(0, (at, lines));
    }
    for at in menu.at + 1..rows.len() {
        if free == 0 {
            break;
        }
        let lines = lines(at);
        free = free.saturating_sub(lines.len());
        shown.push((at, lines));
    }
    shown
}

/// Cells of a line of the list.
fn inner_width(area: Rect) -> usize {
    usize::from(area.width.min(WIDTH).saturating_sub(2))
}

/// Lines of the panel: the head, and the list.
fn n_lines(menu: &Menu, area: Rect) -> u16 {
    let room = usize::from(area.height.saturating_sub(1));
    let listed = listed(menu, inner_width(area), room);
    let n: usize = listed.iter().map(|(_, lines)| lines.len()).sum();
    u16::try_from(n.clamp(1, room.max(1))).unwrap_or(u16::MAX).saturating_add(1)
}

/// The row of the list that lies in a row of the screen.
pub(super) fn row_at(menu: &Menu, area: Rect, row: u16) -> Option<usize> {
    let height = n_lines(menu, area).min(area.height);
    let y = usize::from(row.checked_sub(area.bottom() - height)?.checked_sub(1)?);
    let listed = listed(menu, inner_width(area), usize::from(height.saturating_sub(1)));
    let mut places = listed.iter().flat_map(|(at, lines)| lines.iter().map(move |_| *at));
    places.nth(y).filter(|_| row < area.bottom())
}

pub(super) fn draw(menu: &Menu, area: Rect, frame: &mut Frame) {
    let inside = panel(frame, area, WIDTH, n_lines(menu, area));
    // What the chosen row does; before anything is chosen by typing, what the list is.
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
    let room = usize::from(inside.height.saturating_sub(1));
    let keys_width = keys_width(menu);
    let rows = listed(menu, usize::from(inside.width), room);
    let lines = rows.iter().flat_map(|(at, lines)| (0..).zip(lines).map(move |(nth, line)| (*at, nth, line)));
    for (y, (at, nth, detail)) in (1..inside.height).zip(lines) {
        let (label, keys) = match menu.rows().nth(at).filter(|_| nth == 0) {
            Some(row) => (row.label.as_str(), row.keys.as_str()),
            None => ("", ""),
        };
        let line = Line::from(vec![
            Span::raw(format!("{} ", padded(label, LABEL))),
            Span::styled(padded(keys, keys_width + 1), style::ACCENT),
            Span::styled(detail.as_str(), style::DIM),
        ]);
        put(frame, inside, y, &line);
        if at == menu.at {
            let bar = Rect { x: inside.x, y: inside.y + y, width: inside.width, height: 1 };
            frame.cells.set_style(bar, style::CHOSEN);
        }
    }
    if rows.is_empty() {
        put(frame, inside, 1, &Line::styled("nothing matches; Backspace takes letters back", style::DIM));
    }
}

/// What may follow the keys typed so far, at once. Where the rows do not suffice, names stand in columns.
pub(super) fn which_key((keys, context): (&KeyMap, Context), pending: &[Key], area: Rect, frame: &mut Frame) {
    let follow: Vec<_> = keys.after(context, pending).collect();
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
            let rest = Span::styled(format!("{:<4}", shown(&binding.keys[pending.len()..])), style::ACCENT);
            let info = binding.action.info();
            let line = if n_columns == 1 {
                let typed = Span::styled(format!("{:<3} ", shown(pending)), style::DIM);
                Line::from(vec![typed, rest, Span::raw(info.doc)])
            } else {
                Line::from(vec![rest, Span::raw(info.name.replace('-', " "))])
            };
            put(frame, column, y, &line);
        }
    }
}
