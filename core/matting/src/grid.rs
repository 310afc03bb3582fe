//! Symmetric matrices over the nodes of a grid, where a node is coupled with those near it alone.

#[cfg(test)]
mod tests;

use nalgebra::DMatrix;

use crate::work::{each, made, rows};

/// `K` by `K` numbers, by rows.
pub(crate) type Block<const K: usize> = [[f64; K]; K];

/// From a node to another, right and down.
pub(crate) type Offset = [isize; 2];

/// Pixels share a window of 3 by 3 with those within two of them; each pair once.
pub(crate) const WITHIN_TWO: &[Offset] = &[
    [0, 0],
    [1, 0],
    [2, 0],
    [-2, 1],
    [-1, 1],
    [0, 1],
    [1, 1],
    [2, 1],
    [-2, 2],
    [-1, 2],
    [0, 2],
    [1, 2],
    [2, 2],
];

/// Tiles of three pixels by three reach no farther than the tiles about them; each pair once.
pub(crate) const WITHIN_ONE: &[Offset] = &[[0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl Size {
    pub(crate) fn n_nodes(self) -> usize {
        self.width * self.height
    }

    /// The node that lies so far from another, where there is one.
    pub(crate) fn beside(self, node: usize, [dx, dy]: Offset) -> Option<usize> {
        let x = (node % self.width).checked_add_signed(dx).filter(|&x| x < self.width)?;
        let y = (node / self.width).checked_add_signed(dy).filter(|&y| y < self.height)?;
        Some(y * self.width + x)
    }

    /// Columns from which an offset leads to a column.
    fn columns(self, dx: isize) -> std::ops::Range<usize> {
        let reach = dx.unsigned_abs().min(self.width);
        if dx < 0 { reach..self.width } else { 0..self.width - reach }
    }
}

/// A symmetric matrix: of every node a block with itself and with each node ahead of it. Those behind are the transposes.
/// A row has no fewer nodes than an offset goes along it.
#[derive(Clone, Debug)]
pub(crate) struct Grid<const K: usize> {
    pub(crate) size: Size,
    pub(crate) offsets: &'static [Offset],
    /// `(n_offsets, n_nodes)`; nought where an offset leads out of the grid.
    pub(crate) blocks: Vec<Vec<Block<K>>>,
}

impl<const K: usize> Grid<K> {
    /// The matrix whose block of a node and one ahead, which is there, is what `block` says.
    pub(crate) fn new(
        size: Size,
        offsets: &'static [Offset],
        block: impl Fn(usize, Offset) -> Block<K> + Sync + Send,
    ) -> Self {
        let plane = |&offset: &Offset| {
            let there = |node| size.beside(node, offset).map_or([[0.0; K]; K], |_| block(node, offset));
            made(size.n_nodes(), there)
        };
        Self { size, offsets, blocks: offsets.iter().map(plane).collect() }
    }

    /// The product with a vector.
    pub(crate) fn times(&self, x: &[[f64; K]], out: &mut [[f64; K]]) {
        rows(out, self.size.width, |y, row| {
            row.fill([0.0; K]);
            for (&offset, blocks) in self.offsets.iter().zip(&self.blocks) {
                self.add_ahead(y, offset, blocks, x, row);
                if offset != [0, 0] {
                    self.add_behind(y, offset, blocks, x, row);
                }
            }
        });
    }

    /// What the product with a vector lacks of a right side.
    pub(crate) fn fault(&self, x: &[[f64; K]], right: &[[f64; K]], out: &mut [[f64; K]]) {
        self.times(x, out);
        each(out, right, right, |out, right, _| *out = right - *out);
    }

    /// Adds to a row what comes from the nodes ahead.
    fn add_ahead(
        &self,
        y: usize,
        [dx, dy]: Offset,
        blocks: &[Block<K>],
        x: &[[f64; K]],
        row: &mut [[f64; K]],
    ) {
        let width = self.size.width;
        let Some(other) = y.checked_add_signed(dy).filter(|&y| y < self.size.height) else { return };
        let columns = self.size.columns(dx);
        let first = (other * width + columns.start).wrapping_add_signed(dx);
        let blocks = &blocks[y * width + columns.start..][..columns.len()];
        let others = &x[first..][..columns.len()];
        for ((out, block), x) in row[columns].iter_mut().zip(blocks).zip(others) {
            for (out, row) in out.iter_mut().zip(block) {
                *out += row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
            }
        }
    }

    /// Adds to a row what comes from the nodes behind, whose blocks are transposed.
    fn add_behind(
        &self,
        y: usize,
        [dx, dy]: Offset,
        blocks: &[Block<K>],
        x: &[[f64; K]],
        row: &mut [[f64; K]],
    ) {
        let width = self.size.width;
        let Some(other) = y.checked_add_signed(-dy).filter(|&y| y < self.size.height) else { return };
        let columns = self.size.columns(-dx);
        let first = (other * width + columns.start).wrapping_add_signed(-dx);
        let blocks = &blocks[first..][..columns.len()];
        let others = &x[first..][..columns.len()];
        for ((out, block), x) in row[columns].iter_mut().zip(blocks).zip(others) {
            for (row, x) in block.iter().zip(x) {
                for (out, a) in out.iter_mut().zip(row) {
                    *out += a * x;
                }
            }
        }
    }

    /// The numbers on the diagonal.
    pub(crate) fn diagonal(&self) -> Vec<[f64; K]> {
        self.blocks[0].iter().map(|block| std::array::from_fn(|k| block[k][k])).collect()
    }

    /// Calls `see` with every node that this one is coupled with, itself too, and the block of both.
    pub(crate) fn coupled(&self, node: usize, mut see: impl FnMut(usize, Block<K>)) {
        for (&[dx, dy], blocks) in self.offsets.iter().zip(&self.blocks) {
            if let Some(ahead) = self.size.beside(node, [dx, dy]) {
                see(ahead, blocks[node]);
            }
            if let Some(behind) = self.size.beside(node, [-dx, -dy]).filter(|_| [dx, dy] != [0, 0]) {
                see(behind, std::array::from_fn(|i| std::array::from_fn(|j| blocks[behind][j][i])));
            }
        }
    }

    /// All of it, both halves, with zeros.
    pub(crate) fn dense(&self) -> DMatrix<f64> {
        let n = self.size.n_nodes() * K;
        let mut dense = DMatrix::zeros(n, n);
        for node in 0..self.size.n_nodes() {
            self.coupled(node, |other, block| {
                for (i, row) in block.iter().enumerate() {
                    for (j, &value) in row.iter().enumerate() {
                        dense[(node * K + i, other * K + j)] = value;
                    }
                }
            });
        }
        dense
    }
}
