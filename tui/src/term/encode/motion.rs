//! The picture at a price: which cells to paint, and how, so that a budget of bytes takes most error off the screen.
//!
//! Every cell holds two pixels. It can be painted in several ways: with one or both colours of the pen as they are, with
//! the half blocks `▀` and `▄` (whose colours are swapped), as one flat colour. Each way leaves an error and costs bytes
//! that depend on what was painted before. The choice for all cells is the path of least *error + λ · bytes* through
//! them, found by following the few best pens from cell to cell (a trellis with pruned survivors, as in
//! rate-distortion optimized coding: Ortega and Ramchandran 1998, IEEE Signal Processing Magazine 15(6)). The price λ of
//! a byte is the one at which the budget is spent.

use super::{distance, pen};

/// So many pens are followed.
const SURVIVORS: usize = 2;
/// The price is looked for in so many trials at most.
const TRIALS: usize = 2;
/// A trial that spends between these parts of the budget will do; what is too much is cut off.
const WILL_DO: (f32, f32) = (0.85, 1.03);
/// Part of the budget that the next frame's price is meant to spend.
const AIM: f32 = 0.98;
/// The price follows the bytes with this power.
const POWER: f32 = 0.75;
/// Least price of a byte while the picture moves, squared error: less would buy what the next frame paints over.
const PRICE_MIN: f32 = 2.0;
/// Largest change of the price at once.
const PRICE_STEP: f32 = 8.0;
/// A price below this is none.
const PRICE_NONE: f32 = 1e-2;
/// No cell costs more, bytes; a price at which the worst cell is worth so many is not too high.
const DEAREST: usize = 60;
/// A cell whose error is not worth so many bytes is passed by.
const CHEAPEST: usize = 5;
/// Cells worth looking at: one for so many bytes.
const BYTES_PER_CELL: usize = 4;
/// Wide enough that it is far from everything.
const FAR: u32 = 1 << 20;

pub(super) type Rgb = [u8; 3];

/// A cell of the picture whose pixels on screen are not the wanted ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) index: usize,
    /// The wanted pixels.
    pub(super) above: Rgb,
    pub(super) below: Rgb,
    /// How much its error matters.
    pub(super) weight: f32,
    /// Squared error on screen, weighted.
    pub(super) error: f32,
}

/// A glyph of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Glyph {
    Upper,
    Lower,
    Blank,
}

/// A cell to be painted: a colour that is `None` stays as the pen has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paint {
    pub(super) index: usize,
    pub(super) glyph: Glyph,
    pub(super) fg: Option<Rgb>,
    pub(super) bg: Option<Rgb>,
}

/// A way through the cells so far.
#[derive(Clone, Copy, Debug)]
struct Survivor {
    /// Error and price so far, relative to painting nothing.
    sum: f64,
    n_bytes: usize,
    fg: Option<Rgb>,
    bg: Option<Rgb>,
    /// The cell after the one painted last; `None` when the cursor may be anywhere.
    cursor: Option<usize>,
    /// The last paint, as a place in the list of all paints.
    last: Option<u32>,
    /// The paint of this cell, not yet in the list.
    paint: Option<Paint>,
}

/// Chooses paints; remembers what a byte was worth.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// While the picture rests, and while it moves.
    prices: [f32; 2],
    /// The cell with which the walk begins: the first that the last budget did not reach.
    first: usize,
    /// Room for sorting errors.
    errors: Vec<f32>,
    /// Paints of all survivors, each with its predecessor.
    paints: Vec<(Paint, Option<u32>)>,
    /// Those of the best way, in order.
    path: Vec<Paint>,
}

