//! PNG through kitty's protocol (<https://sw.kovidgoyal.net/kitty/graphics-protocol/>), straight or through tmux.

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use ratatui::layout::Rect;

use super::{PIECE_MAX, Pixmap, Room, Still, go_to, picture};

/// Bytes of base 64 in a piece: a multiple of four, as the protocol wants it, with room for what stands around.
const PART_MAX: usize = PIECE_MAX - 128;
/// In its place stands a part of a picture.
const PLACEHOLDER: char = '\u{10eeee}';
/// Placeholders of a piece at most; each is four bytes.
const PLACES_MAX: usize = (PIECE_MAX - 128) / 4;

/// Marks over a placeholder that number its row: the first of kitty's `rowcolumn-diacritics.txt`.
const NUMBERS: [u32; 96] = [
    0x305, 0x30d, 0x30e, 0x310, 0x312, 0x33d, 0x33e, 0x33f, 0x346, 0x34a, 0x34b, 0x34c, 0x350, 0x351, 0x352,
    0x357, 0x35b, 0x363, 0x364, 0x365, 0x366, 0x367, 0x368, 0x369, 0x36a, 0x36b, 0x36c, 0x36d, 0x36e, 0x36f,
    0x483, 0x484, 0x485, 0x486, 0x487, 0x592, 0x593, 0x594, 0x595, 0x597, 0x598, 0x599, 0x59c, 0x59d, 0x59e,
    0x59f, 0x5a0, 0x5a1, 0x5a8, 0x5a9, 0x5ab, 0x5ac, 0x5af, 0x5c4, 0x610, 0x611, 0x612, 0x613, 0x614, 0x615,
    0x616, 0x617, 0x657, 0x658, 0x659, 0x65a, 0x65b, 0x65d, 0x65e, 0x6d6, 0x6d7, 0x6d8, 0x6d9, 0x6da, 0x6db,
    0x6dc, 0x6df, 0x6e0, 0x6e1, 0x6e2, 0x6e4, 0x6e7, 0x6e8, 0x6eb, 0x6ec, 0x730, 0x732, 0x733, 0x735, 0x736,
    0x73a, 0x73d, 0x73f, 0x740, 0x741, 0x743,
];

/// Number of our picture: another one for every honami on the same terminal.
fn id() -> u32 {
    0x68_0000 | std::process::id() & 0xffff
}

/// A picture above the cells, which stay as they are below it.
pub(super) fn still(area: Rect, pixmap: &Pixmap, room: Room) -> Option<Still> {
    let file = picture::png(pixmap, room)?;
    let place = format!("c={},r={},z=1,C=1", area.width, area.height);
    let mut pieces = transmission(&file, &place, |sequence| sequence.to_vec());
    // It appears where the cursor is when the last piece comes; other frames may have come between.
    for piece in [0, pieces.len() - 1] {
        let mut placed = Vec::new();
        go_to(&mut placed, area.x, area.y);
        placed.append(&mut pieces[piece]);
        pieces[piece] = placed;
    }
    let remove = delete();
    Some(Still {
        area,
        pieces,
        stop: [b"\x1b_Gm=0,q=2;\x1b\\", &remove[..]].concat(),
        remove,
        replaces: false,
    })
}

/// A picture that stands in characters of its own, so that tmux moves and hides it as it does characters.
pub(super) fn still_in_tmux(area: Rect, pixmap: &Pixmap, room: Room) -> Option<Still> {
    if usize::from(area.height) > NUMBERS.len() {
        return None;
    }
    let file = picture::png(pixmap, room)?;
    let place = format!("U=1,c={},r={}", area.width, area.height);
    let mut pieces = transmission(&file, &place, wrapped);
    pieces.extend(placeholders(area));
    let remove = wrapped(&delete());
    let stop = [wrapped(b"\x1b_Gm=0,q=2;\x1b\\"), remove.clone()].concat();
    Some(Still { area, pieces, stop, remove, replaces: true })
}

/// The sequences that send a file and place it.
fn transmission(file: &[u8], place: &str, wrap: impl Fn(&[u8]) -> Vec<u8>) -> Vec<Vec<u8>> {
    let text = BASE64.encode(file);
    let parts: Vec<&[u8]> = text.as_bytes().chunks(PART_MAX).collect();
    let sequence = |(i, part): (usize, &&[u8])| {
        let more = u8::from(i + 1 < parts.len());
        let keys = match i {
            0 => format!("a=T,f=100,i={},p=1,{place},q=2,m={more}", id()),
            _ => format!("m={more},q=2"),
        };
        wrap(&[b"\x1b_G", keys.as_bytes(), b";", part, b"\x1b\\"].concat())
    };
    parts.iter().enumerate().map(sequence).collect()
}

fn delete() -> Vec<u8> {
    format!("\x1b_Ga=d,d=I,i={},q=2\x1b\\", id()).into_bytes()
}

/// A sequence that tmux is to hand on.
fn wrapped(sequence: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x1bPtmux;".to_vec();
    for &b in sequence {
        bytes.extend_from_slice(if b == 0x1b { b"\x1b\x1b" } else { std::slice::from_ref(&b) });
    }
    bytes.extend_from_slice(b"\x1b\\");
    bytes
}

/// The characters in which the picture stands: the colour is its number, the marks are row and column; who has
/// none stands in the column after its left neighbour.
fn placeholders(area: Rect) -> Vec<Vec<u8>> {
    let [_, r, g, b] = id().to_be_bytes();
    let rows_per_piece = (PLACES_MAX / usize::from(area.width).max(1)).max(1);
    let mut pieces: Vec<Vec<u8>> = Vec::new();
    for (row, number) in (0..area.height).zip(NUMBERS) {
        if usize::from(row) % rows_per_piece == 0 {
            pieces.push(Vec::new());
        }
        let Some(bytes) = pieces.last_mut() else { continue };
        go_to(bytes, area.x, area.y + row);
        let marks = [number, NUMBERS[0]].into_iter().filter_map(char::from_u32).collect::<String>();
        let rest = PLACEHOLDER.to_string().repeat(usize::from(area.width) - 1);
        let written = write!(bytes, "\x1b[0;38;2;{r};{g};{b}m{PLACEHOLDER}{marks}{rest}\x1b[m");
        debug_assert!(written.is_ok(), "a Vec takes every byte");
    }
    pieces
}
