//! A dendrogram in dots: heights upwards on a scale of ratios, groups in their colours, and the line of the cut.
//!
//! Ratios, because the clearest cut is where one merge is higher than the next by the largest factor: there the gap is
//! widest. Differences would press all but the first few of Ward's merges to the ground.

use ratatui::style::Style;
use ratatui::text::{Line, Span};

use super::style;
use crate::app::groups::Groups;
use crate::braille::{DOTS, braille};

/// How far above its leaves the lowest merge is drawn, of the height of the highest.
const LOWEST: f64 = 0.12;

/// Heights as rows of dots.
struct Scale {
    /// Merges below are not told apart, and not drawn.
    low: f64,
    high: f64,
    /// Rows of dots.
    n_rows: usize,
}

impl Scale {
    /// As many merges as there are columns of dots to tell their parts apart in.
    fn of(heights: &[f64], n_columns: usize, n_rows: usize) -> Self {
        let seen = &heights[..heights.len().min(n_columns)];
        let least = seen.iter().copied().filter(|height| *height > 0.0).fold(f64::INFINITY, f64::min);
        let high = seen.iter().copied().fold(0.0, f64::max);
        Self { low: if heights.len() > n_columns { least } else { least.min(high) }, high, n_rows }
    }

    /// The row of a height, from above.
    fn row(&self, height: f64) -> usize {
        let up = match () {
            () if height < self.low || height <= 0.0 => 0.0,
            () if self.high <= self.low => 1.0,
            () => LOWEST + (1.0 - LOWEST) * (height / self.low).ln() / (self.high / self.low).ln(),
        };
        ((1.0 - up.clamp(0.0, 1.0)) * self.n_rows.saturating_sub(1) as f64).round() as usize
    }
}

/// Cells of dots, and the group that each shows.
struct Canvas {
    columns: usize,
    dots: Vec<u8>,
    of: Vec<Option<u32>>,
}

impl Canvas {
    fn dot(&mut self, (x, y): (usize, usize), group: Option<u32>) {
        let at = y / 4 * self.columns + (x / 2).min(self.columns - 1);
        if let Some(dots) = self.dots.get_mut(at) {
            *dots |= DOTS[y % 4][x % 2];
            self.of[at] = group.or(self.of[at]);
        }
    }
}

/// A dendrogram in so many columns and rows, the numbers of its groups under it as far as they have room.
pub(super) fn draw(
    groups: &Groups,
    selected: Option<u32>,
    (columns, rows): (u16, u16),
) -> Vec<Line<'static>> {
    let number = groups.shown.len().to_string();
    let columns = usize::from(columns).saturating_sub(number.len() + 1);
    let rows = usize::from(rows).saturating_sub(1);
    let heights = &groups.chart.heights;
    if columns == 0 || rows == 0 || heights.is_empty() {
        return Vec::new();
    }
    let scale = Scale::of(heights, 2 * columns, 4 * rows);
    let canvas = dots(groups, &scale, columns, rows);
    let cut = cut_row(groups, &scale) / 4;
    let cell = |at: usize| match (canvas.dots[at], at / columns == cut) {
        (0, true) => ('╌', style::ACCENT),
        (0, false) => (' ', Style::new()),
        (dots, _) => {
            (braille(dots), canvas.of[at].map_or(style::DIM, |group| style::group_text(Some(group))))
        }
    };
    let row = |y: usize| {
        let mut line = runs((y * columns..(y + 1) * columns).map(cell));
        if y == cut {
            line.push_span(Span::styled(format!(" {number}"), style::ACCENT.patch(style::BOLD)));
        }
        line
    };
    let mut lines: Vec<Line<'static>> = (0..rows).map(row).collect();
    lines.push(numbers(groups, selected, columns));
    lines
}

