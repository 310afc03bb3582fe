//! The composite distance of thesis 4.3.1: where tracks are, and where they are going.
//!
//! Between two tracks at frame t, with p the positions and v(t) = p(t+1) - p(t) (eq. 4.1, t = 0..T-2: errata
//! E13):
//!
//! ```text
//! d(t) = w_pos |p1 - p2| / s_pos  +  w_mov angle(v1, v2) / s_mov
//! ```
//!
//! The angle between the velocities is the arccos of eq. 4.2, computed as the difference of their headings,
//! which needs no clamp (errata E14) and keeps small angles exact. s_pos and s_mov are the standard
//! deviations of the two distances over all pairs and frames (errata E16). Frames whose mean distance lies
//! more than `outlier_sd` standard deviations from the mean over all frames are left out; the distance of two
//! tracks is the mean over the frames that remain.
//!
//! Where tracks have gaps, the mean runs over the frames where both are seen (now and in the next frame); a
//! feature that stands still has no heading (errata E14), so its pairs have a movement only where both move.
//! Two tracks that never move together get the mean angle of all pairs, which neither draws them together nor
//! apart; two that are never seen together get the largest distance there is.
//!
//! One pass over the pairs gives the positions' part and every frame's mean; the mean angle and its square
//! come from each frame's sorted headings, so the frames to leave out are known before the second, cheaper
//! pass over the angles. Memory is the condensed matrix; nothing is N x N x T.

mod headings;
mod pairs;
mod steps;

use crate::{MotionError, Positions, pool};
use steps::{Movement, Place, Step, Steps};

/// Weights of the two distances, and how unusual a frame may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Weight of the distance between positions.
    pub position_weight: f64,
    /// Weight of the angle between velocities.
    pub movement_weight: f64,
    /// Frames further from the mean than this many standard deviations are left out; `None` keeps all.
    pub outlier_sd: Option<f64>,
    /// Threads to work with; 0 for those of the current rayon pool. The result is the same.
    pub n_threads: usize,
}

impl Default for Options {
    /// The thesis's: equal weights, frames beyond 2 standard deviations left out.
    fn default() -> Self {
        Self { position_weight: 1.0, movement_weight: 1.0, outlier_sd: Some(2.0), n_threads: 0 }
    }
}

/// Distances between all tracks, with what they were made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Composite {
    /// Number of tracks n.
    pub n_tracks: usize,
    /// Distances of the pairs (i, j), i < j, row by row: n (n - 1) / 2, finite, 0 or more.
    pub condensed: Vec<f64>,
    /// Standard deviation of the distance between positions over pairs and frames, pixels.
    pub position_sd_px: f64,
    /// Standard deviation of the angle between velocities over pairs and frames, radians.
    pub movement_sd_rad: f64,
    /// Mean distance of all pairs in frames 0..T-1; `None` where fewer than two tracks are seen.
    pub frame_means: Vec<Option<f64>>,
    /// The frames that were left out, ascending.
    pub outlier_frames: Vec<u32>,
    /// Pairs never seen together, which were given the largest distance.
    pub n_apart: usize,
}

