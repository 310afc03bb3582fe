//! The painter: shapes with smooth edges over a picture of RGB pixels, without a graphics card.
//!
//! Places are pixels: (0, 0) is the centre of the top-left pixel, x right, y down. How much of a pixel a shape covers is told
//! by the distance of its centre from the shape's edge, as if the edge were straight: right for lines along the axes, within
//! 0.03 for others. Where a shape goes over itself it covers once. What has no area, or a place that is no number, is not
//! drawn; nothing is drawn outside of the picture. The same calls give the same bytes everywhere.

mod stroke;
mod text;

pub use text::text_width;

/// A place, or a way, in pixels.
pub type Point = [f64; 2];

/// What is drawn with: a colour and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// Opacity, 0 to 1.
    pub alpha: f64,
}

/// A picture that is drawn on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

/// Columns and rows of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Patch {
    columns: std::ops::Range<usize>,
    rows: std::ops::Range<usize>,
}

impl Ink {
    /// All of a colour.
    #[must_use]
    pub fn opaque(rgb: [u8; 3]) -> Self {
        Self { rgb, alpha: 1.0 }
    }

    /// So much of it, 0 to 1.
    #[must_use]
    pub fn times(self, part: f64) -> Self {
        Self { alpha: self.alpha * part, ..self }
    }
}

impl Canvas {
    /// A picture of row-major pixels.
    ///
    /// # Panics
    /// When there are not `width * height` pixels.
    #[must_use]
    #[track_caller]
    pub fn new(pixels: Vec<[u8; 3]>, width: u32, height: u32) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize, "picture of {width}x{height}");
        Self { width: width as usize, pixels }
    }

    /// A picture of one colour.
    #[must_use]
    pub fn filled(rgb: [u8; 3], width: u32, height: u32) -> Self {
        Self { width: width as usize, pixels: vec![rgb; width as usize * height as usize] }
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.pixels.len().checked_div(self.width).unwrap_or_default()
    }

    /// Its pixels, row-major.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Its pixels, to be changed by others.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 3]] {
        &mut self.pixels
    }

    /// A filled disc.
    pub fn disc(&mut self, centre: Point, radius: f64, ink: Ink) {
        if radius > 0.0 {
            let reach = radius + 0.5;
            let patch = self.patch(centre, [reach; 2]);
            self.shade(&patch, ink, |at| covered(away(at, centre) - radius));
        }
    }

    /// A circle of a line so wide, half of it on each side of the radius.
    pub fn ring(&mut self, centre: Point, radius: f64, width: f64, ink: Ink) {
        if radius > 0.0 && width > 0.0 {
            let patch = self.patch(centre, [radius + width / 2.0 + 0.5; 2]);
            self.shade(&patch, ink, |at| covered_line((away(at, centre) - radius).abs(), width));
        }
    }

    /// A filled ellipse about a centre, by two half axes at right angles.
    pub fn ellipse(&mut self, centre: Point, half_axes: [Point; 2], ink: Ink) {
        if let Some(ellipse) = Ellipse::of(centre, half_axes) {
            let patch = self.patch(centre, ellipse.reach(0.5));
            self.shade(&patch, ink, |at| covered(ellipse.beyond(at)));
        }
    }

    /// The outline of an ellipse, of a line so wide.
    pub fn ellipse_outline(&mut self, centre: Point, half_axes: [Point; 2], width: f64, ink: Ink) {
        if let Some(ellipse) = Ellipse::of(centre, half_axes).filter(|_| width > 0.0) {
            let patch = self.patch(centre, ellipse.reach(width / 2.0 + 0.5));
            self.shade(&patch, ink, |at| covered_line(ellipse.beyond(at).abs(), width));
        }
    }

    /// A filled rectangle, from its upper left to its lower right corner.
    pub fn rectangle(&mut self, [left, top]: Point, [right, bottom]: Point, ink: Ink) {
        let (centre, half) =
            ([(left + right) / 2.0, (top + bottom) / 2.0], [(right - left) / 2.0, (bottom - top) / 2.0]);
        if half[0] > 0.0 && half[1] > 0.0 {
            let patch = self.patch(centre, half.map(|half| half + 0.5));
            // Each axis by itself: so much of a pixel is beside its middle.
            let along =
                |axis: usize, at: Point| covered_line((at[axis] - centre[axis]).abs(), 2.0 * half[axis]);
            self.shade(&patch, ink, |at| along(0, at) * along(1, at));
        }
    }

    /// The pixels within so far of a place, across and down.
    fn patch(&self, centre: Point, reach: Point) -> Patch {
        let side = |axis: usize, n: usize| {
            let (first, last) = ((centre[axis] - reach[axis]).ceil(), (centre[axis] + reach[axis]).floor());
            // What is no number is nowhere; casts stop at the ends of what can be counted.
            if first <= last {
                (first.max(0.0) as usize).min(n)..((last + 1.0).max(0.0) as usize).min(n)
            } else {
                0..0
            }
        };
        Patch { columns: side(0, self.width), rows: side(1, self.height()) }
    }

    /// Lays ink over the pixels of a patch, as much as each is covered.
    fn shade(&mut self, patch: &Patch, ink: Ink, covered: impl Fn(Point) -> f64) {
        for row in patch.rows.clone() {
            for column in patch.columns.clone() {
                let part = covered([column as f64, row as f64]);
                if part > 0.0 {
                    self.blend(row * self.width + column, ink.rgb, part * ink.alpha);
                }
            }
        }
    }

    /// Lays a colour over a pixel.
    fn blend(&mut self, at: usize, rgb: [u8; 3], alpha: f64) {
        let alpha = alpha.clamp(0.0, 1.0);
        let pixel = &mut self.pixels[at];
        for (under, over) in pixel.iter_mut().zip(rgb) {
            *under = (f64::from(*under) + (f64::from(over) - f64::from(*under)) * alpha).round() as u8;
        }
    }
}

