//! Groups as the screen shows them, and where their dendrogram is drawn.

use std::collections::BTreeMap;

use honami_model::document::ClusteringId;
use honami_model::hierarchy::{self, Dendrogram};
use honami_model::track::TrackId;

/// The shown clustering at its cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    /// How it was made, as the title says it.
    pub what: String,
    /// Which it is.
    pub clustering: ClusteringId,
    /// Its tracks, in the dendrogram's order of leaves.
    pub tracks: Vec<TrackId>,
    /// The hierarchy.
    pub dendrogram: Dendrogram,
    /// The groups of its leaves.
    pub shown: hierarchy::Groups,
    /// What a person calls each group.
    pub names: Vec<Option<String>>,
    /// The clusters of each group that was made by hand: a cut leaves them.
    pub held: Vec<Vec<u32>>,
    /// Frames that were left out as outliers, rising.
    pub outlier_frames: Vec<u32>,
    /// Where the dendrogram is drawn: worked out once, not with every picture.
    pub chart: Chart,
    of: BTreeMap<TrackId, u32>,
}

/// Where a dendrogram is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// How far to the right every cluster is, 0 to 1: leaves next to those that they are merged with.
    pub across: Vec<f64>,
    /// The heights of the merges in the order in which cuts undo them.
    pub heights: Vec<f64>,
}

impl Groups {
    /// A clustering cut into `k` groups, some of which are held by hand.
    #[must_use]
    pub fn new(
        what: String,
        (clustering, tracks, dendrogram): (ClusteringId, Vec<TrackId>, Dendrogram),
        (k, held): (u32, &[Vec<u32>]),
        outlier_frames: Vec<u32>,
    ) -> Self {
        let shown = dendrogram.groups(k, held);
        let of = tracks.iter().copied().zip(shown.of.iter().copied()).collect();
        let (names, held, chart) = (vec![None; shown.len()], held.to_vec(), Chart::of(&dendrogram));
        Self { what, clustering, tracks, dendrogram, shown, names, held, outlier_frames, chart, of }
    }

    /// The groups at another cut.
    #[must_use]
    pub fn at(&self, k: u32) -> hierarchy::Groups {
        self.dendrogram.groups(k, &self.held)
    }

    /// The group of a track, from 0.
    #[must_use]
    pub fn of(&self, track: TrackId) -> Option<u32> {
        self.of.get(&track).copied()
    }

    /// Number of tracks of every group.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.shown.len()];
        self.shown.of.iter().for_each(|group| sizes[*group as usize] += 1);
        sizes
    }

    /// The group in which all leaves of each cluster are, if they are in one.
    #[must_use]
    pub fn of_clusters(&self) -> Vec<Option<u32>> {
        let mut of: Vec<Option<u32>> = self.shown.of.iter().copied().map(Some).collect();
        for merge in self.dendrogram.merges() {
            let [a, b] = [merge.a, merge.b].map(|part| of[part as usize]);
            of.push(a.filter(|_| a == b));
        }
        of
    }
}

impl Chart {
    fn of(dendrogram: &Dendrogram) -> Self {
        let (n, merges) = (dendrogram.n_leaves() as usize, dendrogram.merges());
        let mut across = vec![0.0; n + merges.len()];
        let mut open: Vec<usize> = across.len().checked_sub(1).into_iter().collect();
        let mut n_placed = 0_u32;
        while let Some(cluster) = open.pop() {
            match cluster.checked_sub(n) {
                None => {
                    across[cluster] = (f64::from(n_placed) + 0.5) / n as f64;
                    n_placed += 1;
                }
                // The first part is the next: it comes to the left.
                Some(row) => open.extend([merges[row].b as usize, merges[row].a as usize]),
            }
        }
        for (row, merge) in merges.iter().enumerate() {
            across[n + row] = f64::midpoint(across[merge.a as usize], across[merge.b as usize]);
        }
        Self { across, heights: dendrogram.heights() }
    }
}
