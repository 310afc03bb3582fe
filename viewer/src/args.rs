//! What the viewer is asked for.

use std::path::PathBuf;

use clap::Parser;

use honami_media::write::RATES;

use crate::skeleton::Part;
use crate::target::Size;

/// Frames per second where nothing else is said or known.
pub const FPS: f64 = 25.0;

/// Shows a scene that `honami view` wrote.
#[derive(Clone, Debug, Parser)]
#[command(version, after_help = "Exit codes: 0 done, 1 failed, 2 called wrongly.")]
pub struct Args {
    /// The scene.
    #[arg(required_unless_present = "adapters")]
    pub scene: Option<PathBuf>,
    /// Draw into a file instead of a window: .png, .mp4 (needs ffmpeg) or .y4m, else a folder of PNG images.
    #[arg(long, value_name = "OUT")]
    pub offscreen: Option<PathBuf>,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: [u32; 2],
    /// So many frames; of a PNG image the last of them.
    #[arg(long, value_name = "N", conflicts_with = "seconds", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: Option<u32>,
    /// So many seconds.
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Frames per second [default: those of the clip, or 25].
    #[arg(long, value_name = "F", value_parser = rate)]
    pub fps: Option<f64>,
    /// Samples of a pixel: 4 for smooth edges.
    #[arg(long, value_name = "1|4", default_value = "4", value_parser = samples)]
    pub samples: u32,
    /// Seen from so far round, counterclockwise from above, 0 from the front.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub azimuth: Option<f32>,
    /// Seen from so far above the horizon.
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = finite)]
    pub elevation: Option<f32>,
    /// Seen from so many times as far away as the scene says.
    #[arg(long, value_name = "TIMES", default_value = "1", value_parser = positive)]
    pub distance: f64,
    /// The camera goes so far round while it is filmed.
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, value_parser = finite)]
    pub turn: f32,
    /// What to draw of a skeleton [default: all but ellipsoids].
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub parts: Vec<Part>,
    /// Draw with the adapter that has this in its name.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Move a forest on the processor's cores though there is a card, as without one.
    #[arg(long)]
    pub cpu: bool,
    /// Do what comes by standard input, a command a line, and tell on standard output what is done in the window; the end of
    /// the input ends the window.
    #[arg(long, conflicts_with = "offscreen")]
    pub control: bool,
    /// End where standard input ends, and tell of every frame that is written, and why there are no more.
    #[arg(long, hide = true, conflicts_with = "control")]
    pub attended: bool,
    /// List what could draw, the best first, which is what does.
    #[arg(long)]
    pub adapters: bool,
    /// That list as JSON.
    #[arg(long, requires = "adapters")]
    pub json: bool,
}

impl Args {
    /// The size of a picture.
    #[must_use]
    pub fn size(&self) -> Size {
        let [width, height] = self.size;
        Size { width, height, samples: self.samples }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides
        .filter(|sides: &[u32; 2]| sides.iter().all(|side| (1..=16384).contains(side)))
        .ok_or_else(|| "a size is WIDTHxHEIGHT, 1 to 16384 pixels each, as 1280x720".to_owned())
}

fn samples(text: &str) -> Result<u32, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(4),
        _ => Err("1 or 4 samples".to_owned()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0);
    number.ok_or_else(|| "a number above 0 is wanted".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|fps| RATES.contains(fps));
    number.ok_or_else(|| format!("{} to {} frames per second are wanted", RATES.start(), RATES.end()))
}

fn finite(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|v: &f32| v.is_finite());
    number.ok_or_else(|| "a number is wanted".to_owned())
}
