//! What may be typed of mattes.

use std::path::PathBuf;

use clap::Args;
use honami_workbench::matting::{Options, PartsWish};

/// How much of every pixel is plant, from a few strokes on a picture; and the mask of what is worth tracking.
///
/// Closed-form matting (Levin et al. 2008), at the picture's own size: `--picture` writes the frame of a clip; paint white on
/// the plant and black on what lies behind it, with a hard brush; `--scribbles` reads that. The mask that `--mask` writes
/// leaves out the boundary of the plant, the background that it encloses and its trunk (Zeng 2015): `honami track --mask`
/// and `honami grow --envelope` read it. Of a project's frame the matte is kept: features are looked for inside it from
/// then on, until `--remove`; without marks the kept mattes are listed, or written. docs/mattes.md has more.
#[derive(Args, Debug)]
pub(in crate::cli) struct Matte {
    /// An image (its own colours), a clip, or a project file (.honami).
    pub(in crate::cli) picture_of: PathBuf,
    /// A copy of the picture, black painted on background and white on the plant (PNG, TIFF or BMP).
    #[arg(long, value_name = "IMAGE", conflicts_with = "trimap")]
    pub(in crate::cli) scribbles: Option<PathBuf>,
    /// A gray picture: black is background, white the plant, gray between unknown.
    #[arg(long, value_name = "IMAGE")]
    pub(in crate::cli) trimap: Option<PathBuf>,
    /// Write the opacities: 0 is background, 255 the plant.
    #[arg(long, value_name = "PNG")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Write the mask that detectors read: white where features may be.
    #[arg(long, value_name = "PNG")]
    pub(in crate::cli) mask: Option<PathBuf>,
    /// Write the parts over the picture: kept cyan, boundary red, inner background yellow, trunk brown, outside dark.
    #[arg(long, value_name = "PNG")]
    pub(in crate::cli) parts: Option<PathBuf>,
    /// Write the picture itself, to paint on.
    #[arg(long, value_name = "PNG")]
    pub(in crate::cli) picture: Option<PathBuf>,
    /// Which frame of a clip (default: 0; all with --remove).
    #[arg(long, value_name = "N")]
    pub(in crate::cli) frame: Option<u32>,
    /// Carry the kept matte of --frame on by the motion of the tracks, to every N-th frame after it, and keep these, too.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with_all = ["scribbles", "trimap", "out", "mask", "parts", "picture", "remove"])]
    pub(in crate::cli) every: Option<u32>,
    /// Keep no matte of a project any longer, or not that of --frame.
    #[arg(long, conflicts_with_all = ["scribbles", "trimap", "out", "mask", "parts", "picture"])]
    pub(in crate::cli) remove: bool,
    /// Plant no farther than this from background is boundary, pixels.
    #[arg(long, value_name = "PX", default_value_t = PartsWish::default().boundary_px,
        value_parser = clap::value_parser!(u32).range(..=1000))]
    pub(in crate::cli) band: u32,
    /// Pieces of plant or background of fewer pixels count as what is about them.
    #[arg(long, value_name = "PIXELS", default_value_t = PartsWish::default().speck)]
    pub(in crate::cli) speck: usize,
    /// Keep the trunk, from the foot to where the plant is twice as wide.
    #[arg(long)]
    pub(in crate::cli) with_trunk: bool,
    /// How much opacities that do not change with colour are preferred, 1e-9 to 1.
    #[arg(long, value_name = "E", default_value_t = Options::default().epsilon, allow_negative_numbers = true)]
    pub(in crate::cli) epsilon: f64,
    /// How much a mark weighs, 1e-4 to 1e6.
    #[arg(long, value_name = "L", default_value_t = Options::default().lambda, allow_negative_numbers = true)]
    pub(in crate::cli) lambda: f64,
}