impl Motion {
    /// The paints that take most error off the screen for `budget` bytes, or some more.
    ///
    /// `fg` and `bg` are the pen's colours, where it has 24-bit ones. While the picture moves, cells may be painted with
    /// colours near the wanted; otherwise only exactly. What the budget does not reach, [`Motion::cut`] is told.
    pub(super) fn choose(
        &mut self,
        spots: &mut Vec<Spot>,
        colours: (Option<Rgb>, Option<Rgb>),
        columns: usize,
        budget: usize,
        moving: bool,
    ) -> &[Paint] {
        let n_looked_at = (budget / BYTES_PER_CELL).max(1);
        if spots.len() > n_looked_at {
            self.errors.clear();
            self.errors.extend(spots.iter().map(|spot| spot.error));
            let (_, &mut least, _) =
                self.errors.select_nth_unstable_by(n_looked_at - 1, |a, b| b.total_cmp(a));
            spots.retain(|spot| spot.error >= least);
        }
        let first = spots.partition_point(|spot| spot.index < self.first);
        spots.rotate_left(first);
        let worst = spots.iter().map(|spot| spot.error).fold(0.0, f32::max);
        let least = if moving { PRICE_MIN } else { 0.0 };
        // At the highest price the worst cell is painted: there is always progress.
        let most = (worst / DEAREST as f32).max(least);
        let all_fits = spots.len() * DEAREST <= budget;
        let mut price = if all_fits { least } else { self.prices[usize::from(moving)].clamp(least, most) };
        let mut last = None;
        for _ in 0..TRIALS {
            let walk = Walk { spots, columns, price, moving };
            let best = walk.run(colours, &mut self.paints);
            last = best.last;
            let part = best.n_bytes as f32 / budget.max(1) as f32;
            let tried = price;
            let change = (part / AIM).powf(POWER).clamp(1.0 / PRICE_STEP, PRICE_STEP);
            price = (price.max(PRICE_NONE) * change).min(most);
            // Nothing is cheaper than free: with all of it in the budget the price ends there.
            price = if price <= PRICE_NONE { least } else { price.max(least) };
            if (part >= WILL_DO.0 || tried <= least) && part <= WILL_DO.1 {
                break;
            }
        }
        self.prices[usize::from(moving)] = price;
        self.follow(last);
        &self.path
    }

    /// Says that this cell of the path was not painted any more.
    pub(super) fn cut(&mut self, index: usize) {
        self.first = index;
    }

    /// Lists the paints up to one of them, in order.
    fn follow(&mut self, mut last: Option<u32>) {
        self.path.clear();
        while let Some(at) = last {
            let (paint, before) = self.paints[at as usize];
            self.path.push(paint);
            last = before;
        }
        self.path.reverse();
    }
}

/// What a colour of the pen becomes.
#[derive(Clone, Copy)]
enum Dip {
    Keep,
    Above,
    Below,
    Flat,
}

const N_WAYS: usize = 10;
/// The ways of painting a cell: the glyph, and what becomes of the foreground and of the background.
const WAYS: [(Glyph, Dip, Dip); N_WAYS] = [
    (Glyph::Upper, Dip::Keep, Dip::Keep),
    (Glyph::Lower, Dip::Keep, Dip::Keep),
    (Glyph::Blank, Dip::Keep, Dip::Keep),
    (Glyph::Upper, Dip::Above, Dip::Keep),
    (Glyph::Lower, Dip::Keep, Dip::Above),
    (Glyph::Upper, Dip::Keep, Dip::Below),
    (Glyph::Lower, Dip::Below, Dip::Keep),
    (Glyph::Blank, Dip::Keep, Dip::Flat),
    (Glyph::Upper, Dip::Above, Dip::Below),
    (Glyph::Lower, Dip::Below, Dip::Above),
];

/// A walk through all spots at one price.
struct Walk<'a> {
    spots: &'a [Spot],
    columns: usize,
    price: f32,
    moving: bool,
}

impl Walk<'_> {
    /// The best way through all spots; the paints of all survivors are listed.
    fn run(&self, (fg, bg): (Option<Rgb>, Option<Rgb>), paints: &mut Vec<(Paint, Option<u32>)>) -> Survivor {
        paints.clear();
        let start = Survivor { sum: 0.0, n_bytes: 0, fg, bg, cursor: None, last: None, paint: None };
        let mut survivors = Best::of(start);
        let worth = self.price * CHEAPEST as f32;
        for spot in self.spots {
            // Hardly ever is it painted for so little.
            if spot.error <= worth {
                continue;
            }
            let inks = Inks::of(spot, self.price, self.moving);
            let mut next = survivors;
            for survivor in survivors.all() {
                self.ways(spot, &inks, survivor, &mut next);
            }
            for survivor in &mut next.ranked[..next.n] {
                if let Some(paint) = survivor.paint.take() {
                    paints.push((paint, survivor.last));
                    survivor.last = Some(paints.len() as u32 - 1);
                }
            }
            survivors = next;
        }
        survivors.ranked[0]
    }

    /// Adds to `next` what becomes of a survivor that paints this spot.
    fn ways(&self, spot: &Spot, inks: &Inks, from: &Survivor, next: &mut Best) {
        let far = |pen: Option<Rgb>, wanted| pen.map_or(FAR, |pen| distance(pen, wanted));
        let (fa, fb) = (far(from.fg, spot.above), far(from.fg, spot.below));
        let (ba, bb) = (far(from.bg, spot.above), far(from.bg, spot.below));
        let (above, below, flat) = (inks.above.error, inks.below.error, inks.flat.error);
        // In the order of `WAYS`.
        let errors = [
            fa + bb,
            fb + ba,
            ba + bb,
            above + bb,
            above + fb,
            fa + below,
            ba + below,
            flat,
            above + below,
            above + below,
        ];
        let go = pen::move_bytes(from.cursor, spot.index, self.columns);
        let base = go as f32 * self.price - spot.error;
        let mut limit = next.limit(from);
        let mut costs = [0.0; N_WAYS];
        for ((cost, &error), &price) in costs.iter_mut().zip(&errors).zip(&inks.prices) {
            *cost = base + error as f32 * spot.weight + price;
        }
        for (way, &cost) in costs.iter().enumerate() {
            if cost >= limit || errors[way] > 0 && !self.moving {
                continue;
            }
            let (glyph, fg, bg) = WAYS[way];
            let (fg, bg) = (inks.dip(fg), inks.dip(bg));
            next.admit(Survivor {
                sum: from.sum + f64::from(cost),
                n_bytes: from.n_bytes + inks.n_bytes[way] as usize + go,
                fg: fg.or(from.fg),
                bg: bg.or(from.bg),
                cursor: Some(spot.index + 1),
                last: from.last,
                paint: Some(Paint { index: spot.index, glyph, fg, bg }),
            });
            limit = next.limit(from);
        }
    }
}

