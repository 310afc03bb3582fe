//! Keys as terminals report them and as tables and tests write them (`g`, `Ctrl-r`, `space`, `Enter`).

use std::fmt;
use std::str::FromStr;

/// A key without its modifiers. Letters carry their case: `A` is not `a` with shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "each variant is the name on the key")]
pub enum Code {
    Char(char),
    Enter,
    Esc,
    Tab,
    Backspace,
    Delete,
    Insert,
    Up,
    Down,
    Left,
    Right,
    Home,
    End,
    PageUp,
    PageDown,
    F(u8),
}

/// A key with the modifiers that terminals can tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// Which key.
    pub code: Code,
    /// Held with Ctrl.
    pub ctrl: bool,
    /// Held with Alt.
    pub alt: bool,
    /// Held with Shift; always false for characters.
    pub shift: bool,
}

impl Key {
    /// The key alone.
    #[must_use]
    pub const fn plain(code: Code) -> Self {
        Self { code, ctrl: false, alt: false, shift: false }
    }

    /// The key with the modifiers of an xterm parameter: 1 + shift + 2 alt + 4 ctrl (higher bits are dropped).
    #[must_use]
    pub const fn with_modifiers(code: Code, parameter: u16) -> Self {
        let bits = parameter.saturating_sub(1);
        let shift = bits & 1 != 0 && !matches!(code, Code::Char(_));
        Self { code, shift, alt: bits & 2 != 0, ctrl: bits & 4 != 0 }
    }

    /// The character it types, if it types one.
    #[must_use]
    pub fn text(self) -> Option<char> {
        match self.code {
            Code::Char(c) if !self.ctrl && !self.alt => Some(c),
            _ => None,
        }
    }
}

/// Names of the keys that no single character names. The first name of a code is the one shown.
const NAMES: [(&str, Code); 18] = [
    ("space", Code::Char(' ')),
    ("Enter", Code::Enter),
    ("Esc", Code::Esc),
    ("Tab", Code::Tab),
    ("Backspace", Code::Backspace),
    ("Delete", Code::Delete),
    ("Insert", Code::Insert),
    ("Up", Code::Up),
    ("Down", Code::Down),
    ("Left", Code::Left),
    ("Right", Code::Right),
    ("Home", Code::Home),
    ("End", Code::End),
    ("PageUp", Code::PageUp),
    ("PageDown", Code::PageDown),
    ("F1", Code::F(1)),
    ("F2", Code::F(2)),
    ("F12", Code::F(12)),
];

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (held, name) in [(self.ctrl, "Ctrl-"), (self.alt, "Alt-"), (self.shift, "Shift-")] {
            if held {
                f.write_str(name)?;
            }
        }
        match (NAMES.iter().find(|(_, code)| *code == self.code), self.code) {
            (Some((name, _)), _) => f.write_str(name),
            (None, Code::Char(c)) => write!(f, "{c}"),
            (None, Code::F(n)) => write!(f, "F{n}"),
            (None, other) => write!(f, "{other:?}"),
        }
    }
}

/// A word that names no key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyError(String);

impl fmt::Display for KeyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a key like `g`, `Ctrl-r` or `Enter` is wanted, `{}` came", self.0)
    }
}

impl std::error::Error for KeyError {}

impl FromStr for Key {
    type Err = KeyError;

    fn from_str(word: &str) -> Result<Self, KeyError> {
        let mut key = Self::plain(Code::Esc);
        let mut rest = word;
        loop {
            let held = [("Ctrl-", &mut key.ctrl), ("Alt-", &mut key.alt), ("Shift-", &mut key.shift)]
                .into_iter()
                .find_map(|(name, flag)| {
                    rest.strip_prefix(name).filter(|r| !r.is_empty()).map(|r| (r, flag))
                });
            let Some((after, flag)) = held else { break };
            *flag = true;
            rest = after;
        }
        let mut chars = rest.chars();
        key.code = match (chars.next(), chars.next()) {
            (Some(c), None) => Code::Char(c),
            _ => NAMES
                .iter()
                .find(|(name, _)| *name == rest)
                .map(|(_, code)| *code)
                .or_else(|| rest.strip_prefix('F').and_then(|n| n.parse().ok()).map(Code::F))
                .ok_or_else(|| KeyError(word.to_owned()))?,
        };
        Ok(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back() {
        for word in
            ["g", "G", "-", "Ctrl-r", "Alt-Left", "Shift-Tab", "space", "Ctrl-space", "F7", "é", "Ctrl--"]
        {
            assert_eq!(word.parse::<Key>().map(|k| k.to_string()), Ok(word.to_owned()));
        }
        assert_eq!("Entr".parse::<Key>(), Err(KeyError("Entr".to_owned())));
    }
}
