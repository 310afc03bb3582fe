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
    assert_eq!(line(Context::Move), "hjkl 1 px  HJKL .25  ⏎ keep  Esc back");
    assert_eq!(line(Context::Menu), "⏎ choose  Esc back");
    let mut changed = keys.clone();
    for binding in &mut changed.bindings {
        if binding.action == Action::Accept {
            binding.keys = vec![Key::plain(Code::F(1))];
        }
    }
    assert!(changed.hints(Context::Move).contains(&("F1".to_owned(), "keep")));
}
