//! What the terminal can do: one question at the start, answers whenever they come.
//!
//! Nothing waits for an answer. What is not known is not used, with one exception: synchronized output, which
//! terminals without it ignore. The environment only says how to ask; it never makes the terminal able to do
//! anything, because ssh forwards variables of another terminal and `TERM` lies.

use std::fmt;

use super::colour::Depth;
use super::input::Reply;

/// Who are you, do you know synchronized output.
const ASK: &[u8] = b"\x1b[>q\x1b[?2026$p";
/// A picture of one pixel, which is not to be kept: do you know kitty's protocol?
const ASK_KITTY: &[u8] = b"\x1b_Gi=1,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\";
/// The same question, and what is your terminfo entry, to the terminal in which tmux runs: tmux hands both on
/// only where its user allows passthrough. XTVERSION would be kept by tmux for itself.
const ASK_THROUGH_TMUX: &[u8] =
    b"\x1bPtmux;\x1b\x1b_Gi=1,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\x1b\\\x1b\\\x1bPtmux;\x1b\x1bP+q544e\x1b\x1b\\\x1b\\";
/// Size of a cell, size of everything, colour of the background; then what everybody answers.
const ASK_LAST: &[u8] = b"\x1b[16t\x1b[14t\x1b]11;?\x1b\\\x1b[c";

/// Field of DA1 that says sixel.
const SIXEL: u16 = 4;
/// Sides of a cell that are believed, pixels.
const CELL_PX: std::ops::RangeInclusive<u16> = 3..=200;

/// How pixels get to the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// JPEG by OSC 1337; in parts, where the terminal knows them.
    Iterm {
        /// The file may come in several sequences.
        in_parts: bool,
    },
    /// PNG by kitty's protocol, straight.
    Kitty,
    /// PNG by kitty's protocol through tmux, placed by characters.
    KittyInTmux,
    /// Sixel, for cells of so many pixels.
    Sixel {
        /// Width and height of a cell, pixels.
        cell_px: (u16, u16),
    },
}

/// What stands between the program and the terminal, as far as the environment says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Around {
    /// Nothing, or nothing that is known.
    #[default]
    Nothing,
    /// tmux.
    Tmux,
    /// Something that sets `TERM=screen…`: GNU screen, or an old tmux.
    Screen,
}

impl Around {
    /// From the environment (`TMUX`, `TERM`).
    #[must_use]
    pub fn from_env(var: impl Fn(&str) -> Option<String>) -> Self {
        let term = var("TERM").unwrap_or_default();
        if var("TMUX").is_some() || term.starts_with("tmux") {
            Self::Tmux
        } else if term.starts_with("screen") {
            Self::Screen
        } else {
            Self::Nothing
        }
    }
}

/// What is known of the terminal.
#[derive(Clone, Debug, Default)]
pub struct Capabilities {
    around: Around,
    /// Name and version, as it says itself.
    version: Option<String>,
    /// What it says of mode 2026.
    sync: Option<u16>,
    /// Fields of DA1: its class, then what it can do.
    attributes: Option<Vec<u16>>,
    /// It has answered the question for kitty's protocol.
    kitty: bool,
    /// The terminfo entry of the terminal behind tmux.
    entry: Option<String>,
    /// Width and height of a cell, pixels.
    cell_px: Option<(u16, u16)>,
    /// Width and height of all cells, pixels.
    text_px: Option<(u16, u16)>,
    background: Option<[u8; 3]>,
}

impl Capabilities {
    /// Nothing is known yet but what stands around.
    #[must_use]
    pub fn new(around: Around) -> Self {
        Self { around, ..Self::default() }
    }

    /// The questions, to be sent in one write. DA1 is the last: whoever has answered it has answered all.
    #[must_use]
    pub fn questions(&self) -> Vec<u8> {
        let kitty = match self.around {
            Around::Nothing => ASK_KITTY,
            Around::Tmux => ASK_THROUGH_TMUX,
            // GNU screen would show the wrapping, an old tmux would take the question for a title.
            Around::Screen => b"",
        };
        [ASK, kitty, ASK_LAST].concat()
    }

