//! Poses by turns: of every segment the turn of all modes together, and then each upon the one before.
//!
//! Sixty-four nodes at a time: their turns are a product of matrices, what these do to segments goes on beside one another,
//! and sums along branches are taken for some copies at once, since each addition waits for the one before.

use super::tile::{COLUMNS, PANEL, Tiles};
use crate::turning::Turning;
use std::array::from_fn;

/// Coefficients of cos(h) and sin(h) / h in powers of h^2, which are right to 5e-8 up to a quarter turn: half of what a
/// segment turns at most. Through five points of Chebyshev's.
const COSINE: [f32; 5] = [0.999_999_95, -0.499_999_05, 0.041_663_573, -0.001_385_363, 2.315_241_7e-5];
const SINE: [f32; 5] = [1.0, -0.166_666_58, 0.008_333_05, -1.980_901_7e-4, 2.605_107_6e-6];
/// A segment turns no farther than round to the other side, radians.
const FARTHEST: f32 = std::f32::consts::PI;
/// The largest number of single precision: turns beyond it, which are infinite there, are taken for it, so that they keep an
/// axis.
const HUGE: f32 = f32::MAX;

/// A plant whose segments turn.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    /// Rows of x of 64 nodes, then of y, then of z.
    tiles: Tiles,
    /// Of so many nodes, their segments at rest likewise.
    rests: Vec<[[f32; COLUMNS]; 3]>,
    /// Of each the place of the node before it, which comes before; of the root its own.
    parents: Vec<u32>,
    /// Where wanted nodes are among these; none where they are these.
    wanted: Vec<u32>,
    /// Of the first so many wanted nodes: how many of these it takes.
    takes: Vec<u32>,
}

impl Turns {
    /// Nodes of the beams, with those on the way to them where they are not among the ones before.
    pub(super) fn new(turning: &Turning, nodes: &[u32]) -> Self {
        let (order, wanted) = with_ways(turning, nodes);
        let mut place = vec![u32::MAX; turning.segments.len() + 1];
        let mut parents = Vec::with_capacity(order.len());
        // What a node has: of a second one in the same place nothing.
        let mut segment = Vec::with_capacity(order.len());
        for (at, &node) in (0..).zip(&order) {
            let first = &mut place[node as usize];
            if *first == u32::MAX {
                *first = at;
                let of_segment = (node as usize).checked_sub(1);
                parents.push(of_segment.map_or(at, |k| place[turning.parents[k] as usize]));
                segment.push(of_segment);
            } else {
                parents.push(*first);
                segment.push(None);
            }
        }
        let n_blocks = order.len().div_ceil(COLUMNS);
        let axis =
            |of: &dyn Fn(usize) -> nalgebra::Vector3<f64>, block: usize, axis: usize| -> [f32; COLUMNS] {
                from_fn(|k| {
                    segment.get(block * COLUMNS + k).copied().flatten().map_or(0.0, |k| of(k)[axis] as f32)
                })
            };
        let rest = |k: usize| turning.segments[k];
        let rests = (0..n_blocks).map(|block| from_fn(|at| axis(&rest, block, at))).collect();
        let row = |turns: &Vec<nalgebra::Vector3<f64>>| -> Vec<f32> {
            let turn = |k: usize| turns[k];
            (0..3 * n_blocks).flat_map(|at| axis(&turn, at / 3, at % 3)).collect()
        };
        let rows: Vec<Vec<f32>> = turning.turns.iter().map(row).collect();
        let is_all = wanted.iter().zip(0..).all(|(place, k)| *place == k) && wanted.len() == order.len();
        let most = |most: &mut u32, place: &u32| {
            *most = (*most).max(place + 1);
            Some(*most)
        };
        let takes = wanted.iter().scan(0, most).collect();
        let wanted = if is_all { Vec::new() } else { wanted };
        Self { tiles: Tiles::new(&rows, 3 * COLUMNS * n_blocks), rests, parents, wanted, takes }
    }

    pub(super) fn bytes(&self) -> usize {
        let numbers = self.parents.len() + self.wanted.len() + self.takes.len();
        self.tiles.bytes() + size_of_val(self.rests.as_slice()) + numbers * size_of::<u32>()
    }

    /// Displacements of the first wanted nodes of some copies, by panels of the amplitudes of their first modes.
    pub(super) fn pose(
        &self,
        panels: &[[f32; PANEL]],
        n_modes: usize,
        displacements: &mut [f32],
        n_copies: usize,
    ) {
        let n_wanted = displacements.len() / n_copies / 3;
        let Some(&n) = n_wanted.checked_sub(1).and_then(|last| self.takes.get(last)) else { return };
        let n = n as usize;
        let displacements = displacements.as_chunks_mut::<3>().0;
        if self.wanted.is_empty() {
            return self.put(panels, n_modes, displacements, n);
        }
        let mut all = vec![[0.0; 3]; n * n_copies];
        self.put(panels, n_modes, &mut all, n);
        for (row, all) in displacements.chunks_exact_mut(n_wanted).zip(all.chunks_exact(n)) {
            for (moved, place) in row.iter_mut().zip(&self.wanted) {
                *moved = all[*place as usize];
            }
        }
    }

