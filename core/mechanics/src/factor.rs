//! K - s M of a plant in factors: children are done before their parents, so that nothing fills in and all is linear in
//! the number of nodes.
//!
//! Stretching is many orders stiffer than bending, and a matrix K that is summed and then factored loses as many digits
//! of the bending. A tree is statically determinate: what a segment gives way under forces at its tip is known in closed
//! form, F, and K itself is never formed. With S, what a node and all that it bears add dynamically, the pivot of the
//! node is F^-1 + S, and what its parent feels is written without a difference of large numbers:
//! (F^-1 + S)^-1 = G (1 + G^T S G)^-1 G^T where F = G G^T. Without a shift, S = 0 and a solution is plain statics.

#[cfg(test)]
mod tests;

use crate::beams::Beams;
use crate::tree_matrix::{DOF, TreeMatrix};
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};

/// The factors of K - s M.
#[derive(Clone, Debug)]
pub struct Factor {
    nodes: Vec<Pivot>,
    n_negative: usize,
}

/// A node's pivot, inverted, and what its row has of its parent: the pivot's inverse times the link.
#[derive(Clone, Copy, Debug)]
struct Pivot {
    parent: Option<u32>,
    inverse: Matrix6<f64>,
    above: Matrix6<f64>,
}

/// A shift that is an eigenvalue of a part of the plant to the last digit: the pivot of this node is 0 or no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is singular at node {node}")]
pub struct Singular {
    /// Counted without the root.
    pub node: usize,
}

/// Right-hand sides at a time.
pub(crate) const WIDE: usize = 2;

/// How the segments of a plant give way.
#[derive(Clone, Debug)]
pub(crate) struct Flexibility {
    nodes: Vec<Flexible>,
}

/// The segment that leads to a node.
#[derive(Clone, Copy, Debug)]
struct Flexible {
    /// F = G G^T: displacement and rotation of the tip by forces and moments there, with the base clamped.
    root: Matrix6<f64>,
    /// What the tip does when the base moves and nothing is strained.
    carried: Matrix6<f64>,
}

impl Flexibility {
    pub(crate) fn new(beams: &Beams) -> Self {
        let flexible = |(_, _, section, direction): (usize, usize, crate::Section, Vector3<f64>)| Flexible {
            root: section.flexibility_root(&direction),
            carried: carried(&(direction * section.length)),
        };
        Self { nodes: beams.segments().map(flexible).collect() }
    }
}

/// Displacement and rotation at the end of a rigid arm.
fn carried(arm: &Vector3<f64>) -> Matrix6<f64> {
    let mut carried = Matrix6::identity();
    // psi x r = -r x psi.
    carried.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::zeros() - arm.cross_matrix()));
    carried
}

impl Factor {
    /// Factors K - s M.
    ///
    /// # Errors
    /// [`Singular`].
    pub(crate) fn new(flexibility: &Flexibility, mass: &TreeMatrix, shift: f64) -> Result<Self, Singular> {
        // S of every node: its own mass, then what its children add.
        let mut dynamic: Vec<Matrix6<f64>> = mass.nodes.iter().map(|block| block.own * -shift).collect();
        let empty = Pivot { parent: None, inverse: Matrix6::zeros(), above: Matrix6::zeros() };
        let (mut nodes, mut n_negative) = (vec![empty; mass.len()], 0);
        for (node, block) in mass.nodes.iter().enumerate().rev() {
            let (Flexible { root, carried }, borne) = (&flexibility.nodes[node], &dynamic[node]);
            let (middle, negative) =
                invert(&(Matrix6::identity() + root.tr_mul(borne) * root)).ok_or(Singular { node })?;
            n_negative += negative;
            let inverse = root * middle * root.transpose();
            // (F^-1 + S)^-1 F^-1.
            let still = Matrix6::identity() - inverse * borne;
            let follows = still * carried;
            let link = block.link * shift;
            let above = -follows - inverse * link;
            if let Some(parent) = block.parent {
                let across = follows.tr_mul(&link);
                let felt = carried.tr_mul(borne) * follows - across - across.transpose();
                dynamic[parent as usize] += felt - link.tr_mul(&(inverse * link));
            }
            nodes[node] = Pivot { parent: block.parent, inverse, above };
        }
        Ok(Self { nodes, n_negative })
    }

    /// How many eigenvalues of K x = lambda M x lie below the shift (Sylvester's law of inertia).
    #[must_use]
    pub fn n_negative(&self) -> usize {
        self.n_negative
    }

    /// Solves in place.
    ///
    /// # Panics
    /// When the vector is not 6 numbers a node.
    pub fn solve(&self, x: &mut [f64]) {
        self.solve_columns::<1>(x);
    }

    /// Solves for columns that lie one after the other.
    pub(crate) fn solve_columns<const N: usize>(&self, x: &mut [f64]) {
        let height = DOF * self.nodes.len();
        assert_eq!(x.len(), N * height, "6 numbers a node");
        let at = |x: &[f64], node: usize| {
            SMatrix::<f64, DOF, N>::from_fn(|row, column| x[column * height + DOF * node + row])
        };
        let put = |x: &mut [f64], node: usize, value: &SMatrix<f64, DOF, N>| {
            for column in 0..N {
                let place = column * height + DOF * node;
                x[place..place + DOF].copy_from_slice(value.column(column).as_slice());
            }
        };
        for (node, pivot) in self.nodes.iter().enumerate().rev() {
            if let Some(parent) = pivot.parent {
                let above = at(x, parent as usize) - pivot.above.tr_mul(&at(x, node));
                put(x, parent as usize, &above);
            }
        }
        for (node, pivot) in self.nodes.iter().enumerate() {
            let mut mine = pivot.inverse * at(x, node);
            if let Some(parent) = pivot.parent {
                mine -= pivot.above * at(x, parent as usize);
            }
            put(x, node, &mine);
        }
    }
}

/// The inverse of a symmetric block by L D L^T, and how many of its pivots are negative.
fn invert(block: &Matrix6<f64>) -> Option<(Matrix6<f64>, usize)> {
    let (mut lower, mut pivots) = (Matrix6::identity(), [0.0; DOF]);
    for j in 0..DOF {
        let pivot = block[(j, j)] - (0..j).map(|k| lower[(j, k)] * lower[(j, k)] * pivots[k]).sum::<f64>();
        // Blocks are near 1; whatever is left of it here is more than rounding.
        if !(pivot.is_finite() && pivot.abs() > f64::EPSILON) {
            return None;
        }
        pivots[j] = pivot;
        for i in j + 1..DOF {
            let sum: f64 = (0..j).map(|k| lower[(i, k)] * lower[(j, k)] * pivots[k]).sum();
            lower[(i, j)] = (block[(i, j)] - sum) / pivot;
        }
    }
    // The inverse of a unit lower triangle, forward.
    let mut inverse = Matrix6::identity();
    for column in 0..DOF {
        for i in column + 1..DOF {
            inverse[(i, column)] = -(column..i).map(|k| lower[(i, k)] * inverse[(k, column)]).sum::<f64>();
        }
    }
    let mut scaled = inverse;
    for (mut row, pivot) in scaled.row_iter_mut().zip(pivots) {
        row /= pivot;
    }
    let n_negative = pivots.iter().filter(|pivot| **pivot < 0.0).count();
    Some((inverse.tr_mul(&scaled), n_negative))
}