    /// Takes notice of an answer, in any order, early or late.
    pub fn learn(&mut self, reply: &Reply) {
        let believed = |(width, height): (u16, u16)| CELL_PX.contains(&width) && CELL_PX.contains(&height);
        match reply {
            Reply::Version(version) => self.version = Some(version.clone()),
            Reply::Mode { mode: 2026, state } => self.sync = Some(*state),
            Reply::Attributes(fields) => self.attributes = Some(fields.clone()),
            Reply::Graphics { is_ok } => self.kitty = *is_ok,
            Reply::Entry(entry) => self.entry = Some(entry.clone()),
            Reply::CellSize { width, height } if believed((*width, *height)) => {
                self.cell_px = Some((*width, *height));
            }
            Reply::TextSize { width, height } => self.text_px = Some((*width, *height)),
            Reply::Background(rgb) => self.background = Some(*rgb),
            Reply::CellSize { .. } | Reply::Mode { .. } | Reply::Ready => {}
        }
    }

    /// Whether frames are to be bracketed as one update.
    ///
    /// tmux 3.7 to 3.7c redraw the whole pane at the end of each (tmux PR 5612).
    #[must_use]
    pub fn synchronizes(&self) -> bool {
        let redraws = matches!(self.tmux(), Some("3.7" | "3.7a" | "3.7b" | "3.7c"));
        match self.sync {
            _ if redraws => false,
            Some(state) => matches!(state, 1..=3),
            None => self.around == Around::Nothing && self.tmux().is_none(),
        }
    }

    /// Whether queries are answered on this side of the link, by what passes the frames on.
    #[must_use]
    pub fn is_relayed(&self) -> bool {
        self.around != Around::Nothing || self.tmux().is_some()
    }

    /// How pixels get to a terminal of so many columns and rows; `None` while that is unknown, and where they
    /// do not.
    #[must_use]
    pub fn pixels(&self, size: (u16, u16)) -> Option<Pixels> {
        let fields = self.attributes.as_ref()?;
        if self.tmux().is_some() || self.around == Around::Tmux {
            // Placing by characters is what these two know.
            let places = matches!(self.entry.as_deref(), Some("xterm-kitty" | "xterm-ghostty"));
            return (self.kitty && places).then_some(Pixels::KittyInTmux);
        }
        match self.program() {
            ("iTerm2", version) => Some(Pixels::Iterm { in_parts: is_at_least(version, (3, 5)) }),
            ("WezTerm" | "mintty", _) => Some(Pixels::Iterm { in_parts: false }),
            _ if self.kitty => Some(Pixels::Kitty),
            _ if self.around == Around::Nothing && fields.iter().skip(1).any(|&f| f == SIXEL) => {
                self.cell_px(size).map(|cell_px| Pixels::Sixel { cell_px })
            }
            _ => None,
        }
    }

    /// Width and height of a cell in pixels, on a terminal of so many columns and rows.
    #[must_use]
    pub fn cell_px(&self, (columns, rows): (u16, u16)) -> Option<(u16, u16)> {
        let whole = || {
            let (width, height) = self.text_px?;
            let cell = (width.checked_div(columns)?, height.checked_div(rows)?);
            (CELL_PX.contains(&cell.0) && CELL_PX.contains(&cell.1)).then_some(cell)
        };
        self.cell_px.or_else(whole)
    }

    /// Whether the background is known to be brighter than middle grey.
    #[must_use]
    pub fn is_light(&self) -> bool {
        // BT.601 luma, in thousandths.
        let luma = |[r, g, b]: [u8; 3]| 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
        self.background.is_some_and(|rgb| luma(rgb) > 127_500)
    }

    /// Version of tmux, where it is tmux.
    fn tmux(&self) -> Option<&str> {
        match self.program() {
            ("tmux", version) => Some(version),
            _ => None,
        }
    }

    /// Name and version: `XTerm(390)`, `tmux 3.3a`, `iTerm2 3.5.0`.
    fn program(&self) -> (&str, &str) {
        let whole = self.version.as_deref().unwrap_or_default();
        let (name, version) = whole.split_once([' ', '(']).unwrap_or((whole, ""));
        (name, version.trim_end_matches(')'))
    }
}

/// Whether a version `3.5.0beta1` is this one or later.
fn is_at_least(version: &str, (major, minor): (u32, u32)) -> bool {
    let mut numbers = version.split(|c: char| !c.is_ascii_digit()).map(|n| n.parse::<u32>().unwrap_or(0));
    (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) >= (major, minor)
}

impl fmt::Display for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Iterm { .. } => "JPEG",
            Self::Kitty => "PNG",
            Self::KittyInTmux => "PNG through tmux",
            Self::Sixel { .. } => "sixel",
        })
    }
}

impl fmt::Display for Depth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mono => "no colours",
            Self::Ansi16 => "16 colours",
            Self::Ansi256 => "256 colours",
            Self::True => "true colour",
        })
    }
}

#[cfg(test)]
mod tests;
