//! Corners that are neighbours make a grid.

use std::collections::{BTreeMap, VecDeque};

use honami_model::picture::Gray;

use super::Board;
use super::rays::{Corner, corner};
use crate::sample::bilinear;

/// An edge leads to a neighbour within this angle, radians: from nearby, its direction is known to a tenth.
const ASIDE_RAD: f64 = 0.25;
/// Corners that are looked at along an edge, nearest first.
const TRIES: usize = 6;
/// Neighbours are no closer, pixels: their rings would see the same edges.
const CLOSEST_PX: f64 = 7.0;
/// A missing corner is looked for within this share of the distance to its neighbour.
const NEAR: f64 = 0.3;
/// Contrast across an edge between two corners, of the lesser one's.
const EDGE: f64 = 0.25;
/// Contrast of a corner, of its neighbour's: light changes slowly over a board.
const AS_BRIGHT: f64 = 0.35;

type Cell = [i32; 2];
/// To the right, down, to the left, up: clockwise.
const STEPS: [Cell; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// A corner on a grid, and which of its edges leads along the rows.
#[derive(Clone, Copy, Debug)]
struct Placed {
    corner: Corner,
    along: usize,
}

impl Placed {
    /// The edge that leads this way, one of [`STEPS`].
    fn ray(&self, way: usize) -> usize {
        (self.along + way) % 4
    }
}

/// Corners by column and row.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    cells: BTreeMap<Cell, Placed>,
}

/// The grid of most corners, or one of the size that is wanted; `None` where no two corners are neighbours.
pub(super) fn largest(picture: &Gray<'_>, corners: Vec<Corner>, board: Board) -> Option<Grid> {
    let links = links(picture, &corners);
    let mut taken = vec![false; corners.len()];
    let mut best: Option<Grid> = None;
    for seed in 0..corners.len() {
        if taken[seed] {
            continue;
        }
        let mut grid = Grid::linked(&corners, &links, seed, &mut taken);
        if grid.len() < 4 {
            continue;
        }
        grid.fill(picture);
        grid.trim(board);
        if grid.ordered(board).is_some() {
            return Some(grid);
        }
        if best.as_ref().is_none_or(|best| grid.len() > best.len()) {
            best = Some(grid);
        }
    }
    best
}

/// For each edge of each corner the corner and the edge at its other end, where both say so.
fn links(picture: &Gray<'_>, corners: &[Corner]) -> Vec<[Option<(usize, usize)>; 4]> {
    let one_way: Vec<[Option<(usize, usize)>; 4]> =
        (0..corners.len()).map(|i| [0, 1, 2, 3].map(|ray| neighbour(picture, corners, i, ray))).collect();
    let mutual =
        |i: usize, ray: usize| one_way[i][ray].filter(|&(j, back)| one_way[j][back] == Some((i, ray)));
    (0..corners.len()).map(|i| [0, 1, 2, 3].map(|ray| mutual(i, ray))).collect()
}

fn neighbour(picture: &Gray<'_>, corners: &[Corner], i: usize, ray: usize) -> Option<(usize, usize)> {
    let from = &corners[i];
    let (sin, cos) = from.rays[ray].sin_cos();
    let mut ahead: Vec<(f64, usize)> = Vec::new();
    for (j, to) in corners.iter().enumerate() {
        let [x, y] = [to.at[0] - from.at[0], to.at[1] - from.at[1]];
        let (along, across) = (x * cos + y * sin, y * cos - x * sin);
        if along > CLOSEST_PX && across.abs() < along * ASIDE_RAD {
            ahead.push((along, j));
        }
    }
    ahead.sort_by(|a, b| a.0.total_cmp(&b.0));
    ahead.into_iter().take(TRIES).find_map(|(_, j)| {
        let back = facing(from, ray, &corners[j])?;
        is_edge(picture, from, &corners[j], from.rises(ray)).then_some((j, back))
    })
}

