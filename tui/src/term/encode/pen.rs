//! The terminal's pen: where the cursor is and which colours are set, so that only changes are sent.

use std::io::Write as _;

use ratatui::buffer::{Cell, CellWidth};
use ratatui::style::{Color, Modifier};

use super::near;
use crate::term::colour::base_index;

/// Bytes of the longest cell: a move, two 24-bit colours, every attribute, a glyph.
pub(super) const LONGEST: usize = 72;

/// Attributes that are sent, and their SGR numbers.
const ATTRIBUTES: [(Modifier, u8); 5] = [
    (Modifier::BOLD, 1),
    (Modifier::DIM, 2),
    (Modifier::ITALIC, 3),
    (Modifier::UNDERLINED, 4),
    (Modifier::REVERSED, 7),
];

#[derive(Debug, Default)]
pub(super) struct Pen {
    cursor: Option<(usize, usize)>,
    fg: Color,
    bg: Color,
    modifier: Modifier,
}

/// Bytes that a half-block cell costs when nothing is shared with its neighbours.
pub(super) fn expected_bytes(cell: &Cell) -> usize {
    let colour = |c| match c {
        Color::Rgb(r, g, b) => 8 + [r, g, b].map(digits).iter().sum::<usize>(),
        Color::Indexed(n) => 6 + digits(n),
        _ => 3,
    };
    12 + colour(cell.fg) + colour(cell.bg)
}

/// Whether nothing of a cell is in the foreground's colour.
fn is_flat(cell: &Cell) -> bool {
    cell.symbol() == " " && !cell.modifier.intersects(Modifier::UNDERLINED | Modifier::REVERSED)
}

fn digits(n: u8) -> usize {
    match n {
        0..=9 => 1,
        10..=99 => 2,
        _ => 3,
    }
}

/// Bytes of a 24-bit colour's parameters, `38;2;r;g;b`.
pub(super) fn rgb_bytes(rgb: [u8; 3]) -> usize {
    7 + rgb.map(digits).iter().sum::<usize>()
}

/// Bytes of going to a cell, from a place where the cursor is or from anywhere; cells are counted row by row.
pub(super) fn move_bytes(cursor: Option<usize>, to: usize, columns: usize) -> usize {
    let digits = |n: usize| {
        if n < 10 {
            1
        } else if n < 100 {
            2
        } else {
            3
        }
    };
    let (x, y) = (to % columns, to / columns);
    match cursor {
        // At the end of a row the cursor is nowhere.
        Some(here) if here / columns == y && here <= to && here % columns > 0 => match to - here {
            0 => 0,
            1 => 3,
            n => 3 + digits(n),
        },
        _ => 4 + digits(x + 1) + digits(y + 1),
    }
}

impl Pen {
    /// Says that the cursor may be anywhere.
    pub(super) fn lose_cursor(&mut self) {
        self.cursor = None;
    }

    /// The colours that are set, where they are 24-bit ones; attributes are taken off.
    pub(super) fn plain(&mut self, bytes: &mut Vec<u8>) -> (Option<[u8; 3]>, Option<[u8; 3]>) {
        if !self.modifier.is_empty() {
            bytes.extend_from_slice(b"\x1b[m");
            *self = Self { cursor: self.cursor, ..Self::default() };
        }
        let known = |colour| match colour {
            Color::Rgb(r, g, b) => Some([r, g, b]),
            _ => None,
        };
        (known(self.fg), known(self.bg))
    }

    /// Paints a glyph with these colours, or those that are set; returns the colours.
    pub(super) fn put_glyph(
        &mut self,
        (x, y): (usize, usize),
        symbol: &'static str,
        (fg, bg): (Option<[u8; 3]>, Option<[u8; 3]>),
        bytes: &mut Vec<u8>,
    ) -> (Color, Color) {
        let colour = |wanted: Option<[u8; 3]>, set| wanted.map_or(set, |[r, g, b]| Color::Rgb(r, g, b));
        let mut cell = Cell::new(symbol);
        (cell.fg, cell.bg) = (colour(fg, self.fg), colour(bg, self.bg));
        self.put(x, y, &cell, 0, bytes);
        (cell.fg, cell.bg)
    }

