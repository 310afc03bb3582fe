//! Poses by curves: U = S V (thesis 6.4.1), where a row of S are the amplitudes of a copy's modes, or powers of their arc
//! tangents, and V their displacements.

use super::arc::arc_tangent;
use super::tile::{PANEL, Tiles};
use crate::bending::Bending;
use nalgebra::Vector3;
use pulp::Arch;

/// A plant whose nodes follow curves.
#[derive(Clone, Debug)]
pub(super) struct Curves {
    /// b of every mode, or 0 where it moves linearly.
    b: Vec<f32>,
    n_powers: usize,
    tiles: Tiles,
}

impl Curves {
    pub(super) fn new(bendings: &[Bending], nodes: &[u32]) -> Self {
        assert!(bendings.iter().all(Bending::is_product), "one arc tangent a mode, or none");
        let n_powers = bendings.first().map_or(1, |bending| bending.powers().len());
        let numbers = |row: &Vec<Vector3<f64>>| -> Vec<f32> {
            nodes.iter().flat_map(|&node| row[node as usize].iter().map(|v| *v as f32)).collect()
        };
        // Row by row, mode after mode, so that those of the first modes stand together.
        let rows: Vec<Vec<f32>> =
            bendings.iter().flat_map(|bending| bending.powers().iter().map(numbers)).collect();
        let b = bendings.iter().map(|bending| bending.b().unwrap_or(0.0) as f32).collect();
        Self { b, n_powers, tiles: Tiles::new(&rows, 3 * nodes.len()) }
    }

    pub(super) fn bytes(&self) -> usize {
        self.tiles.bytes()
    }

    /// Rows of V that the first modes have.
    pub(super) fn n_rows(&self, n_modes: usize) -> usize {
        n_modes * self.n_powers
    }

    /// Powers of the arc tangents of a copy's first modes, into its place in a panel.
    pub(super) fn shares(&self, row: &[f32], place: usize, panel: &mut [[f32; PANEL]]) {
        let mut turned = vec![0.0; panel.len() / self.n_powers];
        self.arcs(row, &mut turned);
        for (shares, s) in panel.chunks_exact_mut(self.n_powers).zip(&turned) {
            let mut power = 1.0;
            for shares in shares {
                power *= s;
                shares[place] = power;
            }
        }
    }

    pub(super) fn pose(
        &self,
        panels: &[[f32; PANEL]],
        n_rows: usize,
        displacements: &mut [f32],
        n_copies: usize,
    ) {
        self.tiles.multiply(panels, n_rows, displacements.len() / n_copies, displacements);
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
