//! JPEG through OSC 1337 (<https://iterm2.com/documentation-images.html>).

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use ratatui::layout::Rect;

use super::{PIECE_MAX, Pixmap, Room, Still, go_to, picture};

/// Bytes of a part that leave room for what stands around them; base 64 comes in fours.
const PART_MAX: usize = PIECE_MAX - 96;

pub(super) fn still(area: Rect, pixmap: &Pixmap, room: Room, in_parts: bool) -> Option<Still> {
    // A picture that cannot be cut must fit into what may be on its way.
    let n_max = if in_parts { room.in_all } else { room.in_all.min(room.at_once) };
    let file = picture::jpeg(pixmap, n_max)?;
    let how = format!(
        "inline=1;size={};width={};height={};preserveAspectRatio=0;doNotMoveCursor=1",
        file.len(),
        area.width,
        area.height
    );
    let text = BASE64.encode(&file);
    let at = |tail: &[u8]| {
        let mut piece = Vec::new();
        go_to(&mut piece, area.x, area.y);
        piece.extend_from_slice(tail);
        piece
    };
    let pieces = if in_parts {
        let begin = at(format!("\x1b]1337;MultipartFile={how}\x07").as_bytes());
        let part = |part: &[u8]| [b"\x1b]1337;FilePart=", part, b"\x07"].concat();
        let parts = text.as_bytes().chunks(PART_MAX).map(part);
        std::iter::once(begin).chain(parts).chain([at(b"\x1b]1337;FileEnd\x07")]).collect()
    } else {
        vec![at(format!("\x1b]1337;File={how}:{text}\x07").as_bytes())]
    };
    // Half a file is closed where it would have been shown: whatever comes of it, the cells are painted anew.
    let stop = if in_parts { at(b"\x1b]1337;FileEnd\x07") } else { Vec::new() };
    Some(Still { area, pieces, stop, remove: Vec::new(), replaces: true })
}
