//! Agglomerative clustering (thesis 4.3.2): average linkage and Ward's criterion, on any dissimilarity.

use honami_model::hierarchy::{Dendrogram, Merge};

use crate::MotionError;

/// What makes two groups close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// The mean distance between their tracks (thesis eq. 4.5 with errata E20: UPGMA).
    Average,
    /// The least increase of inertia (thesis eq. 4.9 and 4.10; errata E18 and E19).
    ///
    /// Two tracks at distance d start with an increase Δ = d²/2; a merge has the height √(2Δ), as SciPy's
    /// has, so that two single tracks merge at d. Defined by the recurrence 4.10, it holds for
    /// dissimilarities that no points in space have, and its heights never fall from one merge to the next.
    Ward,
}

/// Merges the closest two groups until one is left.
///
/// `condensed` holds the distances of the pairs (i, j), i < j, row by row: n (n - 1) / 2 of them, finite and
/// not negative. Time and memory O(n²). The merges are those of `scipy.cluster.hierarchy.linkage`.
///
/// # Errors
/// [`MotionError`] for fewer than 2 tracks, a list of another length, or a value that is no distance.
pub fn linkage(
    mut condensed: Vec<f64>,
    n_tracks: usize,
    criterion: Criterion,
) -> Result<Dendrogram, MotionError> {
    if n_tracks < 2 {
        return Err(MotionError::TooFewTracks(n_tracks));
    }
    let wanted = n_tracks * (n_tracks - 1) / 2;
    if condensed.len() != wanted {
        return Err(MotionError::Condensed { n_tracks, wanted, came: condensed.len() });
    }
    let is_distance = |d: &f64| d.is_finite() && *d >= 0.0;
    if let Some(index) = condensed.iter().position(|d| !is_distance(d)) {
        return Err(MotionError::Distance { index, value: condensed[index] });
    }
    let method = match criterion {
        Criterion::Average => kodama::Method::Average,
        Criterion::Ward => kodama::Method::Ward,
    };
    // Ward squares distances: scaled to at most 1, nothing overflows and the heights scale back exactly.
    let largest = condensed.iter().fold(0.0_f64, |largest, &d| largest.max(d));
    let scale = if largest > 1e100 { largest } else { 1.0 };
    condensed.iter_mut().for_each(|d| *d /= scale);
    let steps = kodama::linkage(&mut condensed, n_tracks, method);
    let index = |k: usize| u32::try_from(k).unwrap_or(u32::MAX);
    let merges = steps.steps().iter().map(|step| Merge {
        a: index(step.cluster1),
        b: index(step.cluster2),
        height: step.dissimilarity * scale,
        size: index(step.size),
    });
    // n(n - 1)/2 distances in memory keep n far below u32::MAX, and kodama's steps form one tree.
    Ok(Dendrogram::new(index(n_tracks), merges.collect()).unwrap_or_else(|error| unreachable!("{error}")))
}

#[cfg(test)]
mod tests;
