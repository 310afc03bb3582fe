//! The tracks with their doubt over the clip.

use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::state::State;
use crate::app::tracks::TrackRow;
use crate::app::view::fitted;
use crate::app::view::lines::sparkline;

/// Cells of a track's doubt over the clip.
const BARS: usize = 12;

pub(super) struct Tracks<'a> {
    state: &'a State,
    listed: Vec<&'a TrackRow>,
}

impl<'a> Tracks<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        Self { state, listed: state.listed() }
    }
}

impl List for Tracks<'_> {
    fn heading(&self) -> String {
        let order = if self.state.by_doubt { "by doubt" } else { "by number" };
        format!("  {order:<14}doubt{:>15}", "worst at")
    }

    fn nothing(&self) -> &'static str {
        "no tracks yet"
    }

    fn len(&self) -> usize {
        self.listed.len()
    }

    fn current(&self) -> Option<usize> {
        self.listed.iter().position(|row| Some(row.id) == self.state.selected)
    }

    fn row(&self, i: usize) -> Line<'static> {
        let row = self.listed[i];
        let group = self.state.groups.as_ref().and_then(|g| g.of(row.id));
        let name = fitted(row.name.as_deref().unwrap_or_default(), 8);
        let worst = self.state.review.queue.of_track(row.id).next();
        let worst = worst.map_or_else(String::new, |item| item.worst.to_string());
        Line::from(vec![
            Span::styled(
                if self.state.picked.contains(&row.id) { "✓" } else { "●" },
                style::group_text(group),
            ),
            Span::raw(format!("{:>5} {name} ", row.id.to_string())),
            Span::styled(sparkline(self.state, row.id, BARS), style::DIM),
            Span::styled(format!(" {worst:>6}"), style::DIM),
        ])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        Some(Pick::Track(self.listed[i].id))
    }
}
