//! What to generate: size, length, wind, and the faults of the camera.

use std::fmt;
use std::str::FromStr;

/// What a scene is grown from; equal settings give equal bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Seed of every random choice.
    pub seed: u64,
    /// Width, pixels, 32 to 8192.
    pub width: u32,
    /// Height, pixels, 32 to 8192.
    pub height: u32,
    /// Frames, 2 to 20,000.
    pub n_frames: u32,
    /// Frames a second, 10 to 1000: below 10 the fastest sway (4.9 Hz) would alias. What is carried may be filmed as slowly as 0.001.
    pub fps: f64,
    /// How hard the wind blows.
    pub level: Level,
    /// Leaves, 1 to 20,000.
    pub n_leaves: u32,
    /// Standard deviation of the sensor noise, 8-bit levels, 0 to 50.
    pub noise: f64,
    /// How far the light swings about its mean, relative, 0 to 0.5.
    pub lighting: f64,
}

impl Default for Settings {
    /// The demo: 640x360, 180 frames at 25 a second, 300 leaves in calm air.
    fn default() -> Self {
        Self {
            seed: 1,
            width: 640,
            height: 360,
            n_frames: 180,
            fps: 25.0,
            level: Level::Calm,
            n_leaves: 300,
            noise: 1.2,
            lighting: 0.06,
        }
    }
}

impl Settings {
    /// The scene of the accuracy tables: 960x720, 150 frames at 25 a second, 2,600 leaves.
    #[must_use]
    pub fn benchmark(level: Level) -> Self {
        Self { width: 960, height: 720, n_frames: 150, n_leaves: 2600, level, ..Self::default() }
    }

    /// Checks every range of a scene.
    pub(crate) fn check(&self) -> Result<(), SynthError> {
        self.check_film()?;
        if !(1..=20_000).contains(&self.n_leaves) {
            return Err(SynthError::Leaves(self.n_leaves));
        }
        if !(10.0..=1000.0).contains(&self.fps) {
            return Err(SynthError::Sways(self.fps));
        }
        Ok(())
    }

    /// Checks the ranges of what films, whatever moves before it.
    pub(crate) fn check_film(&self) -> Result<(), SynthError> {
        if !(32..=8192).contains(&self.width) || !(32..=8192).contains(&self.height) {
            return Err(SynthError::Size { width: self.width, height: self.height });
        }
        if !(2..=20_000).contains(&self.n_frames) {
            return Err(SynthError::Frames(self.n_frames));
        }
        if !(1e-3..=1000.0).contains(&self.fps) {
            return Err(SynthError::Fps(self.fps));
        }
        if !(0.0..=50.0).contains(&self.noise) {
            return Err(SynthError::Noise(self.noise));
        }
        if !(0.0..=0.5).contains(&self.lighting) {
            return Err(SynthError::Lighting(self.lighting));
        }
        Ok(())
    }
}

/// How hard the wind blows.
///
/// The steps named here hold at 720 rows and 25 frames a second and scale with height and rate:
/// [`Level::step_px`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Level {
    /// Leaves move 1.5 px a frame.
    #[default]
    Calm,
    /// Leaves move 3.4 px a frame.
    Wind,
    /// Leaves move 5.8 px a frame.
    Storm,
}

impl Level {
    /// Every level, mildest first.
    pub const ALL: [Self; 3] = [Self::Calm, Self::Wind, Self::Storm];

    /// Mean displacement of a leaf from one frame to the next, pixels; this defines the level.
    ///
    /// 1.5, 3.4 and 5.8 px for pictures 720 high at 25 frames a second; it grows with the height and
    /// shrinks with the rate, so the wind is the same in any size and at any rate.
    #[must_use]
    pub fn step_px(self, height: u32, fps: f64) -> f64 {
        let step_px = match self {
            Self::Calm => 1.5,
            Self::Wind => 3.4,
            Self::Storm => 5.8,
        };
        step_px * f64::from(height) / 720.0 * 25.0 / fps
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Calm => "calm",
            Self::Wind => "wind",
            Self::Storm => "storm",
        })
    }
}

impl FromStr for Level {
    type Err = SynthError;

    fn from_str(text: &str) -> Result<Self, SynthError> {
        Self::ALL
            .into_iter()
            .find(|level| level.to_string() == text)
            .ok_or_else(|| SynthError::UnknownLevel(text.to_owned()))
    }
}

/// Why no scene came of the settings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynthError {
    /// The picture is too small or too large.
    #[error("wanted a picture of 32x32 to 8192x8192 pixels, got {width}x{height}")]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// Too few or too many frames.
    #[error("wanted 2 to 20000 frames, got {0}")]
    Frames(u32),
    /// Too few or too many leaves.
    #[error("wanted 1 to 20000 leaves, got {0}")]
    Leaves(u32),
    /// The rate is out of range or not a number.
    #[error("wanted 0.001 to 1000 frames a second, got {0}")]
    Fps(f64),
    /// The rate is too slow for what sways.
    #[error("wanted 10 to 1000 frames a second (below 10 the sways alias), got {0}")]
    Sways(f64),
    /// The noise is out of range or not a number.
    #[error("wanted sensor noise of 0 to 50 levels, got {0}")]
    Noise(f64),
    /// The swing of the light is out of range or not a number.
    #[error("wanted light that swings by 0 to 0.5 of its mean, got {0}")]
    Lighting(f64),
    /// The plant cannot move as far as the level asks.
    #[error(
        "this plant cannot sway by {wanted_px:.4} px a frame (it came to {reached_px:.4}); \
         use more frames, more leaves or another seed"
    )]
    Level {
        /// What the level asks for.
        wanted_px: f64,
        /// What the plant came to.
        reached_px: f64,
    },
    /// What is to be filmed is no plant, or not for so many frames.
    #[error(
        "wanted a moving plant: nodes after their parents, each with a radius and a place in every frame; got {n_nodes} \
         nodes and {n_frames} frames that are not"
    )]
    Moving {
        /// Nodes that it names.
        n_nodes: usize,
        /// Frames that it has.
        n_frames: usize,
    },
    /// Not the name of a level.
    #[error("wanted calm, wind or storm, got {0:?}")]
    UnknownLevel(String),
}
