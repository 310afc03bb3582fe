//! The undo tree: newest first, branches side by side, where the document stands marked.

use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::history::Lane;
use crate::app::state::{Mode, State};

pub(super) struct History<'a>(pub(super) &'a State);

impl List for History<'_> {
    fn heading(&self) -> String {
        format!("{} edits", self.0.history.len().saturating_sub(1))
    }

    fn nothing(&self) -> &'static str {
        "nothing was done yet"
    }

    fn len(&self) -> usize {
        self.0.history.len()
    }

    fn current(&self) -> Option<usize> {
        match self.0.mode {
            Mode::History { at, .. } => Some(at),
            _ => Some(self.0.history.head_row()),
        }
    }

    fn row(&self, i: usize) -> Line<'static> {
        let Some((entry, lanes)) = self.0.history.row(i) else { return Line::default() };
        let is_head = entry.id == self.0.history.head;
        let used = lanes.iter().rposition(|lane| *lane != Lane::Empty).map_or(0, |last| last + 1);
        let glyph = |lane: &Lane| match lane {
            Lane::Empty => " ",
            Lane::Passes => "│",
            Lane::Entry if is_head => "◉",
            Lane::Entry => "○",
            Lane::Begins => "╯",
        };
        let graph: String = lanes.iter().take(used).map(glyph).collect();
        let style = if is_head { style::ACCENT } else { style::DIM };
        Line::from(vec![Span::styled(graph, style), Span::raw(format!(" {}", entry.label))])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        Some(Pick::Entry(i))
    }
}
