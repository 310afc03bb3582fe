//! CVAT for video, XML 1.1: tracks of points with keyframe, outside and occluded.
//!
//! `<track id label source><points frame keyframe outside occluded points="x,y" z_order/></track>`, as the
//! "XML annotation format" page of CVAT's manual has it. CVAT itself, when it loads such a file, takes the
//! key-frames alone, draws straight lines between them and holds the last one to the end of the clip, unless it
//! is outside. So that it shows what is seen where, the frames in which that changes are key-frames too, and a
//! shape of no sample ends each span. [`ADDED`] marks both; CVAT and others read no such attribute.

use std::io::{BufRead, Write};

use honami_model::track::{Quality, Sample, Source, Status};

use super::draft::{self, Draft, Room};
use super::xml::{Node, Tag, Xml, escaped};
use super::{Flaw, ForeignTrack, ForeignTracks, Outgoing, Tally};
use crate::origin::Raster;

/// The label of a track without a name.
const UNNAMED: &str = "track";

/// The attribute of shapes that CVAT needs and no hand has made: `key` on an ordinary sample that is a key-frame
/// there, `end` on a shape that is no sample.
const ADDED: &str = "honami";

/// Shapes that are no points.
const SHAPES: [&str; 7] = ["box", "polygon", "polyline", "ellipse", "mask", "cuboid", "skeleton"];

pub(crate) fn parse(reader: impl BufRead, raster: Raster) -> Result<ForeignTracks, Flaw> {
    let mut xml = Xml::new(reader);
    let (mut drafts, mut room, mut tally) = (Vec::new(), Room::new(), Tally::default());
    let mut size = [None; 2];
    while let Some(node) = xml.next()? {
        match node {
            Node::Open(tag) if xml.path().count() == 1 && tag.name != "annotations" => {
                return Err(Flaw::wrong("first element", "<annotations>", &format!("<{}>", tag.name)));
            }
            Node::Open(tag) if tag.name == "image" => {
                return Err(Flaw::wrong(
                    "element <image>",
                    "`CVAT for video 1.1`: export the task anew in that format",
                    "`CVAT for images`",
                ));
            }
            Node::Open(tag) if tag.name == "track" => {
                drafts.push(track(&mut xml, &tag, raster, &mut room, &mut tally)?);
            }
            Node::Text(text) => {
                let inner: Vec<&str> = xml.path().rev().take(2).collect();
                match inner[..] {
                    ["width", "original_size"] => size[0] = text.trim().parse().ok(),
                    ["height", "original_size"] => size[1] = text.trim().parse().ok(),
                    _ => {}
                }
            }
            Node::Open(_) | Node::Close => {}
        }
    }
    let mut seen = std::collections::BTreeSet::new();
    if let Some(twice) = drafts.iter().filter_map(|draft: &Draft| draft.number).find(|id| !seen.insert(*id)) {
        return Err(Flaw::wrong("<track>", "every id once", &twice.to_string()));
    }
    let size = size[0].zip(size[1]).map(|(width, height)| [width, height]);
    Ok(ForeignTracks { tracks: draft::all(drafts)?, size, dropped: tally.lines() })
}

fn track<R: BufRead>(
    xml: &mut Xml<R>,
    tag: &Tag,
    raster: Raster,
    room: &mut Room,
    tally: &mut Tally,
) -> Result<Draft, Flaw> {
    let mut draft = Draft::numbered(tag.need("id", "a whole number of 0 or more")?);
    draft.name = tag.get("label").filter(|&label| label != UNNAMED).map(str::to_owned);
    loop {
        match xml.next()? {
            Some(Node::Open(tag)) => {
                match tag.name.as_str() {
                    "points" if tag.get("points").is_some_and(|points| points.contains(';')) => {
                        tally.add("shapes of several points: only single ones are tracks");
                    }
                    "points" if tag.get(ADDED) == Some("end") => {}
                    "points" => {
                        let frame = tag.need("frame", "a whole number of 0 or more")?;
                        draft.put(room, frame, sample(&tag, raster)?)?;
                    }
                    name if SHAPES.contains(&name) => tally.add("boxes and other shapes that are no points"),
                    _ => {}
                }
                if tag.name == "points" { attributes(xml, tally)? } else { xml.skip()? }
            }
            Some(Node::Text(_)) => {}
            Some(Node::Close) | None => return Ok(draft),
        }
    }
}

/// Counts the attributes of a shape, to its end.
fn attributes<R: BufRead>(xml: &mut Xml<R>, tally: &mut Tally) -> Result<(), Flaw> {
    loop {
        match xml.next()? {
            Some(Node::Open(_)) => {
                tally.add("attributes of points");
                xml.skip()?;
            }
            Some(Node::Text(_)) => {}
            Some(Node::Close) | None => return Ok(()),
        }
    }
}

