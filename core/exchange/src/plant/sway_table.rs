//! Where sensors of a plant are over time: `sensor,node,frame,time_s,x,y,z`.

use crate::table::{Fields, Line, Row, TableError, finite, whole};

/// Where a sensor is in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwayRow {
    /// The sensor, from 0.
    pub sensor: u32,
    /// The node that it sits on, of the beams.
    pub node: u32,
    /// Frame, from 0.
    pub frame: u32,
    /// Its time, seconds.
    pub time_s: f64,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Metres, up.
    pub z: f64,
}

impl Row for SwayRow {
    const COLUMNS: &'static [&'static str] = &["sensor", "node", "frame", "time_s", "x", "y", "z"];
    const NEEDED: &'static [&'static str] = Self::COLUMNS;

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let (number, place) = ("a whole number of 0 or more", "a finite number");
        Ok(Self {
            sensor: fields.required("sensor", number, whole)?,
            node: fields.required("node", number, whole)?,
            frame: fields.required("frame", number, whole)?,
            time_s: fields.required("time_s", place, finite)?,
            x: fields.required("x", place, finite)?,
            y: fields.required("y", place, finite)?,
            z: fields.required("z", place, finite)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.sensor);
        line.put(self.node);
        line.put(self.frame);
        line.number(self.time_s);
        line.number(self.x);
        line.number(self.y);
        line.number(self.z);
    }
}
