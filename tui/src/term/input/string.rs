//! Control strings: `ESC ] text ST` and its like, which carry answers.

use super::{Event, Head, Reply, STRING_MAX};

/// Where the text of a control string ends and where what follows begins.
pub(super) fn end(bytes: &[u8]) -> Option<(usize, usize)> {
    bytes.iter().enumerate().find_map(|(i, &b)| match b {
        0x07 => Some((i, i + 1)),
        0x1b => match bytes.get(i + 1) {
            Some(b'\\') => Some((i, i + 2)),
            Some(_) => Some((i, i)), // another sequence begins: this one was cut off
            None => None,
        },
        _ => None,
    })
}

/// The string at the head of `bytes`, which begin with `ESC` and one of `]P_^X`.
pub(super) fn head(bytes: &[u8]) -> Head {
    let scanned = bytes.len().min(STRING_MAX);
    let Some((end, next)) = end(&bytes[2..scanned]) else {
        return if scanned == STRING_MAX { Head::TooLong(STRING_MAX - 1) } else { Head::Part };
    };
    let text = String::from_utf8_lossy(&bytes[2..2 + end]);
    Head::Whole(reply(bytes[1], &text).map(Event::Reply), 2 + next)
}

/// The answer in a string of a kind.
fn reply(kind: u8, text: &str) -> Option<Reply> {
    match kind {
        b'P' => match text.strip_prefix(">|") {
            Some(version) => Some(Reply::Version(version.to_owned())),
            None => entry(text).map(Reply::Entry),
        },
        b'_' => {
            let (_, word) = text.strip_prefix('G')?.split_once(';')?;
            Some(Reply::Graphics { is_ok: word == "OK" })
        }
        b']' => colour(text.strip_prefix("11;")?).map(Reply::Background),
        _ => None,
    }
}

/// `1+r544E=hex`, in either case; some terminals add other names.
fn entry(text: &str) -> Option<String> {
    let (name, hex) = text.strip_prefix("1+r")?.split(';').next()?.split_once('=')?;
    if !name.eq_ignore_ascii_case("544e") {
        return None;
    }
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    let bytes: Option<Vec<u8>> = hex.as_bytes().chunks(2).map(byte).collect();
    String::from_utf8(bytes?).ok()
}

/// `rgb:r/g/b` or `rgba:r/g/b/a`, one to four hexadecimal digits each.
fn colour(text: &str) -> Option<[u8; 3]> {
    let parts = text.strip_prefix("rgb:").or_else(|| text.strip_prefix("rgba:"))?;
    let mut channels = parts.split('/').map(|digits| {
        let most =
            16_u32.checked_pow(u32::try_from(digits.len()).ok()?).filter(|m| (16..=65_536).contains(m))?;
        u8::try_from(u32::from_str_radix(digits, 16).ok()? * 255 / (most - 1)).ok()
    });
    Some([channels.next()??, channels.next()??, channels.next()??])
}
