//! Hierarchies of groups: a dendrogram where they came from merging, and its cuts.

use std::collections::BinaryHeap;

pub use groups::Groups;

mod groups;

/// One merge of a dendrogram: two clusters become one at a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merge {
    /// First cluster: leaf k is k, the result of merge r is n + r.
    pub a: u32,
    /// Second cluster, numbered alike.
    pub b: u32,
    /// Dissimilarity at which they merge, finite, 0 or more.
    pub height: f64,
    /// Leaves below, at least 2.
    pub size: u32,
}

/// A binary merge tree over n leaves in SciPy's linkage convention.
#[derive(Clone, Debug, PartialEq)]
pub struct Dendrogram {
    n_leaves: u32,
    merges: Vec<Merge>,
}

/// Why rows are no dendrogram: a sentence that names the row and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DendrogramError(String);

impl Dendrogram {
    /// Checks that the merges form one tree: n - 1 rows, each cluster used once and after it was made.
    ///
    /// # Errors
    /// [`DendrogramError`] with the first row that breaks the rule.
    pub fn new(n_leaves: u32, merges: Vec<Merge>) -> Result<Self, DendrogramError> {
        let n = n_leaves as usize;
        let fail = |why: String| Err(DendrogramError(why));
        let wanted = n.saturating_sub(1);
        if merges.len() != wanted {
            return fail(format!("{} merges of {n} tracks, not {wanted}", merges.len()));
        }
        let mut sizes = vec![1_u32; n];
        let mut used = vec![false; n + wanted];
        for (row, &Merge { a, b, height, size }) in merges.iter().enumerate() {
            for cluster in [a as usize, b as usize] {
                if cluster >= n + row {
                    return fail(format!("merge {row} with cluster {cluster}, which does not exist yet"));
                }
                if std::mem::replace(&mut used[cluster], true) {
                    return fail(format!("merge {row} with cluster {cluster} a second time"));
                }
            }
            let leaves = sizes[a as usize] + sizes[b as usize];
            if size != leaves {
                return fail(format!("merge {row} of size {size}, its leaves are {leaves}"));
            }
            if !height.is_finite() || height < 0.0 {
                return fail(format!("merge {row} at height {height}"));
            }
            sizes.push(leaves);
        }
        Ok(Self { n_leaves, merges })
    }

    /// Number of leaves n.
    #[must_use]
    pub fn n_leaves(&self) -> u32 {
        self.n_leaves
    }

    /// The n - 1 merges.
    #[must_use]
    pub fn merges(&self) -> &[Merge] {
        &self.merges
    }

    /// The group of every leaf in a cut into `k` groups, fewer only if n < k.
    ///
    /// A cut undoes `k - 1` merges from the root down, each time the highest of those at the top, the later row
    /// of equal ones. So cuts are nested and have exactly `k` groups, also where a merge lies below one that it
    /// contains (an inversion). Groups are numbered from 0 in the order in which their first leaf appears.
    #[must_use]
    pub fn cut(&self, k: u32) -> Vec<u32> {
        self.groups(k, &[]).of
    }

    /// The cluster that each group of [`cut`](Self::cut) is, numbered as in [`Merge`]: unlike a group's
    /// number it stays the same when the cut moves.
    #[must_use]
    pub fn nodes(&self, k: u32) -> Vec<u32> {
        self.groups(k, &[]).mains().collect()
    }

    /// The heights of the merges in the order in which cuts undo them: a cut into k groups lies between the
    /// (k - 1)-th and the k-th.
    #[must_use]
    pub fn heights(&self) -> Vec<f64> {
        self.undoing_order().map(|row| self.merges[row].height).collect()
    }

    /// The rows in the order in which cuts undo them.
    fn undoing_order(&self) -> impl Iterator<Item = usize> {
        // The bits of numbers that are 0 or more sort as the numbers do; `abs` is for -0.
        let entry = |row: usize| (self.merges[row].height.abs().to_bits(), row);
        let mut top: BinaryHeap<_> = self.merges.len().checked_sub(1).map(entry).into_iter().collect();
        std::iter::from_fn(move || {
            let (_, row) = top.pop()?;
            let Merge { a, b, .. } = self.merges[row];
            top.extend(
                [a, b].iter().filter_map(|&part| part.checked_sub(self.n_leaves)).map(|r| entry(r as usize)),
            );
            Some(row)
        })
    }

    /// The number of groups, 2 to `k_max`, at which a cut is clearest: where the last merge that
    /// [`cut`](Self::cut) undoes is higher than the next one by the largest factor. 1 where there is nothing to
    /// cut.
    ///
    /// The smallest such number where several are equally clear.
    #[must_use]
    pub fn clearest_cut(&self, k_max: u32) -> u32 {
        let heights = self.heights();
        let mut clearest = (1, 0.0);
        for (k, pair) in (2..=k_max).zip(heights.windows(2)) {
            let factor = pair[0] / pair[1].max(f64::MIN_POSITIVE);
            if factor > clearest.1 {
                clearest = (k, factor);
            }
        }
        if clearest.0 == 1 && !heights.is_empty() { 2.min(k_max.max(1)) } else { clearest.0 }
    }
}

#[cfg(test)]
mod tests;
