//! The history of a document: a tree of transactions, so that nothing undone is ever lost.
//!
//! Undo goes to the parent, redo to the child visited last, and any entry can be reached: back along the
//! inverses to the common ancestor, then forward. Pure logic; the store keeps entries and head.

use serde::{Deserialize, Serialize};

/// Number of an entry: 0 is the empty document, then counted up; also the project's revision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct EntryId(pub u32);

impl EntryId {
    /// The document before the first edit.
    pub const ROOT: Self = Self(0);
}

impl std::fmt::Display for EntryId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// One transaction in the history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its number.
    pub id: EntryId,
    /// What it was done to; `None` for the root only.
    pub parent: Option<EntryId>,
    /// The child visited last: where redo goes.
    pub next: Option<EntryId>,
    /// What happened.
    pub label: String,
    /// Who did it.
    pub author: String,
    /// When, RFC 3339.
    pub time: String,
}

/// One step of a way through the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Apply this entry's inverse: from it to its parent.
    Back(EntryId),
    /// Apply this entry: from its parent to it.
    Forward(EntryId),
}

/// Why entries are no history.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("entry {0} of the history is missing, out of order, or hangs on one that came later")]
pub struct HistoryError(pub EntryId);

/// The tree of entries and the one the document stands at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct History {
    entries: Vec<Entry>,
    head: EntryId,
}

impl History {
    /// A tree from its entries, numbered 0, 1, 2, … with every parent before its children.
    ///
    /// # Errors
    /// [`HistoryError`] with the first entry that breaks the rule, or a head that is none.
    pub fn new(entries: Vec<Entry>, head: EntryId) -> Result<Self, HistoryError> {
        for (number, entry) in (0_u32..).zip(&entries) {
            let parent_is_earlier = match entry.parent {
                None => number == 0,
                Some(parent) => parent.0 < number,
            };
            let next_is_child = entry.next.is_none_or(|next| {
                entries.get(next.0 as usize).is_some_and(|child| child.parent == Some(entry.id))
            });
            if entry.id.0 != number || !parent_is_earlier || !next_is_child {
                return Err(HistoryError(EntryId(number)));
            }
        }
        if head.0 as usize >= entries.len() {
            return Err(HistoryError(head));
        }
        Ok(Self { entries, head })
    }

    /// The entry the document stands at.
    #[must_use]
    pub fn head(&self) -> EntryId {
        self.head
    }

    /// All entries, in the order they were made; the root is the first.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// One entry.
    #[must_use]
    pub fn get(&self, id: EntryId) -> Option<&Entry> {
        self.entries.get(id.0 as usize)
    }

    /// Where undo goes: the parent of the head.
    #[must_use]
    pub fn undo_target(&self) -> Option<EntryId> {
        self.get(self.head)?.parent
    }

    /// Where redo goes: the child of the head visited last.
    #[must_use]
    pub fn redo_target(&self) -> Option<EntryId> {
        self.get(self.head)?.next
    }

    /// The number the next entry will have.
    #[must_use]
    pub fn next_id(&self) -> EntryId {
        EntryId(u32::try_from(self.entries.len()).unwrap_or(u32::MAX))
    }

    /// Adds an entry under the head, which moves to it.
    pub fn push(&mut self, label: String, author: String, time: String) -> EntryId {
        let id = self.next_id();
        let parent = std::mem::replace(&mut self.head, id);
        self.entries[parent.0 as usize].next = Some(id);
        self.entries.push(Entry { id, parent: Some(parent), next: None, label, author, time });
        id
    }

    /// The way from one entry to another; `None` when either does not exist.
    #[must_use]
    pub fn path(&self, from: EntryId, to: EntryId) -> Option<Vec<Step>> {
        let (mut a, mut b) = (self.get(from)?, self.get(to)?);
        let (mut back, mut forward) = (Vec::new(), Vec::new());
        // The later entry cannot be an ancestor of the earlier one: climb from the later until they meet.
        while a.id != b.id {
            if a.id > b.id {
                back.push(Step::Back(a.id));
                a = self.get(a.parent?)?;
            } else {
                forward.push(Step::Forward(b.id));
                b = self.get(b.parent?)?;
            }
        }
        forward.reverse();
        back.extend(forward);
        Some(back)
    }

    /// Moves the head along a way from it; redo will follow the same way again.
    pub fn walk(&mut self, path: &[Step]) {
        for step in path {
            match *step {
                Step::Back(id) => {
                    if let Some(parent) = self.get(id).and_then(|entry| entry.parent) {
                        self.head = parent;
                    }
                }
                Step::Forward(id) => {
                    self.entries[self.head.0 as usize].next = Some(id);
                    self.head = id;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
