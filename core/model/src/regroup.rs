//! Hand work on groups: merged, split, tracks taken into another, named. Each is one transaction.
//!
//! The dendrogram never changes. A group that a person has made is *held*: the document keeps the nodes that it
//! consists of, and a cut leaves them as they are (see [`Dendrogram::groups`]). So every other group stays as it was,
//! whatever is done to one, and what was done outlives a cut that moves.

use std::collections::BTreeSet;

use crate::document::{ClusteringId, Document};
use crate::edit::{Edit, Transaction};
use crate::hierarchy::{Dendrogram, Groups};
use crate::track::{TrackId, TrackSet};

/// What a person does to the shown groups, which are numbered from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Two groups become one.
    Merge(u32, u32),
    /// A group becomes two: its largest node and the rest where it has several, else what its node was merged of.
    Split(u32),
    /// Tracks leave their groups for this one.
    Take(TrackSet, u32),
    /// The groups are those of the cut again.
    Release,
    /// A group gets a name, or loses it.
    Name(u32, Option<String>),
}

/// Why groups stay as they are.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// Nothing is grouped.
    #[error("no clustering is shown: there are no groups to change")]
    NoGroups,
    /// There are not so many groups.
    #[error("there are groups 1 to {n_groups}, no group {}", u64::from(*group) + 1)]
    NoSuchGroup {
        /// The group asked for, from 0.
        group: u32,
        /// Number of groups.
        n_groups: usize,
    },
    /// A group cannot be merged with itself.
    #[error("group {} is one group already: two are wanted", group + 1)]
    Same {
        /// The group, from 0.
        group: u32,
    },
    /// A single track cannot be split.
    #[error("group {} is one track: there is nothing to split", group + 1)]
    OneTrack {
        /// The group, from 0.
        group: u32,
    },
    /// The clustering does not know the track.
    #[error("track {0} is in no group: cluster the tracks again with it")]
    NotGrouped(TrackId),
    /// All of them are in it already.
    #[error("{tracks}: in group {} already", group + 1)]
    InIt {
        /// The tracks.
        tracks: TrackSet,
        /// The group, from 0.
        group: u32,
    },
    /// There is nothing to take back.
    #[error("no group was made by hand: they are those of the cut")]
    NothingHeld,
}

/// The shown clustering, as hand work on its groups needs it.
struct Shown<'a> {
    id: ClusteringId,
    document: &'a Document,
    tracks: &'a [TrackId],
    dendrogram: &'a Dendrogram,
    groups: Groups,
}

/// The transaction of a step on the shown clustering, which has these tracks as leaves.
///
/// # Errors
/// [`Refused`] where nothing would change, or there is no such group or track.
pub fn transaction(
    document: &Document,
    (tracks, dendrogram): (&[TrackId], &Dendrogram),
    step: &Step,
) -> Result<Transaction, Refused> {
    let shown = document.clustering().ok_or(Refused::NoGroups)?;
    let groups = dendrogram.groups(shown.k, document.held_groups(shown.id));
    let shown = Shown { id: shown.id, document, tracks, dendrogram, groups };
    match step {
        Step::Merge(a, b) => shown.merge(*a, *b),
        Step::Split(group) => shown.split(*group),
        Step::Take(tracks, into) => shown.take(tracks, *into),
        Step::Release => shown.release(),
        Step::Name(group, name) => shown.name(*group, name.clone()),
    }
}

