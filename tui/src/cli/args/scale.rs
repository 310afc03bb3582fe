//! What may be typed of scale bars.

use std::path::PathBuf;

use clap::Args;

use super::grow::Place;
use crate::scale::Length;

/// How many metres a pixel is, by something in the picture whose length is known; without places, says it.
///
/// A bar measures along itself and in its own plane: hold it beside the branch that is measured, square to the line of sight.
/// docs/cameras.md has more.
#[derive(Args, Debug)]
pub(in crate::cli) struct Scale {
    /// Project file (.honami).
    pub(in crate::cli) project: PathBuf,
    /// Both ends of the bar, X,Y in pixels each.
    #[arg(value_name = "X,Y", num_args = 2, requires = "length")]
    pub(in crate::cli) ends: Vec<Place>,
    /// How long it is, such as 0.5m, 50cm or 500mm.
    #[arg(long, value_name = "L", requires = "ends")]
    pub(in crate::cli) length: Option<Length>,
    /// Standard error of its length, such as 2mm (default: it is exact).
    #[arg(long, value_name = "L", requires = "ends")]
    pub(in crate::cli) length_error: Option<Length>,
    /// Standard error of each end, pixels.
    #[arg(long, value_name = "PX", default_value_t = 0.5, allow_negative_numbers = true)]
    pub(in crate::cli) end_error: f64,
    /// The frame that it was seen in.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(in crate::cli) frame: u32,
    /// Take it away.
    #[arg(long, conflicts_with = "ends")]
    pub(in crate::cli) remove: bool,
}
