//! A template, and the desk on which one is laid to be compared with pictures.

use serde::{Deserialize, Serialize};

use super::Params;
use super::kernel::{Cell, Kernel, LANES, Lanes, MID_GRAY, Moments, Place, Tap};
use super::live::holds;
use super::search::Ring;
use super::warp::{STILL, Warp, apply};
use crate::{Gray, Point, sample, simd};

/// What a point looked like in a key-frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Template {
    /// Brightness around the point and one pixel more: `(side + 2, side + 2)`, row-major.
    patch: Vec<f32>,
    /// Mean square of what each pixel has been off by when the rest was found, `(side, side)`.
    doubt: Vec<f32>,
    /// From the centre of the template to the point, template pixels: 0 for the newest key-frame's.
    pub(super) shift: Point,
    /// How well it correlates at worst elsewhere around its place in the key-frame, 0..1: how little a correlation says
    /// about where it is. `None` until the point is first looked for.
    pub(super) alike: Option<f32>,
}

/// Where a template was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) at: Point,
    pub(super) warp: Warp,
    /// Weighted correlation, -1..=1.
    pub(super) ncc: f32,
    /// Contrast of the picture over that of the template; 1 where either is flat.
    pub(super) contrast: f32,
}

/// Brightness of a picture over that of the template.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) gain: f32,
    pub(super) offset: f32,
}

/// One thread's memory, with one template laid out for the loops.
#[derive(Debug)]
pub(super) struct Desk<'a> {
    pub(super) params: &'a Params,
    pub(super) kernel: Kernel,
    pub(super) cells: Vec<Cell>,
    /// Weight of each pixel by its place alone.
    by_place: Vec<f32>,
    /// Weights as laid out, while those of the cells leave out what lies beyond the picture.
    whole: Option<Vec<Lanes>>,
    /// [`Template::shift`] of the template.
    shift: Point,
    pub(super) image: Vec<Lanes>,
    pub(super) taps: Vec<Tap>,
    pub(super) region: Vec<f32>,
}

impl Template {
    /// Cuts a template out of a picture.
    pub(super) fn cut(gray: &Gray<'_>, at: Point, params: &Params) -> Self {
        let mut patch = Vec::new();
        sample::patch(gray, at, params.radius_px + 1, &mut patch);
        let side = 2 * params.radius_px as usize + 1;
        Self { patch, doubt: vec![0.0; side * side], shift: [0.0; 2], alike: None }
    }

    /// Whether it has as many pixels as these parameters want.
    pub(super) fn is_of(&self, params: &Params) -> bool {
        let side = 2 * params.radius_px as usize + 1;
        self.patch.len() == (side + 2) * (side + 2) && self.doubt.len() == side * side
    }
}

impl<'a> Desk<'a> {
    pub(super) fn new(params: &'a Params, simd: simd::Level) -> Self {
        let radius = params.radius_px as i32;
        let side = 2 * radius + 1;
        let n = (side * side) as usize;
        let mut cells = vec![Cell::default(); n.div_ceil(LANES)];
        let places = (-radius..=radius).flat_map(|v| (-radius..=radius).map(move |u| (u as f32, v as f32)));
        let per_edge = 1.0 / radius.max(1) as f32;
        let by_place = places
            .enumerate()
            .map(|(k, (u, v))| {
                let cell = &mut cells[k / LANES];
                (cell.u[k % LANES], cell.v[k % LANES]) = (u * per_edge, v * per_edge);
                (-(u * u + v * v) / (2.0 * params.spread_px * params.spread_px)).exp()
            })
            .collect();
        let image = vec![[0.0; LANES]; cells.len()];
        let kernel = Kernel::of(simd);
        Self {
            params,
            kernel,
            cells,
            by_place,
            whole: None,
            shift: [0.0; 2],
            image,
            taps: Vec::new(),
            region: Vec::new(),
        }
    }

    /// Lays a template out; all that follows is about it.
    pub(super) fn lay(&mut self, template: &Template) {
        let side = 2 * self.params.radius_px as usize + 1;
        let per_doubt = 1.0 / self.params.doubt_gray.powi(2);
        self.shift = template.shift;
        self.whole = None;
        for v in 0..side {
            let row = |dy: usize| &template.patch[(v + dy) * (side + 2)..][..side + 2];
            let (above, here, below) = (row(0), row(1), row(2));
            for u in 0..side {
                let k = v * side + u;
                let (cell, lane) = (&mut self.cells[k / LANES], k % LANES);
                cell.value[lane] = here[u + 1] - MID_GRAY;
                cell.dx[lane] = (here[u + 2] - here[u]) / 2.0;
                cell.dy[lane] = (below[u + 1] - above[u + 1]) / 2.0;
                cell.weight[lane] = self.by_place[k] / (1.0 + template.doubt[k] * per_doubt);
            }
        }
    }

    /// Where the centre of the template lies when the point is here.
    pub(super) fn centre(&self, point: Point, warp: Warp) -> Point {
        let [x, y] = apply(warp, self.shift);
        [point[0] - x, point[1] - y]
    }

