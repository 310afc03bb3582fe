//! Joints over time:
//! `joint,parent,groups,frame,time_s,length_px,angle_rad,depth_rad,x_px,y_px,depth_px`.

use std::f64::consts::TAU;

use honami_model::skeleton::{Skeleton, seen};

use crate::table::{Fields, Line, Row, TableError, finite, whole};

/// A joint in a frame. The root has no bone, so no length and no angles.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleRow {
    /// The joint, from 0, the root.
    pub joint: u32,
    /// The joint that its bone begins at.
    pub parent: Option<u32>,
    /// Groups that it is the centre of, numbered from 1 as on the screen, with blanks between; empty for forks.
    pub groups: String,
    /// Frame of the clip.
    pub frame: u32,
    /// Its time, seconds.
    pub time_s: f64,
    /// Length of its bone, pixels; the same in every frame.
    pub length_px: Option<f64>,
    /// By how much its bone turns off that before it, in the picture, clockwise; off straight up where there is none.
    /// Radians above -π to π.
    pub angle_rad: Option<f64>,
    /// By how much its bone points away from the camera, radians -π/2 to π/2.
    pub depth_rad: Option<f64>,
    /// Where the joint is seen, pixels, right.
    pub x_px: f64,
    /// Pixels, down.
    pub y_px: f64,
    /// How far it is behind the root, away from the camera, pixels.
    pub depth_px: f64,
}

impl Row for AngleRow {
    const COLUMNS: &'static [&'static str] = &[
        "joint",
        "parent",
        "groups",
        "frame",
        "time_s",
        "length_px",
        "angle_rad",
        "depth_rad",
        "x_px",
        "y_px",
        "depth_px",
    ];
    const NEEDED: &'static [&'static str] = &["joint", "frame", "x_px", "y_px"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let (id, number) = ("a whole number of 0 or more", "a finite number");
        Ok(Self {
            joint: fields.required("joint", id, whole)?,
            parent: fields.optional("parent", id, whole)?,
            groups: fields.text("groups").unwrap_or_default().to_owned(),
            frame: fields.required("frame", id, whole)?,
            time_s: fields.optional("time_s", number, finite)?.unwrap_or_default(),
            length_px: fields.optional("length_px", number, finite)?,
            angle_rad: fields.optional("angle_rad", number, finite)?,
            depth_rad: fields.optional("depth_rad", number, finite)?,
            x_px: fields.required("x_px", number, finite)?,
            y_px: fields.required("y_px", number, finite)?,
            depth_px: fields.optional("depth_px", number, finite)?.unwrap_or_default(),
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.joint);
        line.maybe(self.parent);
        line.text(&self.groups);
        line.put(self.frame);
        line.number(self.time_s);
        line.maybe(self.length_px);
        line.maybe(self.angle_rad);
        line.maybe(self.depth_rad);
        line.number(self.x_px);
        line.number(self.y_px);
        line.number(self.depth_px);
    }
}

/// Rows of all joints, frame by frame, the first of which is numbered `first`.
pub(super) fn rows(skeleton: &Skeleton, first: u32) -> impl Iterator<Item = AngleRow> + '_ {
    let times = skeleton.times();
    (0..times.len()).flat_map(move |frame| {
        let directions = skeleton.directions(frame);
        let angle = |row: usize| if row == 0 { 0.0 } else { directions[row][0].atan2(directions[row][2]) };
        let row = move |(row, (joint, place)): (usize, (&honami_model::skeleton::Joint, [f64; 3]))| {
            let [x_px, y_px] = seen(place);
            let parent = joint.parent.map(|parent| parent as usize);
            let groups: Vec<String> = joint.groups.iter().map(|group| (group + 1).to_string()).collect();
            AngleRow {
                joint: row as u32,
                parent: joint.parent,
                groups: groups.join(" "),
                frame: first + frame,
                time_s: times.get(frame).unwrap_or_default(),
                length_px: parent.map(|_| joint.length),
                angle_rad: parent.map(|parent| wrapped(angle(row) - angle(parent))),
                depth_rad: parent.map(|_| directions[row][1].clamp(-1.0, 1.0).asin()),
                x_px,
                y_px,
                depth_px: place[1] - skeleton.root()[1],
            }
        };
        skeleton.joints().iter().zip(skeleton.places(directions)).enumerate().map(row).collect::<Vec<_>>()
    })
}

/// The same angle above -π, to π.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle / TAU) - 0.5).ceil()
}
