//! Many copies of one plant at once: the displacements of all nodes of all of them as a product of two matrices.
//!
//! U = S V (thesis 6.4.1): a row of S are the amplitudes of a copy's modes, or powers of their arc tangents, V their
//! displacements. V lies in tiles that stay in the nearest cache while the sums of some copies stay in registers.

mod arc;
#[cfg(test)]
mod tests;
mod tile;

use crate::bending::Bending;
use crate::threads::Threads;
use arc::arc_tangent;
use nalgebra::Vector3;
use pulp::Arch;
use tile::{PANEL, Tiles};

/// Copies that one thread poses before it goes through all tiles again: their rows of S stay in the cache.
pub(crate) const BATCH: usize = 8 * PANEL;

/// A plant ready to be posed.
#[derive(Clone, Debug)]
pub struct Rig {
    n_nodes: usize,
    /// b of every mode, or 0 where it moves linearly.
    b: Vec<f32>,
    n_powers: usize,
    tiles: Tiles,
}

impl Rig {
    /// Some nodes of the beams, in this order, by how all of them bend in every mode: linear or by powers of one arc tangent
    /// a mode, the same number in all modes.
    ///
    /// # Panics
    /// When a mode has an arc tangent a node ([`Form::Node`](crate::Form::Node)), of which there is no such product.
    #[must_use]
    pub fn new(bendings: &[Bending], nodes: &[u32]) -> Self {
        assert!(bendings.iter().all(Bending::is_product), "one arc tangent a mode, or none");
        let n_powers = bendings.first().map_or(1, |bending| bending.powers().len());
        let numbers = |row: &Vec<Vector3<f64>>| -> Vec<f32> {
            nodes.iter().flat_map(|&node| row[node as usize].iter().map(|v| *v as f32)).collect()
        };
        // Row by row, mode after mode, so that those of the first modes stand together.
        let rows: Vec<Vec<f32>> =
            bendings.iter().flat_map(|bending| bending.powers().iter().map(numbers)).collect();
        let b = bendings.iter().map(|bending| bending.b().unwrap_or(0.0) as f32).collect();
        Self { n_nodes: nodes.len(), b, n_powers, tiles: Tiles::new(&rows, 3 * nodes.len()) }
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.b.len()
    }

    /// Nodes that it poses.
    pub(crate) fn n_nodes(&self) -> usize {
        self.n_nodes
    }

    /// Numbers of a copy's pose: three a node.
    #[must_use]
    pub fn n_columns(&self) -> usize {
        3 * self.n_nodes
    }

    /// Memory of the matrix, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.tiles.bytes()
    }

    /// Displacements of all nodes of all copies, metres, `(n_copies, n_nodes, 3)`, from the amplitudes of their modes,
    /// `(n_copies, n_modes)`; the same bits on any number of threads.
    ///
    /// # Panics
    /// When sizes do not fit.
    pub fn pose(&self, amplitudes: &[f32], threads: &Threads, displacements: &mut [f32]) {
        let (n_modes, n_columns) = (self.n_modes(), self.n_columns());
        assert_eq!(amplitudes.len() / n_modes * n_columns, displacements.len(), "a row a copy");
        let batches = amplitudes.chunks(BATCH * n_modes).zip(displacements.chunks_mut(BATCH * n_columns));
        threads.each(batches, |(amplitudes, displacements)| {
            self.pose_batch(amplitudes.chunks(n_modes), n_modes, displacements);
        });
    }

    /// Displacements of the first nodes of some copies, so many as there is room for in a row of `displacements` a copy,
    /// by the first `n_modes` of their amplitudes; the same bits whatever is left out.
    pub(crate) fn pose_batch<'a>(
        &self,
        amplitudes: impl ExactSizeIterator<Item = &'a [f32]>,
        n_modes: usize,
        displacements: &mut [f32],
    ) {
        let (n_columns, n_rows) = (displacements.len() / amplitudes.len().max(1), n_modes * self.n_powers);
        let mut panels = vec![[0.0; PANEL]; amplitudes.len().div_ceil(PANEL) * n_rows];
        let mut turned = vec![0.0; n_modes];
        for (copy, row) in amplitudes.enumerate() {
            self.arcs(row, &mut turned);
            let panel = &mut panels[copy / PANEL * n_rows..][..n_rows];
            for (shares, s) in panel.chunks_exact_mut(self.n_powers).zip(&turned) {
                let mut power = 1.0;
                for shares in shares {
                    power *= s;
                    shares[copy % PANEL] = power;
                }
            }
        }
        self.tiles.multiply(&panels, n_rows, n_columns, displacements);
    }

    /// s of the first modes.
    fn arcs(&self, row: &[f32], turned: &mut [f32]) {
        let bent = self.n_powers > 1;
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for ((s, q), b) in turned.iter_mut().zip(row).zip(&self.b) {
                    *s = if bent { arc_tangent(b * q) } else { *q };
                }
            },
        );
    }
}
