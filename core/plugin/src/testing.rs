//! Runs plugins without a host, for the tests of their crates.

mod clip;
mod samples;
mod suite;

pub use clip::{Clip, off_px};
pub use samples::{Samples, groups};
pub use suite::suite;

use crate::clusterer::{Clusterer, Clustering, Tracks};
use crate::structure::{Filmed, Skeleton, Structure};
use crate::tracker::{Frame, Point, Points, Seed, Stream, Tracker};
use crate::{Cx, Listener, Result};

/// Hears everything and never stops the work.
#[derive(Clone, Copy, Debug)]
pub struct Deaf;

impl Listener for Deaf {
    fn progress(&self, _: f64, _: &str) -> bool {
        false
    }
    fn log(&self, _: i32, _: &str) {}
}

/// A context that nobody listens to.
#[must_use]
pub fn cx() -> Cx<'static> {
    Cx::new(&Deaf)
}

/// A forward stream of pictures of this size, one thread, seed 0, no births.
#[must_use]
pub fn stream(width: u32, height: u32) -> Stream {
    let (fps, n_frames) = (None, None);
    Stream { width, height, fps, n_frames, reversed: false, max_threads: 1, seed: 0, births: 0..0 }
}

/// Tracks points through frames as the host would: seeds before the first push. Returns the rows of every push, and
/// those of `end` last.
///
/// # Errors
/// The tracker's.
pub fn track<'f, T: Tracker>(
    params: &T::Params,
    stream: &Stream,
    seeds: &[Seed],
    frames: impl IntoIterator<Item = Frame<'f>>,
) -> Result<Vec<Vec<Point>>> {
    let mut tracker = T::begin(params, stream, &cx())?;
    tracker.seed(seeds, &cx())?;
    let mut out = Points::default();
    let mut all = Vec::new();
    for frame in frames {
        out.restart(frame.index);
        tracker.push(&frame, &mut out, &cx())?;
        all.push(out.rows().to_vec());
    }
    out.restart(0);
    tracker.end(&mut out, &cx())?;
    all.push(out.rows().to_vec());
    Ok(all)
}

/// Groups tracks.
///
/// # Errors
/// The clusterer's.
pub fn cluster<T: Clusterer>(params: &T::Params, tracks: &Tracks<'_>) -> Result<Clustering> {
    T::cluster(params, tracks, &cx())
}

/// Grows the branches behind tracks.
///
/// # Errors
/// The structure builder's.
pub fn grow<T: Structure>(params: &T::Params, filmed: &Filmed<'_>) -> Result<Skeleton> {
    T::grow(params, filmed, &cx())
}
