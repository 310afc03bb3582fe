//! One thread's search for templates.

use honami_model::picture::Gray;

use super::kernel::{self, Cut, Sums};
use super::planes::{Boxes, Plane};
use super::{Match, Measure, Method, Params, peak};
use crate::klt::{Reason, State};
use crate::{Point, simd};

/// The pixels around a point at every level of a picture, to be looked for in others.
#[derive(Clone, Debug, Default)]
pub struct Template {
    /// Where the point was.
    from: Point,
    /// The pixel it was on.
    pixel: [i32; 2],
    state: Option<State>,
    size: (u32, u32),
    /// Of every level, finest first, row-major.
    pixels: Vec<u8>,
    /// Of every level: first pixel in its plane.
    corners: Vec<[i32; 2]>,
    radius_px: u32,
    /// Standard deviation of its brightness, gray levels.
    contrast: f32,
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
            let rows = plane.data[y * plane.stride + x..].chunks(plane.stride).take(side);
            rows.for_each(|row| self.pixels.extend_from_slice(&row[..side]));
            self.corners.push(corner);
        }
        let area = area(self.radius_px, 0);
        self.contrast = (Sums::of(&self.pixels[..area]).spread(area) as f64).sqrt() as f32 / area as f32;
    }
}

impl Template {
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

    /// Its pixels on a level, row-major.
    fn pixels(&self, level: usize) -> &[u8] {
        let start: usize = (0..level).map(|finer| area(self.radius_px, finer)).sum();
        &self.pixels[start..start + area(self.radius_px, level)]
    }
}

/// Side of a template on a level.
fn side(radius_px: u32, level: usize) -> usize {
    (2 * radius_px as usize + 1) >> level
}

/// Pixels of a template on a level.
fn area(radius_px: u32, level: usize) -> usize {
    side(radius_px, level).pow(2)
}

/// Whether a position lies on the pixels of a picture of this size.
fn holds((width, height): (u32, u32), [x, y]: Point) -> bool {
    (-0.5..=width as f32 - 0.5).contains(&x) && (-0.5..=height as f32 - 0.5).contains(&y)
}

/// The pixel nearest to a position.
fn pixel((width, height): (u32, u32), [x, y]: Point) -> [i32; 2] {
    let near = |c: f32, n: u32| (c.round() as i32).clamp(0, n as i32 - 1);
    [near(x, width), near(y, height)]
}

/// A displacement that was tried on a level, pixels of that level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Tried {
    cost: u32,
    at: [i32; 2],
}

/// Displacements from the first to the last, along x and along y.
#[derive(Clone, Copy, Debug)]
struct Window {
    first: [i32; 2],
    last: [i32; 2],
}

impl Window {
    /// Those within reach of a guess that end on the picture.
    fn around(guess: [i32; 2], pixel: [i32; 2], reach: u32, (width, height): (u32, u32)) -> Self {
        let reach = reach as i32;
        let (first, last) = (guess.map(|c| (c - reach).max(0)), guess.map(|c| c + reach));
        let last = [last[0].min(width as i32 - 1), last[1].min(height as i32 - 1)];
        Self {
            first: [first[0] - pixel[0], first[1] - pixel[1]],
            last: [last[0] - pixel[0], last[1] - pixel[1]],
        }
    }

    /// The same on a level, where pixels are `2^level` times larger.
    fn on(self, level: usize) -> Self {
        Self { first: self.first.map(|c| c >> level), last: self.last.map(|c| c >> level) }
    }

    fn width(&self) -> usize {
        (self.last[0] - self.first[0]) as usize + 1
    }

    fn height(&self) -> usize {
        (self.last[1] - self.first[1]) as usize + 1
    }
}

/// One thread's search: parameters and scratch memory.
pub(super) struct Search<'a> {
    simd: simd::Level,
    params: &'a Params,
    /// The template, a level each, finest first.
    cuts: Vec<Cut>,
    /// First byte of the window at every displacement.
    starts: Vec<u32>,
    costs: Vec<u32>,
    sums: Vec<Sums>,
    tried: Vec<Tried>,
    kept: Vec<Tried>,
    /// A bit for every displacement of a level that is to be tried, whole words a row.
    chosen: Vec<u64>,
}

impl<'a> Search<'a> {
    pub(super) fn new(simd: simd::Level, params: &'a Params) -> Self {
        Self {
            simd,
            params,
            cuts: Vec::new(),
            starts: Vec::new(),
            costs: Vec::new(),
            sums: Vec::new(),
            tried: Vec::new(),
            kept: Vec::new(),
            chosen: Vec::new(),
        }
    }