impl Shown<'_> {
    fn merge(&self, a: u32, b: u32) -> Result<Transaction, Refused> {
        let both = [self.leaves(a)?, self.leaves(b)?];
        if a == b {
            return Err(Refused::Same { group: a });
        }
        // What it is called from now on, if it was not called anything before it was parted.
        let larger = if both[1].len() > both[0].len() { [b, a] } else { [a, b] };
        let merged = self.dendrogram.cover(&both.concat());
        let label = format!("groups {} and {} merged: {}", a + 1, b + 1, counted(both.concat().len()));
        let names = self.called(&merged, &larger);
        Ok(self.hold(label, &[a, b], vec![merged], names))
    }

    fn split(&self, group: u32) -> Result<Transaction, Refused> {
        self.leaves(group)?;
        let parts = match &self.groups.nodes[group as usize][..] {
            [main, rest @ ..] if !rest.is_empty() => [vec![*main], rest.to_vec()],
            nodes => {
                let row = nodes.first().and_then(|node| node.checked_sub(self.dendrogram.n_leaves()));
                let merge = row.and_then(|row| self.dendrogram.merges().get(row as usize));
                let merge = merge.ok_or(Refused::OneTrack { group })?;
                [vec![merge.a], vec![merge.b]]
            }
        };
        let size = |nodes: &[u32]| nodes.iter().map(|node| self.dendrogram.size(*node)).sum::<u32>();
        let [a, b] = parts.each_ref().map(|nodes| size(nodes));
        let label = format!("group {} split: {a} and {}", group + 1, counted(b as usize));
        Ok(self.hold(label, &[group], parts.into(), Vec::new()))
    }

    fn take(&self, tracks: &TrackSet, into: u32) -> Result<Transaction, Refused> {
        let mut all = self.leaves(into)?;
        let mut taken = BTreeSet::new();
        for track in tracks.iter() {
            let leaf = self.tracks.iter().position(|known| *known == track);
            let leaf = leaf.and_then(|leaf| u32::try_from(leaf).ok()).ok_or(Refused::NotGrouped(track))?;
            taken.extend((self.groups.of[leaf as usize] != into).then_some(leaf));
        }
        if taken.is_empty() {
            return Err(Refused::InIt { tracks: tracks.clone(), group: into });
        }
        all.extend(&taken);
        let made = self.dendrogram.cover(&all);
        let mut names = self.called(&made, &[into]);
        let sources: BTreeSet<u32> = taken.iter().map(|leaf| self.groups.of[*leaf as usize]).collect();
        for source in sources {
            let mut left = self.leaves(source)?;
            left.retain(|leaf| !taken.contains(leaf));
            names.extend(self.called(&self.dendrogram.cover(&left), &[source]));
        }
        let label = format!("{tracks} taken into group {}", into + 1);
        // What is left of a group that was not held is the cut's, as it was: only this one is held.
        Ok(self.hold(label, &[into], vec![made], names))
    }

    fn release(&self) -> Result<Transaction, Refused> {
        if self.document.held_groups(self.id).is_empty() {
            return Err(Refused::NothingHeld);
        }
        let n = self.groups.len();
        let label = format!("the {n} groups are those of the cut again");
        Ok(Transaction::new(label, self.edits(Vec::new(), n)))
    }

    fn name(&self, group: u32, name: Option<String>) -> Result<Transaction, Refused> {
        self.leaves(group)?;
        let main = self.groups.nodes[group as usize][0];
        let label = match &name {
            Some(name) => format!("group {} named {name}", group + 1),
            None => format!("group {}: name removed", group + 1),
        };
        Ok(Transaction::new(label, vec![Edit::NameGroup { clustering: self.id, node: main, name }]))
    }

    /// The leaves of a group.
    fn leaves(&self, group: u32) -> Result<Vec<u32>, Refused> {
        let leaves: Vec<u32> =
            (0..).zip(&self.groups.of).filter(|(_, of)| **of == group).map(|(leaf, _)| leaf).collect();
        if leaves.is_empty() {
            return Err(Refused::NoSuchGroup { group, n_groups: self.groups.len() });
        }
        Ok(leaves)
    }

    /// The edit that calls a group after the first of these that has a name, where nothing hangs on its node.
    fn called(&self, nodes: &[u32], after: &[u32]) -> Vec<Edit> {
        let name = |node: u32| self.document.group_name(self.id, node);
        let main = |group: &u32| self.groups.nodes.get(*group as usize)?.first().copied();
        let Some(&node) = nodes.first().filter(|node| name(**node).is_none()) else { return Vec::new() };
        let known = after.iter().filter_map(main).find_map(name);
        let edit = |name: &str| Edit::NameGroup { clustering: self.id, node, name: Some(name.to_owned()) };
        known.map(edit).into_iter().collect()
    }

    /// Holds new groups in the place of old ones. What others hold of their leaves they hold no longer.
    fn hold(&self, label: String, old: &[u32], new: Vec<Vec<u32>>, names: Vec<Edit>) -> Transaction {
        let is_new: BTreeSet<u32> =
            new.iter().flatten().flat_map(|node| self.dendrogram.leaves(*node)).collect();
        let held = self.document.held_groups(self.id).iter();
        let mut held: Vec<Vec<u32>> = held
            .map(|nodes| {
                let mut leaves: Vec<u32> =
                    nodes.iter().flat_map(|node| self.dendrogram.leaves(*node)).collect();
                leaves.retain(|leaf| !is_new.contains(leaf));
                self.dendrogram.cover(&leaves)
            })
            .filter(|nodes| !nodes.is_empty())
            .collect();
        let left = |group: &u32| {
            let mut of = (0..).zip(&self.groups.of);
            !old.contains(group) && of.any(|(leaf, of)| of == group && !is_new.contains(&leaf))
        };
        let n_groups = (0..).take(self.groups.len()).filter(left).count() + new.len();
        held.extend(new);
        let mut edits = self.edits(held, n_groups);
        edits.extend(names);
        Transaction::new(label, edits)
    }

    fn edits(&self, held: Vec<Vec<u32>>, n_groups: usize) -> Vec<Edit> {
        let k = u32::try_from(n_groups).unwrap_or(u32::MAX);
        vec![Edit::HoldGroups { clustering: self.id, groups: held }, Edit::SetCut { k }]
    }
}

fn counted(n: usize) -> String {
    if n == 1 { "1 track".to_owned() } else { format!("{n} tracks") }
}

#[cfg(test)]
mod tests;
