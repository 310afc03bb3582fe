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
const SURVIVORS: usize = 4;
/// The price is looked for in so many trials at most.
const TRIALS: usize = 4;
/// A budget spent to this part is spent.
const SPENT: f32 = 0.94;
/// Least price of a byte while the picture moves, squared error: less would buy what the next frame paints over.
const PRICE_MIN: f32 = 2.0;
/// Largest change of the price between two trials.
const PRICE_STEP: f32 = 8.0;
/// No cell costs more, bytes; a price at which the worst cell is worth so many is not too high.
const DEAREST: f32 = 60.0;
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
    sum: f32,
    n_bytes: u32,
    fg: Option<Rgb>,
    bg: Option<Rgb>,
    /// The cell after the one painted last; `None` when the cursor may be anywhere.
    cursor: Option<usize>,
    /// The last paint, as a place in the list of all paints.
    last: Option<u32>,
}

/// Chooses paints; remembers what a byte was worth.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// While the picture rests, and while it moves.
    prices: [f32; 2],
    /// Paints of all survivors, each with its predecessor.
    paints: Vec<(Paint, Option<u32>)>,
}

impl Motion {
    /// The paints that take most error off the screen for `budget` bytes, or a few more when no price fits.
    ///
    /// `fg` and `bg` are the pen's colours, where it has 24-bit ones. While the picture moves, cells may be painted with
    /// colours near the wanted; otherwise only exactly.
    pub(super) fn choose(
        &mut self,
        spots: &mut Vec<Spot>,
        colours: (Option<Rgb>, Option<Rgb>),
        columns: usize,
        budget: usize,
        moving: bool,
    ) -> Vec<Paint> {
        let n_looked_at = (budget / BYTES_PER_CELL).max(1);
        if spots.len() > n_looked_at {
            spots.select_nth_unstable_by(n_looked_at - 1, |a, b| b.error.total_cmp(&a.error));
            spots.truncate(n_looked_at);
            spots.sort_unstable_by_key(|spot| spot.index);
        }
        let worst = spots.iter().map(|spot| spot.error).fold(0.0, f32::max);
        let least = if moving { PRICE_MIN } else { 0.0 };
        let (mut price, mut dear, mut cheap) = (self.prices[usize::from(moving)].max(least), None, None);
        let mut best: Option<(u32, Vec<Paint>)> = None;
        for _ in 0..TRIALS {
            let walk = Walk { spots, columns, price, moving };
            let (n_bytes, last) = walk.run(colours, &mut self.paints);
            let fits = n_bytes as usize <= budget;
            let is_better = match &best {
                None => true,
                Some((known, _)) if *known as usize > budget => fits && n_bytes > 0 || n_bytes < *known,
                Some((known, _)) => fits && n_bytes > *known,
            };
            if is_better && n_bytes > 0 {
                best = Some((n_bytes, self.path(last)));
                self.prices[usize::from(moving)] = price;
            }
            let part = n_bytes as f32 / budget.max(1) as f32;
            if fits && (part >= SPENT || price <= least) {
                break;
            }
            if fits {
                dear = Some(price);
            } else {
                cheap = Some(price);
            }
            price = match (cheap, dear) {
                (Some(cheap), Some(dear)) => f32::sqrt(cheap.max(1e-3) * dear),
                _ if n_bytes == 0 => (price / PRICE_STEP).min(worst / DEAREST),
                _ => price.max(1e-3) * part.powf(1.5).clamp(1.0 / PRICE_STEP, PRICE_STEP),
            };
            // Nothing is cheaper than free: with all of it in the budget the price ends there.
            price = if price < 1e-2 { least } else { price.max(least) };
        }
        best.map(|(_, paints)| paints).unwrap_or_default()
    }

    /// The paints up to one of them, in order.
    fn path(&self, mut last: Option<u32>) -> Vec<Paint> {
        let mut path = Vec::new();
        while let Some(at) = last {
            let (paint, before) = self.paints[at as usize];
            path.push(paint);
            last = before;
        }
        path.reverse();
        path
    }
}

/// One way of painting a cell.
struct Way {
    error: u32,
    n_bytes: usize,
    glyph: Glyph,
    fg: Option<Rgb>,
    bg: Option<Rgb>,
}

/// A walk through all spots at one price.
struct Walk<'a> {
    spots: &'a [Spot],
    columns: usize,
    price: f32,
    moving: bool,
}

