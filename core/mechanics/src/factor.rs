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
use crate::six::{self, DOF, Six, add, add_transposed, minus, product, put, rows, sum, transposed};
use crate::tree_matrix::TreeMatrix;
use nalgebra::{Matrix6, Vector3};
use pulp::Arch;

/// The factors of K - s M.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    nodes: Vec<Pivot>,
    n_negative: usize,
}

/// A node's pivot, inverted, and what its row has of its parent: the pivot's inverse times the link.
#[derive(Clone, Copy, Debug)]
struct Pivot {
    parent: Option<u32>,
    above: Six,
    inverse: Six,
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
    /// From base to tip.
    arm: Vector3<f64>,
}

impl Flexibility {
    pub(crate) fn new(beams: &Beams) -> Self {
        let flexible = |(_, _, section, direction): (usize, usize, crate::element::Section, Vector3<f64>)| {
            Flexible { root: section.flexibility_root(&direction), arm: direction * section.length }
        };
        Self { nodes: beams.segments().map(flexible).collect() }
    }
}

/// `a` times what a rigid arm does to its end when its base moves: displacement u + psi x r, rotation psi.
#[inline(always)]
fn carried(a: &Six, arm: &Vector3<f64>) -> Six {
    let (mut carried, [x, y, z]) = (*a, [arm.x, arm.y, arm.z]);
    for k in 0..DOF {
        carried[3][k] += a[2][k] * y - a[1][k] * z;
        carried[4][k] += a[0][k] * z - a[2][k] * x;
        carried[5][k] += a[1][k] * x - a[0][k] * y;
    }
    carried
}

impl Factor {
    /// Factors K - s M.
    ///
    /// # Errors
    /// [`Singular`].
    pub(crate) fn new(flexibility: &Flexibility, mass: &TreeMatrix, shift: f64) -> Result<Self, Singular> {
        let empty = Pivot { parent: None, above: six::ZERO, inverse: six::ZERO };
        let mut nodes = vec![empty; mass.len()];
        let n_negative = Arch::new().dispatch(
            #[inline(always)]
            || eliminated(flexibility, mass, shift, |node, pivot| nodes[node] = pivot),
        )?;
        Ok(Self { nodes, n_negative })
    }

    /// How many eigenvalues of K x = lambda M x lie below a shift, with no factors kept.
    ///
    /// # Errors
    /// [`Singular`].
    pub(crate) fn count(flexibility: &Flexibility, mass: &TreeMatrix, shift: f64) -> Result<usize, Singular> {
        Arch::new().dispatch(
            #[inline(always)]
            || eliminated(flexibility, mass, shift, |_, _| ()),
        )
    }

    /// How many eigenvalues of K x = lambda M x lie below the shift (Sylvester's law of inertia).
    pub(crate) fn n_negative(&self) -> usize {
        self.n_negative
    }

    /// Solves in place, for as many columns as there are, one after the other.
    ///
    /// # Panics
    /// When a column is not 6 numbers a node.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let height = DOF * self.nodes.len();
        assert!(x.len().is_multiple_of(height), "6 numbers a node");
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for x in x.chunks_mut(WIDE * height) {
                    if x.len() == height { self.solve_columns::<1>(x) } else { self.solve_columns::<WIDE>(x) }
                }
            },
        );
    }

    #[inline(always)]
    fn solve_columns<const N: usize>(&self, x: &mut [f64]) {
        for (node, pivot) in self.nodes.iter().enumerate().rev() {
            if let Some(parent) = pivot.parent {
                let mut above = rows::<N>(x, parent as usize);
                add_transposed(&pivot.above, &minus(rows::<N>(x, node)), &mut above);
                put(x, parent as usize, &above);
            }
        }
        for (node, pivot) in self.nodes.iter().enumerate() {
            let mut mine = [[0.0; N]; DOF];
            add(&pivot.inverse, &rows::<N>(x, node), &mut mine);
            if let Some(parent) = pivot.parent {
                add(&pivot.above, &minus(rows::<N>(x, parent as usize)), &mut mine);
            }
            put(x, node, &mine);
        }
    }
}

