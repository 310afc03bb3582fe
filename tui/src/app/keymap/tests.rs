//! The table is sound: every action has words and keys, no key has two meanings, hints are the key map.

use std::collections::BTreeMap;

use super::*;

#[test]
fn every_action_has_a_name_a_doc_and_keys_that_parse() {
    let mut names = std::collections::BTreeSet::new();
    for (i, info) in TABLE.iter().enumerate() {
        assert_eq!(info.action as usize, i);
        assert!(names.insert(info.name), "{} twice", info.name);
        assert!(info.doc.len() > 5 && !info.doc.ends_with('.'), "{}", info.name);
        assert!(!info.keys.is_empty() && !info.places.is_empty(), "{}", info.name);
        for key in info.keys.iter().flat_map(|keys| keys.split(' ')) {
            assert_eq!(key.parse::<Key>().map(|k| k.to_string()), Ok(key.to_owned()));
        }
    }
}

#[test]
fn a_key_has_one_meaning_in_all_places() {
    let mut meaning: BTreeMap<Vec<Key>, Action> = BTreeMap::new();
    for binding in KeyMap::default().bindings() {
        let first = *meaning.entry(binding.keys.clone()).or_insert(binding.action);
        assert_eq!(first, binding.action, "{} means two things", shown(&binding.keys));
    }
}

#[test]
fn no_binding_hides_another() {
    let keys = KeyMap::default();
    for binding in keys.bindings() {
        assert_eq!(keys.find(binding.context, &binding.keys), Found::Action(binding.action));
        for n in 1..binding.keys.len() {
            assert_eq!(keys.find(binding.context, &binding.keys[..n]), Found::Prefix, "{binding:?}");
        }
    }
    assert_eq!(keys.find(Context::Menu, &[Key::plain(Code::Char('q'))]), Found::Nothing, "letters are text");
}

#[test]
fn hints_are_the_live_key_map() {
    let keys = KeyMap::default();
    let line = |context| {
        let hints = keys.hints(context);
        hints.iter().map(|(k, w)| format!("{k} {w}")).collect::<Vec<_>>().join("  ")
    };
    assert_eq!(line(Context::Move), "hjkl 1 px  HJKL .25  ⏎ keep  Esc back  * end here  Tab model");
    assert_eq!(line(Context::Menu), "⏎ choose  Esc back");
    let mut changed = keys.clone();
    for binding in &mut changed.bindings {
        if binding.action == Action::Accept {
            binding.keys = vec![Key::plain(Code::F(1))];
        }
    }
    assert!(changed.hints(Context::Move).contains(&("F1".to_owned(), "keep")));
}

/// A key map with a user's own, and what is said of it.
fn with(text: &str) -> (KeyMap, Vec<String>) {
    KeyMap::with(&text.parse().expect("TOML"))
}

#[test]
fn a_users_keys_lie_over_the_usual_ones() {
    let (keys, wrong) = with("undo = [\"U\", \"F5\"]\nfollow = []\n[move]\nleft = \"a\"");
    assert_eq!(wrong, Vec::<String>::new());
    let find = |context, text: &str| {
        let typed: Vec<Key> = text.split(' ').map(|k| k.parse().expect("a key")).collect();
        keys.find(context, &typed)
    };
    for (context, typed, expect) in [
        (Context::Review, "U", Found::Action(Action::Undo)),
        (Context::Review, "F5", Found::Action(Action::Undo)),
        (Context::Review, "u", Found::Nothing),
        (Context::Review, "f", Found::Nothing),
        (Context::Move, "a", Found::Action(Action::Left)),
        (Context::Move, "h", Found::Nothing),
        (Context::Review, "h", Found::Action(Action::Left)),
        (Context::Review, "a", Found::Action(Action::AddFeature)),
    ] {
        assert_eq!(find(context, typed), expect, "{typed}");
    }
    assert_eq!(keys.keys_of(Context::Move, Action::Left).as_deref(), Some("a"), "hints follow");
}

#[test]
fn what_is_wrong_with_a_users_keys_is_said() {
    for (text, expect) in [
        ("undoo = \"u\"", "there is no action undoo; did you mean undo?"),
        ("undo = \"Entr\"", "undo: a key like `g`, `Ctrl-r` or `Enter` is wanted, `Entr` came"),
        ("undo = 7", "undo: keys are wanted, as \"g f\" or [\"g f\", \"F5\"], got 7"),
        ("undo = \"\"", "undo: a key is wanted, nothing came"),
        ("undo = \"F5\"\nredo = \"F5\"", "F5 (review) is given to redo and to undo: it calls redo"),
        ("[move]\nundo = \"F5\"", "undo does nothing in move"),
        ("[moving]\nleft = \"a\"", "keys.moving: a place is wanted, one of "),
        ("undo = \"g\"", "g (review) calls undo and hides go-"),
        ("back = []", "no key calls back while in move"),
        ("palette = []\nhelp = []\nfollow = []", "out of reach in review: "),
    ] {
        let (_, wrong) = with(text);
        assert!(wrong.iter().any(|line| line.starts_with(expect)), "{text}: {wrong:?}");
    }
    assert_eq!(KeyMap::default().lint(), Vec::<String>::new());
}
