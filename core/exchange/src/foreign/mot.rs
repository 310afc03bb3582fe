//! MOTChallenge CSV: `frame,id,left,top,w,h,conf,x,y,z`, frames from 1, a point as the centre of its box.
//!
//! Boxes count from 1 (Milan et al. 2016, MOT16: "all values are 1-based"): a box of left 1 and width 1 covers
//! the leftmost pixels and no more, so that a box's centre lies (w - 1) / 2 right of `left`.

use std::collections::BTreeMap;
use std::io::{BufRead, Write};

use super::cells::{Cell, Cells, narrow};
use super::draft::{self, Draft, Room};
use super::{Flaw, ForeignTracks, Outgoing, Tally, seen, trust_of};
use crate::origin::Raster;

/// What each column holds.
const TITLES: [&str; 7] = ["frame", "id", "left", "top", "w", "h", "conf"];

pub(crate) fn parse(reader: impl BufRead, raster: Raster) -> Result<ForeignTracks, Flaw> {
    let mut cells = Cells::new(reader);
    let mut drafts: BTreeMap<u32, Draft> = BTreeMap::new();
    let (mut room, mut tally, mut first_box) = (Room::new(), Tally::default(), None);
    while let Some(row) = cells.next()? {
        if row.n_columns() < 6 {
            let wanted = "frame,id,left,top,w,h[,conf,x,y,z]";
            let came = row.words().collect::<Vec<_>>().join(",");
            return Err(Flaw::wrong(format!("line {}", row.line), wanted, &came));
        }
        let frame = whole(row, 0)?.checked_sub(1).ok_or_else(|| row.wrong("frame", "1 or more", "0"))?;
        let id = whole(row, 1)?;
        let [left, top, w, h] = [number(row, 2)?, number(row, 3)?, number(row, 4)?, number(row, 5)?];
        if w < 0.0 || h < 0.0 {
            return Err(row.wrong("w and h", "0 or more", &format!("{w},{h}")));
        }
        if *first_box.get_or_insert((w.to_bits(), h.to_bits())) != (w.to_bits(), h.to_bits()) {
            tally.add("boxes of other sizes than the first: only centres are kept");
        }
        let centre = raster.to_ours([left + (w - 1.0) / 2.0, top + (h - 1.0) / 2.0]);
        let at = narrow(centre).ok_or_else(|| row.wrong("left", "pixels", row.text(2)))?;
        // Confidences of detectors have any range, and -1 is none: those say nothing that we could keep.
        let trust = row.number(6, TITLES[6])?.map(|conf| conf as f32).filter(|c| (0.0..=1.0).contains(c));
        let draft = drafts.entry(id).or_insert_with(|| Draft::numbered(id));
        draft.put(&mut room, frame, seen(at, trust))?;
    }
    let tracks = draft::all(drafts.into_values())?;
    Ok(ForeignTracks { tracks, dropped: tally.lines(), ..ForeignTracks::default() })
}

fn number(row: Cell<'_>, column: usize) -> Result<f64, Flaw> {
    let title = TITLES[column];
    row.number(column, title)?.ok_or_else(|| row.wrong(title, "a finite number", row.text(column)))
}

/// Whole numbers are also written as `1.0`.
fn whole(row: Cell<'_>, column: usize) -> Result<u32, Flaw> {
    let number = number(row, column)?;
    if number.fract().abs() > 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
        return Err(row.wrong(TITLES[column], "a whole number of 0 or more", row.text(column)));
    }
    Ok(number as u32)
}

pub(crate) fn write(mut out: impl Write, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    let side = what.box_px;
    for frame in 0..what.n_frames {
        for (at, track) in what.tracks.iter().enumerate() {
            let sample = track.at(frame).and_then(|sample| Some((sample, trust_of(sample)?)));
            let Some((sample, trust)) = sample else { continue };
            let id = track.number.map_or_else(|| at.to_string(), |number| number.to_string());
            let [x, y] = raster.from_ours([sample.x.into(), sample.y.into()]);
            let [left, top] = [x, y].map(|centre| centre - (side - 1.0) / 2.0);
            writeln!(out, "{},{id},{left},{top},{side},{side},{trust},-1,-1,-1", frame + 1)?;
        }
    }
    Ok(())
}
