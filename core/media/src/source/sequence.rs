//! Image sequences: a folder, a printf pattern or a glob of PNG, JPEG, TIFF and BMP files, in natural order.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::picture::Range;
use image::{ColorType, DynamicImage, ImageDecoder, ImageReader};

use super::{Decode, Probed, Shape, Source, check_size};
use crate::convert::{narrow_image, rgb_to_planes};
use crate::error::{MediaError, Size};

mod names;

/// Rate of a sequence that nobody gave a rate, frames per second.
const DEFAULT_FPS: f64 = 25.0;

/// The images of a folder or pattern in order, or of a single image file; and what was left out.
pub(crate) fn list(path: &Path) -> Result<(Vec<PathBuf>, Vec<String>), MediaError> {
    names::list(path)
}

/// Whether the name is that of an image.
pub(crate) fn is_image(path: &Path) -> bool {
    names::is_image(path)
}

/// Whether the path can only mean a sequence.
pub(crate) fn is_pattern(path: &Path) -> bool {
    names::is_pattern(path)
}

/// Reads the heads of all images: one size, colour where any of them has it.
pub(crate) fn probe(path: &Path, files: Vec<PathBuf>, mut notes: Vec<String>) -> Result<Probed, MediaError> {
    let mut size = None;
    let mut colour = false;
    for (frame, file) in (0_u32..).zip(&files) {
        let decoder = open(file)?;
        let (width, height) = decoder.dimensions();
        let (first_width, first_height) = *size.get_or_insert((width, height));
        if (width, height) != (first_width, first_height) {
            let first = Size(first_width, first_height);
            return Err(MediaError::SizeChange {
                path: file.clone(),
                frame,
                found: Size(width, height),
                first,
            });
        }
        colour |= decoder.color_type().has_color();
    }
    let Some((width, height)) = size else {
        return Err(MediaError::NoImages { path: path.to_path_buf() });
    };
    let (width, height) = check_size(path, u64::from(width), u64::from(height))?;
    let shape = Shape { width, height, colour, range: Range::Full };
    notes.push(format!("images carry no times: {DEFAULT_FPS} fps unless a rate is given"));
    let times_s = (0..files.len()).map(|k| k as f64 / DEFAULT_FPS).collect();
    Ok(Probed { shape, times_s, notes, source: Box::new(Sequence { files: files.into(), shape }) })
}

struct Sequence {
    files: Arc<[PathBuf]>,
    shape: Shape,
}

impl Source for Sequence {
    fn recipe(&self) -> String {
        // Changes with the image crate or with the conversion in `convert`.
        "images, image 0.25, planes 1".to_owned()
    }

    fn decode(&self, wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        let (files, shape) = (Arc::clone(&self.files), self.shape);
        Ok((wanted, Box::new(Images { files, shape, next: wanted as usize })))
    }
}

struct Images {
    files: Arc<[PathBuf]>,
    shape: Shape,
    next: usize,
}

impl Decode for Images {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        let Some(file) = self.files.get(self.next) else { return Ok(false) };
        let picture = DynamicImage::from_decoder(open(file)?).map_err(|e| damaged(file, &e))?;
        let (first, found) =
            (Size(self.shape.width, self.shape.height), Size(picture.width(), picture.height()));
        if first != found {
            return Err(MediaError::SizeChange { path: file.clone(), frame: self.next as u32, found, first });
        }
        fill(picture, &self.shape, frame);
        self.next += 1;
        Ok(true)
    }
}

pub(crate) fn open(file: &Path) -> Result<impl ImageDecoder, MediaError> {
    let reader = ImageReader::open(file)
        .and_then(ImageReader::with_guessed_format)
        .map_err(|e| MediaError::io("read", file, e))?;
    let decoder = reader.into_decoder().map_err(|e| damaged(file, &e))?;
    if matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F) {
        let what = "an image of floating-point samples; save it with 8 or 16 bits".to_owned();
        return Err(MediaError::Unsupported { path: file.to_path_buf(), what });
    }
    Ok(decoder)
}

pub(crate) fn damaged(file: &Path, error: &image::ImageError) -> MediaError {
    MediaError::damaged(file, error.to_string())
}

/// Planes of a picture; transparency is ignored.
fn fill(picture: DynamicImage, shape: &Shape, frame: &mut [u8]) {
    let gray = match picture {
        DynamicImage::ImageLuma8(gray) => gray.into_raw(),
        DynamicImage::ImageLumaA8(gray) => gray.pixels().map(|p| p.0[0]).collect(),
        DynamicImage::ImageLuma16(gray) => gray.pixels().map(|p| narrow_image(p.0[0])).collect(),
        DynamicImage::ImageLumaA16(gray) => gray.pixels().map(|p| narrow_image(p.0[0])).collect(),
        DynamicImage::ImageRgb8(rgb) => return rgb_to_planes(rgb.as_raw(), shape, frame),
        DynamicImage::ImageRgb16(rgb) => {
            let narrow: Vec<u8> = rgb.as_raw().iter().map(|&v| narrow_image(v)).collect();
            return rgb_to_planes(&narrow, shape, frame);
        }
        DynamicImage::ImageRgba16(rgba) => {
            let narrow: Vec<u8> =
                rgba.pixels().flat_map(|p| [p.0[0], p.0[1], p.0[2]].map(narrow_image)).collect();
            return rgb_to_planes(&narrow, shape, frame);
        }
        other => return rgb_to_planes(other.into_rgb8().as_raw(), shape, frame),
    };
    let (y, uv) = frame.split_at_mut(shape.luma_len());
    y.copy_from_slice(&gray);
    uv.fill(128);
}
