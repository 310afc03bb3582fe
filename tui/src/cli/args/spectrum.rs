//! What may be typed of spectra.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use honami_workbench::densities::Window;

use super::{frames_per_second, hertz, seconds};

#[derive(Args, Debug)]
pub(in crate::cli) struct Spectrum {
    /// Project file (.honami), a table of tracks (.csv), of sensors as `simulate` writes it (.csv), or columns of numbers
    /// with one of times (time_s, t_s, time, t) or with --fps.
    pub(in crate::cli) project: PathBuf,
    /// It is columns of numbers without times, so many rows a second: strain, tilt or whatever was recorded of what swings.
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = frames_per_second)]
    pub(in crate::cli) fps: Option<f64>,
    /// Only this track; of tracks alone.
    #[arg(long, value_name = "ID")]
    pub(in crate::cli) track: Option<u32>,
    /// How many peaks to name for each, 3 where it is not said; of tracks alone, other series have their strongest swing.
    #[arg(long, value_name = "N")]
    pub(in crate::cli) peaks: Option<usize>,
    /// Leave out what is slower: gusts move a plant more slowly than it swings.
    #[arg(long, value_name = "HZ", default_value_t = 0.0, value_parser = hertz)]
    pub(in crate::cli) above: f64,
    /// From this time on, seconds. Where what was held is let go within a record is found without it, and told.
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) from: Option<f64>,
    /// To this time, seconds.
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) to: Option<f64>,
    /// What pieces of a record are seen through for its density: hann, hamming, blackman, or rect, which is none.
    #[arg(long, value_name = "NAME", default_value = Window::default().word(), value_parser = windows())]
    pub(in crate::cli) window: Window,
    /// Length of the pieces, seconds (default: a fourth of the record); they overlap by half. Longer ones tell closer
    /// frequencies apart, more of them are surer.
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = above_none)]
    pub(in crate::cli) piece: Option<f64>,
    /// Write the densities with the band that has the truth in 95 of 100 cases: series,unit,hz,density,low,high.
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) csv: Option<PathBuf>,
    /// Draw them; of tracks all together and groups, or that of --track.
    #[arg(long, value_name = "FILE.svg")]
    pub(in crate::cli) svg: Option<PathBuf>,
}

fn windows() -> impl TypedValueParser<Value = Window> {
    PossibleValuesParser::new(Window::ALL.map(Window::word))
        .map(|word| Window::ALL.into_iter().find(|window| window.word() == word).unwrap_or_default())
}

/// A length of time.
fn above_none(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    seconds.ok_or_else(|| format!("wanted seconds, a number above 0, got {text}"))
}
