//! The groups of the shown clustering; the current one is the selected track's.

use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::state::State;
use crate::app::tracks::Groups;

/// Cells of the bar of a group's share of the tracks.
const BAR: usize = 12;

pub(super) struct GroupList<'a> {
    state: &'a State,
    groups: Option<&'a Groups>,
    sizes: Vec<usize>,
}

impl<'a> GroupList<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        let groups = state.groups.as_ref();
        Self { state, groups, sizes: groups.map(Groups::sizes).unwrap_or_default() }
    }
}

impl List for GroupList<'_> {
    fn heading(&self) -> String {
        format!("  {}   - + cut", self.groups.map_or("", |groups| &groups.what))
    }

    fn nothing(&self) -> &'static str {
        "no groups yet: c groups the tracks"
    }

    fn len(&self) -> usize {
        self.sizes.len()
    }

    fn current(&self) -> Option<usize> {
        self.groups?.of(self.state.selected?).map(|group| group as usize)
    }

    fn row(&self, i: usize) -> Line<'static> {
        let n = self.sizes[i];
        let most = self.sizes.iter().copied().max().unwrap_or(1).max(1);
        let bar = "━".repeat((n * BAR).div_ceil(most));
        let style = style::group_text(u32::try_from(i).ok());
        let word = if n == 1 { "track" } else { "tracks" };
        Line::from(vec![
            Span::styled("●", style),
            Span::raw(format!(" {:<4} {n:>4} {word:<7}", i + 1)),
            Span::styled(bar, style),
        ])
    }

    /// Its first track.
    fn pick(&self, i: usize) -> Option<Pick> {
        let groups = self.groups?;
        let is_in = |row: &&crate::app::tracks::TrackRow| groups.of(row.id) == u32::try_from(i).ok();
        self.state.tracks.iter().find(is_in).map(|row| Pick::Track(row.id))
    }
}
