//! The key-frames of the selected track; the current one is the last up to the current frame.

use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::state::State;
use crate::app::tracks::TrackRow;

pub(super) struct KeyFrames<'a> {
    state: &'a State,
    row: Option<&'a TrackRow>,
}

impl<'a> KeyFrames<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        Self { state, row: state.selected_row() }
    }

    fn frames(&self) -> &'a [u32] {
        self.row.map_or(&[], |row| &row.keys)
    }
}

impl List for KeyFrames<'_> {
    fn heading(&self) -> String {
        format!("{:>8} {:>8} {:>8} {:>8}", "frame", "s", "x", "y")
    }

    fn nothing(&self) -> &'static str {
        match self.row {
            Some(_) => "no key-frames: m moves, ⏎ confirms",
            None => "no track is selected",
        }
    }

    fn len(&self) -> usize {
        self.frames().len()
    }

    fn current(&self) -> Option<usize> {
        self.frames().partition_point(|key| *key <= self.state.frame).checked_sub(1)
    }

    fn row(&self, i: usize) -> Line<'static> {
        let frame = self.frames()[i];
        let t_s = self.state.clip.times.get(frame).unwrap_or_default();
        let [x, y] = self.row.and_then(|row| row.at(frame)).unwrap_or_default();
        let is_here = frame == self.state.frame;
        Line::from(vec![
            Span::styled("◆", if is_here { style::KEY } else { style::DIM }),
            Span::raw(format!("{frame:>6}")),
            Span::styled(format!(" {t_s:>8.2} {x:>8.1} {y:>8.1}"), style::DIM),
        ])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        Some(Pick::Frame(self.frames()[i]))
    }
}
