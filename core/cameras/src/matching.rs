//! Which track of one view is which of the other.

use crate::assign::assigned;
use crate::{Pair, Pixel};

/// Fewer frames that both were seen in say nothing.
pub const FEWEST_FRAMES: usize = 8;

/// A track as one camera saw it: its place in each frame, `None` where it was not seen. Frames of both views are at the same times.
pub type Seen = [Option<Pixel>];

/// What makes two tracks one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Tracks that are farther from each other's epipolar lines than this are not one, pixels; by the root mean square over frames.
    pub farthest_px: f64,
    /// What movement along the lines counts, pixels: where it is not alike at all it costs as much as lying so far from them.
    pub unlike_px: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { farthest_px: 3.0, unlike_px: 2.0 }
    }
}

/// Two tracks that are one, by their numbers in each view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Number of the left one.
    pub left: usize,
    /// Number of the right one.
    pub right: usize,
    /// Root mean square distance from the epipolar lines, pixels.
    pub epipolar_px: f64,
    /// How alike they move along the lines, either way, 0..=1; 0 where one of them hardly moves.
    pub alike: f64,
    /// How much more the next best pair of either would cost, pixels; infinite where there is none. A small number is a doubt,
    /// and so is one below 0: it would suit better, and suits another even more.
    pub margin_px: f64,
}

/// Tracks of two views that are one, so that their costs together are least: each track has a partner or none.
///
/// What is one place lies on the epipolar line in every frame, so what moves across the lines moves alike in both views; of the
/// movement along them, which depends on depth, only its likeness in time counts.
///
/// A pixel beyond what a camera's distortion can describe counts as one that was not seen.
#[must_use]
pub fn matched(pair: &Pair, left: &[&Seen], right: &[&Seen], options: &Options) -> Vec<Match> {
    let rays = |tracks: &[&Seen], camera: usize| -> Vec<Vec<Option<Pixel>>> {
        let ray = |at: &Option<Pixel>| pair.cameras[camera].undistort(&(*at)?).ok();
        tracks.iter().map(|track| track.iter().map(ray).collect()).collect()
    };
    let (left_rays, right_rays) = (rays(left, 0), rays(right, 1));
    let mut likenesses = Vec::with_capacity(left.len() * right.len());
    for (l, l_rays) in left.iter().zip(&left_rays) {
        for (r, r_rays) in right.iter().zip(&right_rays) {
            let px = epipolar_px(pair, l_rays, r_rays);
            // What lies too far away is none, however it moves.
            let near = px.filter(|px| *px <= options.farthest_px);
            likenesses.push(near.map(|px| (px, alike(&together(l, r)))));
        }
    }
    let cost = |likeness: &Option<(f64, f64)>| match likeness {
        Some((px, alike)) => px.hypot(options.unlike_px * (1.0 - alike)),
        None => f64::INFINITY,
    };
    let costs: Vec<f64> = likenesses.iter().map(cost).collect();
    let n = right.len();
    let matches =
        assigned(&costs, n).into_iter().enumerate().filter_map(|(left, right)| Some((left, right?)));
    let with_margin = matches.filter_map(|(l, r)| {
        let (epipolar_px, alike) = likenesses[l * n + r]?;
        let in_row = (0..n).filter(|&other| other != r).map(|other| costs[l * n + other]);
        let in_column = (0..left.len()).filter(|&other| other != l).map(|other| costs[other * n + r]);
        let next = in_row.chain(in_column).fold(f64::INFINITY, f64::min);
        Some(Match { left: l, right: r, epipolar_px, alike, margin_px: next - costs[l * n + r] })
    });
    with_margin.collect()
}

/// Frames in which both are seen.
fn together(left: &Seen, right: &Seen) -> Vec<[Pixel; 2]> {
    left.iter().zip(right).filter_map(|(l, r)| Some([(*l)?, (*r)?])).collect()
}

/// Root mean square distance of directions from the epipolar lines, pixels; `None` where they were hardly seen together.
fn epipolar_px(pair: &Pair, left: &Seen, right: &Seen) -> Option<f64> {
    let essential = pair.essential();
    let both = together(left, right);
    let squares: f64 = both.iter().map(|rays| pair.epipolar_px_of(&essential, rays).powi(2)).sum();
    (both.len() >= FEWEST_FRAMES).then(|| (squares / both.len() as f64).sqrt())
}

