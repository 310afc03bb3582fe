//! A clip: a video or image sequence with the time of every frame.

use serde::{Deserialize, Serialize};

/// What is known of a clip without its pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clip {
    /// Width of every frame, pixels.
    pub width: u32,
    /// Height of every frame, pixels.
    pub height: u32,
    /// Presentation time of every frame, in display order.
    pub times: FrameTimes,
}

impl Clip {
    /// Number of frames T.
    #[must_use]
    pub fn n_frames(&self) -> u32 {
        self.times.len()
    }
}

/// The presentation times of a clip's frames: finite, strictly increasing seconds; never empty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct FrameTimes(Vec<f64>);

/// Why a list of numbers cannot be frame times.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimesError {
    /// A clip needs at least one frame.
    #[error("a clip needs at least one frame, this one has none")]
    Empty,
    /// A time is NaN or infinite.
    #[error("frame {frame} has no finite time")]
    NotFinite {
        /// The first such frame.
        frame: u32,
    },
    /// A time does not lie after its predecessor.
    #[error("frame {frame} is not later than the frame before it")]
    NotIncreasing {
        /// The first such frame.
        frame: u32,
    },
    /// The rate is not a positive number.
    #[error("a frame rate must be a positive number")]
    Rate,
}

impl FrameTimes {
    /// Checks and keeps the given times.
    ///
    /// # Errors
    /// [`TimesError`] when empty, not finite or not strictly increasing.
    pub fn new(times_s: Vec<f64>) -> Result<Self, TimesError> {
        if times_s.is_empty() {
            return Err(TimesError::Empty);
        }
        for (frame, &t) in (0_u32..).zip(&times_s) {
            if !t.is_finite() {
                return Err(TimesError::NotFinite { frame });
            }
            if frame > 0 && t <= times_s[frame as usize - 1] {
                return Err(TimesError::NotIncreasing { frame });
            }
        }
        Ok(Self(times_s))
    }

    /// `n` frames at a constant rate, the first at 0 s.
    ///
    /// # Errors
    /// [`TimesError`] when `n` is 0 or the rate is not a positive number.
    pub fn constant(n: u32, fps: f64) -> Result<Self, TimesError> {
        if !(fps.is_finite() && fps > 0.0) {
            return Err(TimesError::Rate);
        }
        Self::new((0..n).map(|k| f64::from(k) / fps).collect())
    }

    /// Number of frames.
    #[must_use]
    pub fn len(&self) -> u32 {
        u32::try_from(self.0.len()).unwrap_or(u32::MAX)
    }

    /// Always false: a clip has a frame.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// All times, seconds.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.0
    }

    /// Time of a frame, seconds; `None` beyond the clip.
    #[must_use]
    pub fn get(&self, frame: u32) -> Option<f64> {
        self.0.get(frame as usize).copied()
    }

    /// The usual rate: one over the median step, frames per second; `None` for a single frame.
    #[must_use]
    pub fn nominal_fps(&self) -> Option<f64> {
        let mut steps = self.steps();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).map(|step| 1.0 / step)
    }

    /// Whether some step differs from the median step by more than 5 %.
    ///
    /// Container time bases round (29.97 fps in milliseconds alternates 33 and 34): 5 % lets that pass.
    #[must_use]
    pub fn is_variable(&self) -> bool {
        self.nominal_fps().is_some_and(|fps| self.steps().iter().any(|step| (step * fps - 1.0).abs() > 0.05))
    }

    fn steps(&self) -> Vec<f64> {
        self.0.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}

impl TryFrom<Vec<f64>> for FrameTimes {
    type Error = TimesError;
    fn try_from(times_s: Vec<f64>) -> Result<Self, TimesError> {
        Self::new(times_s)
    }
}

impl From<FrameTimes> for Vec<f64> {
    fn from(times: FrameTimes) -> Self {
        times.0
    }
}

#[cfg(test)]
mod tests;
