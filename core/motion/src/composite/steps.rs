//! What tracks do from frame to frame, in blocks of 16 tracks, step after step.

use super::Moments;
use crate::Positions;

/// Tracks of a block.
pub(super) const LANES: usize = 16;
/// One number of 16 tracks, where a vector register can take it whole.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f32; LANES]);
pub(super) const ZERO: Lanes = Lanes([0.0; LANES]);

/// A track over one step, from a frame to the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Step {
    /// Position in the first of the two frames, pixels; `None` unless seen in both.
    place: Option<[f32; 2]>,
    /// Direction of the velocity, radians; `None` where it is zero (errata E14).
    heading: Option<f32>,
}

impl Step {
    pub(super) fn is_seen(&self) -> bool {
        self.place.is_some()
    }

    pub(super) fn is_moving(&self) -> bool {
        self.heading.is_some()
    }
}

/// The steps of all tracks: (n_steps, n_tracks), row-major.
pub(super) struct Steps {
    n_tracks: usize,
    steps: Vec<Step>,
}

/// Three numbers of 16 tracks over the steps; the last is 1 where the first two mean something, else 0.
pub(super) type Block = Vec<[Lanes; 3]>;

/// A distance between two tracks in one step.
pub(super) trait Distance: Copy {
    /// The numbers it is computed from, if they are there.
    fn parts(step: &Step) -> Option<[f32; 2]>;
    /// The distance.
    fn between(a: [f32; 2], b: [f32; 2]) -> f32;
    /// Whether the sums over the pairs of each step are wanted.
    const SUM_STEPS: bool;
}

/// Distance between positions, pixels.
#[derive(Clone, Copy)]
pub(super) struct Place;

impl Distance for Place {
    const SUM_STEPS: bool = true;

    fn parts(step: &Step) -> Option<[f32; 2]> {
        step.place
    }

    #[inline(always)]
    fn between(a: [f32; 2], b: [f32; 2]) -> f32 {
        let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
        (dx * dx + dy * dy).sqrt()
    }
}

/// Angle between velocities, radians, 0..=π (eq. 4.2).
#[derive(Clone, Copy)]
pub(super) struct Movement;

impl Distance for Movement {
    const SUM_STEPS: bool = false;

    fn parts(step: &Step) -> Option<[f32; 2]> {
        step.heading.map(|heading| [heading, 0.0])
    }

    #[inline(always)]
    fn between(a: [f32; 2], b: [f32; 2]) -> f32 {
        let turn = (a[0] - b[0]).abs();
        let other_way = std::f32::consts::TAU - turn;
        // Not f32::min: its care for NaN costs three instructions, and there is none here.
        if turn < other_way { turn } else { other_way }
    }
}

impl Steps {
    pub(super) fn of(positions: &Positions) -> Self {
        let (n_tracks, n_steps) = (positions.n_tracks(), positions.n_frames() - 1);
        let mut steps = vec![Step::default(); n_tracks * n_steps];
        for track in 0..n_tracks {
            for frame in 0..n_steps {
                let (Some(here), Some(there)) =
                    (positions.get(track, frame), positions.get(track, frame + 1))
                else {
                    continue;
                };
                let (u, v) =
                    (f64::from(there[0]) - f64::from(here[0]), f64::from(there[1]) - f64::from(here[1]));
                let moves = u != 0.0 || v != 0.0;
                let heading = moves.then(|| v.atan2(u) as f32);
                steps[frame * n_tracks + track] = Step { place: Some(here), heading };
            }
        }
        Self { n_tracks, steps }
    }

    pub(super) fn len(&self) -> usize {
        self.steps.len() / self.n_tracks
    }

    fn row(&self, step: usize) -> &[Step] {
        &self.steps[step * self.n_tracks..][..self.n_tracks]
    }

    /// The headings there are in a step.
    pub(super) fn headings(&self, step: usize) -> Vec<f64> {
        self.row(step).iter().filter_map(|s| s.heading.map(f64::from)).collect()
    }

    /// Moments of the distances between positions, given their sums over pairs.
    ///
    /// The sum of squares needs no pairs: over i < j, Σ |pi - pj|² = n Σ |p - mean|².
    pub(super) fn place_moments(&self, sums: &[f64]) -> Vec<Moments> {
        let of_step = |(step, &sum): (usize, &f64)| {
            let places: Vec<[f64; 2]> =
                self.row(step).iter().filter_map(|s| s.place.map(|p| p.map(f64::from))).collect();
            let n = places.len() as f64;
            let squares = [0, 1].map(|axis| {
                let mean = places.iter().map(|p| p[axis]).sum::<f64>() / n;
                n * places.iter().map(|p| (p[axis] - mean).powi(2)).sum::<f64>()
            });
            match places.len() {
                0 => Moments::default(),
                _ => Moments { n_pairs: n * (n - 1.0) / 2.0, sum, squares: squares[0] + squares[1] },
            }
        };
        sums.iter().enumerate().map(of_step).collect()
    }

    /// The chosen steps in blocks of 16 tracks, the last filled up with tracks that are never there.
    pub(super) fn blocks<D: Distance>(&self, _distance: D, chosen: &[usize]) -> Vec<Block> {
        let mut blocks = vec![vec![[ZERO; 3]; chosen.len()]; self.n_tracks.div_ceil(LANES)];
        for (k, &step) in chosen.iter().enumerate() {
            for (track, step) in self.row(step).iter().enumerate() {
                if let Some([a, b]) = D::parts(step) {
                    let lanes = &mut blocks[track / LANES][k];
                    let lane = track % LANES;
                    (lanes[0].0[lane], lanes[1].0[lane], lanes[2].0[lane]) = (a, b, 1.0);
                }
            }
        }
        blocks
    }

    /// Which of the chosen steps have a property, for counting those that two tracks share.
    pub(super) fn counts(&self, chosen: &[usize], has: impl Fn(&Step) -> bool) -> Counts {
        let n_words = chosen.len().div_ceil(64);
        let mut bits = vec![0_u64; self.n_tracks * n_words];
        for (k, &step) in chosen.iter().enumerate() {
            for (track, step) in self.row(step).iter().enumerate() {
                bits[track * n_words + k / 64] |= u64::from(has(step)) << (k % 64);
            }
        }
        let row = |track: usize| &bits[track * n_words..][..n_words];
        let totals =
            (0..self.n_tracks).map(|track| row(track).iter().map(|w| w.count_ones()).sum()).collect();
        Counts { n_words, n_steps: chosen.len(), bits, totals }
    }
}

/// For every track a bit a step.
pub(super) struct Counts {
    n_words: usize,
    n_steps: usize,
    bits: Vec<u64>,
    totals: Vec<u32>,
}

impl Counts {
    /// Number of steps that both tracks have.
    pub(super) fn common(&self, i: usize, j: usize) -> u32 {
        // Most tracks have every step.
        if self.totals[i] as usize == self.n_steps {
            return self.totals[j];
        }
        let row = |track: usize| &self.bits[track * self.n_words..][..self.n_words];
        row(i).iter().zip(row(j)).map(|(a, b)| (a & b).count_ones()).sum()
    }
}
