//! Which points go together, and where the others say that one of them is.
//!
//! Leaves ride on branches. Of the points that were around a point when it was seeded, those that have kept their
//! distance from it since are likely to ride with it; a turn and a shift fitted to them tells where it is while it
//! cannot be seen, however far the branch has swung.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Live, POINTS_A_LOOK, Params};
use crate::Point;

/// A point that was near when the two were related.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Neighbour {
    id: u64,
    /// Which seeding of it; another is another point.
    stamp: u32,
    pub(super) slot: u32,
    /// Where it was when the two were related.
    base: Point,
    /// Mean square of how far their distance has been off since, pixels².
    apart: f32,
    /// Frames in that mean.
    n: u32,
}

/// What is known of every point before the unsure ones have asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) at: Point,
    pub(super) is_sure: bool,
    pub(super) before: Point,
    pub(super) was_sure: bool,
}

/// Where the neighbours say that a point is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word {
    pub(super) at: Point,
    /// Cosine and sine of how they have turned.
    pub(super) turn: [f32; 2],
    /// How far they are from what they say of each other, pixels.
    pub(super) spread_px: f32,
}

/// A neighbour's two positions, and how much it counts.
type Pair = (Point, Point, f32);

/// Fewer have no say.
const QUORUM: usize = 3;
/// How slowly what was long ago is forgotten: frames.
const MEMORY_FRAMES: f32 = 20.0;
/// Relatives that are farther away count less, pixels (standard deviation).
pub(super) const NEAR_PX: f32 = 60.0;

/// Looks up who is where, and finds relatives for those who lack some.
///
/// `go_on` is asked every so many points.
pub(super) fn relate<E>(
    live: &mut [Live],
    params: &Params,
    go_on: &mut dyn FnMut(f64) -> Result<(), E>,
) -> Result<(), E> {
    let n = live.len();
    let mut look = |slot: usize, part: f64| {
        if slot.is_multiple_of(POINTS_A_LOOK) { go_on(part + 0.5 * slot as f64 / n as f64) } else { Ok(()) }
    };
    let slots: BTreeMap<(u64, u32), u32> =
        live.iter().zip(0..).map(|(point, slot)| ((point.id, point.stamp), slot)).collect();
    for (slot, point) in live.iter_mut().enumerate() {
        look(slot, 0.0)?;
        point.near.retain_mut(|other| {
            slots.get(&(other.id, other.stamp)).inspect(|slot| other.slot = **slot).is_some()
        });
    }
    let grid = Grid::new(live, params.neighbours as usize);
    for slot in 0..n {
        look(slot, 0.5)?;
        if live[slot].is_sure && live[slot].near.len() < params.neighbours as usize {
            let found = grid.around(live, slot, params.neighbours as usize);
            let old: BTreeMap<u64, (f32, u32)> =
                live[slot].near.iter().map(|n| (n.id, (n.apart, n.n))).collect();
            let relative = |&other: &u32| {
                let Live { id, stamp, at, .. } = live[other as usize];
                let (apart, n) = old.get(&id).copied().unwrap_or_default();
                Neighbour { id, stamp, slot: other, base: at, apart, n }
            };
            let near = found.iter().map(relative).collect();
            (live[slot].near, live[slot].base) = (near, live[slot].at);
        }
    }
    Ok(())
}

/// Points by the cell of the picture they are in.
struct Grid {
    origin: Point,
    side_px: f32,
    size: [usize; 2],
    cells: Vec<Vec<u32>>,
}

impl Grid {
    /// Cells that hold some ninth of the neighbours wanted each.
    fn new(live: &[Live], n_wanted: usize) -> Self {
        let sure = || live.iter().filter(|point| point.is_sure);
        let bound =
            |start: f32, f: fn(f32, f32) -> f32, axis: usize| sure().map(|p| p.at[axis]).fold(start, f);
        let origin = [0, 1].map(|axis| bound(f32::MAX, f32::min, axis));
        let end = [0, 1].map(|axis| bound(f32::MIN, f32::max, axis));
        let span = [0, 1].map(|axis| (end[axis] - origin[axis]).clamp(1.0, 1e5));
        let share = n_wanted as f32 / 9.0 / sure().count().max(1) as f32;
        let side_px = (span[0] * span[1] * share).sqrt().clamp(1.0, NEAR_PX);
        let size = span.map(|px| (px / side_px) as usize + 1);
        let mut grid = Self { origin, side_px, size, cells: vec![Vec::new(); size[0] * size[1]] };
        for (point, slot) in live.iter().zip(0..) {
            if point.is_sure {
                let [x, y] = grid.cell(point.at);
                grid.cells[y * size[0] + x].push(slot);
            }
        }
        grid
    }

    fn cell(&self, at: Point) -> [usize; 2] {
        [0, 1].map(|axis| {
            (((at[axis] - self.origin[axis]) / self.side_px).max(0.0) as usize).min(self.size[axis] - 1)
        })
    }

