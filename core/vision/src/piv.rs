//! Particle image velocimetry: dense motion by correlating windows of two pictures through their Fourier transforms.
//!
//! M. Raffel, C. E. Willert, J. Kompenhans, "Particle Image Velocimetry"; J. Diener's thesis, 2.4.1 (the second
//! formula, here with the means taken off and with weights). A window `A` of the first picture, with weights `w` of sum 1, is
//! compared with the second picture `B` at every displacement within reach:
//!
//! `ρ(d) = Σ w(p) (A(p) - Ā) B(p + d) / √(Var_w A · Var_w B_d)`
//!
//! which costs three transforms back and forth for all `d` together (`piv/correlate.rs`). The peak is found to a
//! fraction of a pixel by a Gaussian through three values a direction, held against the next best one and against its
//! neighbours (`piv/validate.rs`). Passes go from large windows to small; each looks around where the one before says. The last ones
//! correlate there and back, which takes off what a window's weights favour.
//!
//! Transforms are sums of rounded numbers, so answers are the same bits for any number of threads, but not on processors
//! with other instructions.

mod correlate;
#[cfg(test)]
mod tests;
mod validate;

use honami_model::picture::Gray;

use crate::field::{Field, Grid};
use crate::sample;
use crate::work::{in_looks, shared, threads};
use correlate::{Correlator, Scratch};

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Radius of the smallest windows, those of the last pass, pixels; their side is `2r + 1`.
    pub radius_px: u32,
    /// Passes with larger windows, each with twice the radius of the next one.
    pub coarser: u32,
    /// Passes with the smallest windows after the first of them, each with the second picture's windows moved by a
    /// fraction of a pixel, and there and back: the rest that is left to measure becomes small, and with it the error.
    pub repeats: u32,
    /// From a node of the field to the next, pixels, at least 1.
    pub step_px: u32,
    /// What counts how much in a window.
    pub weighting: Weighting,
    /// A peak less than so many times as high as the next best is not believed.
    pub peak_ratio: f32,
    /// A vector that lies farther from the median of its neighbours, in units of their usual distance from it, is not
    /// believed.
    pub median_limit: f32,
}

/// What counts how much in a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// All pixels alike.
    Uniform,
    /// A Gaussian whose standard deviation is half the radius: finer detail, and no edges at which pixels come and go.
    Gaussian,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            radius_px: 8,
            coarser: 2,
            repeats: 1,
            step_px: 8,
            weighting: Weighting::Gaussian,
            peak_ratio: 1.2,
            median_limit: 2.0,
        }
    }
}

/// Displacements from one picture to the next, on up to `n_threads` threads; `None` where `go_on`, which is told the
/// share of the work that is done, said no.
///
/// Vectors that were not believed are replaced by their neighbours' median where most of these were; others are not
/// known, nor is anything where the smaller picture side is less than five pixels.
///
/// # Panics
/// When the pictures differ in size.
#[must_use]
#[track_caller]
pub fn measure(
    from: &Gray<'_>,
    to: &Gray<'_>,
    params: &Params,
    n_threads: usize,
    go_on: &dyn Fn(f64) -> bool,
) -> Option<Field> {
    assert_eq!((from.width, from.height), (to.width, to.height), "size of the two pictures");
    let passes = Pass::all(params, from.width, from.height);
    let work: f64 = passes.iter().map(Pass::work).sum();
    let mut done = 0.0;
    let mut last: Option<Field> = None;
    for (i, pass) in passes.iter().enumerate() {
        let share = pass.work() / work;
        let found = pass
            .run(from, to, params, last.as_ref(), n_threads, &|part| go_on((done + share * part).min(1.0)))?;
        let field = validate::validate(pass.grid, &found, params);
        last = Some(if i + 1 < passes.len() { validate::filled(field) } else { field });
        done += share;
    }
    last.or_else(|| {
        let grid = Grid::over(from.width, from.height, params.step_px);
        Some(Field::new(grid, std::iter::repeat_n(None, grid.len())))
    })
}

