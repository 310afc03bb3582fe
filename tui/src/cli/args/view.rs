//! What may be typed of what is shown.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::grow::Place;
use super::{Size, WithPlugin};

/// Scenes in a window, or into a file.
#[derive(Args, Debug)]
pub(in crate::cli) struct View {
    /// Project file (.honami).
    pub(in crate::cli) project: PathBuf,
    /// What to show of it (default: the skeleton).
    #[arg(value_enum)]
    pub(in crate::cli) what: Option<ViewWhat>,
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
    /// Draw into a file: .png, .mp4 (needs ffmpeg) or .y4m, else a folder of images, OUT/.
    #[arg(long, value_name = "OUT")]
    pub(in crate::cli) offscreen: PathBuf,
    /// Pixels of the picture (default: 720 high, as wide as the clip has it).
    #[arg(long, value_name = "WxH")]
    pub(in crate::cli) size: Option<Size>,
    /// What to draw, of bones, ellipsoids, leaves, trails, clip and copies (default: bones, leaves, trails, clip and copies).
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub(in crate::cli) parts: Vec<Part>,
    #[command(flatten)]
    pub(in crate::cli) shot: Shot,
}

/// How it is filmed.
#[derive(Args, Debug)]
pub(in crate::cli) struct Shot {
    /// Frames of a movie; an image shows the last of them (default: all; of an image the first).
    #[arg(long, value_name = "N", conflicts_with = "seconds", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(in crate::cli) frames: Option<u32>,
    /// Seconds of a movie.
    #[arg(long, value_name = "S")]
    pub(in crate::cli) seconds: Option<f64>,
    /// Frames per second (default: those of the clip).
    #[arg(long, value_name = "F")]
    pub(in crate::cli) fps: Option<f64>,
    /// Samples of a pixel, 1 or 4 (default: 4, for smooth edges).
    #[arg(long, value_name = "N")]
    pub(in crate::cli) samples: Option<u32>,
    /// Seen from so far round, counterclockwise from above, degrees (default: 0, the front, over the clip).
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub(in crate::cli) azimuth: Option<f64>,
    /// Seen from so far above the horizon, degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub(in crate::cli) elevation: Option<f64>,
    /// Seen from so many times as far away.
    #[arg(long, value_name = "TIMES")]
    pub(in crate::cli) distance: Option<f64>,
    /// The camera goes so far round meanwhile, degrees.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
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
