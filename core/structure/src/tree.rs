//! The tree of groups that a cut of a dendrogram leaves: terminal groups, and what they merge to.

#[cfg(test)]
mod tests;

use honami_model::hierarchy::{Dendrogram, Groups};

/// A group of the tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// Row of the group it is part of, before its own; `None` for the whole, row 0.
    pub parent: Option<usize>,
    /// Rows of its parts; none of a terminal group.
    pub children: Vec<usize>,
    /// Of a terminal group, its number.
    pub number: u32,
    /// The cluster of the dendrogram that it is; of a terminal group that was made by hand its largest.
    pub node: u32,
    /// Of a terminal group, leaves of the dendrogram that are in it, those without a path left out.
    pub leaves: Vec<usize>,
}

/// The tree above a cut into `k` groups, as [`tree_of`] has it.
#[must_use]
pub fn tree(dendrogram: &Dendrogram, k: u32, is_seen: &[bool]) -> Vec<Group> {
    tree_of(dendrogram, &dendrogram.groups(k, &[]), is_seen)
}

/// The tree above these groups of its leaves, each group after the one it is part of. One that a person has merged of
/// several clusters stands where most of it is. Leaves for which `is_seen` is false are left out, and so is a group of
/// which nothing is left; what it was merged with takes the place of both. Empty where nothing is left.
#[must_use]
pub fn tree_of(dendrogram: &Dendrogram, shown: &Groups, is_seen: &[bool]) -> Vec<Group> {
    let (n, merges) = (dendrogram.n_leaves() as usize, dendrogram.merges());
    let is_seen: Vec<bool> = (0..n).map(|leaf| is_seen.get(leaf) == Some(&true)).collect();
    let mut n_seen: Vec<usize> = is_seen.iter().map(|&is_seen| usize::from(is_seen)).collect();
    let count = |n_seen: &mut Vec<usize>| {
        merges.iter().for_each(|merge| n_seen.push(n_seen[merge.a as usize] + n_seen[merge.b as usize]));
    };
    count(&mut n_seen);
    let most = |nodes: &Vec<u32>| nodes.iter().rev().copied().max_by_key(|node| n_seen[*node as usize]);
    let ends: Vec<u32> = shown.nodes.iter().filter_map(most).collect();
    // What does not stand with its group is not there.
    for (nodes, end) in shown.nodes.iter().zip(&ends) {
        for leaf in nodes.iter().filter(|node| *node != end).flat_map(|node| dendrogram.leaves(*node)) {
            n_seen[leaf as usize] = 0;
        }
    }
    n_seen.truncate(n);
    count(&mut n_seen);
    let numbers = &shown.of;
    let mut groups: Vec<Group> = Vec::new();
    let whole = n_seen.len().checked_sub(1).filter(|&whole| n_seen[whole] > 0);
    let mut open: Vec<(usize, Option<usize>)> = whole.map(|whole| (whole, None)).into_iter().collect();
    while let Some((cluster, parent)) = open.pop() {
        let end = ends.iter().position(|&end| end as usize == cluster);
        let parts = match (end, cluster.checked_sub(n)) {
            (None, Some(row)) => [merges[row].b as usize, merges[row].a as usize],
            _ => [cluster; 2],
        };
        let mut seen = parts.into_iter().filter(|&part| n_seen[part] > 0);
        if end.is_none() && parts.iter().any(|&part| n_seen[part] == 0) {
            open.extend(seen.next().map(|part| (part, parent)));
            continue;
        }
        let row = groups.len();
        let mut group = Group { parent, node: cluster as u32, ..Group::default() };
        if let Some(number) = end {
            group.number = u32::try_from(number).unwrap_or(u32::MAX);
            group.node = shown.nodes[number][0];
            let is_in = |&leaf: &usize| is_seen[leaf] && numbers[leaf] == group.number;
            group.leaves = (0..n).filter(is_in).collect();
        } else {
            open.extend(seen.map(|part| (part, Some(row))));
        }
        groups.push(group);
        if let Some(parent) = parent {
            groups[parent].children.push(row);
        }
    }
    groups
}
