//! TrackMate: its whole file (read) and its simple tracks (read and written).
//!
//! Whole: `TrackMate > Model > AllSpots > SpotsInFrame > Spot`, `AllTracks > Track > Edge`. Simple: `Tracks >
//! particle > detection t x y z`. Lengths are in the file's unit; the whole file says how wide a pixel is, the
//! simple one must count in pixels or be told. ImgLib2, below TrackMate, counts from pixel centres.

use std::io::{BufRead, Write};

use super::draft::{self, Draft, Room};
use super::xml::{Node, Tag, Xml};
use super::{Flaw, ForeignTracks, Outgoing, Tally, seen};
use crate::foreign::cells::narrow;
use crate::origin::Raster;

mod whole;

pub(crate) fn parse(
    reader: impl BufRead,
    raster: Raster,
    pixel_size: Option<f64>,
) -> Result<ForeignTracks, Flaw> {
    let mut xml = Xml::new(reader);
    while let Some(node) = xml.next()? {
        match node {
            Node::Open(tag) if tag.name == "TrackMate" => return whole::parse(xml, raster, pixel_size),
            Node::Open(tag) if tag.name == "Tracks" => return simple(xml, &tag, raster, pixel_size),
            Node::Open(tag) => {
                let came = format!("<{}>", tag.name);
                return Err(Flaw::wrong("first element", "<TrackMate> or <Tracks>", &came));
            }
            _ => {}
        }
    }
    Err(Flaw::wrong("file", "<TrackMate> or <Tracks>", ""))
}

fn simple<R: BufRead>(
    mut xml: Xml<R>,
    root: &Tag,
    raster: Raster,
    pixel_size: Option<f64>,
) -> Result<ForeignTracks, Flaw> {
    let unit = root.get("spaceUnits").unwrap_or("pixel");
    let pixel_size = match pixel_size {
        Some(size) => size,
        None if ["pixel", "pixels", "px", ""].contains(&unit) => 1.0,
        None => {
            return Err(root.wrong("spaceUnits", "pixel, or the width of a pixel (--pixel-size)", unit));
        }
    };
    let (mut drafts, mut room, mut tally) = (Vec::new(), Room::new(), Tally::default());
    while let Some(node) = xml.next()? {
        match node {
            Node::Open(tag) if tag.name == "particle" => drafts.push(Draft::default()),
            Node::Open(tag) if tag.name == "detection" => {
                let wrong = || tag.wrong("detection", "a <particle> around it", "none");
                let draft = drafts.last_mut().ok_or_else(wrong)?;
                let frame = frame(&tag, "t")?;
                if tag.get("z").is_some_and(|z| z.parse::<f64>().is_ok_and(|z| z.abs() > 0.0)) {
                    tally.add("heights z");
                }
                draft.put(&mut room, frame, sample(&tag, ["x", "y"], raster, pixel_size)?)?;
            }
            _ => {}
        }
    }
    Ok(ForeignTracks { tracks: draft::all(drafts)?, dropped: tally.lines(), ..ForeignTracks::default() })
}

/// A frame, which some versions write as `3.0`.
fn frame(tag: &Tag, attribute: &str) -> Result<u32, Flaw> {
    let number = tag.number(attribute)?;
    if number.fract().abs() > 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
        let came = tag.get(attribute).unwrap_or_default();
        return Err(tag.wrong(attribute, "a whole number of 0 or more", came));
    }
    Ok(number as u32)
}

fn sample(
    tag: &Tag,
    axes: [&str; 2],
    raster: Raster,
    pixel_size: f64,
) -> Result<honami_model::track::Sample, Flaw> {
    let at = [tag.number(axes[0])? / pixel_size, tag.number(axes[1])? / pixel_size];
    let came = tag.get(axes[0]).unwrap_or_default();
    let at = narrow(raster.to_ours(at)).ok_or_else(|| tag.wrong(axes[0], "pixels", came))?;
    Ok(seen(at, None))
}

pub(crate) fn write(mut out: impl Write, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    let interval = what.fps.map_or(1.0, |fps| 1.0 / fps);
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        out,
        "<Tracks nTracks=\"{}\" spaceUnits=\"pixel\" frameInterval=\"{interval}\" timeUnits=\"sec\" from=\"honami\">",
        what.tracks.len()
    )?;
    for track in what.tracks {
        let seen = || track.samples().filter(|(_, sample)| sample.status.is_seen());
        writeln!(out, "  <particle nSpots=\"{}\">", seen().count())?;
        for (frame, sample) in seen() {
            let [x, y] = raster.from_ours([sample.x.into(), sample.y.into()]);
            writeln!(out, "    <detection t=\"{frame}\" x=\"{x}\" y=\"{y}\" z=\"0.0\" />")?;
        }
        writeln!(out, "  </particle>")?;
    }
    writeln!(out, "</Tracks>")
}
