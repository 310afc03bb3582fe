//! Leave one key-frame out: how well a tracker finds what a person has placed.

use std::ops::Range;

use honami_model::track::TrackId;
use honami_motion::accuracy::median;

use super::{Bench, Racer};
use crate::drive::Seed;
use crate::error::WorkbenchError;
use crate::retrack::anchors;
use crate::session::Session;

/// Where a person says that features are, in time: frames with positions in pixels, one list a track, in which a
/// stretch ends where the feature is said to be lost.
pub type KeyPaths = Vec<Vec<(u32, [f32; 2])>>;

/// How far key-frames are from where a tracker puts them that goes on from the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Key-frames that have one before them.
    pub n: usize,
    /// Those in which the tracker sees the feature.
    pub n_found: usize,
    /// Median distance, pixels, one in which it was lost being farther off than any other; `None` when half of them were.
    pub median_px: Option<f64>,
}

impl LeftOut {
    /// Of the distances, those where the feature was lost being infinitely far; `None` of none.
    fn of(distances: Vec<f64>) -> Option<Self> {
        let (n, n_found) = (distances.len(), distances.iter().filter(|px| px.is_finite()).count());
        let median_px = median(distances)?;
        Some(Self { n, n_found, median_px: median_px.is_finite().then_some(median_px) })
    }
}

/// The key-frames of a project; where a feature was found before the first of them, its birth counts as one.
///
/// # Errors
/// What the project met.
pub fn key_paths(session: &Session) -> Result<KeyPaths, WorkbenchError> {
    let mut paths = Vec::new();
    let document = session.project.document();
    for track in document.tracks().filter(|(_, track)| !track.keys.is_empty()).map(|(id, _)| id) {
        let mut path = Vec::new();
        for (frame, at) in anchors(session, track)? {
            match at {
                Some(at) => path.push((frame, at)),
                None => paths.push(std::mem::take(&mut path)),
            }
        }
        paths.push(path);
    }
    paths.retain(|path| path.len() > 1);
    Ok(paths)
}

/// One key-frame, and the one after it, which is left out.
type Way = [(u32, [f32; 2]); 2];

/// Pairs of key-frames within the frames.
fn ways(keys: &KeyPaths, frames: &Range<u32>) -> Vec<Way> {
    let pairs = keys.iter().flat_map(|path| path.array_windows::<2>().copied());
    pairs.filter(|way| way.iter().all(|(frame, _)| frames.contains(frame))).collect()
}

/// Tracks from every key-frame to the next, all in one pass; `None` where there are no two.
pub(super) fn measure(bench: &Bench<'_>, racer: &mut Racer) -> Result<Option<LeftOut>, WorkbenchError> {
    let ways = ways(&bench.question.keys, &bench.question.frames);
    let (Some(first), Some(last)) =
        (ways.iter().map(|way| way[0].0).min(), ways.iter().map(|way| way[1].0).max())
    else {
        return Ok(None);
    };
    let seed = |(number, way): (u32, &Way)| {
        let (frame, [x, y]) = way[0];
        Seed { frame, track: TrackId(number), x, y }
    };
    let seeds = (0..).zip(&ways).map(seed).collect();
    let mut far_px = vec![f64::INFINITY; ways.len()];
    bench.drive(racer, seeds, first..last + 1, ", key-frames left out", &mut |frame, rows| {
        for (track, sample) in rows.iter().filter(|(_, sample)| sample.status.is_seen()) {
            let number = track.0 as usize;
            if let Some([_, (end, at)]) = ways.get(number)
                && *end == frame
            {
                far_px[number] = apart([sample.x, sample.y], *at);
            }
        }
    })?;
    Ok(LeftOut::of(far_px))
}

/// The same for who stays at the key-frame before.
pub(super) fn standing(keys: &KeyPaths, frames: &Range<u32>) -> Option<LeftOut> {
    LeftOut::of(ways(keys, frames).iter().map(|[(_, a), (_, b)]| apart(*a, *b)).collect())
}

fn apart(a: [f32; 2], b: [f32; 2]) -> f64 {
    f64::from(a[0] - b[0]).hypot(f64::from(a[1] - b[1]))
}

#[cfg(test)]
mod tests {
    use super::{LeftOut, standing, ways};

    #[test]
    fn each_key_frame_is_left_out_that_has_one_before_it() {
        let keys = vec![
            vec![(0, [0.0, 0.0]), (10, [3.0, 4.0]), (20, [3.0, 4.0])],
            vec![(5, [1.0, 1.0]), (25, [1.0, 8.0])],
        ];
        assert_eq!(ways(&keys, &(0..30)).len(), 3);
        assert_eq!(ways(&keys, &(0..20)), [[keys[0][0], keys[0][1]]]);
        // 5, 0 and 7 px.
        let wanted = LeftOut { n: 3, n_found: 3, median_px: Some(5.0) };
        assert_eq!(standing(&keys, &(0..30)), Some(wanted));
        assert_eq!(standing(&keys, &(30..40)), None);
        let lost = f64::INFINITY;
        assert_eq!(LeftOut::of(vec![lost, 1.0]), Some(LeftOut { n: 2, n_found: 1, median_px: None }));
    }
}
