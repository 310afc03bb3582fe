//! Where frames come from: each kind of clip decodes in display order, behind one small trait.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use honami_model::picture::{Gray, Planes, Range};

use crate::error::MediaError;

pub(crate) mod ffmpeg;
pub(crate) mod mp4;
mod rotate;
pub(crate) mod sequence;
pub(crate) mod y4m;

pub(crate) use rotate::turned;

/// Size and kind of every frame of a clip: luma, then (with colour) both chroma planes, packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) colour: bool,
    pub(crate) range: Range,
}

impl Shape {
    /// Pixels of the luma plane.
    pub(crate) fn luma_len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Pixels of one chroma plane, whether there is one or not.
    pub(crate) fn chroma_len(&self) -> usize {
        self.width.div_ceil(2) as usize * self.height.div_ceil(2) as usize
    }

    /// Bytes of a frame.
    pub(crate) fn frame_len(&self) -> usize {
        self.luma_len() + if self.colour { 2 * self.chroma_len() } else { 0 }
    }

    /// The planes in the bytes of a frame.
    pub(crate) fn planes<'a>(&self, frame: &'a [u8]) -> Planes<'a> {
        let (luma, chroma) = frame.split_at(self.luma_len());
        Planes {
            y: Gray::packed(luma, self.width, self.height),
            uv: self.colour.then(|| chroma.split_at(self.chroma_len())),
            range: self.range,
        }
    }
}

/// A clip that can be decoded any number of times, always to the same bytes.
pub(crate) trait Source: Send + Sync {
    /// What, beside the content, decides the bytes: the decoder and its version. Part of the cache's key.
    fn recipe(&self) -> String;

    /// Whether decoding can begin at any frame at the cost of reading it: such a clip needs no cache.
    fn is_raw(&self) -> bool {
        false
    }

    /// Starts decoding at the last frame at or before `wanted` where it can; says which that is.
    fn decode(&self, wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError>;
}

/// A running decoder.
pub(crate) trait Decode: Send {
    /// Writes the next frame in display order, [`Shape::frame_len`] bytes; `false` after the last one.
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError>;
}

/// What is known of a clip before its frames are decoded.
pub(crate) struct Probed {
    pub(crate) shape: Shape,
    /// Times of the frames in display order, seconds; the first is 0.
    pub(crate) times_s: Vec<f64>,
    /// What a user should know, one sentence each.
    pub(crate) notes: Vec<String>,
    pub(crate) source: Box<dyn Source>,
}

/// Times in units of `numerator / denominator` seconds, sorted, as seconds after the first.
pub(crate) fn seconds(mut ticks: Vec<i64>, numerator: u64, denominator: u64) -> Vec<f64> {
    ticks.sort_unstable();
    let first = ticks.first().copied().unwrap_or(0);
    ticks.iter().map(|t| (t - first) as f64 * numerator as f64 / denominator as f64).collect()
}

/// Refuses sizes that no camera has: a plane must be addressable and its rows must have pixels.
pub(crate) fn check_size(path: &Path, width: u64, height: u64) -> Result<(u32, u32), MediaError> {
    const LONGEST_SIDE: u64 = 32_768;
    if (1..=LONGEST_SIDE).contains(&width) && (1..=LONGEST_SIDE).contains(&height) {
        return Ok((width as u32, height as u32));
    }
    Err(MediaError::damaged(path, format!("its frames are said to be {width}x{height}")))
}

/// Runs a decoder: its panic becomes an error. What `work` was changing must not be used afterwards.
pub(crate) fn contained<T>(path: &Path, work: impl FnOnce() -> T) -> Result<T, MediaError> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let said = first_line(&*panic);
        let why = format!("the decoder breaks down on it: {said}; copy it anew or convert it with ffmpeg");
        MediaError::damaged(path, why)
    })
}

fn first_line(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref().copied());
    text.and_then(|text| text.lines().next()).unwrap_or("it does not say why")
}
