//! Two runs on the picture: where A and B have each track, joined where they differ, in the colour of how far.

use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};

use honami_workbench::versus::{Compared, LIMITS_PX, Paired, Sight, class};

use super::{CROSSED, Canvas, DARK, HALO, HOLLOW, RING, UNSEEN, WHITE};
use crate::app::state::{Mode, State};
use crate::app::versus::{LETTERS, Sides};
use crate::app::view::{fill, put, style};
use crate::term::encode::Frame;

/// Colours from agreement to the worst: each is another of the 16, too.
const COLOURS: [[u8; 3]; LIMITS_PX.len() + 1] =
    [[110, 130, 255], [0, 225, 235], [255, 215, 0], [255, 70, 60], [255, 60, 230]];
/// What stands for them where there are no colours: the pixels that they are below.
const GLYPHS: [char; LIMITS_PX.len() + 1] = ['1', '2', '4', '8', '#'];
/// The ends that are A's and B's.
const ENDS: [[u8; 3]; 2] = [WHITE, DARK];

/// The colour of a distance, as a text colour.
pub(in crate::app::view) fn text(px: f64) -> Style {
    Style::new().fg(rgb(COLOURS[class(px)]))
}

fn rgb([r, g, b]: [u8; 3]) -> Color {
    Color::Rgb(r, g, b)
}

impl Canvas<'_> {
    /// Every so many-th track as the two have it; the selected one with its ways.
    pub(super) fn versus(
        &mut self,
        state: &State,
        (shown, compared): (Sides, &Compared),
        frame: u32,
        nth: usize,
    ) {
        let sides = [0, 1].into_iter().filter(|side| shown.shows(*side));
        let selected = state.selected.and_then(|track| compared.track(track));
        for (side, paired) in sides.clone().flat_map(|side| selected.map(|paired| (side, paired))) {
            self.trace(&paired.spans[side], frame, [ENDS[side]; 2]);
        }
        for (i, paired) in compared.tracks.iter().enumerate() {
            let is_meant = state.selected == Some(paired.track) || state.picked.contains(&paired.track);
            if is_meant || (state.marks_all && i.is_multiple_of(nth)) {
                self.paired(paired, shown, frame, nth > 1);
            }
        }
        let moving = matches!(state.mode, Mode::Move(_) | Mode::Sketch(_));
        for (side, paired) in sides.flat_map(|side| selected.map(|paired| (side, paired))) {
            if let Some(sample) = paired.spans[side].get(frame).filter(|_| !moving) {
                let at = [sample.x, sample.y];
                self.mark(at, &HALO, ENDS[1 - side], ' ');
                self.mark(at, &RING, ENDS[side], LETTERS[side]);
            }
        }
    }

    /// A track in a frame; in a crowd with marks of one pixel.
    fn paired(&mut self, paired: &Paired, sides: Sides, frame: u32, is_crowd: bool) {
        let Some(sight) = paired.sight(frame) else { return };
        let [Some(a), Some(b)] = paired.spans.each_ref().map(|span| span.get(frame)) else { return };
        let at = [a, b].map(|sample| [sample.x, sample.y]);
        let is_seen = [a, b].map(|sample| sample.status.is_seen());
        let one = |shape: &'static [(i64, i64)]| if is_crowd { &shape[..1] } else { shape };
        match (sides, sight) {
            (Sides::Both, Sight::Both(px)) => self.joined(at, px),
            (Sides::One(side), Sight::Both(px)) => {
                self.point(at[side], COLOURS[class(px)], GLYPHS[class(px)])
            }
            (Sides::Both, Sight::Alone(side)) => {
                let shape = if is_crowd { &[(0, 0)][..] } else { &HOLLOW };
                self.mark(at[side], shape, ENDS[side], LETTERS[side]);
            }
            (Sides::One(side), _) if is_seen[side] => self.point(at[side], ENDS[side], LETTERS[side]),
            (Sides::One(side), _) => self.mark(at[side], one(&CROSSED), UNSEEN, 'x'),
            (Sides::Both, Sight::Neither) => self.mark(at[0], one(&CROSSED), UNSEEN, 'x'),
        }
    }

    /// A line from A to B; where they cannot be told apart, a point.
    fn joined(&mut self, [a, b]: [[f32; 2]; 2], px: f64) {
        let (colour, glyph) = (COLOURS[class(px)], GLYPHS[class(px)]);
        if self.lens.pixel_of(a) == self.lens.pixel_of(b) {
            return self.point(a, colour, glyph);
        }
        self.line(a, b, colour);
        self.mark(a, &[(0, 0)], ENDS[0], glyph);
        self.mark(b, &[(0, 0)], ENDS[1], glyph);
    }

    fn point(&mut self, at: [f32; 2], colour: [u8; 3], glyph: char) {
        self.mark(at, &[], colour, glyph);
        self.tint(at, colour);
    }
}

/// What the colours mean, in the upper left corner.
pub(in crate::app::view) fn legend(state: &State, area: Rect, frame: &mut Frame) {
    let Some(versus) = state.versus.as_deref() else { return };
    let mut parts: Vec<(Span<'static>, String)> = Vec::new();
    let mark = |i: usize| {
        let glyph = if state.mono { GLYPHS[i].to_string() } else { "■".to_owned() };
        Span::styled(glyph, Style::new().fg(rgb(COLOURS[i])))
    };
    for (i, limit) in LIMITS_PX.iter().enumerate() {
        parts.push((mark(i), format!(" <{limit}  ")));
    }
    parts.push((mark(LIMITS_PX.len()), format!(" {}+ px", LIMITS_PX[LIMITS_PX.len() - 1])));
    for side in [0, 1].into_iter().filter(|side| !state.mono && versus.sides.shows(*side)) {
        parts.push((Span::styled("  ■", Style::new().fg(rgb(ENDS[side]))), format!(" {}", LETTERS[side])));
    }
    let mut line = Line::raw(" ");
    for (mark, words) in parts {
        let words = Span::styled(words, style::DIM);
        if line.width() + mark.width() + words.width() < usize::from(area.width) {
            line.spans.extend([mark, words]);
        }
    }
    let row = Rect { width: (line.width() as u16 + 1).min(area.width), height: 1.min(area.height), ..area };
    fill(frame, row, style::PANEL);
    put(frame, row, 0, &line);
}

#[cfg(test)]
mod tests;