    /// Of the first `n` nodes, on the way or wanted; a row a copy.
    fn put(&self, panels: &[[f32; PANEL]], n_modes: usize, moved: &mut [[f32; 3]], n: usize) {
        // The root comes first, and stays.
        moved.iter_mut().step_by(n).for_each(|root| *root = [0.0; 3]);
        self.tiles.by_groups(
            panels,
            n_modes,
            n.div_ceil(COLUMNS),
            #[inline(always)]
            |group, panel, turns| {
                for turns in turns.iter_mut() {
                    way_gone(&self.rests[group], turns);
                }
                let first = group * COLUMNS;
                let parents = &self.parents[first..n.min(first + COLUMNS)];
                let mut copies = moved.chunks_mut(PANEL * n).nth(panel).unwrap_or_default().chunks_mut(n);
                let mut copies: [&mut [[f32; 3]]; PANEL] = from_fn(|_| copies.next().unwrap_or_default());
                along(parents, first, turns, &mut copies);
            },
        );
    }
}

/// Puts each node where its segment leads to from the one before, in some copies: those that are there.
#[inline(always)]
fn along(
    parents: &[u32],
    first: usize,
    ways: &[[[f32; COLUMNS]; 3]; PANEL],
    copies: &mut [&mut [[f32; 3]]; PANEL],
) {
    // Mostly a node follows on the last.
    let mut last = [[0.0; 3]; PANEL];
    for (k, &parent) in parents.iter().enumerate().take(COLUMNS) {
        let follows = k > 0 && parent as usize + 1 == first + k;
        for ((copy, [x, y, z]), last) in copies.iter_mut().zip(ways).zip(&mut last) {
            if !follows {
                *last = copy.get(parent as usize).copied().unwrap_or_default();
            }
            *last = [last[0] + x[k], last[1] + y[k], last[2] + z[k]];
            if let Some(moved) = copy.get_mut(first + k) {
                *moved = *last;
            }
        }
    }
}

/// Turns segments, and puts where their tips go, as seen from their bases, into the place of the turns.
#[inline(always)]
fn way_gone([rest_x, rest_y, rest_z]: &[[f32; COLUMNS]; 3], turns: &mut [[f32; COLUMNS]; 3]) {
    let mut squares = [0.0; COLUMNS];
    let mut too_far = 0_u32;
    for k in 0..COLUMNS {
        squares[k] = turns[0][k] * turns[0][k] + turns[1][k] * turns[1][k] + turns[2][k] * turns[2][k];
        too_far += u32::from(squares[k] > FARTHEST * FARTHEST);
    }
    if too_far > 0 {
        turned_less(turns, &mut squares);
    }
    let [x, y, z] = turns;
    for k in 0..COLUMNS {
        let of_half = squares[k] * 0.25;
        let (cosine, sine) = (series(&COSINE, of_half), series(&SINE, of_half) * 0.5);
        // By a quaternion: 2 cos (v x d) + 2 v x (v x d), which is more exact than what turned less what did not.
        let v = [x[k] * sine, y[k] * sine, z[k] * sine];
        let across = cross(v, [rest_x[k], rest_y[k], rest_z[k]]);
        let along = cross(v, across);
        x[k] = 2.0 * (cosine * across[0] + along[0]);
        y[k] = 2.0 * (cosine * across[1] + along[1]);
        z[k] = 2.0 * (cosine * across[2] + along[2]);
    }
}

/// Turns no farther than a segment does, and their squares.
#[cold]
fn turned_less(turns: &mut [[f32; COLUMNS]; 3], squares: &mut [f32; COLUMNS]) {
    for (k, square) in squares.iter_mut().enumerate().filter(|(_, square)| **square > FARTHEST * FARTHEST) {
        let long = [0, 1, 2].map(|axis| f64::from(turns[axis][k].clamp(-HUGE, HUGE)));
        let by = f64::from(FARTHEST) / (long[0] * long[0] + long[1] * long[1] + long[2] * long[2]).sqrt();
        for (axis, long) in turns.iter_mut().zip(long) {
            axis[k] = (long * by) as f32;
        }
        *square = FARTHEST * FARTHEST;
    }
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn series(coefficients: &[f32; 5], x: f32) -> f32 {
    let mut sum = 0.0;
    for c in coefficients.iter().rev() {
        sum = sum * x + c;
    }
    sum
}

/// Nodes in the order that they are wanted, each after those on the way to it; and where among these the wanted are.
fn with_ways(turning: &Turning, nodes: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut is_there = vec![false; turning.segments.len() + 1];
    let (mut order, mut wanted) = (Vec::with_capacity(nodes.len()), Vec::with_capacity(nodes.len()));
    let mut way = Vec::new();
    for &node in nodes {
        let mut before = node;
        while let Some(k) = (before as usize).checked_sub(1) {
            before = turning.parents[k];
            if is_there[before as usize] {
                break;
            }
            way.push(before);
        }
        for before in way.drain(..).rev().chain([node]) {
            is_there[before as usize] = true;
            order.push(before);
        }
        wanted.push(order.len() as u32 - 1);
    }
    (order, wanted)
}
