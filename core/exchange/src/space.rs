//! Tables of tracks in space.

use honami_model::space::Fix;
use honami_model::track::TrackId;

use crate::table::{Fields, Line, Row, TableError, finite, whole};

const COUNT: &str = "a whole number of 0 or more";
const NUMBER: &str = "a finite number";

/// A fix of a track in space: `track,frame,time_s,x_m,y_m,z_m,ex_m,ey_m,ez_m,residual_px`.
///
/// Places and their standard errors are metres in the left camera's axes: x right, y down, z forward.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceRow {
    /// The track.
    pub track: TrackId,
    /// When its frame is, seconds.
    pub time_s: f64,
    /// Where it is.
    pub fix: Fix,
}

impl Row for SpaceRow {
    const COLUMNS: &'static [&'static str] =
        &["track", "frame", "time_s", "x_m", "y_m", "z_m", "ex_m", "ey_m", "ez_m", "residual_px"];
    const NEEDED: &'static [&'static str] = &["track", "frame", "time_s", "x_m", "y_m", "z_m"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let place = |column| fields.required(column, NUMBER, finite);
        // Where a table says nothing of errors, they are not known to be other than 0.
        let error = |column| Ok::<f32, TableError>(fields.optional(column, NUMBER, finite)?.unwrap_or(0.0));
        Ok(Self {
            track: TrackId(fields.required("track", COUNT, whole)?),
            time_s: place("time_s")?,
            fix: Fix {
                frame: fields.required("frame", COUNT, whole)?,
                place_m: [place("x_m")?, place("y_m")?, place("z_m")?],
                errors_m: [error("ex_m")?, error("ey_m")?, error("ez_m")?],
                residual_px: error("residual_px")?,
            },
        })
    }

    fn put(&self, line: &mut Line) {
        let Fix { frame, place_m, errors_m, residual_px } = self.fix;
        line.put(self.track);
        line.put(frame);
        line.number(self.time_s);
        place_m.into_iter().for_each(|c| line.number(c));
        errors_m.into_iter().chain([residual_px]).for_each(|c| line.number(c));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Writer, read};

    #[test]
    fn a_row_comes_back_with_every_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let row = |frame: u32| SpaceRow {
            track: TrackId(7),
            time_s: f64::from(frame) / 25.0,
            fix: Fix {
                frame,
                place_m: [0.1, -1.0 / 3.0, 2.000_000_001],
                errors_m: [1e-4, 2e-4, 1.5e-3],
                residual_px: 0.31,
            },
        };
        let mut table = Writer::create(&path).unwrap();
        (0..3).for_each(|frame| table.write(&row(frame)).unwrap());
        table.finish().unwrap();
        let back: Result<Vec<SpaceRow>, _> = read(&path).unwrap().collect();
        assert_eq!(back.unwrap(), [row(0), row(1), row(2)]);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.starts_with("track,frame,time_s,x_m,y_m,z_m,ex_m,ey_m,ez_m,residual_px\n7,0,0,0.1,"),
            "{text}"
        );
    }
}
