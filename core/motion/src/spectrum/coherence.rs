//! How much of what several tracks do about a frequency they do together.

use std::f64::consts::TAU;

use super::{Analyser, FEWEST, detrended, hann};

/// Frequencies that are looked at for each resolution cell.
const BINS: i32 = 4;

impl Analyser {
    /// The share of the power about a frequency that is common to several tracks, 0 to 1, each given by its position in
    /// every frame of the clip; `None` where fewer than two are seen in 8 frames, or nothing moves.
    ///
    /// `c = Σ_{i≠j} Re⟨a_i, a_j⟩ / ((n - 1) Σ_i |a_i|²)`, with the Fourier components `a_i` of the x and y of n tracks
    /// (without mean and drift, under a Hann window), summed over the frequencies that cannot be told apart from `hz`;
    /// 0 where that is less. It is the semblance of Neidell and Taner (Geophysics 36 (1971) 482) without the 1/n that
    /// tracks have which share nothing. Tracks that add something of their own of power D to a common motion of power
    /// C share C / (C + D). Those that move alike but not as far share less: the tip of a branch and its middle (half as
    /// far) 0.8.
    #[must_use]
    pub fn coherence(&self, tracks: &[Vec<Option<[f32; 2]>>], hz: f64) -> Option<f64> {
        let (first, last) = (self.times_s.first()?, self.times_s.last()?);
        let step_hz = 1.0 / (last - first) / f64::from(BINS);
        let bins = (-BINS..=BINS).map(|bin| hz + f64::from(bin) * step_hz).filter(|hz| *hz > 0.0);
        let turns: Vec<Vec<(f64, f64)>> =
            bins.map(|hz| self.times_s.iter().map(|t| (TAU * hz * t).sin_cos()).collect()).collect();
        let mut sums = vec![[[0.0; 2]; 2]; turns.len()];
        let (mut n, mut own) = (0_u32, 0.0);
        for track in tracks {
            let is_seen = |frame: &usize| track[*frame].is_some_and(|at| at.iter().all(|c| c.is_finite()));
            let seen: Vec<usize> = (0..track.len().min(self.times_s.len())).filter(is_seen).collect();
            if seen.len() < FEWEST {
                continue;
            }
            n += 1;
            let times: Vec<f64> = seen.iter().map(|&frame| self.times_s[frame]).collect();
            let window = hann(&times);
            let to_amplitude = 2.0 / window.iter().sum::<f64>();
            for axis in 0..2 {
                let values = seen.iter().map(|&frame| track[frame].map_or(0.0, |at| f64::from(at[axis])));
                let mut values = detrended(&times, values.collect());
                values.iter_mut().zip(&window).for_each(|(value, weight)| *value *= weight * to_amplitude);
                for (sums, turns) in sums.iter_mut().zip(&turns) {
                    let parts = seen.iter().zip(&values).map(|(&frame, value)| (turns[frame], value));
                    let [re, im] = parts
                        .fold([0.0; 2], |[re, im], ((sin, cos), value)| [re + value * cos, im - value * sin]);
                    own += re * re + im * im;
                    sums[axis][0] += re;
                    sums[axis][1] += im;
                }
            }
        }
        let together: f64 = sums.as_flattened().as_flattened().iter().map(|part| part * part).sum();
        let pairs = (together - own) / (f64::from(n.max(2) - 1) * own);
        (n > 1 && own > 0.0).then_some(pairs.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests;