/// How much of a pixel lies inside of an edge that its centre is so far beyond.
fn covered(beyond: f64) -> f64 {
    (0.5 - beyond).clamp(0.0, 1.0)
}

/// How much of a pixel a line so wide covers whose middle is so far from its centre; of thin ones all they have.
fn covered_line(away: f64, width: f64) -> f64 {
    (0.5 + width / 2.0 - away).clamp(0.0, width.min(1.0))
}

fn away(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// An ellipse, by what takes it to the circle of radius 1.
struct Ellipse {
    centre: Point,
    half_axes: [Point; 2],
    /// The half axes over the square of their lengths.
    inverse: [Point; 2],
}

impl Ellipse {
    /// `None` of what has no area.
    fn of(centre: Point, half_axes: [Point; 2]) -> Option<Self> {
        let inverse = half_axes.map(|axis| {
            let square = axis[0].powi(2) + axis[1].powi(2);
            axis.map(|v| v / square)
        });
        inverse.as_flattened().iter().all(|v| v.is_finite()).then_some(Self { centre, half_axes, inverse })
    }

    /// How far it and so much more reaches, across and down.
    fn reach(&self, more: f64) -> Point {
        [0, 1].map(|axis| self.half_axes[0][axis].hypot(self.half_axes[1][axis]) + more)
    }

    /// How far a place is beyond the edge, to first order: what is too much of 1 over how steeply that grows.
    fn beyond(&self, at: Point) -> f64 {
        let way = [at[0] - self.centre[0], at[1] - self.centre[1]];
        let on = self.inverse.map(|axis| axis[0] * way[0] + axis[1] * way[1]);
        let length = on[0].hypot(on[1]);
        if length <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let slope = [0, 1].map(|k| (on[0] * self.inverse[0][k] + on[1] * self.inverse[1][k]) / length);
        (length - 1.0) / slope[0].hypot(slope[1])
    }
}

#[cfg(test)]
mod tests;
