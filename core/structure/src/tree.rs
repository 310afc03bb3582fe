//! The tree of groups that a cut of a dendrogram leaves: terminal groups, and what they merge to.

#[cfg(test)]
mod tests;

use honami_model::hierarchy::Dendrogram;

/// A group of the tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// Row of the group it is part of, before its own; `None` for the whole, row 0.
    pub parent: Option<usize>,
    /// Rows of its parts; none of a terminal group.
    pub children: Vec<usize>,
    /// Of a terminal group, its number in the cut.
    pub number: u32,
    /// Of a terminal group, leaves of the dendrogram that are in it, those without a path left out.
    pub leaves: Vec<usize>,
}

/// The tree above a cut into `k` groups, each group after the one it is part of. Leaves for which `is_seen` is false are
/// left out, and so is a group of which nothing is left; what it was merged with takes the place of both. Empty where
/// nothing is left.
#[must_use]
pub fn tree(dendrogram: &Dendrogram, k: u32, is_seen: &[bool]) -> Vec<Group> {
    let (n, merges) = (dendrogram.n_leaves() as usize, dendrogram.merges());
    let mut n_seen: Vec<usize> = (0..n).map(|leaf| usize::from(is_seen.get(leaf) == Some(&true))).collect();
    merges.iter().for_each(|merge| n_seen.push(n_seen[merge.a as usize] + n_seen[merge.b as usize]));
    let (numbers, ends) = (dendrogram.cut(k), dendrogram.nodes(k));
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
        let mut group = Group { parent, ..Group::default() };
        if let Some(number) = end {
            group.number = u32::try_from(number).unwrap_or(u32::MAX);
            let is_in = |&leaf: &usize| n_seen[leaf] > 0 && numbers[leaf] == group.number;
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
