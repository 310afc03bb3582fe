//! The three tables: tracks, points to track, and truth.

use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use crate::table::{Fields, Line, Row, TableError, finite, whole};

const ID: &str = "a whole number of 0 or more";
const NUMBER: &str = "a finite number";

/// A sample of a track: `track,frame,time_s,x,y,status,source,quality,fb,ncc,run`.
///
/// `status` is the number of [`Status`] (its word is read too), `source` the word of [`Source`], `quality` is
/// [`trust`] of `fb` and `ncc` (written for those who plot; on reading the two parts decide), `run` is empty
/// for hand work. Only `track,frame,x,y` are needed on reading: the rest is taken as tracked and imported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackRow {
    /// The track.
    pub track: TrackId,
    /// Frame, from 0.
    pub frame: u32,
    /// Presentation time of the frame, seconds; unknown where a foreign table has none.
    pub time_s: Option<f64>,
    /// Position, status, source and quality.
    pub sample: Sample,
    /// The run that found it.
    pub run: Option<u64>,
}

/// One number for how far a sample can be trusted, 0 (not at all) to 1; `None` where nothing was measured.
///
/// The lesser of max(ncc, 0) and 1 / (1 + fb), fb in pixels: the worst measured part decides, and a
/// forward-backward error of one pixel halves the trust.
#[must_use]
pub fn trust(quality: Quality) -> Option<f32> {
    let from_ncc = quality.ncc.map(|ncc| ncc.clamp(0.0, 1.0));
    let from_fb = quality.fb_px.map(|fb_px| 1.0 / (1.0 + fb_px.max(0.0)));
    [from_ncc, from_fb].into_iter().flatten().reduce(f32::min)
}

pub(crate) fn status_from(text: &str) -> Option<Status> {
    let numbered = || Status::from_u8(text.parse().ok()?);
    let words = ["lost", "tracked", "occluded", "outside", "rejected", "newborn"];
    numbered().or_else(|| Status::from_u8(u8::try_from(words.iter().position(|&word| word == text)?).ok()?))
}

pub(crate) fn source_from(text: &str) -> Option<Source> {
    [Source::Key, Source::Sketch, Source::Tracked, Source::Interpolated, Source::Imported]
        .into_iter()
        .find(|source| source.word() == text)
}

impl Row for TrackRow {
    const COLUMNS: &'static [&'static str] =
        &["track", "frame", "time_s", "x", "y", "status", "source", "quality", "fb", "ncc", "run"];
    const NEEDED: &'static [&'static str] = &["track", "frame", "x", "y"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let status = fields.optional("status", "0 to 5, or lost, tracked, …, newborn", status_from)?;
        let source =
            fields.optional("source", "key, sketch, tracked, interpolated or imported", source_from)?;
        fields.optional("quality", "a number from 0 to 1", |text| {
            finite::<f32>(text).filter(|q| (0.0..=1.0).contains(q))
        })?;
        Ok(Self {
            track: TrackId(fields.required("track", ID, whole)?),
            frame: fields.required("frame", ID, whole)?,
            time_s: fields.optional("time_s", NUMBER, finite)?,
            sample: Sample {
                x: fields.required("x", NUMBER, finite)?,
                y: fields.required("y", NUMBER, finite)?,
                status: status.unwrap_or(Status::Tracked),
                source: source.unwrap_or(Source::Imported),
                quality: Quality {
                    fb_px: fields.optional("fb", NUMBER, finite)?,
                    ncc: fields.optional("ncc", NUMBER, finite)?,
                },
            },
            run: fields.optional("run", ID, whole)?,
        })
    }

    fn put(&self, line: &mut Line) {
        let Sample { x, y, status, source, quality } = self.sample;
        line.put(self.track);
        line.put(self.frame);
        line.maybe(self.time_s);
        line.number(x);
        line.number(y);
        line.put(status as u8);
        line.put(source.word());
        line.maybe(trust(quality));
        line.maybe(quality.fb_px);
        line.maybe(quality.ncc);
        match self.run {
            Some(run) => line.put(run),
            None => line.put(""),
        }
    }
}

/// A point to track: `id,x,y[,frame]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// Number of the point.
    pub id: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// The frame it is given in; the first, where it is left out.
    pub frame: Option<u32>,
}

impl Row for PointRow {
    const COLUMNS: &'static [&'static str] = &["id", "x", "y", "frame"];
    const NEEDED: &'static [&'static str] = &["id", "x", "y"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        Ok(Self {
            id: fields.required("id", ID, whole)?,
            x: fields.required("x", NUMBER, finite)?,
            y: fields.required("y", NUMBER, finite)?,
            frame: fields.optional("frame", ID, whole)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.id);
        line.number(self.x);
        line.number(self.y);
        line.maybe(self.frame);
    }
}

/// Where a point of a generated clip truly is: `track,frame,x,y,visible,branch`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthRow {
    /// The point.
    pub track: u32,
    /// Frame, from 0.
    pub frame: u32,
    /// Pixels, right.
    pub x: f32,
    /// Pixels, down.
    pub y: f32,
    /// Whether it can be seen: inside the picture and behind nothing. Written as 1 or 0.
    pub visible: bool,
    /// The branch it hangs on.
    pub branch: u32,
}

impl Row for TruthRow {
    const COLUMNS: &'static [&'static str] = &["track", "frame", "x", "y", "visible", "branch"];
    const NEEDED: &'static [&'static str] = Self::COLUMNS;

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        Ok(Self {
            track: fields.required("track", ID, whole)?,
            frame: fields.required("frame", ID, whole)?,
            x: fields.required("x", NUMBER, finite)?,
            y: fields.required("y", NUMBER, finite)?,
            visible: fields.required("visible", "1 or 0", |text| match text {
                "1" | "true" => Some(true),
                "0" | "false" => Some(false),
                _ => None,
            })?,
            branch: fields.required("branch", ID, whole)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.track);
        line.put(self.frame);
        line.number(self.x);
        line.number(self.y);
        line.put(u8::from(self.visible));
        line.put(self.branch);
    }
}

/// The group of a track: `track,group,name`.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupRow {
    /// The track.
    pub track: TrackId,
    /// Its group, numbered from 1 as on the screen.
    pub group: u32,
    /// What a person calls the group; empty where nobody has named it.
    pub name: String,
}

impl Row for GroupRow {
    const COLUMNS: &'static [&'static str] = &["track", "group", "name"];
    const NEEDED: &'static [&'static str] = &["track", "group"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        Ok(Self {
            track: TrackId(fields.required("track", ID, whole)?),
            group: fields
                .required("group", "a whole number of 1 or more", |text| whole(text).filter(|&g| g > 0))?,
            name: fields.text("name").unwrap_or_default().to_owned(),
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.track);
        line.put(self.group);
        line.text(&self.name);
    }
}
