//! A track of one view and one of another that are the same feature: where it is in every frame, though the cameras took their
//! pictures at other times.

use nalgebra::{Matrix3, Vector3};

use crate::clock::Offset;
use crate::{Fix, Pair, Pixel, Pose, triangulate};

/// A track as one camera saw it.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Times of the frames, seconds, growing.
    pub times_s: &'a [f64],
    /// Its place in each frame, `None` where it was not seen.
    pub seen: &'a [Option<Pixel>],
}

impl View<'_> {
    /// Where it is at a time, and how fast it goes, pixels a second. Between frames it follows the cubic through the two before and the two
    /// after (a parabola or a straight line where the outer ones were not seen); over a gap nothing is said.
    ///
    /// Of a movement of f Hz in frames of rate r the cubic misses at most 36 (f / r)⁴ of the amplitude: of a sway of 1 Hz at 25
    /// frames a second a ten-thousandth, of one of 5 Hz a seventeenth.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<(Pixel, Pixel)> {
        // Rounding of an offset is no time between frames.
        let rounding = 1e-9 * time_s.abs().max(1.0);
        let i = self.times_s.partition_point(|&t| t <= time_s + rounding).checked_sub(1)?;
        let seen = |k: usize| Some((*self.times_s.get(k)?, (*self.seen.get(k)?)?));
        let (before, here, next) = (i.checked_sub(1).and_then(seen), seen(i)?, seen(i + 1));
        if next.is_none() && time_s > here.0 + rounding {
            return None;
        }
        let after = next.and_then(|_| seen(i + 2));
        let nodes: Vec<(f64, Pixel)> = [before, Some(here), next, after].into_iter().flatten().collect();
        Some(through(&nodes, time_s))
    }
}

/// The polynomial through some places in time, and its slope: Newton's divided differences.
fn through(nodes: &[(f64, Pixel)], time_s: f64) -> (Pixel, Pixel) {
    let mut differences: Vec<Pixel> = nodes.iter().map(|node| node.1).collect();
    for order in 1..nodes.len() {
        for k in (order..nodes.len()).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k].0 - nodes[k - order].0);
        }
    }
    let (mut place, mut slope) = (Pixel::zeros(), Pixel::zeros());
    for (difference, node) in differences.iter().zip(nodes).rev() {
        slope = slope * (time_s - node.0) + place;
        place = place * (time_s - node.0) + difference;
    }
    (place, slope)
}

/// A fix in one frame of the left view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The frame.
    pub frame: usize,
    /// Where the feature is; its covariance is for pixels with a standard deviation of 1.
    pub fix: Fix,
    /// How far the place goes where the offset is off by its standard error.
    pub by_clock: Vector3<f64>,
}

impl Placed {
    /// The fix for pixels with this standard deviation, and with what the clocks leave open.
    #[must_use]
    pub fn with(&self, sigma_px: f64) -> Fix {
        let by_clock: Matrix3<f64> = self.by_clock * self.by_clock.transpose();
        Fix { covariance: self.fix.covariance * (sigma_px * sigma_px) + by_clock, ..self.fix }
    }
}

/// Where a feature is in every frame of the left view in which both cameras see it; and in how many of those there is no such place
/// before both cameras.
#[must_use]
pub fn placed(pair: &Pair, left: &View<'_>, right: &View<'_>, offset: &Offset) -> (Vec<Placed>, usize) {
    let [left_camera, right_camera] = pair.cameras;
    let fix = |left: Pixel, right: Pixel| {
        let sights = [(left_camera, Pose::identity(), left), (right_camera, pair.right_from_left, right)];
        let fix = triangulate(&sights, 1.0).ok()?;
        fix.place.iter().chain(&fix.covariance).all(|c| c.is_finite()).then_some(fix)
    };
    let (mut found, mut n_lost) = (Vec::new(), 0);
    for (frame, (&time_s, seen)) in left.times_s.iter().zip(left.seen).enumerate() {
        let (Some(seen), Some((there, speed))) = (*seen, right.at(time_s + offset.seconds)) else { continue };
        let Some(of) = fix(seen, there) else {
            n_lost += 1;
            continue;
        };
        let late = if offset.error_s > 0.0 { fix(seen, there + speed * offset.error_s) } else { None };
        let by_clock = late.map_or_else(Vector3::zeros, |late| late.place - of.place);
        found.push(Placed { frame, fix: of, by_clock });
    }
    (found, n_lost)
}

