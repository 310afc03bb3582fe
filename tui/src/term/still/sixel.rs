//! Sixel (DEC STD 070, chapter "Sixel"), cut into tiles that stand for themselves.

use std::collections::BTreeMap;
use std::io::Write as _;

use ratatui::layout::Rect;

use super::palette::palette;
use super::{PIECE_MAX, Pixmap, Room, Still, go_to};

/// Colours to be tried, the most first.
const COLOURS: [usize; 3] = [128, 48, 16];

/// A still, for which the picture has a whole number of pixels to every cell.
///
/// Each tile is one row of cells high, and as many columns wide as fit into a piece.
pub(super) fn still(area: Rect, picture: &Pixmap, room: Room) -> Option<Still> {
    let cell = (picture.width / u32::from(area.width), picture.height / u32::from(area.height));
    if cell.0 == 0 || cell.1 == 0 {
        return None;
    }
    COLOURS.into_iter().find_map(|n| {
        let (colours, indices) = palette(&picture.pixels, n);
        let sheet = Sheet { colours, indices, columns: picture.width as usize };
        let mut pieces = Vec::new();
        let mut n_bytes = 0;
        for row in 0..area.height {
            sheet.tiles(area, row, 0..area.width, cell, &mut pieces);
            n_bytes = pieces.iter().map(Vec::len).sum();
            if n_bytes > room.in_all {
                return None;
            }
        }
        debug_assert!(n_bytes <= room.in_all);
        Some(Still { area, pieces, stop: Vec::new(), remove: Vec::new(), replaces: true })
    })
}

/// A picture in few colours.
struct Sheet {
    colours: Vec<[u8; 3]>,
    indices: Vec<u8>,
    columns: usize,
}

impl Sheet {
    /// The tiles of some columns of a row of cells: one, or if that is too long two halves.
    fn tiles(
        &self,
        area: Rect,
        row: u16,
        cells: std::ops::Range<u16>,
        cell: (u32, u32),
        pieces: &mut Vec<Vec<u8>>,
    ) {
        let mut piece = Vec::new();
        go_to(&mut piece, area.x + cells.start, area.y + row);
        let across = usize::from(cells.start) * cell.0 as usize..usize::from(cells.end) * cell.0 as usize;
        let down = usize::from(row) * cell.1 as usize..usize::from(row + 1) * cell.1 as usize;
        self.tile(across, down, &mut piece);
        if piece.len() > PIECE_MAX && cells.len() > 1 {
            let middle = cells.start.midpoint(cells.end);
            self.tiles(area, row, cells.start..middle, cell, pieces);
            self.tiles(area, row, middle..cells.end, cell, pieces);
        } else {
            pieces.push(piece);
        }
    }

    /// One image of some pixels.
    fn tile(&self, across: std::ops::Range<usize>, down: std::ops::Range<usize>, bytes: &mut Vec<u8>) {
        let mut text = format!("\x1bP0;1;0q\"1;1;{};{}", across.len(), down.len());
        let mut used: Vec<u8> = down
            .clone()
            .flat_map(|y| &self.indices[y * self.columns + across.start..y * self.columns + across.end])
            .copied()
            .collect();
        used.sort_unstable();
        used.dedup();
        for &n in &used {
            let [r, g, b] = self.colours[usize::from(n)].map(|c| (u32::from(c) * 100 + 127) / 255);
            text.push_str(&format!("#{n};2;{r};{g};{b}"));
        }
        bytes.extend_from_slice(text.as_bytes());
        for top in down.clone().step_by(6) {
            if top > down.start {
                bytes.push(b'-');
            }
            self.band(across.clone(), top..(top + 6).min(down.end), bytes);
        }
        bytes.extend_from_slice(b"\x1b\\");
    }

    /// Up to six rows: for each colour, which of six pixels in every column have it.
    fn band(&self, across: std::ops::Range<usize>, down: std::ops::Range<usize>, bytes: &mut Vec<u8>) {
        let mut layers: BTreeMap<u8, Vec<u8>> = BTreeMap::new();
        for (bit, y) in down.enumerate() {
            for (x, n) in self.indices[y * self.columns + across.start..y * self.columns + across.end]
                .iter()
                .enumerate()
            {
                layers.entry(*n).or_insert_with(|| vec![0; across.len()])[x] |= 1 << bit;
            }
        }
        for (i, (n, columns)) in layers.iter().enumerate() {
            if i > 0 {
                bytes.push(b'$');
            }
            let written = write!(bytes, "#{n}");
            debug_assert!(written.is_ok(), "a Vec takes every byte");
            // What follows the last pixel of a colour is left out.
            let end = columns.iter().rposition(|&six| six != 0).map_or(0, |at| at + 1);
            for run in columns[..end].chunk_by(|a, b| a == b) {
                let six = run[0] + 0x3f;
                match run.len() {
                    n @ 0..=3 => bytes.extend(std::iter::repeat_n(six, n)),
                    n => {
                        let written = write!(bytes, "!{n}{}", char::from(six));
                        debug_assert!(written.is_ok(), "a Vec takes every byte");
                    }
                }
            }
        }
    }
}
