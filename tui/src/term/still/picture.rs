//! Picture files small enough for the link.

use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

use super::palette::palette;
use super::{Pixmap, Room};

/// Qualities of JPEG to be tried, the best first.
const QUALITIES: [u8; 5] = [88, 75, 60, 45, 30];
/// Colours of a palette to be tried where all colours are too many.
const COLOURS: [usize; 3] = [256, 64, 16];

/// Bytes that so many bytes are in base 64, about.
fn in_base64(n: usize) -> usize {
    n.div_ceil(3) * 4
}

/// A JPEG file of at most so many bytes in base 64, in the best quality that allows it; `None` where none does.
pub(super) fn jpeg(picture: &Pixmap, n_max: usize) -> Option<Vec<u8>> {
    QUALITIES.into_iter().find_map(|quality| {
        let mut file = Vec::new();
        let encoded = JpegEncoder::new_with_quality(&mut file, quality).encode(
            picture.pixels.as_flattened(),
            picture.width,
            picture.height,
            ExtendedColorType::Rgb8,
        );
        (encoded.is_ok() && in_base64(file.len()) <= n_max).then_some(file)
    })
}

/// A PNG file that fits, in all colours or in as many as allow it; `None` where none does.
pub(super) fn png(picture: &Pixmap, room: Room) -> Option<Vec<u8>> {
    let fits = |file: &Vec<u8>| in_base64(file.len()) <= room.in_all;
    let in_colours = |n: usize| {
        let (colours, indices) = palette(&picture.pixels, n);
        write_png(picture, Some(colours), &indices)
    };
    // In all colours a pixel of a photograph takes a byte or two: do not try in vain.
    let is_hopeless = picture.pixels.len() / 2 > room.in_all;
    let whole = || write_png(picture, None, picture.pixels.as_flattened()).filter(fits);
    let whole = if is_hopeless { None } else { whole() };
    whole.or_else(|| COLOURS.into_iter().find_map(|n| in_colours(n).filter(fits)))
}

/// A PNG file of one byte per channel, or per pixel where there is a palette.
fn write_png(picture: &Pixmap, palette: Option<Vec<[u8; 3]>>, data: &[u8]) -> Option<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, picture.width, picture.height);
    encoder.set_depth(png::BitDepth::Eight);
    match palette {
        Some(colours) => {
            encoder.set_color(png::ColorType::Indexed);
            encoder.set_palette(colours.into_flattened());
        }
        None => encoder.set_color(png::ColorType::Rgb),
    }
    encoder.set_compression(png::Compression::Balanced);
    encoder.write_header().ok()?.write_image_data(data).ok()?;
    Some(file)
}
