//! Folders of PNG images: `frame_00000.png` and so on, gray or RGB.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use honami_model::picture::{Planes, Range};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::{Format, Movie, Unfinished};
use crate::error::MediaError;
use crate::scale;

/// A folder that is being filled with images.
///
/// Gray full-range frames come back exactly; limited range is widened, colour goes through RGB (luma within 2).
#[derive(Debug)]
pub struct PngFolder {
    format: Format,
    n_frames: u32,
    unfinished: Unfinished,
}

impl PngFolder {
    /// Starts a folder.
    ///
    /// # Errors
    /// [`MediaError::Io`] when there is something at `path` other than an empty folder, or it cannot be created.
    pub fn create(path: &Path, format: &Format) -> Result<Self, MediaError> {
        format.check()?;
        let unfinished = Unfinished::beside(path);
        let is_free = std::fs::read_dir(path).map_or(!path.exists(), |mut entries| entries.next().is_none());
        if !is_free {
            let exists = std::io::Error::new(
                std::io::ErrorKind::AlreadyExists,
                "it exists and is not an empty folder",
            );
            return Err(unfinished.fail("write images", exists));
        }
        std::fs::create_dir_all(unfinished.temporary.name()).map_err(|e| unfinished.fail("create", e))?;
        Ok(Self { format: *format, n_frames: 0, unfinished })
    }
}

/// Writes one image: `pixels`, red, green, blue, row by row from the top; all of it or nothing.
///
/// # Errors
/// [`MediaError::WrongFrame`] when there are not as many pixels, [`MediaError::Io`].
pub fn still(path: &Path, pixels: &[[u8; 3]], width: u32, height: u32) -> Result<(), MediaError> {
    let format = Format { width, height, fps: 1.0, colour: true, range: Range::Full };
    format.admit_rgb(pixels)?;
    let unfinished = Unfinished::beside(path);
    let written =
        encode(unfinished.temporary.name(), pixels.as_flattened(), &format, ExtendedColorType::Rgb8);
    written.map_err(|e| unfinished.fail("write", e))?;
    unfinished.finish()
}

impl PngFolder {
    fn add(&mut self, pixels: &[u8], kind: ExtendedColorType) -> Result<(), MediaError> {
        let path = self.unfinished.temporary.name().join(format!("frame_{:05}.png", self.n_frames));
        encode(&path, pixels, &self.format, kind).map_err(|e| self.unfinished.fail("write", e))?;
        self.n_frames += 1;
        Ok(())
    }
}

impl Movie for PngFolder {
    fn push(&mut self, frame: &Planes<'_>) -> Result<(), MediaError> {
        self.format.admit(frame)?;
        let (pixels, kind) = pixels(frame);
        self.add(&pixels, kind)
    }

    /// Every pixel as it is.
    fn push_rgb(&mut self, pixels: &[[u8; 3]]) -> Result<(), MediaError> {
        self.format.admit_rgb(pixels)?;
        self.add(pixels.as_flattened(), ExtendedColorType::Rgb8)
    }

    fn format(&self) -> &Format {
        &self.format
    }

    fn finish(self: Box<Self>) -> Result<(), MediaError> {
        self.unfinished.finish()
    }
}

fn encode(path: &Path, pixels: &[u8], format: &Format, kind: ExtendedColorType) -> std::io::Result<()> {
    let file = BufWriter::new(File::create(path)?);
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive);
    encoder.write_image(pixels, format.width, format.height, kind).map_err(std::io::Error::other)
}

fn pixels(frame: &Planes<'_>) -> (Vec<u8>, ExtendedColorType) {
    let rows = 0..frame.y.height;
    match (frame.uv, frame.range) {
        (None, Range::Full) => (rows.flat_map(|y| frame.y.row(y)).copied().collect(), ExtendedColorType::L8),
        (None, Range::Limited) => {
            (scale::rgb(frame).into_iter().map(|[gray, _, _]| gray).collect(), ExtendedColorType::L8)
        }
        (Some(_), _) => (scale::rgb(frame).into_flattened(), ExtendedColorType::Rgb8),
    }
}