/// One pass over the pictures.
struct Pass {
    radius: u32,
    grid: Grid,
    /// Whether windows of the second picture are moved by fractions of a pixel.
    fractions: bool,
}

/// Smaller windows hold no pattern.
const SMALLEST_RADIUS_PX: u32 = 2;

impl Pass {
    /// From the largest windows to the smallest; none for a picture that holds no window.
    fn all(params: &Params, width: u32, height: u32) -> Vec<Self> {
        let largest = (width.min(height).max(1) - 1) / 2;
        if largest < SMALLEST_RADIUS_PX {
            return Vec::new();
        }
        let radius = |times: u32| (params.radius_px << times).clamp(SMALLEST_RADIUS_PX, largest);
        let pass = |times: u32, fractions: bool| {
            let (radius, step) = (radius(times), (params.step_px.max(1) << times).min(1 << 20));
            let inner = [width - 2 * radius, height - 2 * radius];
            let Grid { origin, step_px, nx, ny } = Grid::over(inner[0], inner[1], step);
            // Windows are cut at whole pixels, and lie on the picture.
            let grid = Grid { origin: origin.map(|c| c.floor() + radius as f32), step_px, nx, ny };
            Self { radius, grid, fractions }
        };
        let coarser = (1..=params.coarser.min(8)).rev().map(|times| pass(times, false));
        coarser.chain((0..=params.repeats).map(|i| pass(0, i > 0))).collect()
    }

    /// Roughly how much there is to do.
    fn work(&self) -> f64 {
        self.grid.len() as f64 * f64::from(self.radius).powi(2)
    }

    /// Measures at every node, around where the pass before says; `None` where `go_on` said no.
    fn run(
        &self,
        from: &Gray<'_>,
        to: &Gray<'_>,
        params: &Params,
        before: Option<&Field>,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<Vec<Option<Vector>>> {
        /// To transform a window there and back, a pixel.
        const PIXEL_NS: f64 = 100.0;
        let correlator = Correlator::new(self.radius, params.weighting);
        let nodes: Vec<_> = self.grid.nodes().collect();
        let cost_ns = PIXEL_NS * f64::from(2 * self.radius + 1).powi(2);
        in_looks(&nodes, cost_ns, &mut |share| go_on(share), |nodes| {
            let mut found = vec![None; nodes.len()];
            shared([&mut found], 1, threads(nodes.len(), cost_ns, n_threads), |first, [found]| {
                let mut scratch = correlator.scratch();
                for (found, &node) in found.iter_mut().zip(&nodes[first..]) {
                    *found = self.look(from, to, before, &correlator, &mut scratch, node);
                }
            });
            found
        })
    }

    /// Measures at one node.
    fn look<'p>(
        &self,
        from: &'p Gray<'p>,
        to: &'p Gray<'p>,
        before: Option<&Field>,
        correlator: &Correlator,
        scratch: &mut Scratch,
        node: crate::Point,
    ) -> Option<Vector> {
        let guess = before.and_then(|field| field.at(node)).unwrap_or([0.0; 2]);
        let shift = if self.fractions { guess } else { guess.map(f32::round) };
        let pixels = |picture: &'p Gray<'p>, centre: crate::Point, span: f32| {
            let [left, top] = centre.map(|c| c - span);
            move |x: usize, y: usize| sample::bilinear(picture, [left + x as f32, top + y as f32])
        };
        let span = self.radius as f32;
        let reach = span + correlator.reach() as f32;
        let there = [node[0] + shift[0], node[1] + shift[1]];
        scratch.take(correlator, pixels(from, node, span))?;
        scratch.correlate(correlator, pixels(to, there, reach));
        if self.fractions {
            scratch.turn();
            scratch.take(correlator, pixels(to, there, span))?;
            scratch.correlate(correlator, pixels(from, node, reach));
            scratch.meet();
        }
        let peak = scratch.peak(correlator)?;
        Some(Vector { to: [shift[0] + peak.at[0], shift[1] + peak.at[1]], ratio: peak.ratio })
    }
}

/// A displacement as it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Vector {
    to: [f32; 2],
    /// How many times as high its peak is as the next best.
    ratio: f32,
}
