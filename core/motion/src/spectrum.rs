//! How strongly tracks sway at which frequency, from the times of their frames.
//!
//! A track's displacement loses its mean and its straight-line drift; x and y are analysed apart and their
//! powers added, so the direction of the sway does not matter. Power at f is the squared amplitude of a sway
//! at f, px²: a sine of amplitude A along any line has power A² at its peak.
//!
//! Evenly timed samples without gaps go through a Hann window and an FFT, padded fourfold; all others through
//! the generalised Lomb-Scargle periodogram (Zechmeister and Kürster, Astron. Astrophys. 496 (2009) 577, eq.
//! 4-12) with the same window as weights. Both are taken at the same frequencies, so tracks can be averaged.

mod coherence;
mod lomb;
mod peaks;

use std::sync::Arc;

use honami_model::clip::FrameTimes;
use realfft::{RealFftPlanner, RealToComplex};

pub use peaks::{Peak, aliases_hz, may_be_alias};

/// Fewer samples than this say nothing of frequencies.
const FEWEST: usize = 8;
/// Grid points for each resolution cell 1 / duration.
const PADDING: usize = 4;

/// An unevenly timed clip may always last this many frames, whatever its own number: 2^22 grid points.
const LONGEST: usize = (1 << 22) / PADDING;

/// Why there is no spectrum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// The clip or the track is too short.
    #[error("a spectrum needs at least {FEWEST} frames in which the track is seen, came {came}")]
    TooFew {
        /// Number of frames there were.
        came: usize,
    },
    /// Frames lie so far apart that the grid of frequencies would not fit in memory.
    #[error(
        "{gap_s:.1} s between frames {frame} and {} are too long for a spectrum of frames usually {step_s:.4} s \
         apart; split the clip there, or give it a frame rate if its times are wrong",
        frame + 1
    )]
    Gap {
        /// Frame before the largest gap.
        frame: usize,
        /// Length of the largest gap, seconds.
        gap_s: f64,
        /// Median distance of two frames, seconds.
        step_s: f64,
    },
}

/// Power over frequency of one track or the median of several.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Distance between two frequencies; the first is 0.
    pub step_hz: f64,
    /// Squared amplitude at each frequency, px², finite, 0 or more.
    pub power_px2: Vec<f64>,
    /// Two sways closer than this cannot be told apart: 1 / duration of what was seen.
    pub resolution_hz: f64,
    /// Half the frame rate: nothing above can be seen.
    pub nyquist_hz: f64,
    /// Frame rate, if the frames are evenly timed: then a sway above [`Spectrum::nyquist_hz`] shows up below.
    pub even_fps: Option<f64>,
    /// Number of tracks it is the median of.
    pub n_tracks: usize,
}

/// Takes spectra of the tracks of one clip.
#[derive(Clone)]
pub struct Analyser {
    times_s: Vec<f64>,
    /// Frame rate: the mean one where frames are evenly timed, else one over the median step.
    fps: f64,
    is_even: bool,
    fft: Arc<dyn RealToComplex<f64>>,
}

impl std::fmt::Debug for Analyser {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Analyser")
            .field("fps", &self.fps)
            .field("is_even", &self.is_even)
            .finish_non_exhaustive()
    }
}

impl Analyser {
    /// Prepares for the tracks of a clip with these frame times.
    ///
    /// # Errors
    /// [`SpectrumError`] for a clip of fewer than 8 frames, and for gaps that make it last more than 2^20 of its
    /// usual steps and more than two for each frame.
    pub fn new(times: &FrameTimes) -> Result<Self, SpectrumError> {
        let times_s = times.as_slice().to_vec();
        let n = times_s.len();
        let (true, Some(nominal)) = (n >= FEWEST, times.nominal_fps()) else {
            return Err(SpectrumError::TooFew { came: n });
        };
        let is_even = !times.is_variable();
        // Containers round times: the mean rate is right where the median step may be off by a percent.
        let fps = if is_even { (n - 1) as f64 / (times_s[n - 1] - times_s[0]) } else { nominal };
        let span_frames = (times_s[n - 1] - times_s[0]) * fps;
        if span_frames > LONGEST.max(2 * n) as f64 {
            return Err(largest_gap(&times_s, 1.0 / fps));
        }
        let len = (PADDING * n.max(span_frames.ceil() as usize)).next_power_of_two();
        Ok(Self { times_s, fps, is_even, fft: RealFftPlanner::new().plan_fft_forward(len) })
    }

    /// Spectrum of one track: its position in every frame of the clip, `None` where it was not seen.
    ///
    /// # Errors
    /// [`SpectrumError`] when it is seen in fewer than 8 frames.
    pub fn track(&self, positions: &[Option<[f32; 2]>]) -> Result<Spectrum, SpectrumError> {
        let seen: Vec<usize> = (0..positions.len().min(self.times_s.len()))
            .filter(|&frame| positions[frame].is_some_and(|p| p.iter().all(|c| c.is_finite())))
            .collect();
        if seen.len() < FEWEST {
            return Err(SpectrumError::TooFew { came: seen.len() });
        }
        let times: Vec<f64> = seen.iter().map(|&frame| self.times_s[frame]).collect();
        let duration_s = times[times.len() - 1] - times[0];
        let has_gaps = seen[seen.len() - 1] - seen[0] + 1 > seen.len();
        let window = hann(&times);
        let mut power_px2 = vec![0.0; self.fft.len() / 2 + 1];
        for axis in 0..2 {
            let values = seen.iter().map(|&frame| positions[frame].map_or(0.0, |p| f64::from(p[axis])));
            let values = detrended(&times, values.collect());
            let power = if self.is_even && !has_gaps {
                self.by_fft(&values, &window)
            } else {
                lomb::power(&times, &values, &window, self.step_hz(), power_px2.len())
            };
            power_px2.iter_mut().zip(power).for_each(|(sum, p)| *sum += p);
        }
        Ok(Spectrum {
            step_hz: self.step_hz(),
            power_px2,
            resolution_hz: 1.0 / duration_s,
            nyquist_hz: self.fps / 2.0,
            even_fps: self.is_even.then_some(self.fps),
            n_tracks: 1,
        })
    }

