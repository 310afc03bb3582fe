//! Symmetric matrices of a plant: each node is coupled to itself and to its parent alone.

use crate::beams::Beams;
use crate::element::{Ends, Section};
use nalgebra::{Matrix6, Vector3, Vector6};

/// Degrees of freedom a node.
pub(crate) const DOF: usize = 6;

/// A symmetric matrix over the nodes of a tree, 6 x 6 numbers a node and a node's link to its parent. Vectors are
/// 6 numbers a node, node after node.
#[derive(Clone, Debug)]
pub struct TreeMatrix {
    pub(crate) nodes: Vec<Block>,
}

/// A node's own block, and its row in its parent's columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// `None` where the parent is clamped.
    pub(crate) parent: Option<u32>,
    pub(crate) own: Matrix6<f64>,
    pub(crate) link: Matrix6<f64>,
}

impl TreeMatrix {
    /// Sums what every segment adds; the root, node 0, is clamped and has no rows.
    pub(crate) fn of_segments(beams: &Beams, of: impl Fn(&Section, &Vector3<f64>) -> Ends) -> Self {
        let free = |node: usize| node.checked_sub(1);
        let empty = |parent: Option<u32>| Block {
            parent: parent.and_then(|parent| parent.checked_sub(1)),
            own: Matrix6::zeros(),
            link: Matrix6::zeros(),
        };
        let mut nodes: Vec<Block> = beams.nodes().iter().skip(1).map(|node| empty(node.parent)).collect();
        for (base, tip, section, direction) in beams.segments() {
            let ends = of(&section, &direction);
            let Some(tip) = free(tip) else { continue };
            nodes[tip].own += ends.tip;
            if let Some(base) = free(base) {
                nodes[tip].link = ends.across;
                nodes[base].own += ends.base;
            }
        }
        Self { nodes }
    }

    pub(crate) fn add(&mut self, node: usize, more: &Matrix6<f64>) {
        self.nodes[node].own += more;
    }

    /// Nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The product with a vector.
    ///
    /// # Panics
    /// When the vector is not 6 numbers a node.
    pub fn times(&self, x: &[f64], product: &mut [f64]) {
        assert_eq!((x.len(), product.len()), (DOF * self.len(), DOF * self.len()), "6 numbers a node");
        let at = |x: &[f64], node: usize| Vector6::from_column_slice(&x[DOF * node..DOF * (node + 1)]);
        for (node, block) in self.nodes.iter().enumerate() {
            let mine = at(x, node);
            let mut sum = block.own * mine;
            if let Some(parent) = block.parent {
                sum += block.link * at(x, parent as usize);
                // The parent comes first: its own share is there already.
                let share = block.link.tr_mul(&mine);
                let place = &mut product[DOF * parent as usize..DOF * (parent as usize + 1)];
                place.iter_mut().zip(share.iter()).for_each(|(sum, share)| *sum += share);
            }
            product[DOF * node..DOF * (node + 1)].copy_from_slice(sum.as_slice());
        }
    }
}