    /// Looks for a template around a guess.
    pub(super) fn find(&mut self, template: &Template, next: &Boxes, guess: Point) -> Match {
        let not_found = |to: Point, state: State| Match { to, state, step: [0; 2], cost: 0 };
        if let Some(state) = template.state {
            return not_found(template.from, state);
        }
        if !guess.iter().all(|c| c.is_finite()) {
            return not_found(template.from, State::Lost(Reason::NotFinite));
        }
        assert_eq!(
            (template.size, template.radius_px),
            (next.size(), next.radius_px()),
            "a template of another picture"
        );
        if template.contrast < self.params.min_contrast {
            return not_found(guess, State::Lost(Reason::Flat));
        }

        let guess = pixel(next.size(), guess);
        let window = Window::around(guess, template.pixel, self.params.search_px, next.size());
        match self.params.method {
            Method::Exhaustive => self.try_all(template, next, window, 0),
            Method::Pyramidal { levels, share } => {
                let top = (levels.clamp(1, next.n_levels()) - 1) as usize;
                self.try_all(template, next, window, top);
                for level in (0..top).rev() {
                    self.keep(share);
                    self.descend(template, next, window, level);
                }
            }
        }
        let far = |at: [i32; 2]| (0..2).map(|i| (template.pixel[i] + at[i] - guess[i]).pow(2)).sum::<i32>();
        let best = self.tried.iter().min_by_key(|t| (t.cost, far(t.at), t.at[1], t.at[0]));
        // A window is never empty.
        let Some(&best) = best else { return not_found(template.from, State::Outside) };
        self.refine(template, next, best)
    }

    /// The position to a fraction of a pixel, and whether it has left the picture.
    fn refine(&mut self, template: &Template, next: &Boxes, best: Tried) -> Match {
        let [dx, dy] = best.at;
        self.tried.clear();
        let around = (-1..2).flat_map(|y| (-1..2).map(move |x| [dx + x, dy + y]));
        self.tried.extend(around.map(|at| Tried { cost: 0, at }));
        self.measure(template, next, 0, false);
        let costs = std::array::from_fn(|i| f64::from(self.tried[i].cost));
        let more = peak::minimum(&costs).unwrap_or([0.0; 2]);
        let to = [0, 1].map(|i| template.from[i] + best.at[i] as f32 + more[i] as f32);
        let sizes = [next.size().0, next.size().1];
        // It is where it could go no farther.
        let left = |i: usize| {
            let at = template.pixel[i] + best.at[i];
            (at == 0 && best.at[i] < 0) || (at + 1 == sizes[i] as i32 && best.at[i] > 0)
        };
        let outside = left(0) || left(1) || !holds(next.size(), to);
        let state = if outside { State::Outside } else { State::Tracked };
        Match { to, state, step: best.at, cost: best.cost }
    }

    /// Tries all displacements of a window on a level.
    fn try_all(&mut self, template: &Template, next: &Boxes, window: Window, level: usize) {
        /// Smaller templates are compared many at a time.
        const SMALL: usize = 16;
        let window = window.on(level);
        let Window { first, last } = window;
        let all = (first[1]..=last[1])
            .flat_map(|y| (first[0]..=last[0]).map(move |x| Tried { cost: 0, at: [x, y] }));
        self.tried.clear();
        if self.params.measure == Measure::Ncc || side(template.radius_px, level) >= SMALL {
            // What is near the guess is often near the answer, and the less there is to beat the sooner others give up.
            self.tried.push(Tried { cost: 0, at: [0, 1].map(|i| (first[i] + last[i]) / 2) });
            self.tried.extend(all);
            self.measure(template, next, level, level == 0);
            return;
        }
        self.tried.extend(all);
        self.take(template, level);
        let plane = &next.planes[level];
        self.costs.clear();
        for y in first[1]..=last[1] {
            let start = start(template, plane, level, [first[0], y]);
            kernel::row_of_differences(
                self.simd,
                &self.cuts[level],
                plane,
                start,
                window.width(),
                &mut self.costs,
            );
        }
        self.tried.iter_mut().zip(&self.costs).for_each(|(tried, &cost)| tried.cost = cost);
    }

