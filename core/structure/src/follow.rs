//! Where the centre of a group is in every frame, though its tracks begin, end and have gaps.
//!
//! The mean of those that are seen would jump whenever one comes or goes. So each track has its usual place beside the
//! centre, and the centre is where those that are seen say it is: the least squares of x(track, frame) = centre(frame) +
//! place(track). Where all are seen, that is their mean. Tracks that are never seen together say nothing of each other's
//! places: then who comes later goes on from where the others have left the centre.

mod settle;
#[cfg(test)]
mod tests;

use honami_model::track::TrackId;

/// A feature and where it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Its track.
    pub track: TrackId,
    /// Pixels (right, down), a frame each; `None` where it is not seen.
    pub at: Vec<Option<[f64; 2]>>,
}

impl Path {
    /// Whether it is seen at all.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.at.iter().any(Option::is_some)
    }

    /// The frames in which it is seen, and where.
    pub(crate) fn seen(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.at.iter().enumerate().filter_map(|(frame, at)| Some((frame, (*at)?)))
    }
}

/// A group over the clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// Its centre, pixels (right, down), a frame each. Where nothing of it is seen, on the straight way from the frame
    /// before to the frame after; before the first and after the last such frame as there.
    pub centre: Vec<[f64; 2]>,
    /// From the centre to where each of its tracks usually is, pixels; zero for one that is never seen.
    pub places: Vec<[f64; 2]>,
}

impl Followed {
    /// Where its `k`-th track is in a frame: where it is seen, else where it usually is.
    #[must_use]
    pub fn at(&self, k: usize, path: &Path, frame: usize) -> [f64; 2] {
        let ([x, y], [dx, dy]) = (self.centre[frame], self.places[k]);
        path.at[frame].unwrap_or([x + dx, y + dy])
    }
}

/// Follows a group; `None` where nothing of it is ever seen. Paths are of one length.
#[must_use]
pub fn follow(paths: &[&Path]) -> Option<Followed> {
    let n_frames = paths.iter().map(|path| path.at.len()).max()?;
    let has_gaps = paths.iter().any(|path| path.at.iter().any(Option::is_none));
    let mut centre = means(paths, n_frames, |_, at| at);
    if has_gaps {
        let places = settle::places(paths, n_frames);
        centre = means(paths, n_frames, |k, at| less(at, places[k]));
        settle::join(paths, &mut centre);
    }
    let places = paths.iter().map(|path| place_of(path, &centre)).collect();
    bridge(&centre).map(|centre| Followed { centre, places })
}

/// The mean in every frame of something of each track that is seen there, of its row and where it is.
fn means(
    paths: &[&Path],
    n_frames: usize,
    of: impl Fn(usize, [f64; 2]) -> [f64; 2],
) -> Vec<Option<[f64; 2]>> {
    let mut sums = vec![(0_u32, [0.0; 2]); n_frames];
    for (k, path) in paths.iter().enumerate() {
        for (frame, at) in path.seen() {
            let (n, sum) = &mut sums[frame];
            (*n, *sum) = (*n + 1, more(*sum, of(k, at)));
        }
    }
    sums.into_iter().map(|(n, sum)| (n > 0).then(|| sum.map(|v| v / f64::from(n)))).collect()
}

/// The mean over the frames in which a track is seen of where it is beside the centre.
fn place_of(path: &Path, centre: &[Option<[f64; 2]>]) -> [f64; 2] {
    mean(path.seen().filter_map(|(frame, at)| Some(less(at, centre[frame]?)))).unwrap_or_default()
}

/// The mean of places; `None` of none.
pub(crate) fn mean(places: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let (mut n, mut sum) = (0_u32, [0.0; 2]);
    for place in places {
        (n, sum) = (n + 1, more(sum, place));
    }
    (n > 0).then(|| sum.map(|v| v / f64::from(n)))
}

/// Goes straight over what is missing; `None` where all is.
fn bridge(centre: &[Option<[f64; 2]>]) -> Option<Vec<[f64; 2]>> {
    let known: Vec<(usize, [f64; 2])> =
        centre.iter().enumerate().filter_map(|(frame, at)| Some((frame, (*at)?))).collect();
    let (first, last) = (known.first()?, known.last()?);
    let between = |frame: usize| {
        let after = known.partition_point(|(at, _)| *at <= frame);
        let (before, after) =
            (known.get(after.wrapping_sub(1)).unwrap_or(first), known.get(after).unwrap_or(last));
        let share = (frame as f64 - before.0 as f64) / (after.0 as f64 - before.0 as f64).max(1.0);
        let share = share.clamp(0.0, 1.0);
        std::array::from_fn(|axis| before.1[axis] + share * (after.1[axis] - before.1[axis]))
    };
    Some((0..centre.len()).map(between).collect())
}

fn more(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
