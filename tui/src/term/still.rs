//! Stills: a picture in the terminal's own pixels over some cells, as pieces that can be sent one by one.
//!
//! Every piece is whole sequences: a status query may follow each, and what is not sent yet can be given up. The
//! cells below are painted first and stay what the encoder works on; a still is an extra that goes at once when
//! the picture changes.

mod iterm;
mod kitty;
mod palette;
mod picture;
mod sixel;

use std::io::Write as _;

use ratatui::layout::Rect;

use super::capabilities::Pixels;

/// Bytes of a piece at most, where the protocol lets a picture be cut.
pub const PIECE_MAX: usize = 4096;

/// A picture in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixmap {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Width times height pixels, row-major.
    pub pixels: Vec<[u8; 3]>,
}

/// What a still may cost, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// In all.
    pub in_all: usize,
    /// At once, where the protocol does not let a picture be cut.
    pub at_once: usize,
}

/// A picture ready to be sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Still {
    /// The cells that it covers.
    pub area: Rect,
    /// What is sent, in order. After the last piece the picture is there.
    pub pieces: Vec<Vec<u8>>,
    /// What is sent instead of the rest, after some pieces but not all.
    pub stop: Vec<u8>,
    /// What takes it away again, after all pieces.
    pub remove: Vec<u8>,
    /// Whether it takes the place of the cells; otherwise they are still there below it.
    pub replaces: bool,
}

/// A still for some cells, as good as the room allows; `None` where the room is too small for any.
#[must_use]
pub fn make(pixels: Pixels, area: Rect, picture: &Pixmap, room: Room) -> Option<Still> {
    if area.is_empty() || picture.pixels.is_empty() {
        return None;
    }
    match pixels {
        Pixels::Iterm { in_parts } => iterm::still(area, picture, room, in_parts),
        Pixels::Kitty => kitty::still(area, picture, room),
        Pixels::KittyInTmux => kitty::still_in_tmux(area, picture, room),
        Pixels::Sixel { .. } => sixel::still(area, picture, room),
    }
}

/// Moves the cursor to a cell.
fn go_to(bytes: &mut Vec<u8>, x: u16, y: u16) {
    let written = write!(bytes, "\x1b[{};{}H", u32::from(y) + 1, u32::from(x) + 1);
    debug_assert!(written.is_ok(), "a Vec takes every byte");
}

#[cfg(test)]
mod tests;
