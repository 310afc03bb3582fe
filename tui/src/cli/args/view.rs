//! What may be typed of what is shown.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::grow::Place;
use super::plant::{Plant, Stand, Typed};
use super::{Size, WithPlugin, movie_rate};

/// Scenes in a window, or into a file.
#[derive(Args, Debug)]
pub(in crate::cli) struct View {
    // The first, since the others take what they read out of the matches.
    #[command(flatten)]
    pub(in crate::cli) typed: Typed,
    #[command(flatten)]
    pub(in crate::cli) plant: Plant,
    /// What to show of it (default: of a project its skeleton, of anything else a forest).
    #[arg(value_enum)]
    pub(in crate::cli) what: Option<ViewWhat>,
    #[command(flatten)]
    pub(in crate::cli) trees: Trees,
    #[command(flatten)]
    pub(in crate::cli) plugin: WithPlugin,
    /// Number of groups to cut the hierarchy into (default: as it is cut).
    #[arg(long, value_name = "K")]
    pub(in crate::cli) groups: Option<u32>,
    /// Where the plant leaves the ground, pixels of the picture (default: where it was placed by hand, else as it grows).
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(in crate::cli) root: Option<Place>,
    /// Stay in the plane of the picture.
    #[arg(long)]
    pub(in crate::cli) flat: bool,
    /// Leave hand work on the skeleton out.
    #[arg(long)]
    pub(in crate::cli) as_grown: bool,
    /// Draw into a file instead of a window: .png, .mp4 (needs ffmpeg) or .y4m, else a folder of images, OUT/.
    #[arg(long, value_name = "OUT")]
    pub(in crate::cli) offscreen: Option<PathBuf>,
    /// Show a forest in the terminal: keys and the mouse go round it and turn its wind.
    #[arg(long, conflicts_with = "offscreen")]
    pub(in crate::cli) terminal: bool,
    /// Pixels of the picture (default: 720 high, as wide as the clip has it; of a forest 1280x720).
    #[arg(long, value_name = "WxH")]
    pub(in crate::cli) size: Option<Size>,
    /// What to draw, of bones, ellipsoids, leaves, trails, clip and copies (default: bones, leaves, trails, clip and copies).
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub(in crate::cli) parts: Vec<Part>,
    #[command(flatten)]
    pub(in crate::cli) shot: Shot,
}

/// Copies of a plant in the wind; nobody has seen a forest of equals.
#[derive(Args, Debug)]
#[command(mut_arg("size_spread", |spread| spread.default_value("0.15")))]
pub(in crate::cli) struct Trees {
    /// What blows, as `honami simulate` takes it: wind:speed=5,towards=90, or storm+vortex.
    #[arg(long, value_name = "WIND", default_value = "wind")]
    pub(in crate::cli) wind: String,
    /// Leaves on the end of every branch, which are drawn and weigh nothing, 0 (none) to 200 (default: as a full crown has).
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=200))]
    pub(in crate::cli) leaves: Option<u32>,
    /// Length of a leaf, metres, 0.0001 to 10 (default: as a plant of that size has).
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub(in crate::cli) leaf_length: Option<f64>,
    #[command(flatten)]
    pub(in crate::cli) stand: Stand,
}

/// How it is filmed.
#[derive(Args, Debug)]
pub(in crate::cli) struct Shot {
    /// Frames of a movie; an image shows the last of them (default: all; of an image the first).
    #[arg(long, value_name = "N", conflicts_with = "seconds", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(in crate::cli) frames: Option<u32>,
    /// Seconds of a movie.
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = positive)]
    pub(in crate::cli) seconds: Option<f64>,
    /// Frames per second (default: those of the clip; of a forest 25).
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = movie_rate)]
    pub(in crate::cli) fps: Option<f64>,
    /// Samples of a pixel, 1 or 4 (default: 4, for smooth edges).
    #[arg(long, value_name = "N", value_parser = samples)]
    pub(in crate::cli) samples: Option<u32>,
    /// Seen from so far round, counterclockwise from above, degrees (default: 0, the front, over the clip).
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub(in crate::cli) azimuth: Option<f64>,
    /// Seen from so far above the horizon, degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub(in crate::cli) elevation: Option<f64>,
    /// Seen from so many times as far away.
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true, value_parser = positive)]
    pub(in crate::cli) distance: Option<f64>,
    /// The camera goes so far round meanwhile, degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub(in crate::cli) turn: Option<f64>,
    /// Draw with the adapter that has this in its name.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) adapter: Option<String>,
}

/// What is shown of a project.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ViewWhat {
    /// The skeleton of the shown groups.
    Skeleton,
    /// Copies of a plant in the wind; of a project the plant is its skeleton.
    Forest,
}

/// A part of a skeleton's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Part {
    Bones,
    Ellipsoids,
    Leaves,
    Trails,
    Clip,
    Copies,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0);
    number.ok_or_else(|| format!("wanted a number above 0, got {text}"))
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|v: &f64| v.is_finite());
    number.ok_or_else(|| format!("wanted a number, got {text}"))
}

fn samples(text: &str) -> Result<u32, String> {
    let number = text.parse().ok().filter(|n| [1, 4].contains(n));
    number.ok_or_else(|| format!("wanted 1 or 4 samples, got {text}"))
}

impl Shot {
    /// As the viewer takes them.
    pub(in crate::cli) fn words(&self) -> Vec<String> {
        let words = [
            ("frames", self.frames.map(|v| v.to_string())),
            ("seconds", self.seconds.map(|v| v.to_string())),
            ("fps", self.fps.map(|v| v.to_string())),
            ("samples", self.samples.map(|v| v.to_string())),
            ("azimuth", self.azimuth.map(|v| v.to_string())),
            ("elevation", self.elevation.map(|v| v.to_string())),
            ("distance", self.distance.map(|v| v.to_string())),
            ("turn", self.turn.map(|v| v.to_string())),
            ("adapter", self.adapter.clone()),
        ];
        words.into_iter().filter_map(|(name, value)| Some(format!("--{name}={}", value?))).collect()
    }
}