    fn step_hz(&self) -> f64 {
        self.fps / self.fft.len() as f64
    }

    fn by_fft(&self, values: &[f64], window: &[f64]) -> Vec<f64> {
        let mut input = self.fft.make_input_vec();
        let mut output = self.fft.make_output_vec();
        input.iter_mut().zip(values).zip(window).for_each(|((x, value), weight)| *x = value * weight);
        // Only wrong lengths fail, and these are the transform's own.
        let done = self.fft.process(&mut input, &mut output);
        debug_assert!(done.is_ok(), "{done:?}");
        let to_amplitude = 2.0 / window.iter().sum::<f64>();
        output.iter().map(|bin| bin.norm_sqr() * to_amplitude * to_amplitude).collect()
    }
}

impl Spectrum {
    /// Median power of several tracks of one clip at each frequency; `None` for none.
    ///
    /// The median, not the mean: a few tracks that have slipped off their leaf jump by more than all sway
    /// together, and would hide it.
    ///
    /// # Panics
    /// When the spectra are not of one [`Analyser`].
    #[must_use]
    #[track_caller]
    pub fn median(spectra: &[Self]) -> Option<Self> {
        let mut median = Self { n_tracks: 0, ..spectra.first()?.clone() };
        for spectrum in spectra {
            assert_eq!(median.power_px2.len(), spectrum.power_px2.len(), "spectra of one clip");
            median.resolution_hz = median.resolution_hz.max(spectrum.resolution_hz);
            median.n_tracks += spectrum.n_tracks;
        }
        let mut powers = vec![0.0; spectra.len()];
        for (bin, power) in median.power_px2.iter_mut().enumerate() {
            powers.iter_mut().zip(spectra).for_each(|(power, spectrum)| *power = spectrum.power_px2[bin]);
            powers.sort_by(f64::total_cmp);
            *power = f64::midpoint(powers[(powers.len() - 1) / 2], powers[powers.len() / 2]);
        }
        Some(median)
    }

    /// The sways that stand out, strongest first, at most `n_max`.
    ///
    /// `over_floor` is how many times the noise around it a peak's power must be. Of single tracks of pure
    /// noise one in ten has a peak 6 times its floor, one in a hundred 10 times; the median of many is quieter,
    /// and foliage, whose peaks are broad, stands out less: 3 suits one track of it, 1.5 the median of many. Peaks below one and a half resolution cells are taken
    /// for drift, peaks below 3 % of the strongest amplitude for its leakage.
    #[must_use]
    pub fn peaks(&self, n_max: usize, over_floor: f64) -> Vec<Peak> {
        peaks::find(self, n_max, over_floor)
    }

    /// How broad a peak is: the distance of the frequencies below and above it at which power is half of that at it, Hz. That of
    /// a steady sway is 1.44 / duration, as the window has it; a clip says nothing of what is narrower.
    #[must_use]
    pub fn width_hz(&self, peak: &Peak) -> f64 {
        peaks::width_hz(self, peak)
    }
}

fn largest_gap(times_s: &[f64], step_s: f64) -> SpectrumError {
    let gaps = times_s.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
    let (frame, gap_s) = gaps.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
    SpectrumError::Gap { frame, gap_s, step_s }
}

/// Hann window over irregular times, 0 half a mean step before the first and after the last.
fn hann(times_s: &[f64]) -> Vec<f64> {
    let n = times_s.len() as f64;
    let (start, duration) = (times_s[0], times_s[times_s.len() - 1] - times_s[0]);
    let half_step = duration / (n - 1.0) / 2.0;
    let phase = |t: f64| std::f64::consts::PI * (t - start + half_step) / (duration + 2.0 * half_step);
    times_s.iter().map(|&t| phase(t).sin().powi(2)).collect()
}

/// The values less the straight line that fits them best; times are irregular, or one alone.
#[must_use]
pub fn detrended(times_s: &[f64], mut values: Vec<f64>) -> Vec<f64> {
    let n = values.len() as f64;
    let (mean_t, mean) = (times_s.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let spread: f64 = times_s.iter().map(|t| (t - mean_t).powi(2)).sum();
    let along: f64 = times_s.iter().zip(&values).map(|(t, v)| (t - mean_t) * (v - mean)).sum();
    let slope = if spread > 0.0 { along / spread } else { 0.0 };
    values.iter_mut().zip(times_s).for_each(|(v, t)| *v -= mean + slope * (t - mean_t));
    values
}

#[cfg(test)]
mod tests;
