//! Distances between tracks from their bi-orthogonal decomposition: what moves with the same components is alike.
//!
//! Each track has a feature made from the components above the noise. The distance of two tracks is
//!
//! ```text
//! d = w_pos |p1 - p2| / s_pos  +  d_feature / s_feature
//! ```
//!
//! with p the mean positions and s the standard deviations of either distance over all N x N pairs of tracks. What a
//! track is like is scaled to length 1: how far it swings does not matter. A track that stands still has the feature 0: it
//! is like others that stand still. Where nothing moves, position alone tells tracks apart.

mod pairs;
#[cfg(test)]
mod tests;

use crate::bod::{Bod, Residual, Table, residual, whitened};
use crate::{MotionError, Positions, pool};
use pairs::Features;

/// Strongest components of the likeness that no rotation changes.
const TURNED_MOST: usize = 15;
/// Weights fall with the singular value to this power.
const FALL: f64 = 0.25;

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
    /// Taken down where [`Likenesses::flutters`].
    Auto,
}

/// How distances are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What makes two tracks alike.
    pub likeness: Likeness,
    /// Weight of the distance between mean positions.
    pub position_weight: f64,
    /// The most components, 1 at least.
    pub most: usize,
    /// What is done about flutter.
    pub flutter: Flutter,
    /// Threads to work with; 0 for those of the current rayon pool. The result is the same.
    pub n_threads: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            likeness: Likeness::Loadings,
            position_weight: 0.6,
            most: 30,
            flutter: Flutter::Keep,
            n_threads: 0,
        }
    }
}

/// Distances between all tracks, with what they were made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Likenesses {
    /// Number of tracks n.
    pub n_tracks: usize,
    /// Distances of the pairs (i, j), i < j, row by row: n (n - 1) / 2, finite, 0 or more.
    pub condensed: Vec<f64>,
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
    /// Tracks that are never seen together with others; they are farthest from all.
    pub n_unseen: usize,
}

/// Computes the distance of all pairs of tracks.
///
/// `keep_going` is told the share of the work that is done, 0 to 1; `false` stops. O(N T min(N, T) + N^2) time, O(N^2)
/// memory.
///
/// # Errors
/// [`MotionError`] as [`Table::new`], for options out of range and for a matrix that does not fit in memory.
pub fn likenesses(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Likenesses, MotionError> {
    let weight = options.position_weight;
    if !(weight.is_finite() && weight >= 0.0) {
        return Err(MotionError::Option { name: "the weight of position", came: weight });
    }
    pool::within(options.n_threads, keep_going, |keep_going| compared(positions, options, keep_going))
}

fn compared(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Likenesses, MotionError> {
    let table = Table::new(positions, &mut |done| keep_going(0.5 * done))?;
    let bod = Bod::new(&table);
    let rest = residual(&table, &bod);
    let flutters = rest.as_ref().is_some_and(Residual::is_flutter);
    let take_down = match options.flutter {
        Flutter::Keep => false,
        Flutter::TakeDown => true,
        Flutter::Auto => flutters,
    };
    let white = rest.filter(|_| take_down).map(|rest| whitened(&table, &rest));
    let is_whitened = white.is_some();
    let bod = white.map_or(bod, |white| Bod::new(&white));
    if !keep_going(0.7) {
        return Err(MotionError::Stopped);
    }
    let most = options.most.max(1);
    let (features, n_used) = match options.likeness {
        Likeness::Loadings => loadings(&bod, most),
        Likeness::Turned => turned(&bod, most.min(TURNED_MOST)),
        Likeness::Steps => steps(&bod, table.n_frames()),
    };
    let places: Vec<Option<[f64; 2]>> = (0..table.n_tracks()).map(|track| table.place(track)).collect();
    let condensed = pairs::distances(&features, &places, options.position_weight, &mut |done| {
        keep_going(0.7 + 0.3 * done)
    })?;
    Ok(Likenesses {
        n_tracks: table.n_tracks(),
        condensed,
        n_above: bod.n_above(),
        n_used,
        flutters,
        is_whitened,
        n_filled: table.n_filled(),
        n_unseen: places.iter().filter(|place| place.is_none()).count(),
    })
}

/// Weighted loadings of the first components that have any weight: their number, and a list for x and y of each.
fn weighted(bod: &Bod, most: usize, fall: f64) -> (usize, Vec<[Vec<f64>; 2]>) {
    let n = bod.n_above().min(most).min(bod.len());
    let of = |k: usize| {
        let weight = bod.share(k).sqrt() * (bod.singular[k] / bod.singular[0]).powf(fall);
        bod.topos(k).map(|loadings| loadings.iter().map(|v| weight * v).collect())
    };
    (n, (0..n).map(of).collect())
}

fn loadings(bod: &Bod, most: usize) -> (Features, usize) {
    let (n, weighted) = weighted(bod, most, FALL);
    (Features::apart(weighted.into_iter().flatten().collect()).unit(), n)
}

fn turned(bod: &Bod, most: usize) -> (Features, usize) {
    let (n, weighted) = weighted(bod, most, 0.0);
    let n_tracks = weighted.first().map_or(0, |[x, _]| x.len());
    let traces: Vec<f64> =
        (0..n_tracks).map(|i| weighted.iter().map(|[x, y]| x[i].powi(2) + y[i].powi(2)).sum()).collect();
    let mut products = Vec::new();
    for k in 0..n {
        for l in k..n {
            // Those off the diagonal are there twice.
            let twice = if k == l { 1.0 } else { std::f64::consts::SQRT_2 };
            let ([kx, ky], [lx, ly]) = (&weighted[k], &weighted[l]);
            let product = |i: usize| match traces[i] {
                trace if trace > 0.0 => twice * (kx[i] * lx[i] + ky[i] * ly[i]) / trace,
                _ => 0.0,
            };
            products.push((0..n_tracks).map(product).collect());
        }
    }
    (Features::apart(products), n)
}

/// Steps without their mean, as what they are of an orthonormal basis: as many complex numbers as components.
fn steps(bod: &Bod, n_frames: usize) -> (Features, usize) {
    let n = if bod.n_above() > 0 { bod.n_denoised() } else { 0 };
    let step = |k: usize| -> Vec<f64> {
        let steps: Vec<f64> = bod.chronos(k).windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mean = steps.iter().sum::<f64>() / (n_frames - 1) as f64;
        steps.iter().map(|v| bod.singular[k] * (v - mean)).collect()
    };
    // Gram and Schmidt, twice over each: steps of components are nearly orthogonal already.
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut lists = Vec::new();
    let all: Vec<Vec<f64>> = (0..n).map(step).collect();
    for steps in &all {
        let mut own = steps.clone();
        for _ in 0..2 {
            for other in &basis {
                let shared: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
                own.iter_mut().zip(other).for_each(|(a, b)| *a -= shared * b);
            }
        }
        let length = own.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length > 1e-9 * bod.singular[0] {
            basis.push(own.iter().map(|v| v / length).collect());
        }
    }
    for axis in &basis {
        let shares: Vec<f64> =
            all.iter().map(|steps| steps.iter().zip(axis).map(|(a, b)| a * b).sum()).collect();
        for side in 0..2 {
            let n_tracks = bod.topos(0)[side].len();
            let at =
                |i: usize| shares.iter().enumerate().map(|(k, share)| share * bod.topos(k)[side][i]).sum();
            lists.push((0..n_tracks).map(at).collect());
        }
    }
    (Features::correlated(lists).unit(), n)
}
