//! The column: a panel beside the picture, or over it where the screen is narrow.
//!
//! A panel is one file here. Most are lists: they say what a row shows and what a click on it picks, and the
//! column scrolls them so that the current row is seen.

mod groups;
mod history;
mod key_frames;
mod log;
mod plots;
mod prints;
mod queue;
mod skeleton;
mod tracks;
mod versus;

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use honami_model::track::TrackId;
use honami_workbench::review::Rank;

use super::lines::wrapped;
use super::{fill, put, style};
use crate::app::panel::Panel;
use crate::app::state::State;
use crate::term::encode::Frame;

/// What a click or the wheel in the column picks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// This panel is to be shown, or none.
    Panel(Option<Panel>),
    /// An item of the queue.
    Item(Rank),
    /// A track.
    Track(TrackId),
    /// A frame of a track.
    At(TrackId, u32),
    /// A frame of the clip.
    Frame(u32),
    /// A row of the undo tree.
    Entry(usize),
    /// The bone of a node.
    Bone(u32),
    /// A line that a plugin printed.
    Print(usize),
}

/// A panel that lists something.
trait List {
    /// What stands above it in so many cells: as much as leaves half of the panel to its rows.
    fn above(&self, _columns: u16, _rows: u16) -> Vec<Line<'static>> {
        Vec::new()
    }
    /// The text of the current row, where it is worth to be read to its end.
    fn text(&self) -> Option<String> {
        None
    }
    /// What its columns mean.
    fn heading(&self) -> String;
    /// What it says instead of rows when there are none.
    fn nothing(&self) -> &'static str;
    /// Number of rows.
    fn len(&self) -> usize;
    /// The current row.
    fn current(&self) -> Option<usize>;
    /// Whether it says how many rows there are beside those that are seen.
    fn tells_rest(&self) -> bool {
        false
    }
    /// The row that stays in sight.
    fn middle(&self) -> Option<usize> {
        self.current()
    }
    /// What a row shows.
    fn row(&self, i: usize) -> Line<'static>;
    /// What choosing a row picks.
    fn pick(&self, i: usize) -> Option<Pick>;
}

/// The list of a panel; `None` for one that is no list.
fn list<'a>(state: &'a State, panel: Panel) -> Option<Box<dyn List + 'a>> {
    Some(match panel {
        Panel::Queue => Box::new(queue::QueueList::of(state)),
        Panel::Tracks => Box::new(tracks::Tracks::of(state)),
        Panel::Groups => Box::new(groups::GroupList::of(state)),
        Panel::Skeleton => Box::new(skeleton::BoneList::of(state)),
        Panel::KeyFrames => Box::new(key_frames::KeyFrames::of(state)),
        Panel::History => Box::new(history::History(state)),
        Panel::Versus => Box::new(versus::VersusList::of(state)),
        Panel::Prints => Box::new(prints::PrintList(state)),
        Panel::Log => Box::new(log::Log(state)),
        Panel::Plots => return None,
    })
}

/// What stands above a list in a panel, as far as there is room.
fn above(list: &dyn List, area: Rect) -> Vec<Line<'static>> {
    let rows = area.height.saturating_sub(2) / 2;
    let mut lines = list.above(area.width, rows);
    lines.truncate(rows.into());
    lines
}

/// The current row's text in rows, where the row has no room for it: at most as many as leave half of the panel to the list.
fn below(list: &dyn List, area: Rect) -> Vec<String> {
    let is_cut = |i: &usize| list.row(*i).width() + 1 > usize::from(area.width);
    let text = list.current().filter(is_cut).and_then(|_| list.text());
    let mut rows = text.map_or_else(Vec::new, |text| wrapped(&text, usize::from(area.width)));
    rows.truncate(usize::from(area.height / 2));
    rows
}

/// The part of the panel's area that has its words.
fn inside(area: Rect) -> Rect {
    if area.x > 0 { Rect { x: area.x + 1, width: area.width.saturating_sub(1), ..area } } else { area }
}

