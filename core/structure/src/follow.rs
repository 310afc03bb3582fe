//! Where the centre of a group is in every frame, though its tracks begin, end and have gaps.
//!
//! The mean of those that are seen would jump whenever one comes or goes. So each track has its usual place beside the
//! centre, and the centre is where those that are seen say it is: the least squares of x(track, frame) = centre(frame) +
//! place(track). Where all are seen, that is their mean.

#[cfg(test)]
mod tests;

use honami_model::track::TrackId;

/// Places move less than this from one round to the next: they are found. Pixels.
const SETTLED: f64 = 1e-6;
/// Rounds at most; tracks that hardly overlap settle slowly.
const MAX_ROUNDS: u32 = 200;

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
    let mut places = vec![[0.0; 2]; paths.len()];
    let mut centre = Vec::new();
    for _ in 0..MAX_ROUNDS {
        centre = (0..n_frames).map(|frame| centre_of(paths, &places, frame)).collect();
        let found: Vec<[f64; 2]> = paths.iter().map(|path| place_of(path, &centre)).collect();
        let moved = found.iter().zip(&places).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        let farthest = moved.fold(0.0, f64::max);
        places = found;
        if !has_gaps || farthest < SETTLED {
            break;
        }
    }
    bridge(&centre).map(|centre| Followed { centre, places })
}

/// The mean over the tracks seen in a frame of where each says the centre is.
fn centre_of(paths: &[&Path], places: &[[f64; 2]], frame: usize) -> Option<[f64; 2]> {
    let said = paths.iter().zip(places).filter_map(|(path, place)| {
        let at = path.at.get(frame).copied().flatten()?;
        Some([at[0] - place[0], at[1] - place[1]])
    });
    mean(said)
}

/// The mean over the frames in which a track is seen of where it is beside the centre.
fn place_of(path: &Path, centre: &[Option<[f64; 2]>]) -> [f64; 2] {
    let beside = path.at.iter().zip(centre).filter_map(|(at, centre)| {
        let (at, centre) = ((*at)?, (*centre)?);
        Some([at[0] - centre[0], at[1] - centre[1]])
    });
    mean(beside).unwrap_or_default()
}

/// The mean of places; `None` of none.
pub(crate) fn mean(places: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 2]> {
    let (mut n, mut sum) = (0_u32, [0.0; 2]);
    for place in places {
        n += 1;
        sum = [sum[0] + place[0], sum[1] + place[1]];
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
