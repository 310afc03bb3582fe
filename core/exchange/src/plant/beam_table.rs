//! The beams that a plant was made into: `node,parent,x,y,z,radius`, the root first and without a parent.

use crate::table::{Fields, Line, Row, TableError, finite, whole};

/// A node, and the beam that leads to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamRow {
    /// From 0.
    pub node: u32,
    /// The node at the base of the beam; `None` for the root.
    pub parent: Option<u32>,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Metres, up.
    pub z: f64,
    /// Of the beam, metres.
    pub radius: f64,
}

impl Row for BeamRow {
    const COLUMNS: &'static [&'static str] = &["node", "parent", "x", "y", "z", "radius"];
    const NEEDED: &'static [&'static str] = Self::COLUMNS;

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let (number, place) = ("a whole number of 0 or more", "a finite number");
        Ok(Self {
            node: fields.required("node", number, whole)?,
            parent: fields.optional("parent", number, whole)?,
            x: fields.required("x", place, finite)?,
            y: fields.required("y", place, finite)?,
            z: fields.required("z", place, finite)?,
            radius: fields.required("radius", place, finite)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.node);
        line.maybe(self.parent);
        line.number(self.x);
        line.number(self.y);
        line.number(self.z);
        line.number(self.radius);
    }
}
