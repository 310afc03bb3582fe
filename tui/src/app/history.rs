//! The undo tree as the screen knows it: its entries, and how its branches lie beside each other.

use honami_model::history::{Entry, EntryId};

/// More branches beside each other than this are not drawn.
pub(super) const LANES_MAX: usize = 8;

/// What a row of the tree shows in one lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lane {
    /// Nothing.
    #[default]
    Empty,
    /// A branch that passes.
    Passes,
    /// The entry.
    Entry,
    /// A branch that begins at this entry: further up it has a lane of its own.
    Begins,
}

/// The undo tree, newest entry first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree {
    /// All entries, in the order they were made.
    entries: Vec<Entry>,
    /// The entry the document stands at.
    pub head: EntryId,
    /// Lanes of every entry's row.
    lanes: Vec<[Lane; LANES_MAX]>,
}

impl Tree {
    /// Takes entries that have been made since, and where the document stands now.
    pub fn grow(&mut self, new: Vec<Entry>, head: EntryId) {
        self.head = head;
        if !new.is_empty() {
            self.entries.extend(new);
            self.lanes = lay(&self.entries);
        }
    }

    /// Number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether nothing is known of it yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The entry of a row, the newest being row 0, and the lanes it is drawn with.
    #[must_use]
    pub fn row(&self, row: usize) -> Option<(&Entry, &[Lane; LANES_MAX])> {
        let at = self.entries.len().checked_sub(row + 1)?;
        self.entries.get(at).zip(self.lanes.get(at))
    }

    /// The entries that are undone on the way from one to an earlier one of its branch; none where it is on another.
    #[must_use]
    pub fn undone(&self, from: EntryId, to: EntryId) -> Vec<EntryId> {
        let parent = |id: &EntryId| self.entries.get(id.0 as usize).and_then(|entry| entry.parent);
        let way: Vec<EntryId> =
            std::iter::successors(Some(from), parent).take_while(|id| *id != to).collect();
        if way.last().is_some_and(|last| parent(last) == Some(to)) { way } else { Vec::new() }
    }

    /// The row of the entry the document stands at.
    #[must_use]
    pub fn head_row(&self) -> usize {
        self.entries.len().saturating_sub(self.head.0 as usize + 1)
    }
}

/// Gives every branch a lane from its tip down to where it began.
fn lay(entries: &[Entry]) -> Vec<[Lane; LANES_MAX]> {
    // For every lane the entry it leads down to.
    let mut wanted: Vec<Option<EntryId>> = Vec::new();
    let mut rows = vec![[Lane::Empty; LANES_MAX]; entries.len()];
    for (entry, row) in entries.iter().zip(&mut rows).rev() {
        let own = wanted.iter().position(|to| *to == Some(entry.id));
        let own = own.or_else(|| wanted.iter().position(Option::is_none)).unwrap_or_else(|| {
            wanted.push(None);
            wanted.len() - 1
        });
        for (lane, to) in wanted.iter_mut().enumerate() {
            let shows = match *to {
                _ if lane == own => Lane::Entry,
                Some(id) if id == entry.id => Lane::Begins,
                Some(_) => Lane::Passes,
                None => Lane::Empty,
            };
            if shows == Lane::Begins {
                *to = None;
            }
            if let Some(cell) = row.get_mut(lane) {
                *cell = shows;
            }
        }
        wanted[own] = entry.parent;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tree of entries with these parents; entry 0 is the root.
    fn tree(parents: &[u32], head: u32) -> Tree {
        let entry = |(id, parent): (u32, Option<u32>)| Entry {
            id: EntryId(id),
            parent: parent.map(EntryId),
            next: None,
            label: format!("edit {id}"),
            author: "ana".to_owned(),
            time: "2026-11-21T14:03:00Z".to_owned(),
        };
        let entries = std::iter::once((0, None)).chain((1..).zip(parents.iter().map(|p| Some(*p))));
        let mut tree = Tree::default();
        tree.grow(entries.map(entry).collect(), EntryId(head));
        tree
    }

    fn drawn(tree: &Tree) -> Vec<String> {
        let glyph = |lane: &Lane| match lane {
            Lane::Empty => ' ',
            Lane::Passes => '|',
            Lane::Entry => 'o',
            Lane::Begins => '/',
        };
        let rows = (0..tree.len()).filter_map(|row| tree.row(row));
        rows.map(|(_, lanes)| lanes.iter().map(glyph).collect::<String>().trim_end().to_owned()).collect()
    }

    #[test]
    fn branches_lie_beside_each_other() {
        for (parents, expect) in [
            (&[][..], &["o"][..]),
            (&[0, 1, 2], &["o", "o", "o", "o"]),
            // 3 and then 4 were made after going back to 1 and to the beginning.
            (&[0, 1, 1, 0], &["o", "|o", "||o", "|o/", "o/"]),
            (&[0, 0, 1, 2], &["o", "|o", "o|", "|o", "o/"]),
        ] {
            assert_eq!(drawn(&tree(parents, 0)), expect, "{parents:?}");
        }
    }

    #[test]
    fn a_long_history_is_laid_out_at_once() {
        // A branch leaves every tenth entry; the time is not measured, but quadratic work would not end.
        let parents: Vec<u32> = (0..200_000).map(|n: u32| if n % 10 == 9 { n - 5 } else { n }).collect();
        let tree = tree(&parents, 77);
        assert_eq!((tree.len(), tree.head_row()), (200_001, 199_923));
        assert_eq!(tree.row(tree.head_row()).map(|(entry, _)| entry.id), Some(EntryId(77)));
    }
}
