//! TAP-Vid-style npz: `points` (N, T, 2) f32 and `occluded` (N, T) bool; a `video` is passed over.
//!
//! Positions count from the corner of the top-left pixel; the published sets have them as shares of width and
//! height ([`Origin::Normalised`](crate::origin::Origin::Normalised)). NaN is a frame in which nothing is known;
//! an occluded point with a position is a predicted one. Pickles are never read: loading one runs its code.

use std::io::{BufReader, Read, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use honami_model::track::{Sample, Status};

use super::cells::narrow;
use super::draft::{self, Draft, Room};
use super::{Flaw, ForeignTracks, Outgoing, Tally, seen};
use crate::origin::Raster;

mod npy;

/// Entries of an archive; `np.savez` of the format has two or three.
const MAX_ENTRIES: usize = 1000;

pub(crate) fn parse(reader: impl Read + Seek, raster: Raster) -> Result<ForeignTracks, Flaw> {
    let mut archive = ZipArchive::new(reader).map_err(|error| zip_flaw("archive", &error))?;
    if archive.len() > MAX_ENTRIES {
        let came = archive.len().to_string();
        return Err(Flaw::wrong("archive", format!("at most {MAX_ENTRIES} arrays"), &came));
    }
    let mut room = Room::new();
    let (shape, occluded) = occluded(&mut archive, &mut room)?;
    let [n_tracks, n_frames] = shape;
    let mut points = entry(&mut archive, "points.npy")?;
    let head = npy::head(&mut points, "points")?;
    if head.shape[..] != [n_tracks, n_frames, 2] {
        let wanted = format!("the shape of occluded and 2: ({n_tracks}, {n_frames}, 2)");
        return Err(Flaw::wrong("points", wanted, &format!("{:?}", head.shape)));
    }
    let mut drafts = Vec::new();
    for (track, hidden) in occluded.chunks(n_frames.max(1)).enumerate() {
        let mut draft = Draft::default();
        for (frame, &hidden) in (0_u32..).zip(hidden) {
            let at = [head.number(&mut points, "points")?, head.number(&mut points, "points")?];
            if at.iter().any(|v| v.is_nan()) {
                continue;
            }
            let wrong = || Flaw::wrong(format!("points[{track}, {frame}]"), "pixels", &format!("{at:?}"));
            let at = narrow(raster.to_ours(at)).ok_or_else(wrong)?;
            draft.put(&mut room, frame, seen(at, hidden.then_some(0.0)))?;
        }
        drafts.push(draft);
    }
    drop(points);
    let mut tally = Tally::default();
    for name in names(&archive).iter().filter(|name| !["points.npy", "occluded.npy"].contains(&name.as_str()))
    {
        tally.add(if name == "video.npy" { "video" } else { "other arrays" });
    }
    Ok(ForeignTracks { tracks: draft::all(drafts)?, dropped: tally.lines(), ..ForeignTracks::default() })
}

/// Tracks and frames, and which samples are hidden, a track after the other.
fn occluded<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    room: &mut Room,
) -> Result<([usize; 2], Vec<bool>), Flaw> {
    let mut entry = entry(archive, "occluded.npy")?;
    let head = npy::head(&mut entry, "occluded")?;
    let &[n_tracks, n_frames] = &head.shape[..] else {
        return Err(Flaw::wrong("occluded", "the shape (tracks, frames)", &format!("{:?}", head.shape)));
    };
    let n = n_tracks.checked_mul(n_frames).ok_or(Flaw::TooMany)?;
    // Seen or not, each has its place in the arrays: an archive of a few bytes may claim any number of them.
    room.take(n)?;
    *room = Room::new();
    // Not reserved at once: what is claimed must be there first.
    let mut hidden = Vec::new();
    for _ in 0..n {
        hidden.push(head.flag(&mut entry, "occluded")?);
    }
    Ok(([n_tracks, n_frames], hidden))
}

fn entry<'a, R: Read + Seek>(
    archive: &'a mut ZipArchive<R>,
    name: &str,
) -> Result<BufReader<impl Read + use<'a, R>>, Flaw> {
    if archive.index_for_name(name).is_none() {
        let came = names(archive).join(", ");
        return Err(Flaw::wrong("archive", format!("the array {}", name.trim_end_matches(".npy")), &came));
    }
    let file = archive.by_name(name).map_err(|error| zip_flaw(name, &error))?;
    Ok(BufReader::with_capacity(1 << 16, file))
}

fn names<R: Read + Seek>(archive: &ZipArchive<R>) -> Vec<String> {
    archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect()
}

fn zip_flaw(at: &str, error: &zip::result::ZipError) -> Flaw {
    Flaw::wrong(at, "a zip archive as np.savez writes it", &error.to_string())
}

pub(crate) fn write(out: impl Write + Seek, raster: Raster, what: &Outgoing<'_>) -> std::io::Result<()> {
    let shape = [what.tracks.len(), what.n_frames as usize];
    let mut archive = ZipWriter::new(out);
    // Larger than 4 GiB needs other headers, which every reader of today knows.
    let large = shape[0].saturating_mul(shape[1]).saturating_mul(8) > (u32::MAX / 2) as usize;
    let options =
        SimpleFileOptions::default().compression_method(CompressionMethod::Deflated).large_file(large);
    archive.start_file("points.npy", options)?;
    archive.write_all(&npy::header("<f4", &[shape[0], shape[1], 2]))?;
    for_each(what, |sample| {
        let at =
            sample.filter(|sample| is_placed(sample)).map(|s| raster.from_ours([s.x.into(), s.y.into()]));
        let [x, y] = at.unwrap_or([f64::NAN; 2]).map(|v| (v as f32).to_le_bytes());
        archive.write_all(&x)?;
        archive.write_all(&y)
    })?;
    archive.start_file("occluded.npy", options)?;
    archive.write_all(&npy::header("|b1", &shape))?;
    for_each(what, |sample| {
        archive.write_all(&[u8::from(!sample.is_some_and(|sample| sample.status.is_seen()))])
    })?;
    archive.finish()?.flush()
}

/// Whether the position of a sample says something.
fn is_placed(sample: &Sample) -> bool {
    sample.status.is_seen() || sample.status == Status::Occluded
}

fn for_each(
    what: &Outgoing<'_>,
    mut each: impl FnMut(Option<&Sample>) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let frames = || 0..what.n_frames;
    what.tracks.iter().try_for_each(|track| frames().try_for_each(|frame| each(track.at(frame))))
}
