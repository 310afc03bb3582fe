//! Tracks as a table that can be decomposed: the same frames for all, each track less its mean, gaps filled.
//!
//! Frames in which fewer than two tracks are seen are left out; what goes from frame to frame goes within runs of frames that
//! follow one another, never over what is left out. What a track lacks of the others is filled with what
//! the components tell: gaps start at the track's mean, then they and the mean are made anew from the strongest
//! components, weaker ones from round to round down to the noise, until the gaps change no more (iterated SVD with a
//! falling threshold: Troyanskaya et al., Bioinformatics 17, 2001; Mazumder, Hastie and Tibshirani, J. Mach. Learn. Res.
//! 11, 2010). So a track that starts late goes on as what it moved with; one that is seen once stands still.

use std::ops::Range;

use super::Bod;
use crate::{MotionError, Positions};

/// Rounds of filling after which it has to do.
const ROUNDS: usize = 40;
/// Gaps are filled when they change by less than this share of what moves.
const SETTLED: f64 = 1e-3;
/// Components of this share of the strongest count at first, then weaker ones by this factor a round, down to this share.
/// Gaps that are wrong still make components of their own, which must not be taken for motion.
const COARSEST: f64 = 0.7;
const FINER: f64 = 0.75;
const FINEST: f64 = 1e-3;

/// Positions of N tracks in the T frames that they are compared in.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    n_tracks: usize,
    /// Frame of each column among those of the positions, ascending.
    frames: Vec<usize>,
    /// Its columns, in order, in runs without a seam.
    runs: Vec<Range<usize>>,
    /// x of every track less its mean, then y: 2 N series of T numbers, pixels.
    series: Vec<f64>,
    /// Mean of every series, pixels.
    means: Vec<f64>,
    /// Which tracks are seen in any of the frames.
    is_known: Vec<bool>,
    n_filled: usize,
    /// The most by which a position is off because f32 has so few digits, pixels.
    rounding_px: f64,
}

impl Table {
    /// Lays tracks out, and fills gaps. `keep_going` is told the share of the work that is done; `false` stops.
    ///
    /// # Errors
    /// [`MotionError`] for fewer than 2 tracks or frames, when no two tracks are seen together in two frames, and a stop.
    pub fn new(positions: &Positions, keep_going: &mut dyn FnMut(f64) -> bool) -> Result<Self, MotionError> {
        let n_tracks = positions.n_tracks();
        if n_tracks < 2 {
            return Err(MotionError::TooFewTracks(n_tracks));
        }
        if positions.n_frames() < 2 {
            return Err(MotionError::TooFewFrames(positions.n_frames()));
        }
        let is_shared = |frame: &usize| {
            (0..n_tracks).filter(|&track| positions.get(track, *frame).is_some()).nth(1).is_some()
        };
        let frames: Vec<usize> = (0..positions.n_frames()).filter(is_shared).collect();
        if frames.len() < 2 {
            return Err(MotionError::NeverTogether);
        }
        let n_frames = frames.len();
        let mut series = vec![0.0; 2 * n_tracks * n_frames];
        let mut means = vec![0.0; 2 * n_tracks];
        let mut gaps = Vec::new();
        let mut largest = 0.0_f64;
        for track in 0..n_tracks {
            let seen = frames.iter().map(|&frame| positions.get(track, frame));
            let places: Vec<Option<[f64; 2]>> = seen.map(|at| at.map(|at| at.map(f64::from))).collect();
            gaps.extend((0..n_frames).filter(|&k| places[k].is_none()).map(|k| (track, k)));
            largest = places.iter().flatten().flatten().fold(largest, |most, v| most.max(v.abs()));
            for axis in 0..2 {
                let row = axis * n_tracks + track;
                let values: Vec<Option<f64>> = places.iter().map(|at| at.map(|at| at[axis])).collect();
                means[row] = centred(&values, &mut series[row * n_frames..(row + 1) * n_frames]);
            }
        }
        let is_known = |track| frames.iter().any(|&frame| positions.get(track, frame).is_some());
        let is_known = (0..n_tracks).map(is_known).collect();
        let rounding_px = largest * f64::from(f32::EPSILON) / 2.0;
        let runs = runs(&frames);
        let mut table =
            Self { n_tracks, frames, runs, series, means, is_known, n_filled: gaps.len(), rounding_px };
        table.fill(&gaps, keep_going)?;
        Ok(table)
    }

    /// The same tracks with other series, which are no pixels any more.
    pub(super) fn with(&self, series: Vec<f64>) -> Self {
        Self { series, rounding_px: 0.0, ..self.clone() }
    }

