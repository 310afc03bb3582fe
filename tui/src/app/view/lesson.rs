//! The step of the tutorial, over the top of the picture.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{fill, put, style};
use crate::app::state::State;
use crate::term::encode::Frame;

pub(super) fn draw(state: &State, area: Rect, frame: &mut Frame) {
    let Some((lesson, (step, n))) =
        state.lesson.as_ref().and_then(|lesson| lesson.step().map(|at| (lesson, at)))
    else {
        return;
    };
    let room = usize::from(area.width.saturating_sub(2));
    let mut rows = vec![Line::from(Span::styled(format!("{step}/{n}"), style::DIM))];
    for (word, is_key) in lesson.words(&state.keys) {
        let word = Span::styled(word, if is_key { style::ACCENT } else { style::PANEL });
        match rows.last_mut() {
            Some(row) if row.width() + 1 + word.width() <= room => {
                row.push_span(" ");
                row.push_span(word);
            }
            _ => rows.push(Line::from(word)),
        }
    }
    let height = u16::try_from(rows.len()).unwrap_or(u16::MAX).min(area.height);
    fill(frame, Rect { height, ..area }, style::PANEL);
    let inside = Rect { x: area.x + 1, width: area.width.saturating_sub(2), ..area };
    for (y, row) in (0..height).zip(&rows) {
        put(frame, inside, y, row);
    }
}
