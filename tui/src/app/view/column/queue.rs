//! The queue: doubtful segments, the most doubtful first.

use ratatui::text::{Line, Span};

use honami_workbench::review::Item;

use super::{List, Pick, style};
use crate::app::state::State;

/// Rows that are looked up: more than any screen has on both sides of the current one.
const REACH: usize = 400;

pub(super) struct QueueList<'a> {
    state: &'a State,
    items: Vec<&'a Item>,
}

impl<'a> QueueList<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        let queue = &state.review.queue;
        // Never all of 100,000: those about the current one.
        let items = match state.current_item().map(Item::rank) {
            Some(rank) => queue.about(rank, REACH),
            None => queue.iter().take(REACH).collect(),
        };
        Self { state, items }
    }
}

impl List for QueueList<'_> {
    fn heading(&self) -> String {
        let progress = self.state.review.progress();
        format!("{:>6} {:>9}  {} left, {} done", "track", "frames", progress.open, progress.judged.done())
    }

    fn nothing(&self) -> &'static str {
        match self.state.review.progress().total() {
            0 => "nothing is doubtful",
            _ => "all is reviewed",
        }
    }

    fn len(&self) -> usize {
        self.items.len()
    }

    fn current(&self) -> Option<usize> {
        let current = self.state.current_item()?;
        self.items.iter().position(|item| item.rank() == current.rank())
    }

    fn row(&self, i: usize) -> Line<'static> {
        let item = self.items[i];
        let group = self.state.groups.as_ref().and_then(|g| g.of(item.track));
        let frames = format!("{}-{}", item.frames.start, item.frames.end - 1);
        let suspicion = format!("{:.2}", item.suspicion);
        let suspicion = suspicion.strip_prefix('0').unwrap_or(&suspicion).to_owned();
        Line::from(vec![
            Span::styled("●", style::group_text(group)),
            Span::raw(format!("{:>4} {frames:>9}", item.track.0)),
            Span::styled(format!(" {suspicion:>4} "), if item.later { style::DIM } else { style::ACCENT }),
            Span::styled(item.reasons.to_string(), style::DIM),
        ])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        Some(Pick::Item(self.items[i].rank()))
    }
}
