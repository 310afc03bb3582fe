//! Groups of tracks by their bi-orthogonal decomposition: what moves with the same components is alike.
//!
//! Tracks are taken apart into components ([`Bod`]), those above the noise give each track its loadings, loadings are smoothed
//! by neighbours (`smooth.rs`), and of smoothed loadings a feature is made (`features.rs`), scaled to length 1: how far a track
//! swings does not matter. From features and mean positions p, s their standard deviations over all N x N pairs of tracks,
//! comes a hierarchy, either by normalised cuts of the graph of weights
//!
//! ```text
//! w = r^8 exp(-(w_pos |p1 - p2| / s_pos)^2)        r = |rho| (or the cosine) of the two features
//! ```
//!
//! in which each track is joined to 50 others, opening next what falls apart most clearly for its size
//! ([`Order::Shares`]); or by merging what has the least distance
//!
//! ```text
//! d = w_pos |p1 - p2| / s_pos  +  d_feature / s_feature
//! ```
//!
//! A track that stands still has the feature 0: it is like others that stand still. Where nothing moves, position alone tells
//! tracks apart.

mod features;
mod pairs;
mod smooth;
#[cfg(test)]
mod tests;

use honami_model::hierarchy::Dendrogram;

use crate::bod::{Bod, Residual, Table, residual, whitened};
use crate::ncut::{Graph, Order, divide};
use crate::{Criterion, MotionError, Positions, linkage, pool};
use features::Topoi;
use pairs::{Features, Pairs};

/// Of likeness in cuts: what is but half alike has nearly no edge.
const SHARPNESS: i32 = 8;
/// Others that each track is joined to at least, and how often groups are halved at most. A cut may split off a single track,
/// so there are more of these than halves of halves would need.
const N_JOINED: usize = 50;
const N_LEVELS: u32 = 24;

/// What makes two tracks alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Likeness {
    /// How far they go with each component, in x and y: `(w_k V_k,x, w_k V_k,y)`, with
    /// `w_k = sqrt(1 - (edge / S_k)^2) (S_k / S_1)^(1/4)`.
    Loadings,
    /// The same up to a rotation in the picture and a sign: `F F^T / tr`, F of K x 2 loadings, K = 15 at most, without the
    /// fall by the singular value.
    Turned,
    /// The correlation of their steps from frame to frame, as complex numbers: sqrt(1 - |rho|), with
    /// `rho = sum v1 conj(v2) / (|v1| |v2|)` (Zeng 2015, 5.1 with errata Z1), without noise.
    Steps,
}

/// Whether frequencies at which leaves flutter are taken down first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flutter {
    /// Tracks are taken as they are.
    Keep,
    /// What the residual's spectrum has more of is taken down ([`whitened`]).
    TakeDown,
    /// Taken down where there is some ([`Residual::is_flutter`]).
    Auto,
}

/// How a hierarchy is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Making {
    /// From above: the whole is cut, and again what falls apart most clearly for its size.
    Cuts,
    /// From below: the closest two are merged.
    Merges(Criterion),
}

/// How tracks are grouped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What makes two tracks alike.
    pub likeness: Likeness,
    /// Neighbours that each track is averaged with, no more than one in 12 of all tracks that move; 0: none.
    pub n_neighbours: usize,
    /// How the hierarchy is made.
    pub making: Making,
    /// Weight of the distance between mean positions, w_pos.
    pub position_weight: f64,
    /// The most components, 1 at least.
    pub most: usize,
    /// What is done about flutter.
    pub flutter: Flutter,
    /// Of the vectors that large graphs are solved from.
    pub seed: u64,
    /// Threads to work with; 0 for those of the current rayon pool. The result is the same.
    pub n_threads: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            likeness: Likeness::Steps,
            n_neighbours: 8,
            making: Making::Cuts,
            position_weight: 0.6,
            most: 30,
            flutter: Flutter::Auto,
            seed: 0,
            n_threads: 0,
        }
    }
}

/// A hierarchy of tracks, with what it was made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouped {
    /// By cuts, halves join at (1 + 1 / (1 + p)) / 2, p = Ncut / sqrt(share of all tracks), or at the height at which their
    /// group joins another, if that is less; parts that were not connected at 1; tracks of the last groups, along the heaviest
    /// edges, at (1 - w) / 2. By merges as [`linkage()`] says.
    pub tree: Dendrogram,
    /// Components of the tracks above the edge of noise.
    pub n_above: usize,
    /// Components that were used; 0 where nothing moves more than noise does.
    pub n_used: usize,
    /// Whether the tracks look like leaves that flutter each for itself.
    pub flutters: bool,
    /// Whether flutter was taken down.
    pub is_whitened: bool,
    /// Positions that were not seen, and are filled.
    pub n_filled: usize,
    /// Tracks that are never seen together with others: no cut joins them to any, and they are farthest from all.
    pub n_unseen: usize,
    /// Of the eigenvectors of cuts, as [`crate::Ncut::residual`]; 0 of merges.
    pub residual: f64,
}