impl Walk<'_> {
    /// Bytes of the best way, and its last paint.
    fn run(
        &self,
        (fg, bg): (Option<Rgb>, Option<Rgb>),
        paints: &mut Vec<(Paint, Option<u32>)>,
    ) -> (u32, Option<u32>) {
        paints.clear();
        let mut survivors = vec![Survivor { sum: 0.0, n_bytes: 0, fg, bg, cursor: None, last: None }];
        let mut next = Vec::with_capacity(SURVIVORS + 1);
        for spot in self.spots {
            // Not even one byte is worth it.
            if spot.error <= self.price {
                continue;
            }
            let inks = Inks::of(spot, if self.moving { self.price } else { 0.0 });
            next.clone_from(&survivors);
            let n_before = paints.len();
            for survivor in &survivors {
                self.ways(spot, &inks, survivor, &mut next, paints);
            }
            survivors.clone_from(&next);
            keep_used(&mut survivors, paints, n_before);
        }
        survivors.first().map_or((0, None), |best| (best.n_bytes, best.last))
    }

    /// Adds to `next` what becomes of a survivor that paints this spot.
    fn ways(
        &self,
        spot: &Spot,
        inks: &Inks,
        from: &Survivor,
        next: &mut Vec<Survivor>,
        paints: &mut Vec<(Paint, Option<u32>)>,
    ) {
        let far = |pen: Option<Rgb>, wanted| pen.map_or(FAR, |pen| distance(pen, wanted));
        let (fa, fb) = (far(from.fg, spot.above), far(from.fg, spot.below));
        let (ba, bb) = (far(from.bg, spot.above), far(from.bg, spot.below));
        let (above, below, flat) = (&inks.above, &inks.below, &inks.flat);
        let way = |error, n_bytes, glyph, fg, bg| Way { error, n_bytes, glyph, fg, bg };
        let (a, b) = (Some(above.colour), Some(below.colour));
        let ways = [
            way(fa + bb, 3, Glyph::Upper, None, None),
            way(fb + ba, 3, Glyph::Lower, None, None),
            way(ba + bb, 1, Glyph::Blank, None, None),
            way(above.error + bb, 6 + above.n_bytes, Glyph::Upper, a, None),
            way(above.error + fb, 6 + above.n_bytes, Glyph::Lower, None, a),
            way(fa + below.error, 6 + below.n_bytes, Glyph::Upper, None, b),
            way(ba + below.error, 6 + below.n_bytes, Glyph::Lower, b, None),
            way(flat.error, 4 + flat.n_bytes, Glyph::Blank, None, Some(flat.colour)),
            way(above.error + below.error, 7 + above.n_bytes + below.n_bytes, Glyph::Upper, a, b),
            way(above.error + below.error, 7 + above.n_bytes + below.n_bytes, Glyph::Lower, b, a),
        ];
        let go = pen::move_bytes(from.cursor, spot.index, self.columns);
        for way in ways {
            if !self.moving && way.error > 0 {
                continue;
            }
            let n_bytes = way.n_bytes + go;
            let sum = from.sum + way.error as f32 * spot.weight - spot.error + self.price * n_bytes as f32;
            let is_full = next.len() == SURVIVORS;
            if is_full && next.last().is_some_and(|worst| worst.sum <= sum) {
                continue;
            }
            let survivor = Survivor {
                sum,
                n_bytes: from.n_bytes + n_bytes as u32,
                fg: way.fg.or(from.fg),
                bg: way.bg.or(from.bg),
                cursor: Some(spot.index + 1),
                last: Some(paints.len() as u32),
            };
            if admit(next, survivor) {
                let paint = Paint { index: spot.index, glyph: way.glyph, fg: way.fg, bg: way.bg };
                paints.push((paint, from.last));
            }
        }
    }
}

/// Puts a survivor in its place, the best first; of two with the same pen in the same place only the better stays.
fn admit(survivors: &mut Vec<Survivor>, new: Survivor) -> bool {
    let same = survivors.iter().position(|s| (s.fg, s.bg, s.cursor) == (new.fg, new.bg, new.cursor));
    if let Some(same) = same {
        if survivors[same].sum <= new.sum {
            return false;
        }
        survivors.remove(same);
    }
    let place = survivors.partition_point(|s| s.sum <= new.sum);
    survivors.insert(place, new);
    survivors.truncate(SURVIVORS);
    place < SURVIVORS
}

/// Forgets the paints since `n_before` that no survivor has made.
fn keep_used(survivors: &mut [Survivor], paints: &mut Vec<(Paint, Option<u32>)>, n_before: usize) {
    let mut kept = [(Paint { index: 0, glyph: Glyph::Blank, fg: None, bg: None }, None); SURVIVORS];
    let mut n_kept = 0;
    for survivor in survivors {
        if let Some(last) = survivor.last.filter(|last| *last as usize >= n_before) {
            kept[n_kept] = paints[last as usize];
            survivor.last = Some((n_before + n_kept) as u32);
            n_kept += 1;
        }
    }
    paints.truncate(n_before);
    paints.extend_from_slice(&kept[..n_kept]);
}

/// A colour as it would be sent.
struct Ink {
    colour: Rgb,
    /// Of its parameters: `38;2;r;g;b`.
    n_bytes: usize,
    /// What it leaves: of one pixel, or for a flat cell of both.
    error: u32,
}

/// The colours that a spot may be painted with.
struct Inks {
    above: Ink,
    below: Ink,
    flat: Ink,
}

impl Inks {
    fn of(spot: &Spot, price: f32) -> Self {
        let limit = price / spot.weight;
        let (above, below) = (spot.above, spot.below);
        let mean = |k: usize| ((u16::from(above[k]) + u16::from(below[k])).div_ceil(2)) as u8;
        let flat = shorter([mean(0), mean(1), mean(2)], limit / 2.0);
        let ink = |wanted: Rgb| {
            let colour = shorter(wanted, limit);
            Ink { colour, n_bytes: pen::rgb_bytes(colour), error: distance(colour, wanted) }
        };
        let error = distance(flat, above) + distance(flat, below);
        Self {
            above: ink(above),
            below: ink(below),
            flat: Ink { colour: flat, n_bytes: pen::rgb_bytes(flat), error },
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