/// The standard deviation of one coordinate of a pixel that these residuals of two views speak of: of four numbers three are spent on the
/// place, and the median says what is usual, so that a few mistakes do not count. `None` of none.
#[must_use]
pub fn sigma_px(mut residuals_px: Vec<f64>) -> Option<f64> {
    /// Median of the square of a normal variable.
    const MEDIAN: f64 = 0.454_936;
    residuals_px.sort_by(f64::total_cmp);
    let middle = residuals_px.get(residuals_px.len() / 2)?;
    // The sum of the squares of both distances is twice that of their mean.
    Some((2.0 * middle * middle / MEDIAN).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::staged::{LENS, Noise};
    use crate::{Camera, Place};

    fn pair() -> Pair {
        let right_from_left = Pose::new(Vector3::new(0.0, 0.3, 0.02), Vector3::new(-0.6, 0.02, 0.1));
        Pair { cameras: [LENS, Camera { fx: 560.0, fy: 560.0, ..LENS }], right_from_left }
    }

    fn place(t: f64) -> Place {
        Place::new(0.1 + 0.05 * (6.0 * t).sin(), -0.1 + 0.03 * (5.0 * t).cos(), 2.0 + 0.04 * (7.0 * t).sin())
    }

    /// Frames of a camera whose clock shows so much more.
    fn filmed(camera: usize, fps: f64, ahead_s: f64, noise: &mut Noise) -> (Vec<f64>, Vec<Option<Pixel>>) {
        let pair = pair();
        let stand = [Pose::identity(), pair.right_from_left][camera];
        let times: Vec<f64> = (0..80).map(|k| f64::from(k) / fps).collect();
        let see = |t: &f64| {
            Some(pair.cameras[camera].project(&stand.of(&place(t - ahead_s))).unwrap() + noise.pixel())
        };
        let seen = times.iter().map(see).collect();
        (times, seen)
    }

    fn view((times_s, seen): &(Vec<f64>, Vec<Option<Pixel>>)) -> View<'_> {
        View { times_s, seen }
    }

    fn offset(seconds: f64, error_s: f64) -> Offset {
        Offset { seconds, error_s, alike: 1.0, rival_s: None }
    }

    #[test]
    fn places_are_right_between_frames_of_another_rate_and_wrong_without_the_offset() {
        let mut none = Noise::new(0, 0.0);
        let left = filmed(0, 25.0, 0.0, &mut none);
        for (fps, ahead) in [(25.0, 0.0), (25.0, 0.0131), (30.0, 0.2), (50.0, -0.117)] {
            let right = filmed(1, fps, ahead, &mut none);
            let (found, n_lost) = placed(&pair(), &view(&left), &view(&right), &offset(ahead, 0.0));
            assert!(n_lost == 0 && found.len() > 30, "{fps}: {}", found.len());
            let off = |of: &Placed| (of.fix.place - place(left.0[of.frame])).norm();
            // The first and last frames have no neighbours on one side.
            let within = found.iter().filter(|of| (5..70).contains(&of.frame));
            let worst = within.map(off).fold(0.0, f64::max);
            assert!(worst < 1e-4, "{fps}, {ahead}: {worst}");
            let (unsynced, _) = placed(&pair(), &view(&left), &view(&right), &offset(ahead + 0.02, 0.0));
            let worst = unsynced.iter().map(off).fold(0.0, f64::max);
            assert!(worst > 5e-3, "{worst}");
        }
    }

    #[test]
    fn between_frames_a_sway_is_missed_by_as_little_as_is_said() {
        for share in [0.02, 0.04, 0.1, 0.2] {
            let sway = |frame: f64| Pixel::new((std::f64::consts::TAU * share * frame).sin(), 0.0);
            let times: Vec<f64> = (0..120).map(f64::from).collect();
            let seen: Vec<_> = times.iter().map(|&t| Some(sway(t))).collect();
            let view = View { times_s: &times, seen: &seen };
            let off =
                (20..1000).map(|k| f64::from(k) * 0.1).map(|t| (view.at(t).unwrap().0 - sway(t)).norm());
            let worst = off.fold(0.0, f64::max) / (36.0 * share.powi(4));
            assert!((0.7..1.05).contains(&worst), "{share}: {worst}");
        }
    }

    #[test]
    fn nothing_is_said_over_a_gap_and_a_frame_needs_no_neighbour() {
        let times = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
        let at = |x: f64| Some(Pixel::new(x, -x));
        let seen = [at(0.0), at(1.0), None, at(9.0), None, at(5.0)];
        let view = View { times_s: &times, seen: &seen };
        for (t, wanted) in [
            (-0.01, None),
            (0.0, Some(0.0)),
            (0.05, Some(0.5)),
            (0.1, Some(1.0)),
            (0.15, None),
            (0.2, None),
            (0.25, None),
            (0.3, Some(9.0)),
            (0.5, Some(5.0)),
            (0.51, None),
        ] {
            let found = view.at(t).map(|(place, _)| place);
            assert_eq!(found.map(|p| (p.x * 1e9).round() / 1e9), wanted, "{t}");
        }
        assert_eq!(view.at(0.05).unwrap().1, Pixel::new(10.0, -10.0));
    }

    #[test]
    fn errors_are_those_of_many_trials_of_pixels_and_clocks() {
        let (sigma, clock_s, n) = (0.3, 0.004, 40);
        let (mut squares, mut told) = (0.0, 0.0);
        let mut sigmas = 0.0;
        for seed in 0..n {
            let mut noise = Noise::new(seed, sigma);
            let (left, right) = (filmed(0, 25.0, 0.0, &mut noise), filmed(1, 25.0, 0.0, &mut noise));
            let slip = clock_s * Noise::new(500 + seed, 1.0).draw();
            let (found, _) = placed(&pair(), &view(&left), &view(&right), &offset(slip, clock_s));
            for of in &found {
                squares += (of.fix.place - place(left.0[of.frame])).norm_squared();
                told += of.with(sigma).covariance.trace();
            }
            let residuals = found.iter().map(|of| of.fix.rms_px).collect();
            sigmas += sigma_px(residuals).unwrap() / n as f64;
        }
        let ratio = (squares / told).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
        // Clocks that are off make residuals, too, and pixels between frames have less noise.
        assert!((0.25..0.45).contains(&sigmas), "{sigmas}");
        assert_eq!(sigma_px(Vec::new()), None);
    }

    #[test]
    fn depth_is_known_worse_than_what_lies_across() {
        let mut none = Noise::new(0, 0.0);
        let (left, right) = (filmed(0, 25.0, 0.0, &mut none), filmed(1, 25.0, 0.0, &mut none));
        let (found, _) = placed(&pair(), &view(&left), &view(&right), &offset(0.0, 0.0));
        let fix = found[0].with(0.5);
        let [along, across] = fix.along_and_across(&Place::zeros());
        assert!(along > 2.0 * across, "{along}, {across}");
        let total = along * along + 2.0 * across * across;
        assert!((total / fix.covariance.trace() - 1.0).abs() < 1e-12);
    }
}