/// Groups tracks by their components.
///
/// `keep_going` is told the share of the work that is done, 0 to 1; `false` stops. O(N T min(N, T) + N^2 K) time for K
/// components; O(N T) memory by cuts, and 8 bytes a pair by merges.
///
/// # Errors
/// [`MotionError`] as [`Table::new`], for options out of range and for a matrix or graph that does not fit in memory.
pub fn grouped(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Grouped, MotionError> {
    let weight = options.position_weight;
    if !(weight.is_finite() && weight >= 0.0) {
        return Err(MotionError::Option { name: "the weight of position", came: weight });
    }
    pool::within(options.n_threads, keep_going, |keep_going| {
        let table = Table::new(positions, &mut |done| keep_going(0.3 * done))?;
        let tracks = Tracks::new(&table, options, &mut |done| keep_going(0.3 + 0.3 * done))?;
        let (tree, residual) = tracks.hierarchy(options, &mut |done| keep_going(0.6 + 0.4 * done))?;
        Ok(Grouped {
            tree,
            n_above: tracks.n_above,
            n_used: tracks.n_used,
            flutters: tracks.flutters,
            is_whitened: tracks.is_whitened,
            n_filled: table.n_filled(),
            n_unseen: tracks.places.iter().filter(|place| place.is_none()).count(),
            residual,
        })
    })
}

/// What tracks are like, and where they are.
struct Tracks {
    features: Features,
    /// Mean positions, pixels; `None` of one never seen.
    places: Vec<Option<[f64; 2]>>,
    n_above: usize,
    n_used: usize,
    flutters: bool,
    is_whitened: bool,
}

impl Tracks {
    fn new(
        table: &Table,
        options: &Options,
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, MotionError> {
        let bod = Bod::new(table);
        if !keep_going(0.1) {
            return Err(MotionError::Stopped);
        }
        let rest = residual(table, &bod);
        let flutters = rest.as_ref().is_some_and(Residual::is_flutter);
        let take_down = match options.flutter {
            Flutter::Keep => false,
            Flutter::TakeDown => true,
            Flutter::Auto => flutters,
        };
        let white = rest.filter(|_| take_down).map(|rest| whitened(table, &rest));
        let is_whitened = white.is_some();
        let bod = white.map_or(bod, |white| Bod::new(&white));
        if !keep_going(0.3) {
            return Err(MotionError::Stopped);
        }
        let places: Vec<_> = (0..table.n_tracks()).map(|track| table.place(track)).collect();
        let topoi = Topoi::new(&bod, options.most.max(1));
        let (weight, n) = (options.position_weight, options.n_neighbours);
        let (loadings, topoi) =
            smooth::smoothed(&bod, topoi, &places, weight, n, &mut |done| keep_going(0.3 + 0.7 * done))?;
        let features = match options.likeness {
            Likeness::Loadings => loadings,
            Likeness::Turned => features::turned(&bod, &topoi),
            Likeness::Steps => features::steps(table, &bod, &topoi),
        };
        // Tracks are made of 4 components at least; those below the noise have no weight in loadings.
        let n_used = match options.likeness {
            Likeness::Steps => topoi.len(),
            Likeness::Loadings | Likeness::Turned => topoi.len().min(bod.n_above()),
        };
        Ok(Self { features, places, n_above: bod.n_above(), n_used, flutters, is_whitened })
    }

    /// The hierarchy, and the largest residual of an eigenvector.
    fn hierarchy(
        &self,
        options: &Options,
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(Dendrogram, f64), MotionError> {
        let n = self.places.len();
        let pairs = Pairs::new(&self.features, &self.places, options.position_weight);
        if let Making::Merges(criterion) = options.making {
            let condensed = pairs.distances(&mut |done| keep_going(0.5 * done))?;
            return Ok((linkage(condensed, n, criterion)?, 0.0));
        }
        let scales = pairs.scales(&mut |done| keep_going(0.2 * done))?;
        let weights = |tracks| pairs.affinities(tracks, SHARPNESS, scales);
        let graph = Graph::of_largest(n, N_JOINED, &weights, &mut |done| keep_going(0.2 + 0.3 * done))?;
        let divided =
            divide(graph, N_LEVELS, Order::Shares, options.seed, &mut |done| keep_going(0.5 + 0.5 * done))?;
        Ok((divided.tree, divided.residual))
    }
}
