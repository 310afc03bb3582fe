//! Text in one upright fixed-width face, of any height: the pixels of one size, seen through a box as wide as a pixel.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, RasterizedChar, get_raster, get_raster_width};

use super::{Canvas, Ink, Point};

const WEIGHT: FontWeight = FontWeight::Bold;
const SIZE: RasterHeight = RasterHeight::Size32;
/// What stands for a letter that the face has not.
const UNKNOWN: char = '\u{fffd}';

/// How wide text is whose lines are so high, pixels.
#[must_use]
pub fn text_width(text: &str, height: f64) -> f64 {
    let letter = get_raster_width(WEIGHT, SIZE) as f64 / SIZE.val() as f64 * height;
    text.chars().count() as f64 * letter
}

impl Canvas {
    /// A line of text from its upper left corner on, so high from line to line. Letters have what is Latin; in the place of
    /// others stands �.
    pub fn text(&mut self, at: Point, height: f64, text: &str, ink: Ink) {
        // As many pixels of the face as one of the picture is wide.
        let step = SIZE.val() as f64 / height;
        if !(height >= 1.0 && step > 0.0) {
            return;
        }
        for (n, letter) in text.chars().enumerate() {
            let left = at[0] + text_width("x", height) * n as f64;
            let Some(raster) = get_raster(letter, WEIGHT, SIZE).or_else(|| get_raster(UNKNOWN, WEIGHT, SIZE))
            else {
                continue;
            };
            let size = [raster.width() as f64 / step, raster.height() as f64 / step];
            let middle = [left + size[0] / 2.0 - 0.5, at[1] + size[1] / 2.0 - 0.5];
            let patch = self.patch(middle, size.map(|side| side / 2.0 + 1.0));
            self.shade(&patch, ink, |pixel| {
                // From the middle of a pixel to the place on the face that is seen there.
                let [x, y] = [(pixel[0] + 0.5 - left) * step, (pixel[1] + 0.5 - at[1]) * step];
                seen(raster, [x, y], step.max(1.0))
            });
        }
    }
}

/// The mean of the face over a box so wide about a place.
fn seen(raster: RasterizedChar, [x, y]: Point, side: f64) -> f64 {
    let half = side / 2.0;
    let mut sum = 0.0;
    for (row, down) in cells(y - half, y + half, raster.height()) {
        for (column, across) in cells(x - half, x + half, raster.width()) {
            sum += down * across * raster.pixel(column, row).map_or(0.0, f64::from);
        }
    }
    sum / (255.0 * side * side)
}

/// The cells of a row of `n` that lie between two places, and how much of each.
fn cells(from: f64, to: f64, n: usize) -> impl Iterator<Item = (usize, f64)> {
    let (first, end) = (from.floor().max(0.0) as usize, (to.ceil().max(0.0) as usize).min(n));
    (first..end).map(move |cell| (cell, to.min(cell as f64 + 1.0) - from.max(cell as f64)))
}
