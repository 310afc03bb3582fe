//! Images as they are: every pixel's own colour, where a clip keeps colours at half size.

use std::path::Path;

use image::{DynamicImage, ImageDecoder as _};

use crate::error::MediaError;
use crate::media::FrameRef;
use crate::source::{check_size, sequence};

/// A picture in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Still {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, row by row from the top.
    pub rgb: Vec<[u8; 3]>,
}

impl Still {
    /// Whether a file has the name of an image: PNG, JPEG, TIFF or BMP.
    #[must_use]
    pub fn is_one(path: &Path) -> bool {
        sequence::is_image(path)
    }

    /// Reads an image. Transparency is ignored, and samples of 16 bits are rounded to 8.
    ///
    /// # Errors
    /// What it is read by: [`MediaError::Missing`], [`MediaError::Damaged`], [`MediaError::Unsupported`].
    pub fn read(path: &Path) -> Result<Self, MediaError> {
        let decoder = sequence::open(path)?;
        let (width, height) = decoder.dimensions();
        let (width, height) = check_size(path, u64::from(width), u64::from(height))?;
        let image = DynamicImage::from_decoder(decoder).map_err(|e| sequence::damaged(path, &e))?;
        Ok(Self { width, height, rgb: image.into_rgb8().pixels().map(|pixel| pixel.0).collect() })
    }

    /// The colours of a frame.
    #[must_use]
    pub fn of(frame: &FrameRef) -> Self {
        let planes = frame.planes();
        let (width, height) = (planes.y.width, planes.y.height);
        let rgb = (0..height).flat_map(|y| (0..width).map(move |x| planes.rgb(x, y)));
        Self { width, height, rgb: rgb.collect() }
    }

    /// Luma of every pixel (BT.601), 0 to 255; of gray pixels what they are.
    #[must_use]
    pub fn gray(&self) -> Vec<u8> {
        let luma = |[r, g, b]: [u32; 3]| ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8;
        self.rgb.iter().map(|colour| luma(colour.map(u32::from))).collect()
    }
}