    fn fill(
        &mut self,
        gaps: &[(usize, usize)],
        keep_going: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(), MotionError> {
        let n_frames = self.n_frames();
        let mut coarse = COARSEST;
        for round in 0..if gaps.is_empty() { 0 } else { ROUNDS } {
            if !keep_going(round as f64 / ROUNDS as f64) {
                return Err(MotionError::Stopped);
            }
            let bod = Bod::new(self);
            let largest = bod.singular.first().copied().unwrap_or(0.0);
            let least = bod.edge.max(coarse * largest);
            let n = bod.singular.iter().take(bod.len()).take_while(|s| **s > least).count();
            if n == 0 {
                break;
            }
            let told = bod.sum(n, |k| 1.0 - (least / bod.singular[k]).powi(2));
            let mut change = 0.0;
            for &(track, frame) in gaps {
                for row in [track, self.n_tracks + track] {
                    let at = row * n_frames + frame;
                    change += (told[at] - self.series[at]).powi(2);
                    self.series[at] = told[at];
                }
            }
            for (row, mean) in self.series.chunks_mut(n_frames).zip(&mut self.means) {
                let off = row.iter().sum::<f64>() / n_frames as f64;
                row.iter_mut().for_each(|v| *v -= off);
                *mean += off;
            }
            let moved: f64 = self.series.iter().map(|v| v * v).sum();
            let is_fine = least <= bod.edge || coarse <= FINEST;
            if is_fine && change <= SETTLED.powi(2) * moved {
                break;
            }
            coarse = (coarse * FINER).max(FINEST);
        }
        if keep_going(1.0) { Ok(()) } else { Err(MotionError::Stopped) }
    }

    /// Number of tracks N.
    #[must_use]
    pub fn n_tracks(&self) -> usize {
        self.n_tracks
    }

    /// Number of frames T.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.frames.len()
    }

    /// The frames of the positions that are compared, ascending.
    #[must_use]
    pub fn frames(&self) -> &[usize] {
        &self.frames
    }

    /// The columns in runs: within each all frames are as far apart as most are.
    pub(crate) fn runs(&self) -> &[Range<usize>] {
        &self.runs
    }

    /// From column to column within runs, what a series goes: one number less than it has, for every run; always one at least.
    pub(crate) fn steps(&self, series: &[f64]) -> Vec<f64> {
        let of_run = |run: &Range<usize>| series[run.clone()].windows(2).map(|pair| pair[1] - pair[0]);
        self.runs.iter().flat_map(of_run).collect()
    }

    /// Number of positions that were not seen in these frames, and are filled.
    #[must_use]
    pub fn n_filled(&self) -> usize {
        self.n_filled
    }

    /// The most by which a position is off because f32 has so few digits, pixels.
    pub(crate) fn rounding_px(&self) -> f64 {
        self.rounding_px
    }

    /// Mean position of a track over the frames, pixels; `None` where it is never seen.
    #[must_use]
    pub fn place(&self, track: usize) -> Option<[f64; 2]> {
        self.is_known[track].then(|| [self.means[track], self.means[self.n_tracks + track]])
    }

    /// Displacements from the mean, pixels: x of every track, then y, T numbers each.
    #[must_use]
    pub fn series(&self) -> &[f64] {
        &self.series
    }

    /// Positions with these displacements where others were seen; frames that are not in the table stay as they are.
    pub(super) fn positions(&self, displacements: &[f64], seen: &Positions) -> Positions {
        let mut positions = seen.clone();
        let n_frames = self.n_frames();
        for (track, (column, &frame)) in
            (0..self.n_tracks).flat_map(|track| self.frames.iter().enumerate().map(move |at| (track, at)))
        {
            if seen.get(track, frame).is_some() {
                let at = |row: usize| {
                    let moved = displacements.get(row * n_frames + column).copied().unwrap_or(0.0);
                    (self.means[row] + moved) as f32
                };
                positions.set(track, frame, [at(track), at(self.n_tracks + track)]);
            }
        }
        positions
    }
}

/// Frames in runs that end where the next frame is not as far as most are from the one before them: where the clip is seen
/// in every tenth frame, these follow one another.
fn runs(frames: &[usize]) -> Vec<Range<usize>> {
    let apart: Vec<usize> = frames.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = apart.clone();
    sorted.sort_unstable();
    let usual = sorted[sorted.len() / 2];
    let seams = apart.iter().zip(1..).filter(|(apart, _)| **apart != usual).map(|(_, column)| column);
    let mut runs = Vec::new();
    let mut first = 0;
    for end in seams.chain([frames.len()]) {
        runs.push(first..end);
        first = end;
    }
    runs
}

/// Writes values less their mean, 0 where there is none, and returns the mean.
fn centred(values: &[Option<f64>], out: &mut [f64]) -> f64 {
    // Less the first one, so that what stands still is exactly 0.
    let Some(first) = values.iter().flatten().next() else { return 0.0 };
    let n = values.iter().flatten().count() as f64;
    let mean = values.iter().flatten().map(|v| v - first).sum::<f64>() / n;
    for (out, value) in out.iter_mut().zip(values) {
        *out = value.map_or(0.0, |v| v - first - mean);
    }
    first + mean
}
