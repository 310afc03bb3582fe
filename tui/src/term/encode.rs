//! From the wanted grid of cells to the fewest bytes that show it.
//!
//! The encoder keeps what the terminal shows. Cells of the frame are *exact* (text, lines: always painted) or
//! *soft* (the picture: painted by largest error on screen, as far as the byte budget goes). Paused, the soft
//! cells converge to exact; while the picture moves, what is nearly right stays as it is.

mod motion;
mod pen;

use std::borrow::Cow;

use ratatui::buffer::{Buffer, Cell, CellWidth};
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};

use super::colour::{Depth, distance, rgb};
use super::glyph;
use motion::{Glyph, Motion, Spot};
use pen::Pen;

pub use super::glyph::HALF_BLOCK;

/// What the screen should show.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Every cell, chrome and picture.
    pub cells: Buffer,
    /// How much a wrong cell matters: 0 for exact cells, otherwise a factor on its error. Row-major.
    pub softness: Vec<u8>,
    /// Stands for what the soft cells show, finer than cells do: another number, another picture.
    pub scene: u64,
}

impl Frame {
    /// An empty screen.
    #[must_use]
    pub fn new(columns: u16, rows: u16) -> Self {
        let cells = Buffer::empty(Rect::new(0, 0, columns, rows));
        Self { softness: vec![0; cells.content.len()], cells, scene: 0 }
    }
}

/// While the picture moves, a soft cell whose channels are all within this of the wanted stays as it is.
const DEAD_BAND: u8 = 6;
/// While the picture moves, a colour already set is taken for a wanted one within this, channel by channel.
const REUSE_BAND: u8 = 3;
/// Squared error of a picture's cell that shows something else.
const NOTHING_RIGHT: f32 = 1e6;
/// From dark to bright, where there are no colours and the background is dark.
const RAMP: &[u8] = b" .:-=+*#%@";
/// In place of cells of which nothing is known: a private character that nobody wants.
const UNKNOWN: Cell = Cell::new("\u{10fffd}");

/// Marks shown cells over which something else stands that looks like them. No frame wants it.
const COVERED: Modifier = Modifier::HIDDEN;

/// Paints frames with as few bytes as it can.
#[derive(Debug)]
pub struct Encoder {
    depth: Depth,
    /// The terminal's background is bright: where there are no colours, a blank is bright.
    is_light: bool,
    columns: usize,
    shown: Vec<Cell>,
    pen: Pen,
    /// How half blocks of 24-bit colours are chosen.
    motion: Motion,
    /// Bytes really spent on soft cells over bytes expected, from the frames before.
    thrift: f32,
}

/// A soft cell that shows the wrong colours.
struct Wrong {
    error: u32,
    index: usize,
}

impl Encoder {
    /// An encoder for a terminal of which nothing is known.
    #[must_use]
    pub fn new(depth: Depth) -> Self {
        Self {
            depth,
            is_light: false,
            columns: 0,
            shown: Vec::new(),
            pen: Pen::default(),
            motion: Motion::default(),
            thrift: 1.0,
        }
    }

    /// The colours it paints in.
    #[must_use]
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// Says whether the terminal's background is bright.
    pub fn set_light(&mut self, is_light: bool) {
        self.is_light = is_light;
    }

    /// Forgets what the terminal shows: the next frame paints every cell.
    pub fn forget(&mut self) {
        self.shown.clear();
    }

    /// Says that something stands in place of some cells that looks about as they did: none of them is right any
    /// more, but those that should look different are more wrong.
    pub fn cover(&mut self, area: Rect) {
        let columns = self.columns;
        let is_in = |i: usize| {
            let (x, y) = (i % columns.max(1), i / columns.max(1));
            (usize::from(area.left())..usize::from(area.right())).contains(&x)
                && (usize::from(area.top())..usize::from(area.bottom())).contains(&y)
        };
        let covered = self.shown.iter_mut().enumerate().filter(|(i, _)| is_in(*i));
        covered.for_each(|(_, cell)| cell.modifier |= COVERED);
    }

    /// Says that somebody else has written: colours and attributes are the terminal's own.
    pub fn lose_pen(&mut self) {
        self.pen = Pen::default();
    }

