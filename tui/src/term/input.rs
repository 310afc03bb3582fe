//! Decoder of what a terminal sends: keys, mouse, paste, and replies to queries.
//!
//! Incremental: bytes may be split anywhere. Time decides only three things: whether an `ESC` at the end of what
//! has come is the Esc key or the beginning of more, whether a paste goes on, and whether a sequence was cut off.
//! The caller waits as long as it likes while there is something [`Decoder::unfinished`], then calls
//! [`Decoder::flush`].

mod csi;
mod string;

use serde::{Deserialize, Serialize};

use super::key::{Code, Key};

/// What the terminal has sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A key was pressed.
    Key(Key),
    /// The mouse did something.
    Mouse(Mouse),
    /// Text was pasted.
    Paste(String),
    /// The terminal answers a query.
    Reply(Reply),
}

/// A mouse event; column and row count cells from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mouse {
    /// What happened.
    pub kind: MouseKind,
    /// Cells from the left.
    pub column: u16,
    /// Cells from the top.
    pub row: u16,
}

/// What a mouse did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MouseKind {
    /// Button 0 (left), 1 (middle) or 2 (right) went down.
    Press(u8),
    /// It moved with that button down.
    Drag(u8),
    /// That button went up.
    Release(u8),
    /// The wheel turned away from the user.
    WheelUp,
    /// The wheel turned towards the user.
    WheelDown,
}

/// Answers of terminals. None of them can be mistaken for a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// `CSI 0 n`: everything before the query `CSI 5 n` has been processed.
    Ready,
    /// `CSI ? mode ; state $ y` (DECRQM); state 0 = unknown, 1 = set, 2 = reset, 3 and 4 = permanently so.
    Mode {
        /// Private mode asked for.
        mode: u16,
        /// What the terminal says of it.
        state: u16,
    },
    /// `DCS > | text ST` (XTVERSION): name and version.
    Version(String),
    /// `CSI ? class ; features c` (DA1).
    Attributes(Vec<u16>),
    /// `APC G i = number ; word ST` (kitty's protocol): whether a picture would have been taken.
    Graphics {
        /// The word is `OK`.
        is_ok: bool,
    },
    /// `DCS 1 + r 544E = hex ST` (XTGETTCAP): name of the terminfo entry.
    Entry(String),
    /// `CSI 6 ; height ; width t`: pixels of a cell.
    CellSize {
        /// Pixels across.
        width: u16,
        /// Pixels down.
        height: u16,
    },
    /// `CSI 4 ; height ; width t`: pixels of all cells.
    TextSize {
        /// Pixels across.
        width: u16,
        /// Pixels down.
        height: u16,
    },
    /// `OSC 11 ; rgb : r / g / b ST`: colour of the background.
    Background([u8; 3]),
}

/// What ends only when nothing more comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfinished {
    /// An `ESC`, alone or with one byte: a key, unless a sequence follows.
    Escape,
    /// A paste whose end has not come.
    Paste,
    /// A sequence whose end has not come, the n-th of all that was decoded: it says whether time has run out for
    /// this one or for an earlier one.
    Sequence(u64),
}

/// Longest control sequence, bytes; a longer one is garbage.
const CSI_MAX: usize = 64;
/// Longest control string (OSC, DCS …), bytes; the rest of a longer one is dropped.
const STRING_MAX: usize = 4096;
/// Longest pasted text, bytes; the rest of a longer one is dropped.
const PASTE_MAX: usize = 4096;
const PASTE_END: &[u8] = b"\x1b[201~";

/// Turns bytes into events.
#[derive(Debug, Default)]
pub struct Decoder {
    pending: Vec<u8>,
    mode: Mode,
    /// How much has been decoded so far, in steps.
    n_steps: u64,
}

#[derive(Debug, Default)]
enum Mode {
    #[default]
    Ground,
    /// Inside a bracketed paste.
    Paste(Vec<u8>),
    /// Inside a control string that was too long: up to its end nothing counts.
    Drop,
}

/// What the head of the pending bytes is.
enum Head {
    /// An event, or nothing of interest, of this many bytes.
    Whole(Option<Event>, usize),
    /// A pasted text begins after this many bytes.
    PasteBegins(usize),
    /// A control string too long to keep, of which this many bytes are here.
    TooLong(usize),
    /// More bytes are needed.
    Part,
}

impl Decoder {
    /// Decodes all that is complete, keeping the rest.
    pub fn feed(&mut self, bytes: &[u8], events: &mut Vec<Event>) {
        self.pending.extend_from_slice(bytes);
        let mut start = 0;
        while start < self.pending.len() {
            let used = self.step(start, events);
            if used == 0 {
                break;
            }
            // A string too long to keep is still the same one.
            self.n_steps += u64::from(!matches!(self.mode, Mode::Drop));
            start += used;
        }
        self.pending.drain(..start);
    }

    /// What would end if nothing followed.
    #[must_use]
    pub fn unfinished(&self) -> Option<Unfinished> {
        match (&self.mode, &self.pending[..]) {
            (Mode::Ground, [0x1b] | [0x1b, _]) => Some(Unfinished::Escape),
            (Mode::Paste(_), _) => Some(Unfinished::Paste),
            (Mode::Drop, _) | (Mode::Ground, [0x1b, _, ..]) => Some(Unfinished::Sequence(self.n_steps)),
            (Mode::Ground, _) => None,
        }
    }