/// Rows of a list that begins under so many, and the first of them that is seen.
fn window(list: &dyn List, area: Rect, top: usize) -> (usize, usize) {
    let n_rows = usize::from(area.height).saturating_sub(top);
    let is_told = list.tells_rest() && list.len() > n_rows;
    let n_rows = n_rows.saturating_sub(usize::from(is_told));
    let at = list.middle().unwrap_or(0);
    (n_rows, at.saturating_sub(n_rows / 2).min(list.len().saturating_sub(n_rows)))
}

pub(super) fn draw(state: &State, area: Rect, frame: &mut Frame) {
    let Some(panel) = state.panel.filter(|_| !area.is_empty()) else { return };
    fill(frame, area, ratatui::style::Style::new());
    let inside = inside(area);
    for y in (area.top()..area.bottom()).filter(|_| inside != area) {
        frame.cells.set_string(area.x, y, "│", style::DIM);
    }
    put(frame, inside, 0, &title(panel, inside.width));
    let Some(list) = list(state, panel) else {
        let below = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        return plots::draw(state, below, frame);
    };
    let mut y = 1;
    for line in above(&*list, inside) {
        put(frame, inside, y, &line);
        y += 1;
    }
    if list.len() == 0 {
        put(frame, inside, y, &Line::styled(list.nothing(), style::DIM));
        return;
    }
    put(frame, inside, y, &Line::styled(list.heading(), style::DIM));
    let whole = below(&*list, inside);
    let foot = inside.height - whole.len() as u16;
    for (y, row) in (foot..).zip(whole) {
        put(frame, inside, y, &Line::raw(row));
    }
    let (n_rows, first) = window(&*list, Rect { height: foot, ..inside }, usize::from(y) + 1);
    for (y, i) in (y + 1..).zip(first..list.len().min(first + n_rows)) {
        let is_current = list.current() == Some(i);
        let mark = Span::raw(if is_current { "▸" } else { " " });
        let mut line = list.row(i);
        line.spans.insert(0, mark);
        put(frame, inside, y, &if is_current { line.style(style::BOLD) } else { line });
    }
    let rest = [first, list.len().saturating_sub(first + n_rows)];
    if list.tells_rest() && rest != [0, 0] {
        put(frame, inside, foot.saturating_sub(1), &Line::styled(rest_words(rest), style::DIM));
    }
}

/// How many rows are not seen, before and after those that are.
fn rest_words([before, after]: [usize; 2]) -> String {
    match (before, after) {
        (0, n) => format!("  … {n} more"),
        (n, 0) => format!("  … {n} before"),
        (before, after) => format!("  … {before} before, {after} more"),
    }
}

/// The panel's name, then those that follow it, as far as there is room.
fn title(panel: Panel, width: u16) -> Line<'static> {
    let mut line = Line::from(Span::styled(panel.name(), style::ACCENT.patch(style::BOLD)));
    let mut next = Panel::after(Some(panel));
    while next != Some(panel) {
        let name = Span::styled(format!("  {}", next.map_or("hide", Panel::name)), style::DIM);
        if line.width() + name.width() > usize::from(width) {
            break;
        }
        line.spans.push(name);
        next = Panel::after(next);
    }
    line
}

/// What a click at this row of the screen picks.
#[must_use]
pub fn pick_at(state: &State, area: Rect, row: u16) -> Option<Pick> {
    let panel = state.panel?;
    let list = list(state, panel);
    if row == area.y {
        return Some(Pick::Panel(Panel::after(Some(panel))));
    }
    let list = list?;
    let top = above(&*list, inside(area)).len() + 2;
    let at = usize::from(row.checked_sub(area.y)?).checked_sub(top)?;
    let below = below(&*list, inside(area)).len() as u16;
    let area = Rect { height: area.height.saturating_sub(below), ..area };
    let (n_rows, first) = window(&*list, area, top);
    let i = first + at;
    (at < n_rows && i < list.len()).then(|| list.pick(i)).flatten()
}

/// What lies so many rows after the current one, within the list.
#[must_use]
pub fn pick_beside(state: &State, by: i64) -> Option<Pick> {
    let list = list(state, state.panel?)?;
    let last = list.len().checked_sub(1)?;
    let by = isize::try_from(by).ok()?;
    list.pick(list.current().map_or(0, |at| at.saturating_add_signed(by)).min(last))
}