    /// Appends the bytes that bring the terminal nearer to the frame.
    ///
    /// Exact cells are all painted. Soft cells are painted while `bytes` stays within `budget`; `moving` says
    /// that the next frame will differ, so that small errors are not worth their bytes.
    /// Returns the number of soft cells still wrong.
    pub fn encode(&mut self, frame: &Frame, budget: usize, moving: bool, bytes: &mut Vec<u8>) -> usize {
        let start = bytes.len();
        let wanted = self.wanted(frame);
        if self.shown.len() != wanted.len() || self.columns != usize::from(frame.cells.area.width) {
            self.columns = usize::from(frame.cells.area.width);
            self.shown = vec![Cell::EMPTY; wanted.len()];
            self.pen = Pen::default();
            bytes.extend_from_slice(b"\x1b[m\x1b[2J");
        }
        self.pen.lose_cursor();
        let halves = halves(&wanted, &frame.softness);
        let (mut wrong, mut spots) = (Vec::new(), Vec::new());
        let mut index = 0;
        while index < wanted.len() {
            let cell = &wanted[index];
            let softness = frame.softness[index];
            if let Some(wanted) = halves.get(index).filter(|_| softness > 0) {
                spots.extend(self.spot(index, *wanted, softness, moving));
                index += 1;
                continue;
            }
            let width = usize::from(cell.cell_width()).max(1);
            if softness == 0 {
                if self.shown[index] != *cell {
                    self.put(index, cell, 0, bytes);
                }
            } else if let Some(error) = self.error(index, cell, moving) {
                wrong.push(Wrong { error: error.saturating_mul(softness.into()), index });
            }
            index += width;
        }
        let band = if moving { REUSE_BAND } else { 0 };
        let left = budget.saturating_sub(bytes.len() - start);
        let n_wrong = self.put_worst(&wanted, wrong, left, band, bytes);
        let left = budget.saturating_sub(bytes.len() - start);
        n_wrong + self.put_picture(&wanted, spots, left, moving, bytes)
    }

    /// A cell of the picture, unless it is right on screen.
    fn spot(&self, index: usize, wanted: [[u8; 3]; 2], softness: u8, moving: bool) -> Option<Spot> {
        let cell = &self.shown[index];
        // Under what covers it a cell is wrong even in the right colours, which matters once the picture rests.
        let least = u32::from(!moving && !cell.modifier.is_empty());
        let error = half(cell).map(|[above, below]| distance(above, wanted[0]) + distance(below, wanted[1]));
        let error = match error.map(|error| error.max(least)) {
            Some(0) => return None,
            Some(error) => error as f32,
            None => NOTHING_RIGHT,
        };
        let weight = f32::from(softness);
        Some(Spot { index, above: wanted[0], below: wanted[1], weight, error: error * weight })
    }

    /// Paints what takes most error off the picture within `budget` bytes; returns how many cells stay wrong.
    fn put_picture(
        &mut self,
        wanted: &[Cell],
        mut spots: Vec<Spot>,
        budget: usize,
        moving: bool,
        bytes: &mut Vec<u8>,
    ) -> usize {
        let mut n_wrong = spots.len();
        if spots.is_empty() {
            return 0;
        }
        let start = bytes.len();
        let colours = self.pen.plain(bytes);
        self.pen.lose_cursor();
        let left = budget.saturating_sub(bytes.len() - start);
        // Out of the way, because painting changes everything else.
        let mut motion = std::mem::take(&mut self.motion);
        let mut cut = None;
        for paint in motion.choose(&mut spots, colours, self.columns, left, moving) {
            if bytes.len() - start + pen::LONGEST > budget {
                cut = Some(paint.index);
                break;
            }
            let (x, y) = (paint.index % self.columns, paint.index / self.columns);
            let symbol = match paint.glyph {
                Glyph::Upper => HALF_BLOCK,
                Glyph::Lower => "▄",
                Glyph::Blank => " ",
            };
            self.break_wide(paint.index, 1);
            let (fg, bg) = self.pen.put_glyph((x, y), symbol, (paint.fg, paint.bg), bytes);
            if x + 1 >= self.columns {
                self.pen.lose_cursor();
            }
            // Kept as if it were an upper half block, whatever the glyph.
            let [above, below] = match paint.glyph {
                Glyph::Upper => [fg, bg],
                Glyph::Lower => [bg, fg],
                Glyph::Blank => [bg; 2],
            };
            let cell = &mut self.shown[paint.index];
            cell.reset();
            cell.set_symbol(HALF_BLOCK).set_fg(above).set_bg(below);
            n_wrong -= usize::from(*cell == wanted[paint.index]);
        }
        if let Some(index) = cut {
            motion.cut(index);
        }
        self.motion = motion;
        n_wrong
    }

