//! Many copies of one plant at once: the displacements of all nodes of all of them as a product of two matrices.
//!
//! What modes do lies in tiles that stay in the nearest cache while the sums of some copies stay in registers.

mod arc;
mod curves;
#[cfg(test)]
mod tests;
mod tile;
mod turns;

use crate::stirring::Following;
use crate::threads::Threads;
use curves::Curves;
use tile::PANEL;
use turns::Turns;

/// Copies that one thread poses before it goes through all tiles again: their rows of S stay in the cache.
pub(crate) const BATCH: usize = 8 * PANEL;

/// A plant ready to be posed.
#[derive(Clone, Debug)]
pub struct Rig {
    n_nodes: usize,
    n_modes: usize,
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    Curves(Curves),
    Turns(Turns),
}

impl Rig {
    /// Some nodes of the beams, in this order, by how they follow the modes.
    ///
    /// # Panics
    /// When a mode has an arc tangent a node ([`Form::Node`](crate::Form::Node)), of which there is no product.
    #[must_use]
    pub fn new(following: &Following, nodes: &[u32]) -> Self {
        let way = match following {
            Following::Curves(bendings) => Way::Curves(Curves::new(bendings, nodes)),
            Following::Turns(turning) => Way::Turns(Turns::new(turning, nodes)),
        };
        Self { n_nodes: nodes.len(), n_modes: following.n_modes(), way }
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.n_modes
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
        match &self.way {
            Way::Curves(curves) => curves.bytes(),
            Way::Turns(turns) => turns.bytes(),
        }
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
        let n_copies = amplitudes.len();
        let n_rows = match &self.way {
            Way::Curves(curves) => curves.n_rows(n_modes),
            Way::Turns(_) => n_modes,
        };
        if n_rows == 0 || n_copies == 0 {
            return displacements.fill(0.0);
        }
        let mut panels = vec![[0.0; PANEL]; n_copies.div_ceil(PANEL) * n_rows];
        for (copy, row) in amplitudes.enumerate() {
            let panel = &mut panels[copy / PANEL * n_rows..][..n_rows];
            match &self.way {
                Way::Curves(curves) => curves.shares(row, copy % PANEL, panel),
                Way::Turns(_) => panel.iter_mut().zip(row).for_each(|(share, q)| share[copy % PANEL] = *q),
            }
        }
        match &self.way {
            Way::Curves(curves) => curves.pose(&panels, n_rows, displacements, n_copies),
            Way::Turns(turns) => turns.pose(&panels, n_rows, displacements, n_copies),
        }
    }
}
