//! The undo tree against a plain model of it: every entry's own list of ancestors.

use proptest::prelude::*;

use super::{Entry, EntryId, History, HistoryError, Step};

fn root() -> Entry {
    Entry {
        id: EntryId::ROOT,
        parent: None,
        next: None,
        label: String::new(),
        author: String::new(),
        time: String::new(),
    }
}

fn push(history: &mut History) -> EntryId {
    history.push("edit".to_owned(), "ada".to_owned(), "2026-01-01T00:00:00Z".to_owned())
}

fn go(history: &mut History, to: EntryId) {
    let path = history.path(history.head(), to).expect("both exist");
    history.walk(&path);
}

/// The entries from the root to this one: what the document is made of there.
fn lineage(history: &History, mut id: EntryId) -> Vec<EntryId> {
    let mut ids = vec![id];
    while let Some(parent) = history.get(id).and_then(|entry| entry.parent) {
        id = parent;
        ids.insert(0, id);
    }
    ids
}

#[test]
fn undo_and_redo_keep_to_the_branch_visited_last() {
    let mut history = History::new(vec![root()], EntryId::ROOT).unwrap();
    let (a, b) = (push(&mut history), push(&mut history));
    go(&mut history, a);
    let c = push(&mut history);
    assert_eq!((history.undo_target(), history.redo_target()), (Some(a), None));
    go(&mut history, a);
    assert_eq!(history.redo_target(), Some(c), "the newer branch");
    go(&mut history, b);
    go(&mut history, EntryId::ROOT);
    assert_eq!((history.undo_target(), history.redo_target()), (None, Some(a)));
    go(&mut history, a);
    assert_eq!(history.redo_target(), Some(b), "the branch visited last");
    assert_eq!(history.path(b, c), Some(vec![Step::Back(b), Step::Forward(c)]));
    assert_eq!(history.path(b, EntryId(9)), None);
}

proptest! {
    #[test]
    fn walking_the_path_arrives(moves in prop::collection::vec((any::<bool>(), any::<prop::sample::Index>()), 1..60)) {
        let mut history = History::new(vec![root()], EntryId::ROOT).unwrap();
        for (add, index) in moves {
            if add {
                push(&mut history);
                continue;
            }
            let to = EntryId(u32::try_from(index.index(history.entries().len())).unwrap());
            // Walk on the lineage: back takes its end away, forward adds to it.
            let mut ids = lineage(&history, history.head());
            for step in history.path(history.head(), to).unwrap() {
                match step {
                    Step::Back(id) => prop_assert_eq!(ids.pop(), Some(id)),
                    Step::Forward(id) => ids.push(id),
                }
            }
            prop_assert_eq!(ids, lineage(&history, to));
            go(&mut history, to);
            prop_assert_eq!(history.head(), to);
            if let Some(parent) = history.undo_target() {
                go(&mut history, parent);
                prop_assert_eq!(history.redo_target(), Some(to));
            }
        }
        let again = History::new(history.entries().to_vec(), history.head());
        prop_assert_eq!(again, Ok(history));
    }
}

#[test]
fn refuses_what_is_no_tree() {
    let child = |id, parent| Entry { id: EntryId(id), parent: Some(EntryId(parent)), ..root() };
    let cases = [
        (vec![], 0, 0),
        (vec![root()], 1, 1),
        (vec![root(), child(2, 0)], 0, 1),
        (vec![root(), child(1, 1)], 0, 1),
        (vec![root(), Entry { parent: None, ..child(1, 0) }], 0, 1),
        (vec![Entry { next: Some(EntryId(2)), ..root() }, child(1, 0), child(2, 1)], 0, 0),
    ];
    for (entries, head, broken) in cases {
        assert_eq!(History::new(entries, EntryId(head)), Err(HistoryError(EntryId(broken))));
    }
}