    /// Keeps the best share of what was tried, at least one; of equal ones the first.
    fn keep(&mut self, share: f32) {
        let n = ((self.tried.len() as f32 * share).ceil() as usize).clamp(1, self.tried.len());
        self.costs.clear();
        self.costs.extend(self.tried.iter().map(|t| t.cost));
        let (better, &mut last, _) = self.costs.select_nth_unstable(n - 1);
        let mut equal = n - better.iter().filter(|&&cost| cost < last).count();
        // Without branches: which are good enough is anybody's guess.
        self.kept.clone_from(&self.tried);
        let mut n_kept = 0;
        for &tried in &self.tried {
            let is_last = (tried.cost == last) & (equal > 0);
            equal -= usize::from(is_last);
            self.kept[n_kept] = tried;
            n_kept += usize::from((tried.cost < last) | is_last);
        }
        self.kept.truncate(n);
    }

    /// Tries the displacements on a level to which those kept on the coarser one lead.
    fn descend(&mut self, template: &Template, next: &Boxes, window: Window, level: usize) {
        let window = window.on(level);
        let words = (window.width() + 2).div_ceil(64) + 1;
        self.chosen.clear();
        self.chosen.resize((window.height() + 2) * words, 0);
        for kept in &self.kept {
            // Of the four finer pixels of a coarse one the first is where its displacement leads; the other three, and
            // those on its other sides, are as near. Bits and rows begin one before the window.
            let [x, y] = [0, 1].map(|i| (2 * kept.at[i] - window.first[i]).max(0) as usize);
            for row in y..(y + 3).min(window.height() + 2) {
                let word = &mut self.chosen[row * words + x / 64..];
                word[0] |= 7 << (x % 64);
                word[1] |= (7_u128 << (x % 64) >> 64) as u64;
            }
        }
        self.tried.clear();
        // What is near the best is often the answer, and the less there is to beat the sooner others are given up.
        let best = self.kept.iter().min_by_key(|kept| kept.cost).map_or([0; 2], |kept| kept.at);
        let within = |i: usize| (2 * best[i]).clamp(window.first[i], window.last[i]);
        self.tried.push(Tried { cost: 0, at: [within(0), within(1)] });
        for y in window.first[1]..=window.last[1] {
            let row = (y - window.first[1]) as usize + 1;
            for (i, &word) in self.chosen[row * words..][..words].iter().enumerate() {
                let mut word = word;
                while word != 0 {
                    let x = window.first[0] + (64 * i) as i32 + word.trailing_zeros() as i32 - 1;
                    word &= word - 1;
                    if (window.first[0]..=window.last[0]).contains(&x) && self.tried[0].at != [x, y] {
                        self.tried.push(Tried { cost: 0, at: [x, y] });
                    }
                }
            }
        }
        self.measure(template, next, level, level == 0);
    }

    /// Fills in the costs of displacements on a level: of all, or of those that may be the least.
    fn measure(&mut self, template: &Template, next: &Boxes, level: usize, least: bool) {
        self.take(template, level);
        let plane = &next.planes[level];
        self.starts.clear();
        self.starts.extend(self.tried.iter().map(|t| start(template, plane, level, t.at) as u32));
        match self.params.measure {
            Measure::Ssd => {
                let kernel = if least { kernel::least_differences } else { kernel::differences };
                kernel(self.simd, &self.cuts[level], plane, &self.starts, &mut self.costs);
                self.tried.iter_mut().zip(&self.costs).for_each(|(tried, &cost)| tried.cost = cost);
            }
            Measure::Ncc => {
                let n = area(template.radius_px, level);
                let sums = Sums::of(template.pixels(level));
                kernel::sums(self.simd, &self.cuts[level], plane, &self.starts, &mut self.sums);
                for (tried, window) in self.tried.iter_mut().zip(&self.sums) {
                    // A flat window is the worst there is.
                    let correlation = window.correlation(&sums, n).unwrap_or(-1.0);
                    tried.cost = ((1.0 - correlation) * f64::from(1_u32 << 31)) as u32;
                }
            }
        }
    }

    /// Makes a level of the template ready to be compared.
    fn take(&mut self, template: &Template, level: usize) {
        if self.cuts.len() <= level {
            self.cuts.resize_with(level + 1, Cut::default);
        }
        self.cuts[level].take(template.pixels(level), side(template.radius_px, level));
    }
}

/// First byte of the window at a displacement on a level.
fn start(template: &Template, plane: &Plane, level: usize, at: [i32; 2]) -> usize {
    let [x, y] = template.corners[level];
    (y + at[1]) as usize * plane.stride + (x + at[0]) as usize
}
