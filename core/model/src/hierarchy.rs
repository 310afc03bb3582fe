//! Hierarchies of groups: a dendrogram where they came from merging, and its cuts.

use serde::{Deserialize, Serialize};

/// One merge of a dendrogram: two clusters become one at a height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

    /// The group of every leaf when the last `k - 1` merges are undone: k groups, fewer only if n < k.
    ///
    /// Groups are numbered from 0 in the order in which their first leaf appears.
    #[must_use]
    pub fn cut(&self, k: u32) -> Vec<u32> {
        let mut number_of = std::collections::BTreeMap::new();
        self.roots(k)
            .into_iter()
            .map(|root| {
                let next = u32::try_from(number_of.len()).unwrap_or(u32::MAX);
                *number_of.entry(root).or_insert(next)
            })
            .collect()
    }

    /// The cluster that each group of [`cut`](Self::cut) is, numbered as in [`Merge`]: unlike a group's
    /// number it stays the same when the cut moves.
    #[must_use]
    pub fn nodes(&self, k: u32) -> Vec<u32> {
        let mut seen = std::collections::BTreeSet::new();
        self.roots(k).into_iter().filter(|&root| seen.insert(root)).collect()
    }

    /// The cluster of every leaf when the last `k - 1` merges are undone.
    fn roots(&self, k: u32) -> Vec<u32> {
        let n = self.n_leaves as usize;
        let keep = n.saturating_sub(k.max(1) as usize);
        let mut parent: Vec<u32> = (0..).take(n + self.merges.len()).collect();
        // By height, not by row: a dendrogram with inversions is cut where its merges are highest.
        let mut order: Vec<usize> = (0..self.merges.len()).collect();
        order.sort_by(|&i, &j| self.merges[i].height.total_cmp(&self.merges[j].height).then(i.cmp(&j)));
        for &row in order.iter().take(keep) {
            let merge = self.merges[row];
            let made = self.n_leaves + u32::try_from(row).unwrap_or(u32::MAX);
            parent[merge.a as usize] = made;
            parent[merge.b as usize] = made;
        }
        (0..self.n_leaves)
            .map(|mut root| {
                while parent[root as usize] != root {
                    root = parent[root as usize];
                }
                root
            })
            .collect()
    }

    /// The number of groups, 2 to `k_max`, at which a cut is clearest: where the heights of the merges it undoes
    /// and of those it keeps differ by the largest factor. 1 where there is nothing to cut.
    ///
    /// The smallest such number where several are equally clear.
    #[must_use]
    pub fn clearest_cut(&self, k_max: u32) -> u32 {
        let mut heights: Vec<f64> = self.merges.iter().map(|merge| merge.height).collect();
        heights.sort_by(|a, b| b.total_cmp(a));
        let mut clearest = (1, 0.0);
        // A cut into k groups undoes the k - 1 highest merges.
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
