//! Plants: branches as nodes on a tree, each with the radius of the wood there. Metres, z up, right-handed.

#[cfg(test)]
mod tests;

use crate::brief::Brief;

/// A plant has no segment thicker at its base than so many times what it is at its tip: else a twig would begin with
/// the radius of the trunk that bears it.
const TAPER_MAX: f64 = 1.5;

/// A point of a plant's axis; all but the root end the segment that leads to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Row of the node before it, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Metres.
    pub position: [f64; 3],
    /// Of the wood here, metres; more than 0.
    pub radius: f64,
}

/// What radius a segment has that was measured at its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RadiusRule {
    /// The mean of both ends, the base taken as no more than half as thick again as the tip.
    #[default]
    Mean,
    /// That of its tip.
    Tip,
}

impl RadiusRule {
    /// Radii that a segment has at its base and at its tip, metres, from those of the nodes there.
    #[must_use]
    pub fn ends(self, base: f64, tip: f64) -> [f64; 2] {
        match self {
            Self::Mean => [base.min(TAPER_MAX * tip), tip],
            Self::Tip => [tip, tip],
        }
    }

    /// Radius of the segment from a node to a node, metres.
    #[must_use]
    pub fn radius(self, base: f64, tip: f64) -> f64 {
        let [base, tip] = self.ends(base, tip);
        f64::midpoint(base, tip)
    }
}

/// A plant at rest. Its nodes are one tree, each after its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    nodes: Vec<Node>,
}

/// Why nodes are no plant.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// A root alone has no segment.
    #[error("a plant has two nodes at least, this one has {0}")]
    TooFew(usize),
    /// Not one root, in row 0.
    #[error("node {node} has no parent: a plant has one root, its first node")]
    Root {
        /// Row.
        node: usize,
    },
    /// The root with a parent, or a child before its parent, which a cycle cannot avoid.
    #[error("node {node} has parent {parent}, which does not come before it")]
    Order {
        /// Row.
        node: usize,
        /// Row that it names.
        parent: u32,
    },
    /// A coordinate that is no number, or a radius that is none or not above 0.
    #[error("node {node} lies at {position:?} m with radius {} m", Brief(*radius))]
    Measure {
        /// Row.
        node: usize,
        /// Metres.
        position: [f64; 3],
        /// Metres.
        radius: f64,
    },
}

impl Plant {
    /// Checks the nodes.
    ///
    /// # Errors
    /// [`PlantError`] for the first node that breaks a rule.
    pub fn new(nodes: Vec<Node>) -> Result<Self, PlantError> {
        if nodes.len() < 2 || u32::try_from(nodes.len()).is_err() {
            return Err(PlantError::TooFew(nodes.len()));
        }
        for (row, &Node { parent, position, radius }) in nodes.iter().enumerate() {
            match parent {
                None if row > 0 => return Err(PlantError::Root { node: row }),
                Some(parent) if parent as usize >= row => {
                    return Err(PlantError::Order { node: row, parent });
                }
                _ => {}
            }
            let is_measured = position.iter().chain([&radius]).all(|v| v.is_finite()) && radius > 0.0;
            if !is_measured {
                return Err(PlantError::Measure { node: row, position, radius });
            }
        }
        Ok(Self { nodes })
    }

    /// Its nodes, each after its parent.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// From the root to the highest node, metres.
    #[must_use]
    pub fn height(&self) -> f64 {
        let root = self.nodes.first().map_or(0.0, |root| root.position[2]);
        self.nodes.iter().map(|node| node.position[2] - root).fold(0.0, f64::max)
    }
}
