//! Keys to actions, and back: the one source of hints, menus and help.

mod user;

use super::action::{Action, Context, TABLE};
use crate::term::key::{Code, Key};

/// One way to call an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Where.
    pub context: Context,
    /// The keys, in order.
    pub keys: Vec<Key>,
    /// What they call.
    pub action: Action,
}

/// What the keys typed so far are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// An action, whole.
    Action(Action),
    /// The beginning of some.
    Prefix,
    /// Nothing.
    Nothing,
}

/// What a key is, with those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Read {
    /// It calls this.
    Action(Action),
    /// It is a letter of a text.
    Text(char),
    /// Nothing, or nothing yet.
    Nothing,
}

/// The live key map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyMap {
    bindings: Vec<Binding>,
}

impl Default for KeyMap {
    fn default() -> Self {
        let mut bindings = Vec::new();
        for info in TABLE {
            for &(context, _) in info.places {
                for sequence in info.keys {
                    let keys: Vec<Key> = sequence.split(' ').filter_map(|k| k.parse().ok()).collect();
                    let is_typed = context.is_text() && keys.iter().any(|k| k.text().is_some());
                    if !is_typed {
                        bindings.push(Binding { context, keys, action: info.action });
                    }
                }
            }
        }
        Self { bindings }
    }
}

impl KeyMap {
    /// All bindings, in the order of the table.
    #[must_use]
    pub fn bindings(&self) -> &[Binding] {
        &self.bindings
    }

    /// What typed keys mean in a place.
    #[must_use]
    pub fn find(&self, context: Context, typed: &[Key]) -> Found {
        let mut found = Found::Nothing;
        for binding in self.in_context(context) {
            if binding.keys == typed {
                return Found::Action(binding.action);
            }
            if binding.keys.starts_with(typed) {
                found = Found::Prefix;
            }
        }
        found
    }

    /// Reads a key in a place, after those of a sequence that is not whole yet: a letter alone that calls nothing is text.
    pub fn read(&self, context: Context, pending: &mut Vec<Key>, key: Key) -> Read {
        pending.push(key);
        match self.find(context, pending) {
            Found::Prefix => Read::Nothing,
            Found::Action(action) => {
                pending.clear();
                Read::Action(action)
            }
            Found::Nothing => {
                let is_alone = std::mem::take(pending).len() == 1;
                key.text().filter(|_| is_alone).map_or(Read::Nothing, Read::Text)
            }
        }
    }

    /// The bindings that begin with some keys.
    pub fn after<'a>(&'a self, context: Context, typed: &'a [Key]) -> impl Iterator<Item = &'a Binding> + 'a {
        self.in_context(context).filter(move |b| b.keys.len() > typed.len() && b.keys.starts_with(typed))
    }

    /// The first keys that call an action in a place, as shown: `g f`, `⏎`.
    #[must_use]
    pub fn keys_of(&self, context: Context, action: Action) -> Option<String> {
        self.in_context(context).find(|b| b.action == action).map(|b| shown(&b.keys))
    }

    /// All keys that call an action in a place, as shown.
    #[must_use]
    pub fn all_keys_of(&self, context: Context, action: Action) -> Vec<String> {
        self.in_context(context).filter(|b| b.action == action).map(|b| shown(&b.keys)).collect()
    }

    /// The hint line: keys and what they do here. Neighbours that do alike share one hint (`hjkl 1 px`).
    #[must_use]
    pub fn hints(&self, context: Context) -> Vec<(String, &'static str)> {
        let mut hints: Vec<(String, &'static str)> = Vec::new();
        for info in TABLE {
            let Some(word) = info.action.word_in(context).filter(|word| !word.is_empty()) else { continue };
            let Some(keys) = self.keys_of(context, info.action) else { continue };
            match hints.iter_mut().find(|(_, other)| *other == word) {
                Some((shared, _)) => shared.push_str(&keys),
                None => hints.push((keys, word)),
            }
        }
        hints
    }

    fn in_context(&self, context: Context) -> impl Iterator<Item = &Binding> {
        self.bindings.iter().filter(move |b| b.context == context)
    }
}

/// A sequence as hints show it.
#[must_use]
pub fn shown(keys: &[Key]) -> String {
    let words: Vec<String> = keys
        .iter()
        .map(|key| match key.code {
            Code::Enter => "⏎".to_owned(),
            _ => key.to_string(),
        })
        .collect();
    words.join(" ")
}

#[cfg(test)]
mod tests;
