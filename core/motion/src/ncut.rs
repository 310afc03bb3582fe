//! Zeng's grouping (thesis 2015, 2.2.2 and 5.4.1): tracks that move alike and are near each other, divided by normalised
//! cuts.
//!
//! Between two tracks, with p their mean positions and v their steps from frame to frame less the mean of these, as complex
//! numbers, there is an edge of the weight
//!
//! ```text
//! w = |rho| exp(-(w_pos |p1 - p2| / s)^2 / 2)        rho = sum v1 conj(v2) / sqrt(sum |v1|^2 sum |v2|^2)
//! ```
//!
//! (Zeng 2.20 and 5.1 with errata Z1; s^2 the mean square distance over all pairs). The text wants "spatial distances and
//! similarity of motion" in one affinity, and does not say how: the product is that of Shi and Malik's affinities, IEEE PAMI
//! 22, 2000, 4. The graph of these is cut in two where that costs least, each half is cut again, and so on (`divide.rs`).
//!
//! Two tracks at rest are as alike as can be, and one at rest has nothing in common with one that moves. One that is never
//! seen has nothing in common with any. Gaps are filled from the other tracks ([`crate::bod::Table`]).

mod affinity;
mod cut;
mod divide;
mod eigen;
mod graph;
#[cfg(test)]
mod tests;

use honami_model::hierarchy::Dendrogram;

use crate::bod::{Bod, Table};
use crate::{MotionError, Positions, pool};
use affinity::Tracks;
pub(crate) use divide::divide;
pub(crate) use graph::Graph;

/// A vector z of length 1 is an eigenvector when |A z - theta z| is no more than this, for theta in -1..1: theta is then right
/// to its square over the distance to the next one. One with a larger residual was not solved in time.
pub const RESIDUAL: f64 = 1e-7;

/// Which group a hierarchy opens next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The one that falls apart most clearly.
    Cuts,
    /// All of a level before any of the next, as in the thesis: halves, quarters, eighths. What has two branches on one side
    /// and one on the other is then cut into four, and not into three.
    Levels,
    /// The one that falls apart most clearly for its size: of least Ncut over the root of its share of all tracks. Small ones
    /// nearly always have a track that is like no other.
    Shares,
}

/// How tracks are grouped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Weight of the distance between mean positions, w_pos; 0: movement alone.
    pub position_weight: f64,
    /// How often groups are halved at most; Zeng finds 5 to 7 levels sufficient.
    pub n_levels: u32,
    /// Which group is opened next.
    pub order: Order,
    /// The others that each track is joined to at least, if there are so many, 1 or more: those of the largest weight, of equal
    /// ones the first.
    pub n_neighbours: usize,
    /// Whether what noise alone could be is taken off tracks first; not in the thesis.
    pub denoises: bool,
    /// Of the vector that large graphs are solved from.
    pub seed: u64,
    /// Threads to work with; 0 for those of the current rayon pool. The result is the same.
    pub n_threads: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            position_weight: 1.0,
            n_levels: 12,
            order: Order::Cuts,
            n_neighbours: 50,
            denoises: false,
            seed: 0,
            n_threads: 0,
        }
    }
}

/// A hierarchy by normalised cuts, with what it was made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Ncut {
    /// Halves that were cut apart join at 1 - Ncut / 2 or at the height at which their group joins another, if that is less;
    /// parts that were not connected at 1; tracks of the last groups, along the heaviest edges, at (1 - weight) / 2. By levels
    /// all but the last are times 2 to the power of the levels below.
    pub tree: Dendrogram,
    /// Groups that were divided no further.
    pub n_groups: usize,
    /// Components that denoised tracks are made of.
    pub n_components: Option<usize>,
    /// The largest |A z - theta z| of an eigenvector z of length 1; above [`RESIDUAL`] it was not solved in time, and its cut is
    /// one that may not be the best.
    pub residual: f64,
    /// Positions that were not seen, and are filled.
    pub n_filled: usize,
    /// Tracks that are never seen together with others.
    pub n_unseen: usize,
}

/// Groups tracks by normalised cuts.
///
/// `keep_going` is told the share of the work that is done, 0 to 1; `false` stops. O(N^2 T) time for the weights, and
/// O(N k) a level and vector for the cuts, with k neighbours; 50 bytes an edge.
///
/// # Errors
/// [`MotionError`] as [`Table::new`], for options out of range and for a graph that does not fit in memory.
pub fn ncut(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Ncut, MotionError> {
    let weight = options.position_weight;
    if !(weight.is_finite() && weight >= 0.0) {
        return Err(MotionError::Option { name: "the weight of position", came: weight });
    }
    pool::within(options.n_threads, keep_going, |keep_going| grouped(positions, options, keep_going))
}

fn grouped(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Ncut, MotionError> {
    let table = Table::new(positions, &mut |done| keep_going(0.25 * done))?;
    let smooth = options.denoises.then(|| {
        let bod = Bod::new(&table);
        let n = bod.n_denoised();
        (n, bod.sum(n, |_| 1.0))
    });
    let tracks = match &smooth {
        // Of nothing that moves there is no sum.
        Some((n, displacements)) if *n > 0 => Tracks::new(&table, displacements, options.position_weight),
        _ => Tracks::new(&table, table.series(), options.position_weight),
    };
    let graph = tracks.graph(options.n_neighbours.max(1), &mut |done| keep_going(0.25 + 0.25 * done))?;
    drop(tracks);
    let divided = divide(graph, options.n_levels, options.order, options.seed, &mut |done| {
        keep_going(0.5 + 0.5 * done)
    })?;
    Ok(Ncut {
        tree: divided.tree,
        n_groups: divided.n_groups,
        n_components: smooth.map(|(n, _)| n),
        residual: divided.residual,
        n_filled: table.n_filled(),
        n_unseen: (0..table.n_tracks()).filter(|&track| table.place(track).is_none()).count(),
    })
}
