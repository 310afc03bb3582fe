//! Many copies of one plant at once: the displacements of all nodes of all of them as a product of two matrices.
//!
//! U = S V (thesis 6.4.1): a row of S are the amplitudes of a copy's modes, or powers of their arc tangents, V their
//! displacements. V lies in tiles that stay in the nearest cache while the sums of some copies stay in registers.

#[cfg(test)]
mod tests;
mod tile;

use crate::beams::Beams;
use crate::bending::{Bending, Form};
use crate::modes::Modes;
use tile::Tiles;

/// Copies that one thread poses before it goes through all tiles again: their rows of S stay in the cache.
const BATCH: usize = 48;

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
    /// The nodes of beams with modes up to the amplitudes `q_max`, a number a mode, linear or by powers of one arc tangent
    /// a mode ([`Form::Node`] has no such product and is taken as [`Form::Mode`] with two).
    #[must_use]
    pub fn new(beams: &Beams, modes: &Modes, q_max: &[f64], form: Form) -> Self {
        let form = if form == Form::Node { Form::Mode(2) } else { form };
        let bendings: Vec<Bending> =
            q_max.iter().enumerate().map(|(mode, q)| Bending::new(beams, modes, mode, *q, form)).collect();
        let n_powers = bendings.first().map_or(1, |bending| bending.powers().len());
        // Row by row: all modes of the first power, then of the next.
        let rows =
            (0..n_powers).flat_map(|power| bendings.iter().map(move |bending| &bending.powers()[power]));
        let rows: Vec<Vec<f32>> =
            rows.map(|row| row.iter().flat_map(|v| v.iter().map(|v| *v as f32)).collect()).collect();
        let b = bendings.iter().map(|bending| bending.b().unwrap_or(0.0) as f32).collect();
        Self { n_nodes: beams.len(), b, n_powers, tiles: Tiles::new(&rows, 3 * beams.len()) }
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.b.len()
    }

    /// Numbers of a copy's pose: three a node.
    #[must_use]
    pub fn n_columns(&self) -> usize {
        3 * self.n_nodes
    }

    /// Displacements of all nodes of all copies, metres, `(n_copies, n_nodes, 3)`, from the amplitudes of their modes,
    /// `(n_copies, n_modes)`; on so many threads, with the same bits whatever their number.
    ///
    /// # Panics
    /// When sizes do not fit.
    pub fn pose(&self, amplitudes: &[f32], n_threads: usize, displacements: &mut [f32]) {
        let (n_modes, n_columns) = (self.n_modes(), self.n_columns());
        assert_eq!(amplitudes.len() / n_modes * n_columns, displacements.len(), "a row a copy");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads.max(1)).build();
        let batches = amplitudes.chunks(BATCH * n_modes).zip(displacements.chunks_mut(BATCH * n_columns));
        match pool {
            Ok(pool) if n_threads > 1 => pool.scope(|scope| {
                for (amplitudes, displacements) in batches {
                    scope.spawn(move |_| self.pose_batch(amplitudes, displacements));
                }
            }),
            _ => batches.for_each(|(amplitudes, displacements)| self.pose_batch(amplitudes, displacements)),
        }
    }

    fn pose_batch(&self, amplitudes: &[f32], displacements: &mut [f32]) {
        let n_modes = self.n_modes();
        let mut shares = Vec::with_capacity(amplitudes.len() * self.n_powers);
        for row in amplitudes.chunks(n_modes) {
            let first = shares.len();
            shares.extend(row.iter().zip(&self.b).map(|(q, b)| if *b == 0.0 { *q } else { (b * q).atan() }));
            for _ in 1..self.n_powers {
                for mode in 0..n_modes {
                    let last = shares[shares.len() - n_modes];
                    shares.push(last * shares[first + mode]);
                }
            }
        }
        self.tiles.multiply(&shares, displacements);
    }
}