    /// Paints a cell; returns it as it is on screen, where a colour within `band` of the wanted may stand.
    pub(super) fn put(&mut self, x: usize, y: usize, cell: &Cell, band: u8, bytes: &mut Vec<u8>) -> Cell {
        self.go_to(x, y, bytes);
        let mut painted = cell.clone();
        if !is_flat(cell) && near(self.fg, cell.fg, band) {
            painted.fg = self.fg;
        }
        if near(self.bg, cell.bg, band) {
            painted.bg = self.bg;
        }
        self.dip(&painted, bytes);
        bytes.extend_from_slice(painted.symbol().as_bytes());
        self.cursor = Some((x + usize::from(painted.cell_width()).max(1), y));
        painted
    }

    fn go_to(&mut self, x: usize, y: usize, bytes: &mut Vec<u8>) {
        let written = match self.cursor {
            Some(here) if here == (x, y) => Ok(()),
            Some((here, row)) if row == y && here + 1 == x => bytes.write_all(b"\x1b[C"),
            Some((here, row)) if row == y && here < x => write!(bytes, "\x1b[{}C", x - here),
            _ => write!(bytes, "\x1b[{};{}H", y + 1, x + 1),
        };
        debug_assert!(written.is_ok(), "a Vec takes every byte");
    }

    /// Sets the colours and attributes of a cell, as one sequence of what differs.
    fn dip(&mut self, cell: &Cell, bytes: &mut Vec<u8>) {
        let keeps_fg = is_flat(cell);
        if (self.bg, self.modifier) == (cell.bg, cell.modifier) && (keeps_fg || self.fg == cell.fg) {
            return;
        }
        bytes.extend_from_slice(b"\x1b[");
        let parameters = bytes.len();
        if !cell.modifier.contains(self.modifier) {
            *self = Self { cursor: self.cursor, ..Self::default() };
            bytes.extend_from_slice(b"0;");
        }
        for (attribute, number) in ATTRIBUTES {
            if cell.modifier.contains(attribute) && !self.modifier.contains(attribute) {
                number_to(bytes, number);
            }
        }
        if self.fg != cell.fg && !keeps_fg {
            colour(cell.fg, 30, bytes);
            self.fg = cell.fg;
        }
        if self.bg != cell.bg {
            colour(cell.bg, 40, bytes);
        }
        if bytes.len() > parameters {
            bytes.pop();
        }
        bytes.push(b'm');
        (self.bg, self.modifier) = (cell.bg, cell.modifier);
    }
}

/// A colour's parameters, each followed by a semicolon; `base` is 30 for the foreground, 40 for the background.
fn colour(colour: Color, base: u8, bytes: &mut Vec<u8>) {
    match (colour, base_index(colour)) {
        (Color::Rgb(r, g, b), _) => [base + 8, 2, r, g, b].into_iter().for_each(|n| number_to(bytes, n)),
        (Color::Indexed(n @ 0..=7), _) | (_, Some(n @ 0..=7)) => number_to(bytes, base + n),
        (Color::Indexed(n @ 8..=15), _) | (_, Some(n)) => number_to(bytes, base + 52 + n),
        (Color::Indexed(n), _) => [base + 8, 5, n].into_iter().for_each(|n| number_to(bytes, n)),
        _ => number_to(bytes, base + 9),
    }
}

fn number_to(bytes: &mut Vec<u8>, n: u8) {
    if n >= 100 {
        bytes.push(b'0' + n / 100);
    }
    if n >= 10 {
        bytes.push(b'0' + n / 10 % 10);
    }
    bytes.extend_from_slice(&[b'0' + n % 10, b';']);
}
