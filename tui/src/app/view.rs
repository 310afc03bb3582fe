//! Draws a state: pure, from the state and the picture at hand to a frame of cells.

pub mod column;
mod form;
mod labels;
mod lesson;
mod lines;
mod menu;
mod opening;
pub mod picture;
pub mod start;
pub mod style;
pub mod theme;

use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;

use super::layout::Layout;
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
    picture::draw(state, &layout, shot, &mut frame);
    picture::motion::legend(state, layout.picture, &mut frame);
    lines::title(state, layout.title, &mut frame);
    column::draw(state, layout.column, &mut frame);
    lines::track(state, layout.track, &mut frame);
    lines::time(state, layout.time, &mut frame);
    lines::hints(state, layout.hints, &mut frame);
    lesson::draw(state, layout.picture, &mut frame);
    match &state.mode {
        Mode::Label(typed) => labels::draw(state, typed, &layout, &mut frame),
        Mode::Form(open) => form::draw(open, layout.picture, &mut frame),
        Mode::Menu(open) => menu::draw(open, layout.picture, &mut frame),
        _ if !state.pending.is_empty() => menu::which_key(state, layout.picture, &mut frame),
        _ => {}
    }
    // Last, over everything: what happened must be seen.
    lines::notices(state, layout.picture, &mut frame);
    if let Some(theme) = state.themes.get(state.theme) {
        theme.paint(&mut frame);
    }
    frame
}

/// A line of text at the left of an area's row.
fn put(frame: &mut Frame, area: Rect, row: u16, line: &Line<'_>) {
    if row < area.height {
        frame.cells.set_line(area.x, area.y + row, line, area.width);
    }
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
