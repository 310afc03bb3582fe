//! The groups of a dendrogram's leaves: those of a cut, and those that a person holds together by hand.

use std::collections::BTreeMap;

use super::{Dendrogram, Merge};

/// Every leaf in one group, each group of one or several clusters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Groups {
    /// The group of every leaf. Groups are numbered from 0 in the order in which their first leaf appears.
    pub of: Vec<u32>,
    /// The clusters that each group consists of, numbered as in [`Merge`]: as few as there can be, the largest
    /// first, of equal ones that with the lower number. One in a cut; several where groups were merged by hand that
    /// the dendrogram keeps apart.
    pub nodes: Vec<Vec<u32>>,
    /// How many merges the cut undoes, from the root down.
    pub n_undone: usize,
}

impl Groups {
    /// Number of groups.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none, for there are no leaves.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The cluster that each group stands for in the dendrogram, its largest: names hang on it.
    pub fn mains(&self) -> impl Iterator<Item = u32> {
        self.nodes.iter().filter_map(|nodes| nodes.first().copied())
    }
}

impl Dendrogram {
    /// The groups at a cut into `k` where `held` ones, each the clusters that it consists of, stay as they are: the
    /// cut opens the dendrogram until there are so many with them, but leaves what is not held in one group at least.
    ///
    /// Clusters that do not exist hold nothing, and a leaf that is in several is held by the first.
    #[must_use]
    pub fn groups(&self, k: u32, held: &[Vec<u32>]) -> Groups {
        let n = self.n_leaves as usize;
        let holder = self.holders(held);
        let n_held = (0..held.len()).filter(|at| holder.contains(&Some(*at))).count();
        let is_undone = self.opened((k as usize).saturating_sub(n_held), &holder);
        let mut roots: Vec<usize> = (0..n + self.merges.len()).collect();
        // A cluster comes after its parts: downwards, its own root is known first.
        for (row, merge) in self.merges.iter().enumerate().rev().filter(|&(row, _)| !is_undone[row]) {
            roots[merge.a as usize] = roots[n + row];
            roots[merge.b as usize] = roots[n + row];
        }
        let mut number_of = BTreeMap::new();
        let number = |(holder, root): (&Option<usize>, &usize)| {
            let next = u32::try_from(number_of.len()).unwrap_or(u32::MAX);
            *number_of.entry(holder.ok_or(*root)).or_insert(next)
        };
        let of: Vec<u32> = holder.iter().zip(&roots).map(number).collect();
        let mut nodes = vec![Vec::new(); number_of.len()];
        for (node, group) in self.largest(&of) {
            nodes[group as usize].push(node);
        }
        Groups { of, nodes, n_undone: is_undone.iter().filter(|is_undone| **is_undone).count() }
    }

    /// The largest clusters that lie whole in one group, given that of every leaf: largest first, then by number.
    fn largest(&self, of: &[u32]) -> Vec<(u32, u32)> {
        let mut groups: Vec<Option<u32>> = of.iter().copied().map(Some).collect();
        for Merge { a, b, .. } in &self.merges {
            let [a, b] = [a, b].map(|part| groups[*part as usize]);
            groups.push(a.filter(|_| a == b));
        }
        let mut is_part = vec![false; groups.len()];
        for (row, merge) in self.merges.iter().enumerate() {
            if groups[of.len() + row].is_some() {
                [merge.a, merge.b].into_iter().for_each(|part| is_part[part as usize] = true);
            }
        }
        let whole = (0_u32..).zip(groups).zip(is_part).filter(|(_, is_part)| !is_part);
        let mut found: Vec<(u32, u32)> =
            whole.filter_map(|((node, group), _)| Some((node, group?))).collect();
        found.sort_by_key(|&(node, _)| (std::cmp::Reverse(self.size(node)), node));
        found
    }

    /// Leaves of a cluster, 0 where there is no such.
    #[must_use]
    pub fn size(&self, node: u32) -> u32 {
        match node.checked_sub(self.n_leaves) {
            None => 1,
            Some(row) => self.merges.get(row as usize).map_or(0, |merge| merge.size),
        }
    }

    /// The leaves of a cluster, rising; none where there is no such.
    #[must_use]
    pub fn leaves(&self, node: u32) -> Vec<u32> {
        let (mut open, mut leaves) = (vec![node], Vec::new());
        while let Some(node) = open.pop() {
            match node.checked_sub(self.n_leaves) {
                None => leaves.push(node),
                Some(row) => open.extend(self.merges.get(row as usize).iter().flat_map(|m| [m.a, m.b])),
            }
        }
        leaves.sort_unstable();
        leaves
    }

    /// As few clusters as there can be that have these leaves and no others, the largest first.
    #[must_use]
    pub fn cover(&self, leaves: &[u32]) -> Vec<u32> {
        let mut is_in = vec![0; self.n_leaves as usize];
        for leaf in leaves.iter().filter(|leaf| **leaf < self.n_leaves) {
            is_in[*leaf as usize] = 1;
        }
        self.largest(&is_in).into_iter().filter(|(_, is_in)| *is_in == 1).map(|(node, _)| node).collect()
    }

    /// Which of the held groups has each leaf.
    fn holders(&self, held: &[Vec<u32>]) -> Vec<Option<usize>> {
        let mut holders = vec![None; self.n_leaves as usize];
        for (at, nodes) in held.iter().enumerate() {
            for leaf in nodes.iter().flat_map(|node| self.leaves(*node)) {
                let holder = &mut holders[leaf as usize];
                *holder = holder.or(Some(at));
            }
        }
        holders
    }

    /// Which merges a cut undoes so that leaves without a holder are in `wanted` groups, or all alone.
    fn opened(&self, wanted: usize, holder: &[Option<usize>]) -> Vec<bool> {
        let mut n_free: Vec<u32> = holder.iter().map(|holder| u32::from(holder.is_none())).collect();
        self.merges.iter().for_each(|m| n_free.push(n_free[m.a as usize] + n_free[m.b as usize]));
        let mut is_undone = vec![false; self.merges.len()];
        let mut n_groups = 1;
        for row in self.undoing_order() {
            if n_groups >= wanted.max(1) {
                break;
            }
            let Merge { a, b, .. } = self.merges[row];
            is_undone[row] = true;
            n_groups += usize::from([a, b].iter().all(|part| n_free[*part as usize] > 0));
        }
        is_undone
    }
}