/// Computes the composite distance of all pairs of tracks.
///
/// `keep_going` is told the share of the work that is done, 0 to 1, some hundred times; `false` stops.
/// O(n² T) time, O(n²) memory.
///
/// # Errors
/// [`MotionError`] for fewer than 2 tracks or frames, tracks that share no frames, options out of range, a
/// matrix that does not fit in memory, and a stop.
pub fn composite(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Composite, MotionError> {
    check(positions, options)?;
    pool::within(options.n_threads, keep_going, |keep_going| of_all(positions, options, keep_going))
}

fn of_all(
    positions: &Positions,
    options: &Options,
    keep_going: &mut dyn FnMut(f64) -> bool,
) -> Result<Composite, MotionError> {
    let n = positions.n_tracks();
    let mut condensed = zeros(n)?;
    let steps = Steps::of(positions);

    let all: Vec<usize> = (0..steps.len()).collect();
    let (places, movements) = (steps.blocks(Place, &all), headings::moments(&steps));
    let set = |total: &mut f64, _: usize, _: usize, sum: f64| *total = sum;
    let sums = pairs::add::<Place>(n, &places, &mut condensed, set, &mut |done| keep_going(0.6 * done))?;
    let place = Spread::of(&steps.place_moments(&sums)).ok_or(MotionError::NeverTogether)?;
    // Without a single pair that moves together, movement tells nothing apart.
    let movement = Spread::of(&movements).unwrap_or_default();
    let (k_place, k_movement) =
        (options.position_weight * place.inverse(), options.movement_weight * movement.inverse());

    let frame_means: Vec<Option<f64>> = steps
        .place_moments(&sums)
        .iter()
        .zip(&movements)
        .map(|(p, m)| Some(k_place * p.mean()? + k_movement * m.mean().unwrap_or(movement.mean)))
        .collect();
    let is_outlier = outliers(&frame_means, options.outlier_sd);
    let (out, kept): (Vec<usize>, Vec<usize>) = all.iter().partition(|&&step| is_outlier[step]);

    if !out.is_empty() {
        let left_out = steps.blocks(Place, &out);
        pairs::add::<Place>(n, &left_out, &mut condensed, |total, _, _, sum| *total -= sum, &mut |_| true)?;
    }
    let (seen, moving) = (steps.counts(&kept, Step::is_seen), steps.counts(&kept, Step::is_moving));
    let finish = |total: &mut f64, i: usize, j: usize, angles: f64| {
        let (n_seen, n_moving) = (seen.common(i, j), moving.common(i, j));
        let angle = if n_moving > 0 { angles / f64::from(n_moving) } else { movement.mean };
        // Left-out frames are subtracted: rounding may leave a hair below zero.
        *total = if n_seen > 0 {
            k_place * total.max(0.0) / f64::from(n_seen) + k_movement * angle
        } else {
            APART
        };
    };
    let headings = steps.blocks(Movement, &kept);
    pairs::add::<Movement>(n, &headings, &mut condensed, finish, &mut |done| keep_going(0.6 + 0.4 * done))?;
    let n_apart = part_the_apart(&mut condensed);
    Ok(Composite {
        n_tracks: n,
        condensed,
        position_sd_px: place.sd,
        movement_sd_rad: movement.sd,
        frame_means,
        outlier_frames: out.iter().map(|&step| u32::try_from(step).unwrap_or(u32::MAX)).collect(),
        n_apart,
    })
}

/// Marks a pair without a distance until the largest one is known.
const APART: f64 = -1.0;

fn check(positions: &Positions, options: &Options) -> Result<(), MotionError> {
    let Options { position_weight, movement_weight, outlier_sd, .. } = *options;
    let named = [
        ("the weight of position", position_weight),
        ("the weight of movement", movement_weight),
        ("the sum of the weights", if position_weight + movement_weight == 0.0 { f64::NAN } else { 1.0 }),
        ("the outlier factor", outlier_sd.unwrap_or(0.0)),
    ];
    for (name, came) in named {
        if !(came.is_finite() && came >= 0.0) {
            return Err(MotionError::Option { name, came });
        }
    }
    if positions.n_tracks() < 2 {
        return Err(MotionError::TooFewTracks(positions.n_tracks()));
    }
    if positions.n_frames() < 2 {
        return Err(MotionError::TooFewFrames(positions.n_frames()));
    }
    Ok(())
}

pub(crate) fn zeros(n_tracks: usize) -> Result<Vec<f64>, MotionError> {
    let len = n_tracks * (n_tracks - 1) / 2;
    let mut condensed = Vec::new();
    if condensed.try_reserve_exact(len).is_err() {
        return Err(MotionError::Memory { n_tracks, bytes: len * size_of::<f64>() });
    }
    condensed.resize(len, 0.0);
    Ok(condensed)
}

/// Number, sum and sum of squares of a distance over the pairs of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    n_pairs: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn mean(&self) -> Option<f64> {
        (self.n_pairs > 0.0).then(|| self.sum / self.n_pairs)
    }
}

/// Mean and standard deviation of a distance over all pairs and steps.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    mean: f64,
    sd: f64,
}

impl Spread {
    fn of(steps: &[Moments]) -> Option<Self> {
        let total = |part: fn(&Moments) -> f64| steps.iter().map(part).sum::<f64>();
        let n_pairs = total(|m| m.n_pairs);
        let (mean, square) = (total(|m| m.sum) / n_pairs, total(|m| m.squares) / n_pairs);
        // The sums carry seven digits: a spread below a thousandth of the size is rounding, not spread.
        let variance = square - mean * mean;
        let sd = if variance > 1e-6 * square { variance.sqrt() } else { 0.0 };
        (n_pairs > 0.0).then_some(Self { mean, sd })
    }

    /// 1 / sd; 0 for a distance that is the same everywhere and so tells nothing.
    fn inverse(&self) -> f64 {
        if self.sd > 0.0 { 1.0 / self.sd } else { 0.0 }
    }
}

/// Which frames lie more than `factor` standard deviations from the mean of the frame means.
fn outliers(frame_means: &[Option<f64>], factor: Option<f64>) -> Vec<bool> {
    let known: Vec<f64> = frame_means.iter().flatten().copied().collect();
    let n = known.len() as f64;
    let mean = known.iter().sum::<f64>() / n;
    let sd = (known.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n).sqrt();
    let is_out = |d: f64| factor.is_some_and(|factor| (d - mean).abs() > factor * sd);
    let out: Vec<bool> = frame_means.iter().map(|d| d.is_some_and(is_out)).collect();
    // A factor of nearly 0 would leave nothing to average over.
    if frame_means.iter().zip(&out).any(|(d, &out)| d.is_some() && !out) {
        out
    } else {
        vec![false; out.len()]
    }
}

/// Gives pairs without a distance the largest one; returns how many there are.
fn part_the_apart(condensed: &mut [f64]) -> usize {
    let largest = condensed.iter().fold(0.0_f64, |largest, &d| largest.max(d));
    let mut n_apart = 0;
    for d in condensed.iter_mut().filter(|d| **d < 0.0) {
        *d = largest;
        n_apart += 1;
    }
    n_apart
}

#[cfg(test)]
mod tests;
