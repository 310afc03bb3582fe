//! Draws a state: pure, from the state and the picture at hand to a frame of cells.

pub mod column;
pub mod forest;
mod form;
mod labels;
mod lesson;
mod lines;
mod menu;
mod offers;
mod opening;
pub mod picture;
pub mod start;
pub mod style;
pub mod theme;

use ratatui::layout::{Alignment, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use super::layout::{Layout, Lens};
use super::state::{Mode, State};
use crate::term::encode::Frame;
pub use opening::opening;
pub use picture::Shot;

/// The whole screen.
#[must_use]
pub fn draw(state: &State, shot: Option<&Shot>) -> Frame {
    let (columns, rows) = state.size;
    let mut frame = Frame::new(columns, rows);
    let layout = Layout::of(state);
    let nth = picture::marks_nth(state, &Lens::of(state, layout.picture), state.shown_frame());
    picture::draw(state, &layout, shot, nth, &mut frame);
    picture::versus::legend(state, layout.picture, &mut frame);
    picture::motion::legend(state, layout.picture, &mut frame);
    lines::title(state, layout.title, nth, &mut frame);
    column::draw(state, layout.column, &mut frame);
    lines::track(state, layout.track, &mut frame);
    lines::time(state, layout.time, &mut frame);
    lines::hints(state, layout.hints, &mut frame);
    lesson::draw(state, layout.picture, &mut frame);
    match &state.mode {
        Mode::Label(typed) => labels::draw(state, typed, &layout, &mut frame),
        Mode::Form(open) => form::draw(open, layout.picture, &mut frame),
        Mode::Menu(open) => menu::draw(open, layout.picture, &mut frame),
        _ if !state.pending.is_empty() => {
            let keys = (&state.keys, state.mode.context());
            menu::which_key(keys, &state.pending, layout.picture, &mut frame);
        }
        _ => {}
    }
    // Last, over everything: what happened must be seen.
    lines::notices(state, layout.picture, &mut frame);
    if let Some(theme) = state.themes.get(state.theme) {
        theme.paint(&mut frame);
    }
    frame
}

/// A line of text in an area's row, where its alignment says. One that is too long ends with `…`.
fn put(frame: &mut Frame, area: Rect, row: u16, line: &Line<'_>) {
    if row >= area.height || area.width == 0 {
        return;
    }
    let text: String = line.spans.iter().map(|span| span.content.as_ref()).collect();
    let width = width(text.trim_end());
    let spare = area.width.saturating_sub(u16::try_from(width).unwrap_or(u16::MAX));
    let indent = match line.alignment {
        Some(Alignment::Center) => spare / 2,
        Some(Alignment::Right) => spare,
        Some(Alignment::Left) | None => 0,
    };
    let y = area.y + row;
    frame.cells.set_line(area.x + indent, y, line, area.width - indent);
    if width > usize::from(area.width) {
        cut(frame, area, y);
    }
}

/// Ends a row of an area with `…`; half a wide character does not stay.
fn cut(frame: &mut Frame, area: Rect, y: u16) {
    let last = area.right() - 1;
    if last > area.x {
        let before = &mut frame.cells[(last - 1, y)];
        if width(before.symbol()) > 1 {
            before.set_symbol(" ");
        }
        let style = before.style();
        frame.cells[(last, y)].set_style(style);
    }
    frame.cells[(last, y)].set_symbol("…");
}

/// Cells that a text takes.
fn width(text: &str) -> usize {
    Line::raw(text).width()
}

/// A text with blanks behind it, so many cells wide, or as wide as it is.
fn padded(text: &str, cells: usize) -> String {
    format!("{text}{}", " ".repeat(cells.saturating_sub(width(text))))
}

/// A text in exactly so many cells: with blanks behind it, or cut and ended with `…`.
fn fitted(text: &str, cells: usize) -> String {
    if width(text) <= cells {
        return padded(text, cells);
    }
    let mut short = String::new();
    for grapheme in Span::raw(text).styled_graphemes(Style::new()) {
        if width(&short) + width(grapheme.symbol) >= cells {
            break;
        }
        short.push_str(grapheme.symbol);
    }
    short.extend((cells > 0).then_some('…'));
    padded(&short, cells)
}

/// The lowest `rows` rows of an area as a panel over the picture; returns its inside.
fn panel(frame: &mut Frame, area: Rect, width: u16, rows: u16) -> Rect {
    let (width, rows) = (width.min(area.width), rows.min(area.height));
    let area = Rect { y: area.y + area.height - rows, width, height: rows, ..area };
    fill(frame, area, style::PANEL);
    Rect { x: area.x + 1, width: width.saturating_sub(2), ..area }
}

/// Blank, exact cells.
fn fill(frame: &mut Frame, area: Rect, style: Style) {
    for y in area.top()..area.bottom() {
        for x in area.left()..area.right() {
            let i = frame.cells.index_of(x, y);
            frame.cells.content[i].reset();
            frame.cells.content[i].set_style(style);
            frame.softness[i] = 0;
        }
    }
}

#[cfg(test)]
mod tests;
