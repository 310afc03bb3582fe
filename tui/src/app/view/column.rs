//! The column beside the picture: tracks with their quality, and groups.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use honami_model::track::TrackId;

use super::lines::sparkline;
use super::{put, style};
use crate::app::state::State;
use crate::app::tracks::TrackRow;
use crate::term::encode::Frame;

/// Most rows that groups take.
const GROUP_ROWS: u16 = 14;

/// Rows of the tracks' list, and of the groups' below it, headings included.
fn split(state: &State, area: Rect) -> (Rect, Rect) {
    let wanted =
        state.groups.as_ref().map_or(0, |g| 2 + u16::try_from(g.k).unwrap_or(u16::MAX).min(GROUP_ROWS));
    let below = wanted.min(area.height / 2);
    (Rect { height: area.height - below, ..area }, Rect { y: area.bottom() - below, height: below, ..area })
}

/// First listed track: the selected one stays near the middle.
fn first_listed(state: &State, n_rows: usize) -> usize {
    let listed = state.listed();
    let at = state.selected.and_then(|id| listed.iter().position(|row| row.id == id)).unwrap_or(0);
    at.saturating_sub(n_rows / 2).min(state.tracks.len().saturating_sub(n_rows))
}

/// The track listed on a row of the screen.
#[must_use]
pub fn track_at(state: &State, area: Rect, row: u16) -> Option<TrackId> {
    let (list, _) = split(state, area);
    let n_rows = usize::from(list.height.saturating_sub(1));
    let at = usize::from(row.checked_sub(list.y + 1)?);
    (at < n_rows).then(|| state.listed().get(first_listed(state, n_rows) + at).map(|row| row.id))?
}

pub(super) fn draw(state: &State, area: Rect, frame: &mut Frame) {
    for y in area.top()..area.bottom() {
        frame.cells.set_string(area.x - 1, y, "│", style::DIM);
    }
    let (list, below) = split(state, area);
    let n_rows = usize::from(list.height.saturating_sub(1));
    let order = if state.by_doubt { "by doubt" } else { "by number" };
    let heading = format!("tracks  {order:<20}worst at");
    put(frame, list, 0, &Line::styled(heading, style::DIM));
    let first = first_listed(state, n_rows);
    for (y, row) in (1..).zip(state.listed().into_iter().skip(first).take(n_rows)) {
        put(frame, list, y, &track_line(state, row));
    }
    groups(state, below, frame);
}

fn track_line(state: &State, row: &TrackRow) -> Line<'static> {
    let is_selected = state.selected == Some(row.id);
    let group = state.groups.as_ref().and_then(|g| g.of(row.id));
    let name: String = row.name.as_deref().unwrap_or_default().chars().take(8).collect();
    let n = state.clip.n_frames();
    let worst = row.worst.first().map_or_else(String::new, u32::to_string);
    let line = Line::from(vec![
        Span::raw(if is_selected { "▸" } else { " " }),
        Span::styled("●", style::group_text(group)),
        Span::raw(format!("{:>5} {name:<8} ", row.id.to_string())),
        Span::styled(sparkline(row, n, 12), style::DIM),
        Span::styled(format!(" {worst:>6}"), style::DIM),
    ]);
    if is_selected { line.style(style::BOLD) } else { line }
}

fn groups(state: &State, area: Rect, frame: &mut Frame) {
    let Some(groups) = &state.groups else { return };
    put(frame, area, 1, &Line::styled(format!("groups  {}   - + cut", groups.what), style::DIM));
    for (y, (group, n)) in (2..).zip((0_u32..).zip(groups.sizes())) {
        let text = format!(" {:<4} {n} {}", group + 1, if n == 1 { "track" } else { "tracks" });
        let line = Line::from(vec![Span::styled(" ●", style::group_text(Some(group))), Span::raw(text)]);
        put(frame, area, y, &line);
    }
}