/// The edge of a corner that leads back to another one of about its contrast, with the dark side on the same hand.
fn facing(from: &Corner, ray: usize, to: &Corner) -> Option<usize> {
    if from.contrast.min(to.contrast) < AS_BRIGHT * from.contrast.max(to.contrast) {
        return None;
    }
    let direction = (from.at[1] - to.at[1]).atan2(from.at[0] - to.at[0]);
    (0..4).find(|&back| turn(to.rays[back], direction).abs() < ASIDE_RAD && to.rises(back) != from.rises(ray))
}

/// From one direction to another, -π..=π.
fn turn(from: f64, to: f64) -> f64 {
    (to - from + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

/// Whether it is brighter on one side of the line between two corners, all along it.
fn is_edge(picture: &Gray<'_>, from: &Corner, to: &Corner, rises: bool) -> bool {
    let [x, y] = [to.at[0] - from.at[0], to.at[1] - from.at[1]];
    let length = x.hypot(y);
    let off = (0.12 * length).clamp(1.5, 6.0) / length;
    let least = EDGE * from.contrast.min(to.contrast);
    let sign = if rises { 1.0 } else { -1.0 };
    let n_right = [0.2, 0.35, 0.5, 0.65, 0.8].into_iter().filter(|share| {
        let middle = [from.at[0] + share * x, from.at[1] + share * y];
        // Clockwise of (x, y), as y points down, is (-y, x).
        let side = |off: f64| {
            f64::from(bilinear(picture, [(middle[0] - off * y) as f32, (middle[1] + off * x) as f32]))
        };
        sign * (side(off) - side(-off)) > least
    });
    n_right.count() >= 4
}

impl Grid {
    /// Corners.
    pub(super) fn len(&self) -> usize {
        self.cells.len()
    }

    /// Columns and rows that it spans.
    pub(super) fn size(&self) -> [usize; 2] {
        let [least, most] = self.span();
        [0, 1].map(|axis| (most[axis] - least[axis] + 1) as usize)
    }

    fn span(&self) -> [Cell; 2] {
        let all = |axis: usize| self.cells.keys().map(move |cell| cell[axis]);
        let least = [0, 1].map(|axis| all(axis).min().unwrap_or(0));
        let most = [0, 1].map(|axis| all(axis).max().unwrap_or(-1));
        [least, most]
    }

    /// All that links lead to from a corner.
    fn linked(
        corners: &[Corner],
        links: &[[Option<(usize, usize)>; 4]],
        seed: usize,
        taken: &mut [bool],
    ) -> Self {
        let mut grid = Self::default();
        let mut queue = VecDeque::from([(seed, [0, 0], 0)]);
        while let Some((i, cell, along)) = queue.pop_front() {
            if taken[i] || grid.cells.contains_key(&cell) {
                continue;
            }
            taken[i] = true;
            let placed = Placed { corner: corners[i], along };
            grid.cells.insert(cell, placed);
            for (way, step) in STEPS.iter().enumerate() {
                if let Some((next, back)) = links[i][placed.ray(way)] {
                    // What leads back there is the edge that leads here, half a turn on.
                    queue.push_back((next, [cell[0] + step[0], cell[1] + step[1]], (back + 6 - way) % 4));
                }
            }
        }
        grid
    }

    /// Looks for corners beside those that are there, until there are no more.
    fn fill(&mut self, picture: &Gray<'_>) {
        loop {
            let cells: Vec<Cell> = self.cells.keys().copied().collect();
            let beside =
                cells.iter().flat_map(|cell| STEPS.iter().map(|step| [cell[0] + step[0], cell[1] + step[1]]));
            let mut empty: Vec<Cell> = beside.filter(|cell| !self.cells.contains_key(cell)).collect();
            empty.sort_unstable();
            empty.dedup();
            let found: Vec<(Cell, Placed)> =
                empty.into_iter().filter_map(|cell| Some((cell, self.missing(picture, cell)?))).collect();
            if found.is_empty() {
                return;
            }
            self.cells.extend(found);
        }
    }

    /// The corner of an empty cell, where two in line with it say it should be.
    fn missing(&self, picture: &Gray<'_>, cell: Cell) -> Option<Placed> {
        STEPS.iter().enumerate().find_map(|(way, step)| {
            let at = |n: i32| self.cells.get(&[cell[0] - n * step[0], cell[1] - n * step[1]]);
            let (near, far) = (at(1)?, at(2)?);
            let before: [f64; 2] = [0, 1].map(|axis| near.corner.at[axis] - far.corner.at[axis]);
            // With a third in line, steps grow or shrink as they did, as perspective has it.
            let growth = at(3).map_or(1.0, |third| {
                let earlier = [0, 1].map(|axis| far.corner.at[axis] - third.corner.at[axis]);
                (before[0].hypot(before[1]) / earlier[0].hypot(earlier[1])).clamp(0.7, 1.4)
            });
            let length = before[0].hypot(before[1]) * growth;
            let predicted = [0, 1].map(|axis| near.corner.at[axis] + growth * before[axis]);
            let found = [5.0, 3.0]
                .into_iter()
                .filter(|&ring| ring < 0.6 * length)
                .find_map(|ring| corner(picture, predicted, ring))?;
            let off = (found.at[0] - predicted[0]).hypot(found.at[1] - predicted[1]);
            let ray = near.ray(way);
            let back = facing(&near.corner, ray, &found)?;
            let is_next =
                off < NEAR * length && is_edge(picture, &near.corner, &found, near.corner.rises(ray));
            is_next.then_some(Placed { corner: found, along: (back + 6 - way) % 4 })
        })
    }

    /// Takes off rows and columns at the rim that are not half there, as long as there are more than wanted.
    fn trim(&mut self, board: Board) {
        let (long, short) = (board.columns.max(board.rows), board.columns.min(board.rows));
        loop {
            let size = self.size();
            let [least, most] = self.span();
            let sparse =
                (0..2).flat_map(|axis| [(axis, least[axis]), (axis, most[axis])]).find(|&(axis, rim)| {
                    let wanted = if size[axis] >= size[1 - axis] { long } else { short };
                    let n_there = self.cells.keys().filter(|cell| cell[axis] == rim).count();
                    size[axis] > wanted && 2 * n_there < size[1 - axis]
                });
            match sparse {
                Some((axis, rim)) => self.cells.retain(|cell, _| cell[axis] != rim),
                None => return,
            }
        }
    }

    /// All corners of the board in its own order, pixels; `None` where the grid is not exactly that board.
    pub(super) fn ordered(&self, board: Board) -> Option<Vec<[f64; 2]>> {
        let [wide, high] = self.size();
        if self.len() != wide * high {
            return None;
        }
        // By how many quarters the grid is turned to lie as the board does.
        let turned = (0..4).filter(|quarters| {
            let size = if quarters % 2 == 0 { [wide, high] } else { [high, wide] };
            size == [board.columns, board.rows]
        });
        let ways = turned.map(|quarters| {
            let cells = self.turned(board, quarters);
            let first = &cells[0];
            // Clockwise of the edge to the left lies the outermost square.
            let is_dark = !first.corner.rises(first.ray(quarters + 2));
            let places: Vec<[f64; 2]> = cells.iter().map(|placed| placed.corner.at).collect();
            let row = [0, 1].map(|axis| places[board.columns - 1][axis] - places[0][axis]);
            (is_dark, row[0] / row[0].hypot(row[1]), places)
        });
        ways.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).map(|(_, _, places)| places)
    }

    /// Corners in the order of a board whose rows lead the way of one of [`STEPS`].
    fn turned(&self, board: Board, quarters: usize) -> Vec<&Placed> {
        let [least, most] = self.span();
        let (along, down) = (STEPS[quarters], STEPS[(quarters + 1) % 4]);
        // The first corner is where neither leads from.
        let first = [0, 1].map(|axis| if along[axis] + down[axis] > 0 { least[axis] } else { most[axis] });
        let cell = |i: usize| {
            let (column, row) = ((i % board.columns) as i32, (i / board.columns) as i32);
            [0, 1].map(|axis| first[axis] + column * along[axis] + row * down[axis])
        };
        (0..board.columns * board.rows).filter_map(|i| self.cells.get(&cell(i))).collect()
    }
}
