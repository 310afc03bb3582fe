//! One thread's search for templates.

use super::kernel::{self, Cut, Memory, Sums};
use super::least::Least;
use super::planes::{Boxes, Plane};
use super::template::{Template, area, holds, pixel, side};
use super::{Match, Measure, Method, Params, peak};
use crate::klt::{Reason, State};
use crate::{Point, simd};

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

    /// The displacement of this index, row by row.
    fn at(&self, i: usize) -> [i32; 2] {
        [self.first[0] + (i % self.width()) as i32, self.first[1] + (i / self.width()) as i32]
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
    memory: Memory,
    /// Displacements that were tried; empty where all of the window were, row by row.
    places: Vec<[i32; 2]>,
    /// Those that the next finer level starts from.
    kept: Vec<[i32; 2]>,
    /// Whether a displacement of the window was tried, row by row.
    seen: Vec<bool>,
    least: Least,
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
            memory: Memory::default(),
            places: Vec::new(),
            kept: Vec::new(),
            seen: Vec::new(),
            least: Least::default(),
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
        let (top, share) = match self.params.method {
            Method::Exhaustive => (0, 1.0),
            Method::Pyramidal { levels, share } => ((levels.clamp(1, next.n_levels()) - 1) as usize, share),
        };
        self.take(template, top);
        self.try_all(template, next, window.on(top), top);
        for level in (0..top).rev() {
            self.keep(window.on(level + 1), share);
            self.descend(window.on(level));
            self.measure(template, next, level, level == 0);
        }
        let far = |at: [i32; 2]| (0..2).map(|i| (template.pixel[i] + at[i] - guess[i]).pow(2)).sum::<i32>();
        // A window is never empty.
        let cost = self.costs.iter().fold(u32::MAX, |least, &cost| least.min(cost));
        let equal = (0..self.costs.len()).filter(|&i| self.costs[i] == cost).map(|i| self.place(window, i));
        let Some(at) = equal.min_by_key(|&at| (far(at), at[1], at[0])) else {
            return not_found(template.from, State::Outside);
        };
        self.refine(template, next, at, cost)
    }

    /// The displacement that a cost belongs to.
    fn place(&self, window: Window, i: usize) -> [i32; 2] {
        self.places.get(i).copied().unwrap_or_else(|| window.at(i))
    }

    /// The position to a fraction of a pixel, and whether it has left the picture.
    fn refine(&mut self, template: &Template, next: &Boxes, best: [i32; 2], cost: u32) -> Match {
        let [dx, dy] = best;
        self.places.clear();
        self.places.extend((-1..2).flat_map(|y| (-1..2).map(move |x| [dx + x, dy + y])));
        self.measure(template, next, 0, false);
        let costs = std::array::from_fn(|i| f64::from(self.costs[i]));
        // Nothing costs less than nothing: what is the same in every pixel has moved by whole ones.
        let more = peak::minimum(&costs).filter(|_| cost > 0).unwrap_or([0.0; 2]);
        let to = [0, 1].map(|i| template.from[i] + best[i] as f32 + more[i] as f32);
        let sizes = [next.size().0, next.size().1];
        // It is where it could go no farther.
        let left = |i: usize| {
            let at = template.pixel[i] + best[i];
            (at == 0 && best[i] < 0) || (at + 1 == sizes[i] as i32 && best[i] > 0)
        };
        let outside = left(0) || left(1) || !holds(next.size(), to);
        let state = if outside { State::Outside } else { State::Tracked };
        Match { to, state, step: best, cost }
    }

    /// Tries all displacements of a window of a level.
    fn try_all(&mut self, template: &Template, next: &Boxes, window: Window, level: usize) {
        /// Smaller templates are compared many at a time; larger ones are given up too soon for that to pay.
        const SMALL: usize = 32;
        self.places.clear();
        if self.params.measure == Measure::Ssd && side(template.radius_px, level) < SMALL {
            let plane = &next.planes[level];
            let block = (start(template, plane, level, window.first), [window.width(), window.height()]);
            let (cut, memory) = (&mut self.cuts[level], &mut self.memory);
            kernel::all_differences(self.simd, cut, plane, block, memory, &mut self.costs);
            return;
        }
        let Window { first, last } = window;
        self.places.extend((first[1]..=last[1]).flat_map(|y| (first[0]..=last[0]).map(move |x| [x, y])));
        self.measure(template, next, level, level == 0);
    }

    /// Keeps the best share of what was tried in a window, at least one; of equal ones the first.
    fn keep(&mut self, window: Window, share: f32) {
        let n = ((self.costs.len() as f32 * share).ceil() as usize).clamp(1, self.costs.len());
        let place = |i| self.places.get(i).copied().unwrap_or_else(|| window.at(i));
        self.kept.clear();
        self.kept.extend(self.least.find(self.simd, &self.costs, n).map(place));
    }

    /// Chooses the displacements of a window to which those kept on the coarser level lead.
    ///
    /// Of the four finer pixels of a coarse one the first is where its displacement leads; the other three, and those
    /// on its other sides, are as near.
    fn descend(&mut self, window: Window) {
        self.seen.clear();
        self.seen.resize(window.width() * window.height(), false);
        self.places.clear();
        self.places.resize(9 * self.kept.len(), [0; 2]);
        let mut n = 0;
        for kept in &self.kept {
            let [columns, rows] = [0, 1].map(|i| {
                let (first, last) = (window.first[i], window.last[i]);
                (2 * kept[i] - 1).max(first)..=(2 * kept[i] + 1).min(last)
            });
            for y in rows {
                for x in columns.clone() {
                    let i = (y - window.first[1]) as usize * window.width() + (x - window.first[0]) as usize;
                    self.places[n] = [x, y];
                    n += usize::from(!std::mem::replace(&mut self.seen[i], true));
                }
            }
        }
        self.places.truncate(n);
    }

    /// Fills in the costs of displacements on a level: of all, or of those that may be the least.
    fn measure(&mut self, template: &Template, next: &Boxes, level: usize, least: bool) {
        let plane = &next.planes[level];
        self.starts.clear();
        self.starts.extend(self.places.iter().map(|&at| start(template, plane, level, at) as u32));
        match self.params.measure {
            Measure::Ssd => {
                let kernel = if least { kernel::least_differences } else { kernel::differences };
                kernel(self.simd, &self.cuts[level], plane, &self.starts, &mut self.costs);
            }
            Measure::Ncc => {
                let n = area(template.radius_px, level);
                let sums = Sums::of(&template.pixels(level)[..n]);
                kernel::sums(self.simd, &self.cuts[level], plane, &self.starts, &mut self.sums);
                // A flat window is the worst there is.
                let correlation = |window: &Sums| window.correlation(&sums, n).unwrap_or(-1.0);
                let cost = |window: &Sums| ((1.0 - correlation(window)) * f64::from(1_u32 << 31)) as u32;
                self.costs.clear();
                self.costs.extend(self.sums.iter().map(cost));
            }
        }
    }

    /// Makes the template ready to be compared, down from a level.
    fn take(&mut self, template: &Template, top: usize) {
        if self.cuts.len() <= top {
            self.cuts.resize_with(top + 1, Cut::default);
        }
        for (level, cut) in self.cuts.iter_mut().enumerate().take(top + 1) {
            cut.take(template.pixels(level), side(template.radius_px, level));
        }
    }
}

/// First byte of the window at a displacement on a level.
fn start(template: &Template, plane: &Plane, level: usize, at: [i32; 2]) -> usize {
    let [x, y] = template.corners[level];
    (y + at[1]) as usize * plane.stride + (x + at[0]) as usize
}