    /// Says that nothing follows: a lone `ESC` is the Esc key, a paste is over, half a sequence is nothing.
    pub fn flush(&mut self, events: &mut Vec<Event>) {
        let event = match (&self.mode, &self.pending[..]) {
            (Mode::Ground, [0x1b, c @ 0x20..=0x7e]) => {
                Some(Event::Key(Key { alt: true, ..Key::plain(Code::Char(char::from(*c))) }))
            }
            (Mode::Ground, [0x1b] | [0x1b, _]) => Some(Event::Key(Key::plain(Code::Esc))),
            (Mode::Paste(text), _) => Some(pasted(text)),
            (Mode::Drop, _) | (Mode::Ground, [0x1b, ..]) => None,
            (Mode::Ground, _) => return,
        };
        self.pending.clear();
        self.mode = Mode::Ground;
        self.n_steps += 1;
        events.extend(event);
    }

    /// Handles the pending bytes from `start` on; returns how many it has used, 0 when it needs more.
    fn step(&mut self, start: usize, events: &mut Vec<Event>) -> usize {
        let rest = &self.pending[start..];
        match &mut self.mode {
            Mode::Paste(text) => {
                let end = find(rest, PASTE_END);
                // The end marker may be split: its possible beginning stays pending.
                let n = end.unwrap_or_else(|| rest.len() - partial_suffix(rest, PASTE_END));
                text.extend_from_slice(&rest[..n.min(PASTE_MAX.saturating_sub(text.len()))]);
                if end.is_none() {
                    return n;
                }
                events.push(pasted(text));
                self.mode = Mode::Ground;
                n + PASTE_END.len()
            }
            Mode::Drop => match string::end(rest) {
                Some((_, n)) => {
                    self.mode = Mode::Ground;
                    n
                }
                // An ESC at the end may be half of the terminator.
                None => rest.len() - usize::from(rest.last() == Some(&0x1b)),
            },
            Mode::Ground => match head(rest) {
                Head::Whole(event, n) => {
                    events.extend(event);
                    n
                }
                Head::PasteBegins(n) => {
                    self.mode = Mode::Paste(Vec::new());
                    n
                }
                Head::TooLong(n) => {
                    self.mode = Mode::Drop;
                    n
                }
                Head::Part => 0,
            },
        }
    }
}

fn pasted(text: &[u8]) -> Event {
    Event::Paste(String::from_utf8_lossy(text).into_owned())
}

fn find(hay: &[u8], needle: &[u8]) -> Option<usize> {
    hay.windows(needle.len()).position(|w| w == needle)
}

/// Length of the longest end of `hay` that is a beginning of `needle`.
fn partial_suffix(hay: &[u8], needle: &[u8]) -> usize {
    (1..needle.len().min(hay.len() + 1)).rev().find(|&n| hay.ends_with(&needle[..n])).unwrap_or(0)
}

fn head(bytes: &[u8]) -> Head {
    let key = |code| Head::Whole(Some(Event::Key(Key::plain(code))), 1);
    let ctrl =
        |c: u8| Head::Whole(Some(Event::Key(Key { ctrl: true, ..Key::plain(Code::Char(char::from(c))) })), 1);
    match bytes[0] {
        0x1b => escape(bytes),
        b'\r' | b'\n' => key(Code::Enter),
        b'\t' => key(Code::Tab),
        0x7f | 0x08 => key(Code::Backspace),
        0 => ctrl(b' '),
        c @ 1..=26 => ctrl(c - 1 + b'a'),
        c @ 28..=31 => ctrl(c - 28 + b'\\'),
        _ => match utf8(bytes) {
            Ok((c, n)) => Head::Whole(Some(Event::Key(Key::plain(Code::Char(c)))), n),
            Err(head) => head,
        },
    }
}

/// The first character; invalid bytes are dropped one by one.
fn utf8(bytes: &[u8]) -> Result<(char, usize), Head> {
    let n = match bytes[0] {
        0..=0x7f => 1,
        0xc2..=0xdf => 2,
        0xe0..=0xef => 3,
        0xf0..=0xf4 => 4,
        _ => return Err(Head::Whole(None, 1)),
    };
    // Continuation bytes are judged as they come, so that a split changes nothing.
    let here = bytes.len().min(n);
    if bytes[1..here].iter().any(|b| b & 0xc0 != 0x80) {
        return Err(Head::Whole(None, 1));
    }
    if here < n {
        return Err(Head::Part);
    }
    match std::str::from_utf8(&bytes[..n]).ok().and_then(|s| s.chars().next()) {
        Some(c) => Ok((c, n)),
        None => Err(Head::Whole(None, 1)),
    }
}

fn escape(bytes: &[u8]) -> Head {
    match bytes.get(1) {
        None => Head::Part,
        Some(b'[') => csi::head(bytes),
        Some(b'O') => match bytes.get(2) {
            None => Head::Part,
            Some(&c) => match csi::letter_key(c) {
                Some(code) => Head::Whole(Some(Event::Key(Key::plain(code))), 3),
                None => Head::Whole(Some(Event::Key(Key { alt: true, ..Key::plain(Code::Char('O')) })), 2),
            },
        },
        Some(b']' | b'P' | b'_' | b'^' | b'X') => string::head(bytes),
        Some(0x1b) => Head::Whole(Some(Event::Key(Key::plain(Code::Esc))), 1),
        Some(_) => match head(&bytes[1..]) {
            Head::Whole(Some(Event::Key(key)), n) => {
                Head::Whole(Some(Event::Key(Key { alt: true, ..key })), n + 1)
            }
            Head::Whole(other, n) => Head::Whole(other, n + 1),
            other => other,
        },
    }
}

#[cfg(test)]
mod tests;
