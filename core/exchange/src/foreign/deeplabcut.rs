//! DeepLabCut CSV: header lines `scorer`, (`individuals`,) `bodyparts`, `coords`, then a row a frame.
//!
//! Columns x, y and, where a network made it, likelihood. The first column is the frame, or, in tables of
//! labelled pictures, ends in their name, whose last number is the frame. A missing point is an empty cell.

use std::io::{BufRead, Write};

use honami_model::track::Sample;

use super::cells::{Cell, Cells, narrow};
use super::draft::{self, Draft, Room};
use super::{Flaw, ForeignTrack, ForeignTracks, Outgoing, seen, trust_of};
use crate::origin::{Origin, Raster};

/// Before the number of a track that has no name.
const PREFIX: &str = "track_";

/// The columns of a track.
struct Columns {
    called: String,
    x: usize,
    y: Option<usize>,
    likelihood: Option<usize>,
}

pub(crate) fn parse(reader: impl BufRead, raster: Raster) -> Result<ForeignTracks, Flaw> {
    let mut cells = Cells::new(reader);
    let columns = header(&mut cells)?;
    let first = columns.first().map_or(1, |columns| columns.x);
    let mut drafts: Vec<Draft> = columns.iter().map(|columns| named(&columns.called)).collect();
    let mut room = Room::new();
    while let Some(row) = cells.next()? {
        let frame = frame_of(row, first)?;
        for (columns, draft) in columns.iter().zip(&mut drafts) {
            if let Some(sample) = sample(row, columns, raster)? {
                draft.put(&mut room, frame, sample)?;
            }
        }
    }
    Ok(ForeignTracks { tracks: draft::all(drafts)?, ..ForeignTracks::default() })
}

fn header<R: BufRead>(cells: &mut Cells<R>) -> Result<Vec<Columns>, Flaw> {
    let mut titles: Vec<Vec<String>> = Vec::new();
    loop {
        let row = cells.need("the header lines scorer, bodyparts, coords")?;
        let name = row.first().cloned().unwrap_or_default();
        let known = ["scorer", "individuals", "bodyparts", "coords"].contains(&name.as_str());
        if !known || titles.len() == 4 {
            let wanted = "the header lines scorer, bodyparts, coords";
            return Err(Flaw::wrong(format!("line {}", titles.len() + 1), wanted, &name));
        }
        titles.push(row);
        if name == "coords" {
            break;
        }
    }
    let coords = titles.pop().unwrap_or_default();
    let who = |column: usize| {
        let parts = titles.iter().filter(|row| row.first().is_some_and(|name| name != "scorer"));
        let parts = parts.filter_map(|row| row.get(column)).map(String::as_str);
        parts.filter(|part| !part.is_empty() && *part != "single").collect::<Vec<_>>().join(" ")
    };
    let mut columns: Vec<Columns> = Vec::new();
    for (column, coord) in coords.iter().enumerate().skip(1) {
        let called = who(column);
        let is_first = columns.is_empty();
        let current = columns.last_mut().filter(|columns| columns.called == called);
        match (coord.as_str(), current) {
            ("x", _) => columns.push(Columns { called, x: column, y: None, likelihood: None }),
            ("y", Some(current)) if current.y.is_none() => current.y = Some(column),
            ("likelihood", Some(current)) => current.likelihood = Some(column),
            // Tables of labelled pictures have their names in up to three columns.
            ("", None) if is_first => {}
            (other, _) => {
                let at = format!("line coords, column {}", column + 1);
                return Err(Flaw::wrong(at, "x, y or likelihood of one body part", other));
            }
        }
    }
    match columns.iter().find(|columns| columns.y.is_none()) {
        Some(columns) => Err(Flaw::wrong("line coords", format!("a column y of {}", columns.called), "none")),
        None if columns.is_empty() => Err(Flaw::wrong("line coords", "columns x and y", "none")),
        None => Ok(columns),
    }
}