/// The best ways so far, no two of which leave the same pen in the same place.
#[derive(Clone, Copy)]
struct Best {
    ranked: [Survivor; SURVIVORS],
    n: usize,
}

impl Best {
    fn of(only: Survivor) -> Self {
        Self { ranked: [only; SURVIVORS], n: 1 }
    }

    fn all(&self) -> &[Survivor] {
        &self.ranked[..self.n]
    }

    /// Nothing that adds this much to a survivor is admitted any more.
    fn limit(&self, from: &Survivor) -> f32 {
        if self.n < SURVIVORS { f32::INFINITY } else { (self.ranked[SURVIVORS - 1].sum - from.sum) as f32 }
    }

    fn admit(&mut self, new: Survivor) {
        let is_same = |s: &Survivor| (s.fg, s.bg, s.cursor) == (new.fg, new.bg, new.cursor);
        // Whose place is taken, if all that are better may stay.
        let mut place = match self.all().iter().position(is_same) {
            Some(same) if self.ranked[same].sum <= new.sum => return,
            Some(same) => same,
            None => {
                self.n = (self.n + 1).min(SURVIVORS);
                self.n - 1
            }
        };
        while place > 0 && self.ranked[place - 1].sum > new.sum {
            self.ranked[place] = self.ranked[place - 1];
            place -= 1;
        }
        self.ranked[place] = new;
    }
}

/// A colour as it would be sent.
struct Ink {
    colour: Rgb,
    /// What it leaves: of one pixel, or for a flat cell of both.
    error: u32,
}

/// The colours that a spot may be painted with, and what the ways of painting it cost without the way there, bytes.
struct Inks {
    above: Ink,
    below: Ink,
    flat: Ink,
    n_bytes: [u32; N_WAYS],
    /// The bytes at the walk's price.
    prices: [f32; N_WAYS],
}

impl Inks {
    fn of(spot: &Spot, price: f32, moving: bool) -> Self {
        let limit = if moving { price / spot.weight } else { 0.0 };
        let (above, below) = (spot.above, spot.below);
        let mean = |k: usize| ((u16::from(above[k]) + u16::from(below[k])).div_ceil(2)) as u8;
        let flat = shorter([mean(0), mean(1), mean(2)], limit / 2.0);
        let error = distance(flat, above) + distance(flat, below);
        let flat = Ink { colour: flat, error };
        let [above, below] = [above, below].map(|wanted| {
            let colour = shorter(wanted, limit);
            Ink { colour, error: distance(colour, wanted) }
        });
        let [a, b, f] = [&above, &below, &flat].map(|ink| pen::rgb_bytes(ink.colour) as u32);
        let n_bytes = [3, 3, 1, 6 + a, 6 + a, 6 + b, 6 + b, 4 + f, 7 + a + b, 7 + a + b];
        let mut prices = [0.0; N_WAYS];
        for (way, &n) in prices.iter_mut().zip(&n_bytes) {
            *way = n as f32 * price;
        }
        Self { above, below, flat, n_bytes, prices }
    }

    fn dip(&self, dip: Dip) -> Option<Rgb> {
        match dip {
            Dip::Keep => None,
            Dip::Above => Some(self.above.colour),
            Dip::Below => Some(self.below.colour),
            Dip::Flat => Some(self.flat.colour),
        }
    }
}

/// A colour of fewer digits, channel by channel, where the squared difference is less than `limit`.
fn shorter(colour: Rgb, limit: f32) -> Rgb {
    colour.map(|c| {
        let short = if c >= 100 { 99 } else { 9 };
        let off = f32::from(c) - f32::from(short);
        if off > 0.0 && off * off < limit { short } else { c }
    })
}
