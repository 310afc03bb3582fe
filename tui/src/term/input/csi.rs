//! Control sequences: `ESC [ parameters final`.

use super::{CSI_MAX, Event, Head, Mouse, MouseKind, Reply};
use crate::term::key::{Code, Key};

/// The sequence at the head of `bytes`, which begin with `ESC [`.
pub(super) fn head(bytes: &[u8]) -> Head {
    for (i, &b) in bytes.iter().enumerate().take(CSI_MAX).skip(2) {
        match b {
            0x20..=0x3f => {}
            0x40..=0x7e => {
                let body = std::str::from_utf8(&bytes[2..i]).unwrap_or_default();
                return match (body, b) {
                    ("200", b'~') => Head::PasteBegins(i + 1),
                    // Three bytes of a mouse that knows no numbers; a letter of the Linux console's F1 to F5.
                    ("", b'M') => after(bytes, i + 4),
                    ("", b'[') => after(bytes, i + 2),
                    _ => Head::Whole(event(body, b), i + 1),
                };
            }
            // Not a control sequence after all: drop what was read and begin anew with this byte.
            _ => return Head::Whole(None, i),
        }
    }
    if bytes.len() >= CSI_MAX { Head::Whole(None, CSI_MAX) } else { Head::Part }
}

/// A sequence of `n` bytes that says nothing to anybody.
fn after(bytes: &[u8], n: usize) -> Head {
    if bytes.len() < n { Head::Part } else { Head::Whole(None, n) }
}

/// Keys whose sequence ends in a letter (`CSI A`, `SS3 P`).
pub(super) fn letter_key(final_byte: u8) -> Option<Code> {
    Some(match final_byte {
        b'A' => Code::Up,
        b'B' => Code::Down,
        b'C' => Code::Right,
        b'D' => Code::Left,
        b'F' => Code::End,
        b'H' => Code::Home,
        b'M' => Code::Enter,
        b'P' => Code::F(1),
        b'Q' => Code::F(2),
        b'R' => Code::F(3),
        b'S' => Code::F(4),
        _ => return None,
    })
}

fn event(body: &str, final_byte: u8) -> Option<Event> {
    let key = |code, modifiers| Some(Event::Key(Key::with_modifiers(code, modifiers)));
    if let Some(private) = body.strip_prefix('?') {
        if final_byte == b'c' {
            return Some(Event::Reply(Reply::Attributes(numbers(private))));
        }
        return match numbers(private.strip_suffix('$').filter(|_| final_byte == b'y')?)[..] {
            [mode, state] => Some(Event::Reply(Reply::Mode { mode, state })),
            _ => None,
        };
    }
    if let Some(body) = body.strip_prefix('<') {
        return mouse(&numbers(body), final_byte).map(Event::Mouse);
    }
    let p = numbers(body);
    let modifiers = p.get(1).copied().unwrap_or(1);
    match final_byte {
        b'n' => (p == [0]).then_some(Event::Reply(Reply::Ready)),
        b't' => match p[..] {
            [6, height, width] => Some(Event::Reply(Reply::CellSize { width, height })),
            [4, height, width] => Some(Event::Reply(Reply::TextSize { width, height })),
            _ => None,
        },
        b'Z' => key(Code::Tab, 2),
        b'~' if p.len() == 3 && p[0] == 27 => key(unicode_key(p[2])?, p[1]),
        b'~' => key(tilde_key(*p.first()?)?, modifiers),
        b'u' => key(unicode_key(*p.first()?)?, modifiers),
        b'M' => None,
        _ => key(letter_key(final_byte)?, modifiers),
    }
}

/// The numbers between semicolons; of `a:b` only a counts, an empty one is 1 as terminals read it.
fn numbers(body: &str) -> Vec<u16> {
    if body.is_empty() {
        return Vec::new();
    }
    body.split(';')
        .map(|n| n.split(':').next().unwrap_or_default())
        .map(|n| if n.is_empty() { 1 } else { n.parse().unwrap_or(u16::MAX) })
        .collect()
}

/// What a button or the wheel does; nobody wants to know of the rest.
fn mouse(p: &[u16], final_byte: u8) -> Option<Mouse> {
    let &[bits, column, row] = p else { return None };
    let button = u8::try_from(bits & 3).ok()?;
    let kind = match (bits & 64 != 0, bits & 32 != 0) {
        _ if final_byte == b'm' => (bits & 96 == 0).then_some(MouseKind::Release(button))?,
        _ if final_byte != b'M' => return None,
        (true, _) if button == 0 => MouseKind::WheelUp,
        (true, _) if button == 1 => MouseKind::WheelDown,
        (true, _) => return None,
        (false, true) if button == 3 => return None,
        (false, true) => MouseKind::Drag(button),
        (false, false) => MouseKind::Press(button),
    };
    Some(Mouse { kind, column: column.saturating_sub(1), row: row.saturating_sub(1) })
}

fn tilde_key(n: u16) -> Option<Code> {
    Some(match n {
        1 | 7 => Code::Home,
        2 => Code::Insert,
        3 => Code::Delete,
        4 | 8 => Code::End,
        5 => Code::PageUp,
        6 => Code::PageDown,
        11..=15 => Code::F((n - 10) as u8),
        17..=21 => Code::F((n - 11) as u8),
        23 | 24 => Code::F((n - 12) as u8),
        _ => return None,
    })
}

/// Keys named by a code point, as kitty's protocol and modifyOtherKeys send them.
fn unicode_key(n: u16) -> Option<Code> {
    Some(match n {
        9 => Code::Tab,
        13 => Code::Enter,
        27 => Code::Esc,
        8 | 127 => Code::Backspace,
        // kitty's private range: modifier and media keys have no meaning here.
        0xe000..=0xf8ff | 0..=31 => return None,
        _ => Code::Char(char::from_u32(u32::from(n))?),
    })
}
