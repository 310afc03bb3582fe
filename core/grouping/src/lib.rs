//! What clusterer plugins share: the choice of linkage, tracks as the algorithms take them, and hierarchies as the host
//! does.

use honami_model::hierarchy::Dendrogram;
use honami_motion::{Criterion, MotionError, Positions, linkage};
use honami_plugin::{Cx, Error, Merge, Result, Track, Tracks, choice};

choice! {
    /// What makes two groups close.
    pub enum Linkage {
        /// The least increase of inertia: groups of similar size.
        Ward = "ward" => "Ward",
        /// The mean distance between their tracks: groups as uneven as they come.
        Average = "average" => "Average",
    }
}

/// Share of all work before linkage.
pub const BEFORE_LINKAGE: f64 = 0.95;

/// The seen samples of all tracks, and the frame of the first.
#[must_use]
pub fn positions(tracks: &Tracks<'_>) -> (i64, Positions) {
    let samples = |track: Track<'_>| {
        let sample = |k: usize| track.seen(k).then(|| [track.x[k], track.y[k]]);
        (track.first_frame, (0..track.x.len()).map(sample).collect())
    };
    Positions::of_samples(&tracks.iter().map(samples).collect::<Vec<_>>())
}

/// Does work that tells its share, 0 to 1, which is `most` of all; the user hears of it, and may stop it.
///
/// # Errors
/// A stop; and what the work says: that tracks cannot be grouped is the fault of the data.
pub fn heard<T>(
    cx: &Cx<'_>,
    most: f64,
    what: &str,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, MotionError>,
) -> Result<T> {
    let mut heard = Ok(());
    let done = work(&mut |done| {
        heard = cx.progress(most * done, what);
        heard.is_ok()
    });
    heard?;
    done.map_err(error)
}

/// The merges of a condensed matrix of distances.
///
/// # Errors
/// A stop, and as [`honami_motion::linkage()`].
pub fn linked(condensed: Vec<f64>, n_tracks: usize, by: Linkage, cx: &Cx<'_>) -> Result<Vec<Merge>> {
    cx.progress(BEFORE_LINKAGE, "linkage")?;
    let criterion = match by {
        Linkage::Ward => Criterion::Ward,
        Linkage::Average => Criterion::Average,
    };
    Ok(merges(&linkage(condensed, n_tracks, criterion).map_err(error)?))
}

/// The merges of a hierarchy, as the host takes them.
#[must_use]
pub fn merges(tree: &Dendrogram) -> Vec<Merge> {
    tree.merges().iter().map(|m| Merge { a: m.a, b: m.b, height: m.height, size: m.size }).collect()
}

fn error(error: MotionError) -> Error {
    match error {
        MotionError::TooFewTracks(_) | MotionError::TooFewFrames(_) | MotionError::NeverTogether => {
            Error::data(error.to_string())
        }
        _ => error.into(),
    }
}

#[cfg(test)]
mod tests;