fn sample(tag: &Tag, raster: Raster) -> Result<Sample, Flaw> {
    let text = tag.get("points").unwrap_or_default();
    let wrong = || tag.wrong("points", "a position as x,y", text);
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |word: &str| word.trim().parse::<f64>().ok();
    let at = number(x).zip(number(y)).map(|(x, y)| raster.to_ours([x, y]).map(|v| v as f32));
    let [x, y] = at.filter(|at| at.iter().all(|v| v.is_finite())).ok_or_else(wrong)?;
    let status = match (tag.flag("outside")?, tag.flag("occluded")?) {
        (true, _) => Status::Outside,
        (false, true) => Status::Occluded,
        (false, false) => Status::Tracked,
    };
    let is_key = tag.flag("keyframe")? && tag.get(ADDED).is_none();
    let source = if is_key { Source::Key } else { Source::Imported };
    Ok(Sample { x, y, status, source, quality: Quality::default() })
}

pub(crate) fn write(mut out: impl Write, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    head(&mut out, what)?;
    for (at, track) in what.tracks.iter().enumerate() {
        let id = track.number.map_or_else(|| at.to_string(), |number| number.to_string());
        let (label, source) = (escaped(label(track)), source(track));
        writeln!(out, "  <track id=\"{id}\" label=\"{label}\" source=\"{source}\">")?;
        for shape in shapes(track, what) {
            let Shape { frame, sample, keyframe, added, gone } = shape;
            let (keyframe, outside) = (u8::from(keyframe), u8::from(gone));
            let occluded = u8::from(is_occluded(sample) && !gone);
            let added = added.map(|word| format!(" {ADDED}=\"{word}\"")).unwrap_or_default();
            let [x, y] = raster.from_ours([sample.x.into(), sample.y.into()]);
            writeln!(
                out,
                "    <points frame=\"{frame}\" keyframe=\"{keyframe}\" outside=\"{outside}\" \
                 occluded=\"{occluded}\" points=\"{x},{y}\" z_order=\"0\"{added}></points>"
            )?;
        }
        writeln!(out, "  </track>")?;
    }
    writeln!(out, "</annotations>")
}

/// A shape of a track as it is written.
#[derive(Clone, Copy)]
struct Shape<'a> {
    frame: u32,
    sample: &'a Sample,
    keyframe: bool,
    /// What [`ADDED`] says of it.
    added: Option<&'static str>,
    gone: bool,
}

/// The shapes of a track: its samples, and one behind every span that ends seen before the clip does.
fn shapes<'a>(track: &'a ForeignTrack, what: &Outgoing<'_>) -> impl Iterator<Item = Shape<'a>> {
    let (every_frame, n_frames) = (what.every_frame, what.n_frames);
    let mut samples = track.samples().peekable();
    // What CVAT shows until it is told otherwise: nothing.
    let mut shown = (true, false);
    std::iter::from_fn(move || {
        let (frame, sample) = samples.next()?;
        let gone = is_gone(sample);
        let now = (gone, is_occluded(sample));
        let is_key = every_frame || sample.source == Source::Key;
        let added = (!is_key && now != shown).then_some("key");
        shown = now;
        let of = Shape { frame, sample, keyframe: is_key || added.is_some(), added, gone };
        let next = frame.saturating_add(1);
        let ends = !gone && next < n_frames && samples.peek().is_none_or(|&(frame, _)| frame > next);
        let end = ends.then_some(Shape { frame: next, keyframe: true, added: Some("end"), gone: true, ..of });
        if ends {
            shown = (true, false);
        }
        Some(std::iter::once(of).chain(end))
    })
    .flatten()
}

fn is_gone(sample: &Sample) -> bool {
    matches!(sample.status, Status::Lost | Status::Outside | Status::Rejected)
}

fn is_occluded(sample: &Sample) -> bool {
    sample.status == Status::Occluded
}

/// Number of samples that CVAT itself does not load.
pub(crate) fn n_between(what: &Outgoing<'_>) -> usize {
    what.tracks.iter().flat_map(|track| shapes(track, what)).filter(|shape| !shape.keyframe).count()
}

fn label(track: &ForeignTrack) -> &str {
    track.name.as_deref().unwrap_or(UNNAMED)
}

/// The word of CVAT for who made a track.
fn source(track: &ForeignTrack) -> &'static str {
    let n_keys = track.samples().filter(|(_, sample)| sample.source == Source::Key).count();
    match n_keys {
        0 => "auto",
        n if n == track.n_samples() => "manual",
        _ => "semi-auto",
    }
}

fn head(out: &mut impl Write, what: &Outgoing<'_>) -> std::io::Result<()> {
    let labels: std::collections::BTreeSet<&str> = what.tracks.iter().map(label).collect();
    let ([width, height], n_frames) = (what.size, what.n_frames);
    writeln!(out, "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<annotations>\n  <version>1.1</version>")?;
    writeln!(out, "  <meta>\n    <task>\n      <size>{n_frames}</size>\n      <mode>interpolation</mode>")?;
    writeln!(out, "      <start_frame>0</start_frame>")?;
    writeln!(out, "      <stop_frame>{}</stop_frame>\n      <labels>", n_frames.saturating_sub(1))?;
    for label in labels {
        let label = escaped(label);
        writeln!(
            out,
            "        <label><name>{label}</name><type>points</type><attributes></attributes></label>"
        )?;
    }
    writeln!(out, "      </labels>\n      <original_size>")?;
    writeln!(out, "        <width>{width}</width>\n        <height>{height}</height>")?;
    writeln!(out, "      </original_size>\n    </task>\n  </meta>")
}