    /// Up to `n` sure points around another one, nearest first.
    fn around(&self, live: &[Live], slot: usize, n: usize) -> Vec<u32> {
        let at = live[slot].at;
        let [x, y] = self.cell(at);
        let rings = (2.0 * NEAR_PX / self.side_px).ceil() as usize;
        let mut found: Vec<(f32, u32)> = Vec::new();
        for ring in 0..=rings.max(1) {
            let columns = x.saturating_sub(ring)..=(x + ring).min(self.size[0] - 1);
            for row in y.saturating_sub(ring)..=(y + ring).min(self.size[1] - 1) {
                for column in columns.clone() {
                    if row.abs_diff(y).max(column.abs_diff(x)) == ring {
                        let others = self.cells[row * self.size[0] + column].iter();
                        let others = others.filter(|&&other| other as usize != slot).take(4 * n);
                        found.extend(others.map(|&other| (distance(at, live[other as usize].at), other)));
                    }
                }
            }
            // One ring more than enough: cells are square, neighbourhoods are round.
            if found.len() >= 2 * n {
                break;
            }
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().take(n).map(|(_, other)| other).collect()
    }
}

/// Where a point's neighbours say it is, from where all were when they were related.
pub(super) fn since_related(point: &Live, seen: &[Seen], params: &Params) -> Option<Word> {
    let sure = point.near.iter().filter(|other| seen[other.slot as usize].is_sure);
    let pair = |other: &Neighbour| (other.base, seen[other.slot as usize].at, weight(point, other, params));
    carry(&sure.map(pair).collect::<Vec<_>>(), point.base, params.kin_px)
}

/// Where a point's neighbours say it is, from where all were in the frame before.
pub(super) fn since_before(point: &Live, seen: &[Seen], params: &Params) -> Option<Word> {
    let sure = point.near.iter().filter(|other| {
        let other = &seen[other.slot as usize];
        other.is_sure && other.was_sure
    });
    let pair = |other: &Neighbour| {
        let other_seen = &seen[other.slot as usize];
        (other_seen.before, other_seen.at, weight(point, other, params))
    };
    carry(&sure.map(pair).collect::<Vec<_>>(), point.before, params.kin_px / 2.0)
}

/// Notes who has kept its distance.
pub(super) fn note(point: &mut Live, seen: &[Seen]) {
    if !point.is_sure {
        return;
    }
    for other in &mut point.near {
        let Seen { at, is_sure, .. } = seen[other.slot as usize];
        if is_sure {
            let off = distance(at, point.at) - distance(other.base, point.base);
            other.n += 1;
            other.apart += (off * off - other.apart) * (1.0 / other.n as f32).max(1.0 / MEMORY_FRAMES);
        }
    }
}

/// How much a neighbour counts.
fn weight(point: &Live, other: &Neighbour, params: &Params) -> f32 {
    let kin = params.kin_px * params.kin_px;
    let [dx, dy] = [0, 1].map(|axis| other.base[axis] - point.base[axis]);
    (kin / (other.apart + kin)).powi(2) * (-(dx * dx + dy * dy) / (2.0 * NEAR_PX * NEAR_PX)).exp()
}

/// Turns and shifts a position as most of the pairs were: least squares, weighed anew twice (Geman-McClure).
fn carry(pairs: &[Pair], own: Point, outlier_px: f32) -> Option<Word> {
    /// As many pixels² of evidence that nothing has turned: a few close neighbours say little about turns.
    const STEADY_PX2: f32 = 20.0;
    if pairs.len() < QUORUM {
        return None;
    }
    let mut weights: Vec<f32> = pairs.iter().map(|pair| pair.2).collect();
    let mut word = None;
    for _ in 0..3 {
        let total: f32 = weights.iter().sum();
        if total < 1e-6 {
            return None;
        }
        let weighed = || pairs.iter().zip(&weights);
        let mean = |f: fn(&Pair) -> f32| weighed().map(|(pair, w)| w * f(pair)).sum::<f32>() / total;
        let from = [mean(|p| p.0[0]), mean(|p| p.0[1])];
        let to = [mean(|p| p.1[0]), mean(|p| p.1[1])];
        let steady = total * STEADY_PX2;
        let turn = weighed().fold([steady, 0.0], |[along, across], (pair, w)| {
            let (a, b) = ([pair.0[0] - from[0], pair.0[1] - from[1]], [pair.1[0] - to[0], pair.1[1] - to[1]]);
            [along + w * (a[0] * b[0] + a[1] * b[1]), across + w * (a[0] * b[1] - a[1] * b[0])]
        });
        let length = turn[0].hypot(turn[1]).max(1e-6);
        let turn = turn.map(|c| c / length);
        let carried = |at: Point| {
            let [x, y] = [at[0] - from[0], at[1] - from[1]];
            [to[0] + turn[0] * x - turn[1] * y, to[1] + turn[1] * x + turn[0] * y]
        };
        let mut squares = 0.0;
        for (pair, w) in pairs.iter().zip(&mut weights) {
            let off = distance(carried(pair.0), pair.1);
            squares += *w * off * off;
            let trust = 1.0 / (1.0 + (off / outlier_px).powi(2));
            *w = pair.2 * trust * trust;
        }
        word = Some(Word { at: carried(own), turn, spread_px: (squares / total).sqrt() });
    }
    word
}

fn distance(a: Point, b: Point) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