/// Correlation of two movements, each along the direction in which it is largest; the sign of a direction is free.
fn alike(both: &[[Pixel; 2]]) -> f64 {
    /// What moves less stands still, pixels.
    const STILL_PX: f64 = 0.1;
    let n = both.len() as f64;
    let along = |side: usize| -> Option<Vec<f64>> {
        let middle = both.iter().map(|seen| seen[side]).sum::<Pixel>() / n;
        let off: Vec<Pixel> = both.iter().map(|seen| seen[side] - middle).collect();
        let scatter: nalgebra::Matrix2<f64> = off.iter().map(|off| off * off.transpose() / n).sum();
        let eigen = scatter.symmetric_eigen();
        let most = eigen.eigenvalues.imax();
        let direction = eigen.eigenvectors.column(most).into_owned();
        (eigen.eigenvalues[most].sqrt() > STILL_PX)
            .then(|| off.iter().map(|off| off.dot(&direction)).collect())
    };
    let (Some(left), Some(right)) = (along(0), along(1)) else { return 0.0 };
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    (product(&left, &right) / (product(&left, &left) * product(&right, &right)).sqrt()).abs()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::staged::{LENS, Noise};
    use crate::{Camera, Place, Pose};

    /// Leaves that sway, each at its own pace, as two cameras see them.
    fn swaying(n: usize, sigma: f64) -> (Pair, [Vec<Vec<Option<Pixel>>>; 2]) {
        let right_from_left = Pose::new(Vector3::new(0.0, 0.3, 0.02), Vector3::new(-1.2, 0.05, 0.2));
        let pair =
            Pair { cameras: [LENS, Camera { fx: 560.0, fy: 560.0, k2: 0.0, ..LENS }], right_from_left };
        let mut noise = Noise::new(21, sigma);
        let mut views = [Vec::new(), Vec::new()];
        for leaf in 0..n {
            let k = leaf as f64;
            let rest = Place::new((k * 2.4).sin(), (k * 1.7).cos() * 0.8, 4.0 + (k * 0.9).sin());
            let at = |frame: usize| {
                let phase = frame as f64 * (0.15 + 0.011 * k) + k;
                rest + Vector3::new(phase.sin(), 0.4 * phase.cos(), 0.5 * (phase * 0.7).sin()) * 0.05
            };
            for (side, view) in views.iter_mut().enumerate() {
                let stand = [Pose::identity(), right_from_left][side];
                let see = |frame: usize| {
                    Some(pair.cameras[side].project(&stand.of(&at(frame))).unwrap() + noise.pixel())
                };
                view.push((0..60).map(see).collect());
            }
        }
        (pair, views)
    }

    fn slices(tracks: &[Vec<Option<Pixel>>]) -> Vec<&Seen> {
        tracks.iter().map(Vec::as_slice).collect()
    }

    #[test]
    fn leaves_are_matched_with_themselves_and_strangers_with_none() {
        let (pair, [mut left, mut right]) = swaying(24, 0.3);
        // The right view knows its tracks in another order, lacks one, and loses others for a while.
        right.reverse();
        right.remove(4);
        left.remove(20);
        left[3][10..40].fill(None);
        let matches = matched(&pair, &slices(&left), &slices(&right), &Options::default());
        assert_eq!(matches.len(), 22);
        for found in matches {
            let leaf = found.left + usize::from(found.left >= 20);
            let right = 23 - leaf;
            assert_eq!(found.right, right - usize::from(right > 4), "leaf {leaf}: {found:?}");
            assert!(found.epipolar_px < 0.6, "{found:?}");
        }
    }

    #[test]
    fn a_pixel_beyond_the_lens_is_left_out_alone() {
        let (pair, [left, mut right]) = swaying(4, 0.1);
        let beyond = Pixel::new(900.0, 232.0);
        assert!(pair.cameras[1].undistort(&beyond).is_err());
        right[2][7] = Some(beyond);
        let matches = matched(&pair, &slices(&left), &slices(&right), &Options::default());
        assert_eq!(
            matches.iter().map(|m| (m.left, m.right)).collect::<Vec<_>>(),
            [(0, 0), (1, 1), (2, 2), (3, 3)]
        );
        assert!(matches.iter().all(|found| found.epipolar_px < 0.3), "{matches:?}");
    }

    #[test]
    fn tracks_that_were_hardly_seen_together_are_no_match() {
        let (pair, [left, mut right]) = swaying(2, 0.0);
        right[1][FEWEST_FRAMES - 1..].fill(None);
        let matches = matched(&pair, &slices(&left), &slices(&right), &Options::default());
        assert_eq!(matches.iter().map(|m| (m.left, m.right)).collect::<Vec<_>>(), [(0, 0)]);
        assert!(matches[0].alike > 0.9 && matches[0].epipolar_px < 1e-9, "{matches:?}");
        assert!(matched(&pair, &[], &slices(&right), &Options::default()).is_empty());
    }
}
