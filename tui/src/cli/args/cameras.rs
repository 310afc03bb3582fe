//! What may be typed of cameras.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use honami_workbench::calibrate::{Board, Held, Window};

use crate::scale::Length;

/// Cameras, from pictures of a chessboard or of targets on bars: focal length, centre, distortion, and of two how they stand.
///
/// The board is held before the camera in a dozen ways, near and far, tilted by 20 to 50 degrees each time another way, in
/// the corners of the picture too; two cameras see it at the same moments. Pictures that do not show all inner corners are
/// left out and named. With `--rig` projects are given instead of pictures, one a camera, whose tracks are the targets.
/// Numbers are those that OpenCV has, with their standard errors. docs/cameras.md has more.
#[derive(Args, Debug)]
pub(in crate::cli) struct Calibrate {
    /// Image files, or one video, folder of images or pattern; with `--rig` a project.
    #[arg(required = true)]
    pub(in crate::cli) images: Vec<PathBuf>,
    /// What the right camera took at the same moments, in the same order: the images before it are the left one's.
    #[arg(long, value_name = "IMAGES", num_args = 1..)]
    pub(in crate::cli) right: Vec<PathBuf>,
    /// Inner corners of the board: those in a row, and rows.
    #[arg(long, value_name = "CxR", default_value = "9x6")]
    pub(in crate::cli) board: Corners,
    /// Side of a square, such as 25mm (mm, cm, m); a number alone leaves open what unit lengths have.
    #[arg(long, value_name = "S", default_value = "1")]
    pub(in crate::cli) square: Length,
    /// How much around a corner is looked at: so many pixels each way, OpenCV's habit, or `squares`: what belongs to it.
    #[arg(long, value_name = "PX|squares", default_value = "11", value_parser = window)]
    pub(in crate::cli) window: Window,
    /// Numbers that are not looked for, where views tell too little: k3, tangential (p1, p2), distortion (all), centre, square (fx is fy).
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub(in crate::cli) hold: Vec<Held>,
    /// Fit so many views at most, those that differ most (default: 40 of a board, 100 of bars, evenly in time).
    #[arg(long, value_name = "N", value_parser = views)]
    pub(in crate::cli) views: Option<usize>,
    /// Targets on bars or another plane, as this file places them: the projects' tracks are what the cameras saw of them.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["board", "square", "window", "hold"])]
    pub(in crate::cli) rig: Option<PathBuf>,
    /// With `--rig`, both cameras' own numbers are known, from files that `--out` wrote: only how they stand is looked for.
    #[arg(long, value_name = "JSON", num_args = 1..=2, requires = "rig", requires = "right")]
    pub(in crate::cli) known: Vec<PathBuf>,
    /// Write the cameras, for `honami triangulate` and other programs.
    #[arg(long, value_name = "JSON")]
    pub(in crate::cli) out: Option<PathBuf>,
}

/// `CxR`: inner corners of a chessboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Corners(pub(in crate::cli) Board);

impl FromStr for Corners {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (columns, rows) = text.split_once('x')?;
            Some(Board { columns: columns.parse().ok()?, rows: rows.parse().ok()? })
        };
        parse()
            .filter(|board| (2..=100).contains(&board.columns) && (2..=100).contains(&board.rows))
            .map(Self)
            .ok_or_else(|| format!("wanted inner corners as CxR between 2x2 and 100x100, got {text}"))
    }
}

fn window(text: &str) -> Result<Window, String> {
    match (text, text.parse()) {
        ("squares", _) => Ok(Window::Squares),
        (_, Ok(radius @ 1..=100)) => Ok(Window::Radius(radius)),
        _ => Err(format!("wanted pixels, 1 to 100, or squares, got {text}")),
    }
}

fn views(text: &str) -> Result<usize, String> {
    let n = text.parse().ok().filter(|n| (1..=10_000).contains(n));
    n.ok_or_else(|| format!("wanted 1 to 10000 views, got {text}"))
}

/// What `synth` has carried before cameras.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum TargetKind {
    /// A chessboard of 9 by 6 inner corners, squares of 30 mm.
    Board,
    /// Six targets on two bars, 5 m and 1 m long.
    Bars,
}
