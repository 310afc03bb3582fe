//! Symmetric matrices of a plant: each node is coupled to itself and to its parent alone.

use crate::beams::Beams;
use crate::element::{Ends, Section};
use crate::factor::WIDE;
use crate::six::{DOF, add, add_transposed, put, rows};
use nalgebra::{Matrix6, Vector3};
use pulp::Arch;

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

    /// Of every node its parent, `None` where that is clamped; its own block, and its rows in its parent's columns, column
    /// by column.
    pub fn blocks(&self) -> impl Iterator<Item = (Option<u32>, [[[f64; DOF]; DOF]; 2])> {
        self.nodes.iter().map(|block| (block.parent, [block.own.data.0, block.link.data.0]))
    }

    /// The product with as many columns as there are, one after the other.
    ///
    /// # Panics
    /// When a column is not 6 numbers a node.
    pub fn times(&self, x: &[f64], product: &mut [f64]) {
        let height = DOF * self.len();
        assert!(x.len() == product.len() && x.len().is_multiple_of(height), "6 numbers a node");
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for (x, product) in x.chunks(WIDE * height).zip(product.chunks_mut(WIDE * height)) {
                    if x.len() == height {
                        self.times_columns::<1>(x, product);
                    } else {
                        self.times_columns::<WIDE>(x, product);
                    }
                }
            },
        );
    }

    #[inline(always)]
    fn times_columns<const N: usize>(&self, x: &[f64], product: &mut [f64]) {
        for (node, block) in self.nodes.iter().enumerate() {
            let (mine, mut sums) = (rows::<N>(x, node), [[0.0; N]; DOF]);
            add(&block.own.data.0, &mine, &mut sums);
            if let Some(parent) = block.parent {
                add(&block.link.data.0, &rows::<N>(x, parent as usize), &mut sums);
                // The parent comes first: its own share is there already.
                let mut place = rows::<N>(product, parent as usize);
                add_transposed(&block.link.data.0, &mine, &mut place);
                put(product, parent as usize, &place);
            }
            put(product, node, &sums);
        }
    }
}
