//! DLTdv xypts CSV: `pt1_cam1_X,pt1_cam1_Y,…`, a row a frame, NaN where a point is missing.
//!
//! DLTdv 8 counts from (1, 1) at the top left; 5 to 7 and Argus from (1, 1) at the bottom left.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, Write};

use super::cells::{Cells, narrow};
use super::deeplabcut::position;
use super::draft::{self, Draft, Room};
use super::{Flaw, ForeignTracks, Outgoing, seen};
use crate::origin::Raster;

pub(crate) fn parse(
    reader: impl BufRead,
    raster: Raster,
    camera: Option<u32>,
) -> Result<ForeignTracks, Flaw> {
    let mut cells = Cells::new(reader);
    let titles = cells.need("the columns pt1_cam1_X, pt1_cam1_Y and so on")?;
    let points = points(&titles, camera)?;
    let mut drafts: Vec<Draft> = points.keys().map(|&number| Draft::numbered(number)).collect();
    let (mut room, mut frame) = (Room::new(), 0_u32);
    while let Some(row) = cells.next()? {
        if row.n_columns() != titles.len() {
            let came = format!("{} columns", row.n_columns());
            return Err(Flaw::wrong(
                format!("line {}", row.line),
                format!("{} columns", titles.len()),
                &came,
            ));
        }
        for (&[x, y], draft) in points.values().zip(&mut drafts) {
            let Some(at) = row.position([x, y], [&titles[x], &titles[y]])? else { continue };
            let wrong = || row.wrong(&titles[x], "pixels", row.text(x));
            draft.put(&mut room, frame, seen(narrow(raster.to_ours(at)).ok_or_else(wrong)?, None))?;
        }
        frame = frame.saturating_add(1);
    }
    Ok(ForeignTracks { tracks: draft::all(drafts)?, ..ForeignTracks::default() })
}

/// The columns of every point of one camera.
fn points(titles: &[String], camera: Option<u32>) -> Result<BTreeMap<u32, [usize; 2]>, Flaw> {
    let mut found: BTreeMap<(u32, u32), [Option<usize>; 2]> = BTreeMap::new();
    for (column, title) in titles.iter().enumerate() {
        let wrong =
            || Flaw::wrong(format!("line 1, column {}", column + 1), "a title like pt1_cam1_X", title);
        let (point, camera, axis) = parts(title).ok_or_else(wrong)?;
        let place = &mut found.entry((camera, point)).or_default()[axis];
        if place.replace(column).is_some() {
            return Err(Flaw::wrong("line 1", "every title once", title));
        }
    }
    let cameras: BTreeSet<u32> = found.keys().map(|&(camera, _)| camera).collect();
    let known: Vec<String> = cameras.iter().map(u32::to_string).collect();
    let camera = match camera {
        Some(camera) if cameras.contains(&camera) => camera,
        None if cameras.len() == 1 => cameras.first().copied().unwrap_or_default(),
        _ => {
            let wanted = format!("one of the cameras {} (--camera)", known.join(", "));
            let came = camera.map_or_else(|| "none".to_owned(), |camera| camera.to_string());
            return Err(Flaw::wrong("line 1", wanted, &came));
        }
    };
    let of_camera = found.into_iter().filter(|((of, _), _)| *of == camera);
    of_camera
        .map(|((_, point), [x, y])| match (x, y) {
            (Some(x), Some(y)) => Ok((point, [x, y])),
            _ => Err(Flaw::wrong("line 1", format!("pt{point}_cam{camera}_X and _Y"), "one of them")),
        })
        .collect()
}

/// Point, camera and axis of a title.
fn parts(title: &str) -> Option<(u32, u32, usize)> {
    let title = title.to_ascii_lowercase();
    let (point, rest) = title.strip_prefix("pt")?.split_once("_cam")?;
    let (camera, axis) = rest.split_once('_')?;
    let axis = ["x", "y"].iter().position(|known| *known == axis)?;
    Some((point.parse().ok()?, camera.parse().ok()?, axis))
}

pub(crate) fn write(out: impl Write, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let title = |point: usize| [format!("pt{point}_cam1_X"), format!("pt{point}_cam1_Y")];
    table.write_record((1..=what.tracks.len()).flat_map(title))?;
    for frame in 0..what.n_frames {
        for track in what.tracks {
            let sample = track.at(frame);
            let sample = sample.filter(|sample| sample.status.is_seen());
            let cells = sample.map_or_else(|| ["NaN", "NaN"].map(str::to_owned), |s| position(raster, s));
            cells.iter().try_for_each(|cell| table.write_field(cell))?;
        }
        table.write_record(None::<&[u8]>)?;
    }
    table.flush()
}