/// The merges that are told apart: those above groups first, so that the colours of groups stay.
fn dots(groups: &Groups, scale: &Scale, columns: usize, rows: usize) -> Canvas {
    let mut canvas = Canvas { columns, dots: vec![0; columns * rows], of: vec![None; columns * rows] };
    let (n, merges) = (groups.tracks.len(), groups.dendrogram.merges());
    let across = |cluster: u32| (groups.chart.across[cluster as usize] * (2 * columns) as f64) as usize;
    let top = |cluster: u32| match (cluster as usize).checked_sub(n) {
        None => scale.row(0.0),
        Some(row) => scale.row(merges[row].height),
    };
    let of = groups.of_clusters();
    let is_drawn = |row: &usize| merges[*row].height >= scale.low;
    let (inner, upper): (Vec<usize>, Vec<usize>) =
        (0..merges.len()).filter(is_drawn).partition(|row| of[n + row].is_some());
    for row in upper.into_iter().chain(inner) {
        let merge = &merges[row];
        let (y, ends) = (scale.row(merge.height), [merge.a, merge.b].map(across));
        (ends[0].min(ends[1])..=ends[0].max(ends[1])).for_each(|x| canvas.dot((x, y), of[n + row]));
        for (part, x) in [merge.a, merge.b].into_iter().zip(ends) {
            let below = top(part);
            // What lies higher than what it is part of (an inversion) hangs upwards.
            (y.min(below)..=y.max(below)).for_each(|y| canvas.dot((x, y), of[part as usize]));
        }
    }
    canvas
}

/// The row of dots between the last merge that the cut undoes and the next.
fn cut_row(groups: &Groups, scale: &Scale) -> usize {
    let heights = &groups.chart.heights;
    let undone = groups.shown.n_undone;
    let above = undone.checked_sub(1).and_then(|last| heights.get(last)).map_or(0, |h| scale.row(*h));
    let below = heights.get(undone).map_or(scale.row(0.0), |height| scale.row(*height));
    usize::midpoint(above, below)
}

/// The number of each group under what it consists of, the selected one's first, then those of the largest; a `…`
/// behind says that there was no room for some.
fn numbers(groups: &Groups, selected: Option<u32>, columns: usize) -> Line<'static> {
    let mut wanted: Vec<(u32, u32)> = (0..)
        .zip(&groups.shown.nodes)
        .flat_map(|(group, nodes)| nodes.iter().map(move |node| (group, *node)))
        .collect();
    let size = |node: u32| groups.dendrogram.size(node);
    wanted.sort_by_key(|&(group, node)| (Some(group) != selected, std::cmp::Reverse(size(node)), group));
    let mut cells = vec![(' ', Style::new()); columns];
    let mut is_whole = true;
    for (group, node) in wanted {
        let text = (group + 1).to_string();
        let middle = (groups.chart.across[node as usize] * columns as f64) as usize;
        let start = middle.saturating_sub((text.len() - 1) / 2).min(columns.saturating_sub(text.len()));
        let around = start.saturating_sub(1)..(start + text.len() + 1).min(columns);
        if columns < text.len() || cells[around].iter().any(|(c, _)| *c != ' ') {
            is_whole = false;
            continue;
        }
        let style = style::group_text(Some(group));
        let style = if Some(group) == selected { style.patch(style::CHOSEN) } else { style };
        cells[start..].iter_mut().zip(text.chars()).for_each(|(cell, digit)| *cell = (digit, style));
    }
    let mut line = runs(cells.into_iter());
    if !is_whole {
        line.push_span(Span::styled(" …", style::DIM));
    }
    line
}

/// Letters with their styles, as few spans as there can be.
fn runs(cells: impl Iterator<Item = (char, Style)>) -> Line<'static> {
    let mut runs: Vec<(String, Style)> = Vec::new();
    for (letter, style) in cells {
        match runs.last_mut() {
            Some((text, last)) if *last == style => text.push(letter),
            _ => runs.push((letter.to_string(), style)),
        }
    }
    runs.into_iter().map(|(text, style)| Span::styled(text, style)).collect::<Vec<_>>().into()
}

#[cfg(test)]
mod tests;
