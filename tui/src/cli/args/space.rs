//! What may be typed of two views.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use honami_workbench::calibrate::file::Unit;
use honami_workbench::space::Pairing;

use super::{Region, seconds};

/// How far the clocks of two clips are apart, with a standard error.
///
/// By a flash that both recorded (--flash): the step up of a region's brightness, to a part of a frame. Without, by movement: how the
/// tracks of both projects move on average, of those that have the same names in both if there are any. What happens at t in
/// LEFT happens at t + offset in RIGHT. docs/cameras.md has more.
#[derive(Args, Debug)]
pub(in crate::cli) struct Sync {
    /// A project file (.honami), or, with --flash, a clip.
    pub(in crate::cli) left: PathBuf,
    /// The other one.
    pub(in crate::cli) right: PathBuf,
    #[command(flatten)]
    pub(in crate::cli) flash: Flash,
    /// Look for offsets of so much at most, seconds either way; of movement.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = positive_seconds, conflicts_with = "flash")]
    pub(in crate::cli) most: f64,
}

/// Where tracks of two views are in space, metres: kept in the left project as tracks in space.
///
/// Tracks of the same name are one feature, others are found by where they are and how they move. In every frame of LEFT in which both
/// cameras see it, a feature has a place in the left camera's axes (x right, y down, z forward), with standard errors and
/// a residual; right tracks are read between their frames. docs/cameras.md has more.
#[derive(Args, Debug)]
pub(in crate::cli) struct Triangulate {
    /// The left camera's project (.honami), which keeps what is found.
    pub(in crate::cli) left: PathBuf,
    /// The right camera's project (.honami).
    pub(in crate::cli) right: PathBuf,
    /// Both cameras, as `honami calibrate LEFT… --right RIGHT… --out` writes them.
    #[arg(long, value_name = "JSON")]
    pub(in crate::cli) cameras: PathBuf,
    /// The unit of lengths in that file, where it does not say: mm, cm or m.
    #[arg(long, value_name = "UNIT")]
    pub(in crate::cli) unit: Option<Unit>,
    /// What happens at t in LEFT happens so many seconds later in RIGHT (default: both begin at the same moment).
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds, conflicts_with = "flash")]
    pub(in crate::cli) offset: Option<f64>,
    /// Its standard error, which makes places less certain.
    #[arg(long, value_name = "S", requires = "offset", value_parser = error_seconds, default_value_t = 0.0)]
    pub(in crate::cli) offset_error: f64,
    #[command(flatten)]
    pub(in crate::cli) flash: Flash,
    /// Which tracks are one: those of the same name, those that move alike, or both.
    #[arg(long = "match", value_name = "HOW", default_value = "both")]
    pub(in crate::cli) pairing: Match,
    /// Tracks farther from each other's epipolar lines are not one, pixels.
    #[arg(long, value_name = "PX", default_value_t = 3.0, value_parser = pixels)]
    pub(in crate::cli) farthest: f64,
    /// Standard deviation of one coordinate of a sample, pixels (default: what the residuals say).
    #[arg(long, value_name = "PX", value_parser = pixels)]
    pub(in crate::cli) sigma: Option<f64>,
}

/// Which tracks are one.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum Match {
    /// Those of the same name.
    Names,
    /// Those that move alike, whatever they are called.
    Motion,
    /// By name, and the rest by motion.
    Both,
}

impl From<Match> for Pairing {
    fn from(how: Match) -> Self {
        match how {
            Match::Names => Self::Names,
            Match::Motion => Self::Motion,
            Match::Both => Self::Both,
        }
    }
}

/// A lamp that both cameras recorded.
#[derive(Args, Debug)]
pub(in crate::cli) struct Flash {
    /// By a lamp that is switched on: in this region, x,y,w,h in pixels, or in the picture (`all`).
    #[arg(long, value_name = "REGION")]
    pub(in crate::cli) flash: Option<Lit>,
    /// Where the lamp is in RIGHT, if not in the same region.
    #[arg(long, value_name = "REGION", requires = "flash")]
    pub(in crate::cli) flash_right: Option<Lit>,
    /// For which part of a frame's length the shutter is open, above 0 to 1; one number, or LEFT,RIGHT.
    #[arg(long, value_name = "PART", requires = "flash", default_value = "1", value_parser = exposures)]
    pub(in crate::cli) exposure: [f64; 2],
    /// Pixels' values grow with light to the power of one over this: about 2.2 of video, 1 of cameras that count light.
    #[arg(long, value_name = "G", requires = "flash", default_value_t = 2.2, value_parser = gamma)]
    pub(in crate::cli) gamma: f64,
}

/// `x,y,w,h`, or `all`: where a lamp is seen.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct Lit(pub(in crate::cli) Option<Region>);

impl std::str::FromStr for Lit {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self(None));
        }
        text.parse().map(|region| Self(Some(region))).map_err(|why| format!("{why}; or all"))
    }
}

fn exposures(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    let is_part = |part: &f64| *part > 0.0 && *part <= 1.0;
    match numbers.as_deref() {
        Some([both]) if is_part(both) => Ok([*both; 2]),
        Some([left, right]) if is_part(left) && is_part(right) => Ok([*left, *right]),
        _ => Err(format!("wanted a part of a frame, above 0 to 1, or two with a comma between, got {text}")),
    }
}

fn gamma(text: &str) -> Result<f64, String> {
    let gamma = text.parse().ok().filter(|gamma: &f64| (0.2..=5.0).contains(gamma));
    gamma.ok_or_else(|| format!("wanted a number from 0.2 to 5, got {text}"))
}

fn pixels(text: &str) -> Result<f64, String> {
    let px = text.parse().ok().filter(|px: &f64| px.is_finite() && *px > 0.0);
    px.ok_or_else(|| format!("wanted pixels, a number above 0, got {text}"))
}

fn error_seconds(text: &str) -> Result<f64, String> {
    let s = seconds(text)?;
    if s >= 0.0 { Ok(s) } else { Err(format!("wanted seconds, 0 or more, got {text}")) }
}

fn positive_seconds(text: &str) -> Result<f64, String> {
    let s = seconds(text)?;
    if s > 0.0 { Ok(s) } else { Err(format!("wanted seconds, above 0, got {text}")) }
}
