//! The groups of the shown clustering under their dendrogram; the current one is the selected track's.

mod tree;

use ratatui::text::{Line, Span};

use honami_workbench::plots::Sway;

use super::plots::unit;
use super::{List, Pick, style};
use crate::app::action::{Action, Context};
use crate::app::groups::Groups;
use crate::app::layout::frame_at;
use crate::app::plotted::Plotted;
use crate::app::state::State;
use crate::app::view::fitted;

/// Cells of the bar of a group's share of the tracks, and of its name instead.
const BAR: usize = 12;
/// With fewer rows there is no dendrogram.
const LEAST: u16 = 6;

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

    /// How a group sways, as far as that is known: it is worked out behind the screen.
    fn figures(&self, group: u32) -> Line<'static> {
        let words = match Plotted::shown(self.state).map(|plots| &plots.sway) {
            None => "…".to_owned(),
            Some(Err(why)) => why.clone(),
            Some(Ok(Sway { peak: None, .. })) => "no sway stands out".to_owned(),
            Some(Ok(Sway { peak: Some(peak), coherence, .. })) => {
                let (unit, per_hz) = unit(peak.hz);
                let mut words = format!("{:.2} {unit}  {:.1} px", per_hz * peak.hz, peak.amplitude_px);
                let share = coherence.map(|share| format!("{share:.2}"));
                words.extend(share.map(|share| format!("  coherence {}", share.trim_start_matches('0'))));
                words
            }
        };
        let number =
            Span::styled(format!("{:<3}", group + 1), style::group_text(Some(group)).patch(style::BOLD));
        Line::from(vec![number, Span::raw(words)])
    }

    /// Over the clip, which frames were left out.
    fn outliers(&self, groups: &Groups, columns: u16) -> Line<'static> {
        let n = groups.outlier_frames.len();
        let words = format!(" {n} outlier {}", if n == 1 { "frame" } else { "frames" });
        let n_frames = self.state.clip.n_frames();
        let strip = ratatui::layout::Rect::new(0, 0, columns.saturating_sub(words.len() as u16), 1);
        let mark = |x: u16| {
            let first = frame_at(strip, n_frames, x);
            let end = frame_at(strip, n_frames, x + 1).max(first + 1);
            let next = groups.outlier_frames.partition_point(|frame| *frame < first);
            if groups.outlier_frames.get(next).is_some_and(|frame| *frame < end) { '╌' } else { '─' }
        };
        let strip: String = (0..strip.width).map(mark).collect();
        Line::styled(strip + &words, style::DIM)
    }
}

impl List for GroupList<'_> {
    /// The dendrogram, and the outlier frames where there are some.
    fn above(&self, columns: u16, rows: u16) -> Vec<Line<'static>> {
        let Some(groups) = self.groups.filter(|_| rows >= LEAST) else { return Vec::new() };
        let strip = (!groups.outlier_frames.is_empty()).then(|| self.outliers(groups, columns));
        let selected = self.current().and_then(|group| u32::try_from(group).ok());
        let mut lines = tree::draw(groups, selected, (columns, rows - 1 - u16::from(strip.is_some())));
        lines.extend(strip);
        lines.extend(selected.map(|group| self.figures(group)));
        lines
    }

    fn heading(&self) -> String {
        let Some(groups) = self.groups else { return String::new() };
        let by_hand = match groups.held.len() {
            0 => String::new(),
            n => format!("   {n} by hand"),
        };
        let plot = self.state.keys.keys_of(Context::Review, Action::PlotGroup);
        let plot = plot.map_or_else(String::new, |keys| format!("   {keys} plot"));
        format!("  {}   - + cut{by_hand}{plot}", groups.what)
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

    fn tells_rest(&self) -> bool {
        true
    }

    fn row(&self, i: usize) -> Line<'static> {
        let n = self.sizes[i];
        let most = self.sizes.iter().copied().max().unwrap_or(1).max(1);
        let name = self.groups.and_then(|groups| groups.names.get(i)).and_then(Option::as_deref);
        let last = name.map_or_else(|| "━".repeat((n * BAR).div_ceil(most)), |name| fitted(name, BAR));
        let style = style::group_text(u32::try_from(i).ok());
        let word = if n == 1 { "track" } else { "tracks" };
        Line::from(vec![
            Span::styled("●", style),
            Span::raw(format!(" {:<4} {n:>4} {word:<7}", i + 1)),
            Span::styled(last, style),
        ])
    }

    /// Its first track.
    fn pick(&self, i: usize) -> Option<Pick> {
        let groups = self.groups?;
        let is_in = |row: &&crate::app::tracks::TrackRow| groups.of(row.id) == u32::try_from(i).ok();
        self.state.tracks.iter().find(is_in).map(|row| Pick::Track(row.id))
    }
}