    /// The frame in the colours that the terminal has.
    fn wanted<'f>(&self, frame: &'f Frame) -> Cow<'f, [Cell]> {
        if self.depth == Depth::True {
            return Cow::Borrowed(&frame.cells.content);
        }
        let mut cells = frame.cells.content.clone();
        for cell in &mut cells {
            if self.depth == Depth::Mono && cell.symbol() == HALF_BLOCK {
                let sum: u32 = [cell.fg, cell.bg].into_iter().flat_map(rgb).map(u32::from).sum();
                let step = sum as usize * (RAMP.len() - 1) / (6 * 255);
                let step = if self.is_light { RAMP.len() - 1 - step } else { step };
                cell.set_char(char::from(RAMP[step]));
            }
            cell.fg = self.depth.nearest(cell.fg);
            cell.bg = self.depth.nearest(cell.bg);
        }
        Cow::Owned(cells)
    }

    /// How wrong a soft cell is on screen; `None` when it is right, or nearly so while the picture moves.
    fn error(&self, index: usize, cell: &Cell, moving: bool) -> Option<u32> {
        let shown = &self.shown[index];
        if shown == cell {
            return None;
        }
        let mut below = shown.clone();
        below.modifier.remove(COVERED);
        let Some(difference) = glyph::difference(&below, cell) else { return Some(1 << 20) };
        if moving && difference.most <= DEAD_BAND {
            return None;
        }
        Some(difference.squares)
    }

    /// Paints the worst cells, row by row, within `budget` bytes; returns how many stay wrong.
    fn put_worst(
        &mut self,
        wanted: &[Cell],
        mut wrong: Vec<Wrong>,
        budget: usize,
        band: u8,
        bytes: &mut Vec<u8>,
    ) -> usize {
        let n_wrong = wrong.len();
        let start = bytes.len();
        wrong.sort_unstable_by_key(|w| (std::cmp::Reverse(w.error), w.index));
        let mut expected = 0.0;
        let chosen = wrong
            .iter()
            .take_while(|w| {
                expected += pen::expected_bytes(&wanted[w.index]) as f32;
                expected * self.thrift <= budget as f32
            })
            .count();
        wrong.truncate(chosen);
        wrong.sort_unstable_by_key(|w| w.index);
        let mut spent = 0.0;
        let mut n_put = 0;
        for w in &wrong {
            let cell = &wanted[w.index];
            if bytes.len() - start + pen::LONGEST > budget {
                break;
            }
            spent += pen::expected_bytes(cell) as f32;
            self.put(w.index, cell, band, bytes);
            n_put += 1;
        }
        if n_put >= 16 {
            let ratio = (bytes.len() - start) as f32 / spent;
            self.thrift = (0.75 * self.thrift + 0.25 * ratio).clamp(0.2, 1.0);
        }
        n_wrong - n_put
    }

    fn put(&mut self, index: usize, cell: &Cell, band: u8, bytes: &mut Vec<u8>) {
        let (x, y) = (index % self.columns, index / self.columns);
        let width = usize::from(cell.cell_width()).max(1);
        self.break_wide(index, width);
        let painted = self.pen.put(x, y, cell, band, bytes);
        if x + width >= self.columns {
            self.pen.lose_cursor();
        }
        self.shown[index] = painted;
    }

    /// Says what becomes of wide glyphs when so many cells are painted over.
    fn break_wide(&mut self, index: usize, width: usize) {
        let (x, y) = (index % self.columns, index / self.columns);
        // A wide glyph that loses one of its cells loses both.
        let old_width = usize::from(self.shown[index].cell_width()).max(1);
        for covered in index + 1..(index + old_width.max(width)).min((y + 1) * self.columns) {
            self.shown[covered] = UNKNOWN;
        }
        if x > 0 && self.shown[index - 1].cell_width() > 1 {
            self.shown[index - 1] = UNKNOWN;
        }
        let end = index + width;
        if end < (y + 1) * self.columns && self.shown[end - 1].cell_width() > 1 {
            self.shown[end] = UNKNOWN;
        }
    }
}

/// The pixels of every cell, if all soft ones are half blocks in 24-bit colours; otherwise nothing.
///
/// Both ways of choosing would compete for the budget: it is one or the other.
fn halves(cells: &[Cell], softness: &[u8]) -> Vec<[[u8; 3]; 2]> {
    let pixels = |(cell, softness): (&Cell, &u8)| match softness {
        0 => Some([[0; 3]; 2]),
        _ => half(cell).filter(|_| cell.modifier.is_empty()),
    };
    cells.iter().zip(softness).map(pixels).collect::<Option<_>>().unwrap_or_default()
}

/// The two pixels of a half block in 24-bit colours, covered or not.
fn half(cell: &Cell) -> Option<[[u8; 3]; 2]> {
    match (cell.fg, cell.bg) {
        (Color::Rgb(a, b, c), Color::Rgb(d, e, f))
            if (cell.modifier - COVERED).is_empty() && cell.symbol() == HALF_BLOCK =>
        {
            Some([[a, b, c], [d, e, f]])
        }
        _ => None,
    }
}

/// Whether every channel is within `band`. Only 24-bit colours are ever near: others are equal or not.
fn near(a: Color, b: Color, band: u8) -> bool {
    match (a, b) {
        (Color::Rgb(..), Color::Rgb(..)) => rgb(a).iter().zip(rgb(b)).all(|(x, y)| x.abs_diff(y) <= band),
        _ => a == b,
    }
}

#[cfg(test)]
mod tests;
