//! From a grid to a coarser one: tiles of three nodes by three become a node each.
//!
//! A vector that a matrix all but loses cannot be smoothed away, so it must be seen on the coarser grid. Of the matting
//! Laplacian these are opacities that are linear in colour in every window, and so among them are four that are known: the
//! constant and the three channels. A node of the coarser grid says how much of each its tile has, after they were made
//! orthonormal there (smoothed aggregation, Vaněk, Mandel & Brezina 1996, without the smoothing).

#[cfg(test)]
mod tests;

use crate::grid::{Block, Grid, Offset, Size, WITHIN_ONE};
use crate::work::{made, rows};

/// Nodes along a tile.
const SIDE: usize = 3;
/// Vectors that are kept: the constant and three channels.
pub(crate) const KEPT: usize = 4;
/// Of a vector's length in a tile, what is left beside the others must be as much; else it says nothing new there.
const LEAST_NEW: f64 = 1e-5;

/// How much of each kept vector the numbers of one node have, `(K, KEPT)`.
pub(crate) type Share<const K: usize> = [[f64; KEPT]; K];

/// The step between a grid and the coarser one.
#[derive(Clone, Debug)]
pub(crate) struct Tiles<const K: usize> {
    fine: Size,
    coarse: Size,
    /// Per fine node: from the numbers of its tile to its own.
    shares: Vec<Share<K>>,
}

impl<const K: usize> Tiles<K> {
    /// Tiles that hold these vectors, and the vectors as the coarser grid has them.
    pub(crate) fn new(fine: Size, vectors: &[Share<K>]) -> (Self, Vec<Share<KEPT>>) {
        let coarse = Size { width: fine.width.div_ceil(SIDE), height: fine.height.div_ceil(SIDE) };
        let mut tiles = Self { fine, coarse, shares: vec![[[0.0; KEPT]; K]; vectors.len()] };
        let parted = made(coarse.n_nodes(), |tile| {
            let nodes: Vec<usize> = tiles.nodes(tile).collect();
            orthonormal(nodes.iter().flat_map(|&node| vectors[node]).collect())
        });
        let mut coarser = Vec::with_capacity(parted.len());
        for (tile, (mut numbers, rest)) in parted.into_iter().enumerate() {
            let nodes: Vec<usize> = tiles.nodes(tile).collect();
            for (node, share) in nodes.into_iter().zip(numbers.chunks_exact_mut(K)) {
                tiles.shares[node].copy_from_slice(share);
            }
            coarser.push(rest);
        }
        (tiles, coarser)
    }

    /// The fine nodes of a tile, row by row.
    fn nodes(&self, tile: usize) -> impl Iterator<Item = usize> + use<K> {
        let fine = self.fine;
        let [left, top] = [tile % self.coarse.width, tile / self.coarse.width].map(|at| at * SIDE);
        let columns = left..(left + SIDE).min(fine.width);
        (top..(top + SIDE).min(fine.height))
            .flat_map(move |y| columns.clone().map(move |x| y * fine.width + x))
    }

    /// Which tile a fine node is in.
    fn tile(&self, node: usize) -> usize {
        let [x, y] = [node % self.fine.width, node / self.fine.width];
        y / SIDE * self.coarse.width + x / SIDE
    }

    /// What the coarser grid has to make good: of every tile the products of its numbers with the kept vectors.
    pub(crate) fn gather(&self, fine: &[[f64; K]], coarse: &mut [[f64; KEPT]]) {
        let width = self.coarse.width;
        rows(coarse, width, |y, row| {
            for (tile, sum) in (y * width..).zip(row) {
                *sum = [0.0; KEPT];
                for node in self.nodes(tile) {
                    for (share, value) in self.shares[node].iter().zip(&fine[node]) {
                        sum.iter_mut().zip(share).for_each(|(sum, share)| *sum += share * value);
                    }
                }
            }
        });
    }

    /// Adds what the coarser grid has found.
    pub(crate) fn add_to(&self, fine: &mut [[f64; K]], coarse: &[[f64; KEPT]]) {
        let width = self.fine.width;
        rows(fine, width, |y, row| {
            for (node, numbers) in (y * width..).zip(row) {
                let found = &coarse[self.tile(node)];
                for (number, share) in numbers.iter_mut().zip(&self.shares[node]) {
                    *number += share.iter().zip(found).map(|(share, found)| share * found).sum::<f64>();
                }
            }
        });
    }

    /// The matrix as the coarser grid has it (Galerkin's).
    pub(crate) fn coarser(&self, matrix: &Grid<K>) -> Grid<KEPT> {
        let mut coarser = Grid::new(self.coarse, WITHIN_ONE, |tile, offset| self.block(matrix, tile, offset));
        // What no pixel has a share in stands alone, at nought.
        for block in &mut coarser.blocks[0] {
            for (k, row) in block.iter_mut().enumerate().filter(|(k, row)| row[*k] <= 0.0) {
                row[k] = 1.0;
            }
        }
        coarser
    }

    /// The coarser block of a tile and the one that lies ahead of it by an offset.
    fn block(&self, matrix: &Grid<K>, tile: usize, offset: Offset) -> Block<KEPT> {
        let other = self.coarse.beside(tile, offset);
        let mut sum = [[0.0; KEPT]; KEPT];
        for node in self.nodes(tile) {
            matrix.coupled(node, |coupled, block| {
                if Some(self.tile(coupled)) == other {
                    add_between(&mut sum, &self.shares[node], &block, &self.shares[coupled]);
                }
            });
        }
        sum
    }
}

/// Adds `leftᵀ block right`.
fn add_between<const K: usize>(sum: &mut Block<KEPT>, left: &Share<K>, block: &Block<K>, right: &Share<K>) {
    for (left, row) in left.iter().zip(block) {
        let mut product = [0.0; KEPT];
        for (value, right) in row.iter().zip(right) {
            product.iter_mut().zip(right).for_each(|(product, right)| *product += value * right);
        }
        for (sum, left) in sum.iter_mut().zip(left) {
            sum.iter_mut().zip(&product).for_each(|(sum, product)| *sum += left * product);
        }
    }
}

/// Vectors as the columns of `numbers` made orthonormal, by Gram and Schmidt, twice; and what they were made of. A vector
/// that says nothing new becomes nought.
fn orthonormal(mut numbers: Vec<[f64; KEPT]>) -> (Vec<[f64; KEPT]>, Share<KEPT>) {
    let mut made_of = [[0.0; KEPT]; KEPT];
    for k in 0..KEPT {
        let length = |numbers: &[[f64; KEPT]]| numbers.iter().map(|row| row[k] * row[k]).sum::<f64>().sqrt();
        let whole = length(&numbers);
        for before in (0..k).chain(0..k) {
            let along: f64 = numbers.iter().map(|row| row[before] * row[k]).sum();
            made_of[before][k] += along;
            numbers.iter_mut().for_each(|row| row[k] -= along * row[before]);
        }
        let left = length(&numbers);
        let is_new = left > LEAST_NEW * whole;
        let scale = if is_new { 1.0 / left } else { 0.0 };
        numbers.iter_mut().for_each(|row| row[k] *= scale);
        made_of[k][k] = if is_new { left } else { 0.0 };
    }
    (numbers, made_of)
}
