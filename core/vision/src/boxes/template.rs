//! The pixels around a point, cut out to be looked for.

use honami_model::picture::Gray;

use super::kernel::{LANES, Sums};
use super::planes::Boxes;
use crate::Point;
use crate::klt::{Reason, State};

/// The pixels around a point at every level of a picture, to be looked for in others.
#[derive(Clone, Debug, Default)]
pub struct Template {
    /// Where the point was.
    pub(super) from: Point,
    /// The pixel it was on.
    pub(super) pixel: [i32; 2],
    pub(super) state: Option<State>,
    pub(super) size: (u32, u32),
    /// Of every level, finest first, row-major; and [`LANES`] more, so that rows can be read in whole vectors.
    pixels: Vec<u8>,
    /// Of every level: first pixel in its plane.
    pub(super) corners: Vec<[i32; 2]>,
    pub(super) radius_px: u32,
    /// Standard deviation of its brightness, gray levels.
    pub(super) contrast: f32,
}

impl Template {
    /// Takes the window around a position; whether anything can be looked for, [`find`](super::find) says.
    pub fn cut(&mut self, boxes: &Boxes, from: Point) {
        let (width, height) = boxes.size();
        (self.from, self.size, self.radius_px) = (from, (width, height), boxes.radius_px());
        self.pixels.clear();
        self.corners.clear();
        self.state = if !from.iter().all(|c| c.is_finite()) {
            Some(State::Lost(Reason::NotFinite))
        } else if !holds((width, height), from) {
            Some(State::Outside)
        } else {
            None
        };
        if self.state.is_some() {
            self.from = from.map(|c| if c.is_finite() { c } else { 0.0 });
            return;
        }
        self.pixel = pixel((width, height), from);
        for (level, plane) in boxes.planes.iter().enumerate() {
            let first = boxes.planes[0].margin - self.radius_px as i32;
            // The coarse pixel nearest to the template's corner.
            let corner = self.pixel.map(|c| (c + first + (1 << level >> 1)) >> level);
            let [x, y] = corner.map(|c| c as usize);
            let side = side(self.radius_px, level);
            for row in (y..y + side).map(|y| &plane.data[y * plane.stride + x..]) {
                self.copy(row, side);
            }
            self.corners.push(corner);
        }
        self.pixels.extend_from_slice(&[0; LANES]);
        let area = area(self.radius_px, 0);
        self.contrast = (Sums::of(&self.pixels[..area]).spread(area) as f64).sqrt() as f32 / area as f32;
    }

    /// Adds a row of pixels.
    fn copy(&mut self, row: &[u8], side: usize) {
        // So many at once, whatever the side, are sooner copied.
        match row.first_chunk::<LANES>() {
            Some(row) if side <= LANES => {
                let n = self.pixels.len() + side;
                self.pixels.extend_from_slice(row);
                self.pixels.truncate(n);
            }
            _ => self.pixels.extend_from_slice(&row[..side]),
        }
    }

    /// The window itself; 0 by 0 pixels where nothing was cut.
    #[must_use]
    pub fn window(&self) -> Gray<'_> {
        let side = if self.pixels.is_empty() { 0 } else { side(self.radius_px, 0) };
        Gray::packed(&self.pixels[..side * side], side as u32, side as u32)
    }

    /// How far the point lies beside its middle pixel, pixels.
    #[must_use]
    pub fn beside(&self) -> Point {
        [self.from[0] - self.pixel[0] as f32, self.from[1] - self.pixel[1] as f32]
    }

    /// Its pixels on a level, row-major, and what is behind them.
    pub(super) fn pixels(&self, level: usize) -> &[u8] {
        let start: usize = (0..level).map(|finer| area(self.radius_px, finer)).sum();
        &self.pixels[start..]
    }
}

/// Side of a template on a level.
pub(super) fn side(radius_px: u32, level: usize) -> usize {
    (2 * radius_px as usize + 1) >> level
}

/// Pixels of a template on a level.
pub(super) fn area(radius_px: u32, level: usize) -> usize {
    side(radius_px, level).pow(2)
}

/// Whether a position lies on the pixels of a picture of this size.
pub(super) fn holds((width, height): (u32, u32), [x, y]: Point) -> bool {
    (-0.5..=width as f32 - 0.5).contains(&x) && (-0.5..=height as f32 - 0.5).contains(&y)
}

/// The pixel nearest to a position.
pub(super) fn pixel((width, height): (u32, u32), [x, y]: Point) -> [i32; 2] {
    let near = |c: f32, n: u32| (c.round() as i32).clamp(0, n as i32 - 1);
    [near(x, width), near(y, height)]
}
