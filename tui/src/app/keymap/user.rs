//! A user's own keys laid over the usual ones, and what is wrong with them.
//!
//! ```toml
//! [keys]
//! undo = "u"                # wherever the action works
//! play = ["space", "F5"]    # several
//! follow = []               # none
//! [keys.move]
//! left = "a"                # only while moving a sample
//! ```

use super::{Binding, KeyMap, shown};
use crate::app::action::{Action, Context, Info, TABLE};
use crate::app::fuzzy;
use crate::term::key::Key;

impl KeyMap {
    /// The usual keys with a user's laid over them, and one line for everything that is wrong with those.
    ///
    /// What a user binds is taken from whatever had it. What cannot be understood is left out.
    #[must_use]
    pub fn with(user: &toml::Table) -> (Self, Vec<String>) {
        let mut wanted = Vec::new();
        let mut wrong = Vec::new();
        // What holds everywhere first: what is said of one place stands over it.
        for (name, value) in user {
            if !value.is_table() {
                wanted.extend(wishes(name, value, None, &mut wrong));
            }
        }
        for (place, value) in user {
            let Some(table) = value.as_table() else { continue };
            match Context::ALL.into_iter().find(|context| context.name() == place) {
                Some(context) => {
                    for (name, value) in table {
                        wanted.extend(wishes(name, value, Some(context), &mut wrong));
                    }
                }
                None => {
                    let known = Context::ALL.map(Context::name).join(", ");
                    wrong.push(format!("keys.{place}: a place is wanted, one of {known}"));
                }
            }
        }
        let mut keys = Self::default();
        for (context, action, _) in &wanted {
            keys.bindings.retain(|b| (b.context, b.action) != (*context, *action));
        }
        let mut own: Vec<Binding> = Vec::new();
        for (context, action, sequences) in wanted {
            own.retain(|b| (b.context, b.action) != (context, action));
            for sequence in sequences {
                if let Some(other) = own.iter().find(|b| b.context == context && b.keys == sequence) {
                    let (first, name) = (other.action.info().name, action.info().name);
                    let (keys, place) = (shown(&sequence), context.name());
                    wrong.push(format!(
                        "{keys} ({place}) is given to {first} and to {name}: it calls {first}"
                    ));
                } else {
                    own.push(Binding { context, keys: sequence, action });
                }
            }
        }
        keys.bindings.retain(|b| !own.iter().any(|o| o.context == b.context && o.keys == b.keys));
        keys.bindings.extend(own);
        wrong.extend(keys.lint());
        (keys, wrong)
    }

    /// What is wrong with the whole: keys that hide others, and places that cannot be left.
    #[must_use]
    pub fn lint(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        for context in Context::ALL {
            for binding in self.in_context(context) {
                let mut hidden = self.after(context, &binding.keys).map(|b| b.action.info().name);
                if let Some(first) = hidden.next() {
                    let n = hidden.count();
                    let more = if n > 0 { format!(" and {n} more") } else { String::new() };
                    let (keys, name) = (shown(&binding.keys), binding.action.info().name);
                    wrong.push(format!("{keys} ({}) calls {name} and hides {first}{more}", context.name()));
                }
            }
            let calls = |action: &Action| self.keys_of(context, *action).is_some();
            let works = |action: &Action| action.word_in(context).is_some();
            for action in
                [Action::Accept, Action::Back, Action::Quit].iter().filter(|a| works(a) && !calls(a))
            {
                wrong.push(format!("no key calls {} while in {}", action.info().name, context.name()));
            }
            // Where neither the palette nor the help opens, an action without a key is out of reach.
            if !calls(&Action::Palette) && !calls(&Action::Help) && !context.is_text() {
                let lost: Vec<&str> = TABLE
                    .iter()
                    .filter(|info| works(&info.action) && !calls(&info.action))
                    .map(|info| info.name)
                    .collect();
                if !lost.is_empty() {
                    let place = context.name();
                    wrong.push(format!("out of reach in {place}: {}", lost.join(", ")));
                }
            }
        }
        wrong
    }
}

/// Keys wanted for an action in a place.
type Wish = (Context, Action, Vec<Vec<Key>>);

/// What one line of a key map asks for, in one place or wherever the action works.
fn wishes(name: &str, value: &toml::Value, place: Option<Context>, wrong: &mut Vec<String>) -> Vec<Wish> {
    let Some(info) = TABLE.iter().find(|info| info.name == name) else {
        wrong.push(format!("there is no action {name}{}", alike(name)));
        return Vec::new();
    };
    let Some(sequences) = sequences(name, value, wrong) else { return Vec::new() };
    let places = info.places.iter().map(|(context, _)| *context);
    let places: Vec<Context> = places.filter(|context| place.is_none_or(|place| place == *context)).collect();
    if let Some(place) = place.filter(|_| places.is_empty()) {
        wrong.push(format!("{name} does nothing in {}", place.name()));
    }
    let fit = |context: Context| {
        let is_typed = |keys: &Vec<Key>| context.is_text() && keys.iter().any(|key| key.text().is_some());
        (context, info.action, sequences.iter().filter(|keys| !is_typed(keys)).cloned().collect::<Vec<_>>())
    };
    // Where letters are text, a letter for everywhere leaves the usual key.
    let is_meant = |wish: &Wish| !wish.2.is_empty() || sequences.is_empty();
    places.into_iter().map(fit).filter(is_meant).collect()
}

/// The key sequences of a value: one, or a list of them.
fn sequences(name: &str, value: &toml::Value, wrong: &mut Vec<String>) -> Option<Vec<Vec<Key>>> {
    let texts: Option<Vec<&str>> = match value {
        toml::Value::String(text) => Some(vec![text]),
        toml::Value::Array(list) => list.iter().map(toml::Value::as_str).collect(),
        _ => None,
    };
    let Some(texts) = texts else {
        wrong.push(format!("{name}: keys are wanted, as \"g f\" or [\"g f\", \"F5\"], got {value}"));
        return None;
    };
    let mut sequences = Vec::new();
    for text in texts {
        match text.split_whitespace().map(str::parse).collect::<Result<Vec<Key>, _>>() {
            Ok(keys) if !keys.is_empty() => sequences.push(keys),
            Ok(_) => wrong.push(format!("{name}: a key is wanted, nothing came")),
            Err(error) => wrong.push(format!("{name}: {error}")),
        }
    }
    Some(sequences)
}

fn alike(name: &str) -> String {
    let best = |info: &&Info| fuzzy::score(name, info.name).or_else(|| fuzzy::score(info.name, name));
    let close = TABLE.iter().filter(|info| best(info).is_some()).max_by_key(best);
    close.map_or_else(String::new, |info| format!("; did you mean {}?", info.name))
}