/// Eliminates all nodes, the last first; the number of negative pivots.
#[inline(always)]
fn eliminated(
    flexibility: &Flexibility,
    mass: &TreeMatrix,
    shift: f64,
    mut keep: impl FnMut(usize, Pivot),
) -> Result<usize, Singular> {
    let mut n_negative = 0;
    // S of every node: its own mass, then what its children add.
    let mut dynamic: Vec<Six> =
        mass.nodes.iter().map(|block| sum(&six::ZERO, &block.own.data.0, -shift)).collect();
    for (node, block) in mass.nodes.iter().enumerate().rev() {
        let (Flexible { root, arm }, borne) = (&flexibility.nodes[node], &dynamic[node]);
        let (root, root_across) = (&root.data.0, transposed(&root.data.0));
        let inner = sum(&six::unit(), &product(&root_across, &product(borne, root)), 1.0);
        let (middle, negative) = invert(&inner).ok_or(Singular { node })?;
        n_negative += negative;
        let inverse = product(root, &product(&middle, &root_across));
        // (F^-1 + S)^-1 F^-1 = 1 - (F^-1 + S)^-1 S.
        let follows = carried(&sum(&six::unit(), &product(&inverse, borne), -1.0), arm);
        let link = sum(&six::ZERO, &block.link.data.0, shift);
        let pulled = product(&inverse, &link);
        let above = sum(&sum(&six::ZERO, &follows, -1.0), &pulled, -1.0);
        if let Some(parent) = block.parent {
            // The transpose of a product with the arm is the product of the transpose.
            let felt = transposed(&carried(&transposed(&product(borne, &follows)), arm));
            let across = product(&transposed(&follows), &link);
            let drawn = product(&transposed(&link), &pulled);
            let place = &mut dynamic[parent as usize];
            *place = sum(place, &felt, 1.0);
            *place = sum(place, &across, -1.0);
            *place = sum(place, &transposed(&across), -1.0);
            *place = sum(place, &drawn, -1.0);
        }
        keep(node, Pivot { parent: block.parent, above, inverse });
    }
    Ok(n_negative)
}

/// The inverse of a symmetric block by L D L^T, and how many of its pivots are negative.
#[inline(always)]
#[expect(clippy::needless_range_loop, reason = "rows and columns of triangles")]
fn invert(block: &Six) -> Option<(Six, usize)> {
    // By columns: of the triangle and, beside it, of what is left of the block.
    let (mut lower, mut left, mut pivots) = (six::unit(), *block, [0.0; DOF]);
    for j in 0..DOF {
        let pivot = left[j][j];
        // Blocks are near 1; whatever is left of it here is more than rounding.
        if !(pivot.is_finite() && pivot.abs() > f64::EPSILON) {
            return None;
        }
        pivots[j] = pivot;
        for i in j + 1..DOF {
            lower[j][i] = left[j][i] / pivot;
        }
        for k in j + 1..DOF {
            for i in k..DOF {
                left[k][i] -= lower[j][i] * left[j][k];
            }
        }
    }
    // The inverse of a unit lower triangle, forward.
    let mut inverse = six::unit();
    for column in 0..DOF {
        for i in column + 1..DOF {
            inverse[column][i] = -(column..i).map(|k| lower[k][i] * inverse[column][k]).sum::<f64>();
        }
    }
    let mut scaled = transposed(&inverse);
    for (column, pivot) in scaled.iter_mut().zip(pivots) {
        column.iter_mut().for_each(|v| *v /= pivot);
    }
    let n_negative = pivots.iter().filter(|pivot| **pivot < 0.0).count();
    Some((product(&scaled, &inverse), n_negative))
}