    /// Where the point is when the centre of the template lies here.
    pub(super) fn point(&self, centre: Point, warp: Warp) -> Point {
        let [x, y] = apply(warp, self.shift);
        [centre[0] + x, centre[1] + y]
    }

    /// Samples a picture where the template would lie.
    pub(super) fn look(&mut self, gray: &Gray<'_>, centre: Point, warp: Warp) {
        let radius = self.params.radius_px as f32;
        let place = Place { at: centre, matrix: warp.map(|c| c * radius) };
        if !place.is_inside(gray) {
            self.leave_out(gray, place);
        } else if let Some(whole) = self.whole.take() {
            self.cells.iter_mut().zip(whole).for_each(|(cell, weight)| cell.weight = weight);
        }
        self.kernel.sample(gray, place, &self.cells, &mut self.image);
    }

    /// Takes the weight off the pixels that would lie beyond the picture.
    fn leave_out(&mut self, gray: &Gray<'_>, place: Place) {
        let whole = self.whole.take().unwrap_or_else(|| self.cells.iter().map(|cell| cell.weight).collect());
        for (cell, weight) in self.cells.iter_mut().zip(&whole) {
            for lane in 0..LANES {
                let is_seen = holds(gray, place.of(cell.u[lane], cell.v[lane]));
                cell.weight[lane] = if is_seen { weight[lane] } else { 0.0 };
            }
        }
        self.whole = Some(whole);
    }

    /// Correlation with what was looked at last, and its contrast over the template's; 0 and 1 where less than half of
    /// the template was seen.
    pub(super) fn likeness(&self) -> (f32, f32) {
        let m = self.moments();
        let half = self.whole.as_ref().map_or(0.0, |whole| whole.iter().flatten().sum::<f32>() / 2.0);
        if m.w < half { (0.0, 1.0) } else { likeness(&m) }
    }

    /// How well the template on the desk, cut here and not turned since, correlates with places around at most.
    pub(super) fn alike(&mut self, gray: &Gray<'_>, at: Point) -> f32 {
        /// Whatever looks like it, its own place counts for something.
        const MOST: f32 = 0.98;
        let radius_px = self.params.radius_px;
        let peak =
            self.search(gray, at, STILL, Ring { from_px: radius_px as f32 / 2.0, reach_px: radius_px });
        peak.map_or(0.0, |(_, ncc)| ncc.clamp(0.0, MOST))
    }

    /// Sums over what was looked at last.
    pub(super) fn moments(&self) -> Moments {
        self.kernel.moments(&self.cells, &self.image)
    }

    /// Correlation with a picture when the point is here.
    pub(super) fn compare(&mut self, gray: &Gray<'_>, point: Point, warp: Warp) -> f32 {
        self.look(gray, self.centre(point, warp), warp);
        self.likeness().0
    }

    /// Learns from a place that is sure which pixels go with the point and which belong to something else.
    pub(super) fn learn(&mut self, template: &mut Template, gray: &Gray<'_>, fit: &Fit) {
        /// A pixel that is off by more has nothing more to say.
        const WORST_GRAY: f32 = 50.0;
        self.look(gray, self.centre(fit.at, fit.warp), fit.warp);
        let line = line(&self.moments());
        for (k, doubt) in template.doubt.iter_mut().enumerate() {
            let (cell, lane) = (k / LANES, k % LANES);
            let expected = (self.image[cell][lane] - line.offset) / line.gain;
            let off = (expected - self.cells[cell].value[lane]).clamp(-WORST_GRAY, WORST_GRAY);
            *doubt += self.params.learning * (off * off - *doubt);
        }
    }
}

/// Gain, within reason, and offset that bring the template closest to the picture.
pub(super) fn line(m: &Moments) -> Line {
    let w = m.w.max(1e-6);
    let (spread, common) = (m.tt - m.t * m.t / w, m.ti - m.t * m.i / w);
    let gain = (common / spread.max(1e-3)).clamp(0.5, 2.0);
    Line { gain, offset: (m.i - gain * m.t) / w }
}

/// `Σ w (t - t̄)(i - ī) / √(Σ w (t - t̄)² Σ w (i - ī)²)`, and `√(Σ w (i - ī)² / Σ w (t - t̄)²)`; 0 and 1 where either
/// is flat.
fn likeness(m: &Moments) -> (f32, f32) {
    let w = m.w.max(1e-6);
    let spread_t = m.tt - m.t * m.t / w;
    let spread_i = m.ii - m.i * m.i / w;
    let common = m.ti - m.t * m.i / w;
    let flat = FLAT_GRAY2 * w;
    if spread_t > flat && spread_i > flat {
        ((common / (spread_t * spread_i).sqrt()).clamp(-1.0, 1.0), (spread_i / spread_t).sqrt())
    } else {
        (0.0, 1.0)
    }
}

/// Variance below which a window is flat, gray levels squared: rounding to 8 bits alone makes as much.
pub(super) const FLAT_GRAY2: f32 = 0.1;
