//! Leaves of a skeleton over time: `track,joint,frame,time_s,x_px,y_px,depth_px`.

use honami_model::skeleton::{Skeleton, seen};
use honami_model::track::TrackId;

use crate::table::{Fields, Line, Row, TableError, finite, whole};

/// Where a leaf is in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafRow {
    /// Its track; that of its mirror image, too.
    pub track: TrackId,
    /// The joint that carries it.
    pub joint: u32,
    /// Frame of the clip.
    pub frame: u32,
    /// Its time, seconds.
    pub time_s: f64,
    /// Where it is seen, pixels, right.
    pub x_px: f64,
    /// Pixels, down.
    pub y_px: f64,
    /// How far it is behind the root, away from the camera, pixels.
    pub depth_px: f64,
}

impl Row for LeafRow {
    const COLUMNS: &'static [&'static str] =
        &["track", "joint", "frame", "time_s", "x_px", "y_px", "depth_px"];
    const NEEDED: &'static [&'static str] = Self::COLUMNS;

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let (id, number) = ("a whole number of 0 or more", "a finite number");
        Ok(Self {
            track: TrackId(fields.required("track", id, whole)?),
            joint: fields.required("joint", id, whole)?,
            frame: fields.required("frame", id, whole)?,
            time_s: fields.required("time_s", number, finite)?,
            x_px: fields.required("x_px", number, finite)?,
            y_px: fields.required("y_px", number, finite)?,
            depth_px: fields.required("depth_px", number, finite)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.track);
        line.put(self.joint);
        line.put(self.frame);
        line.number(self.time_s);
        line.number(self.x_px);
        line.number(self.y_px);
        line.number(self.depth_px);
    }
}

/// Rows of all leaves, frame by frame, the first of which is numbered `first`.
pub(super) fn rows(skeleton: &Skeleton, first: u32) -> impl Iterator<Item = LeafRow> + '_ {
    let times = skeleton.times();
    (0..times.len()).flat_map(move |frame| {
        let places = skeleton.places(skeleton.directions(frame));
        let row = move |leaf: &honami_model::skeleton::Leaf| {
            let (from, by) = (places[leaf.joint as usize], leaf.offsets[frame as usize]);
            let place: [f64; 3] = std::array::from_fn(|axis| from[axis] + by[axis]);
            let [x_px, y_px] = seen(place);
            LeafRow {
                track: leaf.track,
                joint: leaf.joint,
                frame: first + frame,
                time_s: times.get(frame).unwrap_or_default(),
                x_px,
                y_px,
                depth_px: place[1] - skeleton.root()[1],
            }
        };
        skeleton.leaves().iter().map(row)
    })
}