fn named(called: &str) -> Draft {
    match called.strip_prefix(PREFIX).and_then(|number| number.parse().ok()) {
        Some(number) => Draft::numbered(number),
        None => Draft { name: Some(called.to_owned()), ..Draft::default() },
    }
}

/// The frame of a row: a number, or the last number in the name of a picture.
fn frame_of(row: Cell<'_>, first: usize) -> Result<u32, Flaw> {
    let text =
        (0..first).rev().map(|column| row.text(column)).find(|text| !text.is_empty()).unwrap_or_default();
    if let Ok(frame) = text.parse() {
        return Ok(frame);
    }
    let stem = text.rsplit_once('.').map_or(text, |(stem, _)| stem);
    let digits: String = stem.chars().rev().take_while(char::is_ascii_digit).collect();
    let digits: String = digits.chars().rev().collect();
    digits.parse().map_err(|_no_number| row.wrong("1", "a frame, or a picture whose name ends in one", text))
}

fn sample(row: Cell<'_>, columns: &Columns, raster: Raster) -> Result<Option<Sample>, Flaw> {
    let y = columns.y.unwrap_or(columns.x);
    let titles = [format!("x of {}", columns.called), format!("y of {}", columns.called)];
    let Some(at) = row.position([columns.x, y], [&titles[0], &titles[1]])? else { return Ok(None) };
    let title = format!("likelihood of {}", columns.called);
    let trust = match columns.likelihood {
        Some(column) => row.number(column, &title)?.map(|trust| trust as f32),
        None => None,
    };
    if trust.is_some_and(|trust| !(0.0..=1.0).contains(&trust)) {
        let came = columns.likelihood.map_or("", |column| row.text(column));
        return Err(row.wrong(&title, "a number from 0 to 1", came));
    }
    let at =
        narrow(raster.to_ours(at)).ok_or_else(|| row.wrong(&titles[0], "pixels", row.text(columns.x)))?;
    Ok(Some(seen(at, trust)))
}

pub(crate) fn write(out: impl Write, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let parts = body_parts(what.tracks);
    let header = |name: &str, cells: &dyn Fn(&str) -> [String; 3]| {
        std::iter::once(name.to_owned()).chain(parts.iter().flat_map(|part| cells(part))).collect::<Vec<_>>()
    };
    table.write_record(header("scorer", &|_| ["honami"; 3].map(str::to_owned)))?;
    table.write_record(header("bodyparts", &|part| [part; 3].map(str::to_owned)))?;
    table.write_record(header("coords", &|_| ["x", "y", "likelihood"].map(str::to_owned)))?;
    for frame in 0..what.n_frames {
        table.write_field(frame.to_string())?;
        for track in what.tracks {
            let sample = track.at(frame).and_then(|sample| Some((sample, trust_of(sample)?)));
            let Some((sample, trust)) = sample else {
                ["", "", ""].iter().try_for_each(|cell| table.write_field(cell))?;
                continue;
            };
            for value in position(raster, sample) {
                table.write_field(value)?;
            }
            table.write_field(trust.to_string())?;
        }
        table.write_record(None::<&[u8]>)?;
    }
    table.flush()
}

/// A position in the shortest form that reads back to the same bits.
pub(crate) fn position(raster: Raster, sample: &Sample) -> [String; 2] {
    if raster.origin == Origin::Centre {
        return [sample.x.to_string(), sample.y.to_string()];
    }
    raster.from_ours([sample.x.into(), sample.y.into()]).map(|v| v.to_string())
}

/// A name for every track, each once.
fn body_parts(tracks: &[ForeignTrack]) -> Vec<String> {
    let mut used = std::collections::BTreeSet::new();
    let part = |(at, track): (usize, &ForeignTrack)| {
        let number = track.number.map_or_else(|| at.to_string(), |number| number.to_string());
        let name = track.name.clone().unwrap_or_else(|| format!("{PREFIX}{number}"));
        if used.insert(name.clone()) {
            return name;
        }
        let name = format!("{name}_{number}");
        used.insert(name.clone());
        name
    };
    tracks.iter().enumerate().map(part).collect()
}
