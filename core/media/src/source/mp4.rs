//! H.264 in MP4 without any installed program: 8-bit 4:2:0 progressive, what cameras and phones mostly write.
//!
//! The container is read here, the stream is decoded by rusty_h264, which gives the same bits as ffmpeg (tested on
//! every clip; openh264 does not where B-frames use direct prediction: up to 25 levels off in a clip of reeds).

use std::collections::BTreeMap;
use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::picture::Range;
use rusty_h264_decoder::{DecodeError, Decoder};

use super::{Decode, Probed, Shape, Source, check_size, seconds, turned};
use crate::error::{MediaError, Size};
use boxes::{children, find, u16_at, u32_at};
use sps::Sps;
use table::{Sample, Table};

mod boxes;
mod sps;
mod table;

/// Reads the container's index and the stream's parameters.
pub(crate) fn probe(path: &Path) -> Result<Probed, MediaError> {
    let needs_ffmpeg =
        |what: &str| MediaError::NeedsFfmpeg { path: path.to_path_buf(), what: what.to_owned() };
    let file = File::open(path).map_err(|e| MediaError::io("read", path, e))?;
    let file_len = file.metadata().map_err(|e| MediaError::io("read", path, e))?.len();
    let moov = boxes::read_index(path, &file, file_len)?;
    if find(&moov, &[b"mvex"]).is_some() {
        return Err(needs_ffmpeg("a fragmented MP4"));
    }
    let tracks = children(&moov).filter(|(name, _)| name == b"trak").map(|(_, body)| body);
    let Some(trak) = tracks.into_iter().find(|trak| is_video(trak)) else {
        let why = "no video stream in it".to_owned();
        return Err(MediaError::NotAVideo { path: path.to_path_buf(), why });
    };
    let entries = find(trak, &[b"mdia", b"minf", b"stbl", b"stsd"]).and_then(|stsd| stsd.get(8..));
    let avc1 = match entries.and_then(|entries| children(entries).next()) {
        Some((name, body)) if &name == b"avc1" => body,
        Some((name, _)) => return Err(needs_ffmpeg(&format!("{} video", String::from_utf8_lossy(&name)))),
        None => return Err(MediaError::damaged(path, "its index names no codec")),
    };
    let no_parameters = || MediaError::damaged(path, "its H.264 parameters cannot be read");
    let avcc = avc1.get(AVC1_LEN..).and_then(|inner| find(inner, &[b"avcC"])).ok_or_else(no_parameters)?;
    let parameters = parameters(avcc).ok_or_else(no_parameters)?;
    let sps = parameters.iter().find_map(|unit| Sps::parse(unit)).ok_or_else(no_parameters)?;
    if let Some(what) = sps.beyond_builtin() {
        return Err(needs_ffmpeg(what));
    }
    let (width, height) = check_size(path, sps.width, sps.height)?;
    let range = if sps.full_range { Range::Full } else { Range::Limited };
    let shape = Shape { width, height, colour: true, range };
    let table = Table::read(path, &moov, trak, file_len)?;
    let times_s = seconds(table.kept_times(), 1, table.timescale);
    let oblong = "its pixels are not square: positions are in stored pixels".to_owned();
    let notes = if sps.square { Vec::new() } else { vec![oblong] };
    let head = parameters.iter().flat_map(|unit| START_CODE.iter().chain(*unit)).copied().collect();
    let length_size = usize::from(avcc[4] & 3) + 1;
    let source = Video { path: path.to_path_buf(), shape, head, table: Arc::new(table), length_size };
    Ok(turned(Probed { shape, times_s, notes, source: Box::new(source) }, quarters_clockwise(trak)))
}

/// Start code of a unit in a byte stream (H.264 annex B).
const START_CODE: [u8; 4] = [0, 0, 0, 1];

/// Bytes of a visual sample entry before the boxes in it.
const AVC1_LEN: usize = 78;

fn is_video(trak: &[u8]) -> bool {
    find(trak, &[b"mdia", b"hdlr"]).and_then(|hdlr| hdlr.get(8..12)) == Some(b"vide")
}

/// Sequence and picture parameter sets of a decoder configuration (ISO/IEC 14496-15, 5.3.3.1).
fn parameters(avcc: &[u8]) -> Option<Vec<&[u8]>> {
    let mut units = Vec::new();
    let mut at = 5;
    for mask in [0x1f, 0xff] {
        let n = avcc.get(at)? & mask;
        at += 1;
        for _ in 0..n {
            let len = usize::from(u16_at(avcc, at)?);
            units.push(avcc.get(at + 2..at + 2 + len)?);
            at += 2 + len;
        }
    }
    Some(units)
}

/// Quarter turns that make the picture upright, from the track's matrix; other matrices are not honoured.
fn quarters_clockwise(trak: &[u8]) -> u32 {
    let Some(tkhd) = find(trak, &[b"tkhd"]) else { return 0 };
    let start = if tkhd.first() == Some(&1) { 52 } else { 40 };
    let sign = |k: usize| u32_at(tkhd, start + 4 * k).map_or(0, |value| value.cast_signed().signum());
    // Row by row: a b u, c d v; x' = a x + c y, y' = b x + d y.
    match [0, 1, 3, 4].map(sign) {
        [0, 1, -1, 0] => 1,
        [-1, 0, 0, -1] => 2,
        [0, -1, 1, 0] => 3,
        _ => 0,
    }
}

struct Video {
    path: PathBuf,
    shape: Shape,
    table: Arc<Table>,
    /// Sequence and picture parameters, which come before the first sample.
    head: Arc<[u8]>,
    /// Bytes of the length before each unit in a sample.
    length_size: usize,
}

impl Source for Video {
    fn recipe(&self) -> String {
        "rusty_h264 0.17, planes 1".to_owned()
    }

    fn decode(&self, _wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        let mut running = Running {
            path: self.path.clone(),
            shape: self.shape,
            table: Arc::clone(&self.table),
            length_size: self.length_size,
            file: File::open(&self.path).map_err(|e| MediaError::io("read", &self.path, e))?,
            decoder: Decoder::new(),
            n_fed: 0,
            n_shown: 0,
            early: BTreeMap::new(),
        };
        running.decode(&self.head)?;
        Ok((0, Box::new(running)))
    }
}

struct Running {
    path: PathBuf,
    shape: Shape,
    table: Arc<Table>,
    length_size: usize,
    file: File,
    decoder: Decoder,
    /// Samples given to the decoder.
    n_fed: usize,
    /// Pictures that have had their turn in display order.
    n_shown: usize,
    /// Pictures decoded before their turn, by their place in display order.
    early: BTreeMap<usize, Vec<u8>>,
}

impl Decode for Running {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        loop {
            while let Some(picture) = self.early.remove(&self.n_shown) {
                let kept = self.table.keeps(self.n_shown);
                self.n_shown += 1;
                if kept {
                    frame.copy_from_slice(&picture);
                    return Ok(true);
                }
            }
            let Some(&sample) = self.table.samples.get(self.n_fed) else { return Ok(false) };
            let picture = self.picture(sample)?;
            self.early.insert(sample.place, picture);
            self.n_fed += 1;
        }
    }
}

impl Running {
    /// Decodes one sample: one picture, whose place in display order the container knows.
    fn picture(&mut self, sample: Sample) -> Result<Vec<u8>, MediaError> {
        let at = self.n_fed;
        let mut stored = vec![0; sample.len as usize];
        self.file
            .read_exact_at(&mut stored, sample.offset)
            .map_err(|e| MediaError::io("read", &self.path, e))?;
        let stream = annex_b(&stored, self.length_size);
        let stream =
            stream.ok_or_else(|| MediaError::damaged(&self.path, format!("sample {at} is not H.264")))?;
        let planes = self.decode(&stream)?;
        planes.ok_or_else(|| MediaError::damaged(&self.path, format!("sample {at} holds no picture")))
    }

    /// Gives units to the decoder; the planes of the picture that they complete.
    fn decode(&mut self, stream: &[u8]) -> Result<Option<Vec<u8>>, MediaError> {
        let picture = self.decoder.decode(stream).map_err(|error| match error {
            DecodeError::Unsupported(what) => {
                MediaError::NeedsFfmpeg { path: self.path.clone(), what: format!("H.264 with {what}") }
            }
            other => {
                MediaError::damaged(&self.path, format!("sample {} does not decode: {other}", self.n_fed))
            }
        })?;
        let Some(picture) = picture else { return Ok(None) };
        let found = Size(picture.width as u32, picture.height as u32);
        let first = Size(self.shape.width, self.shape.height);
        if found != first {
            let (path, frame) = (self.path.clone(), self.n_shown as u32);
            return Err(MediaError::SizeChange { path, frame, found, first });
        }
        let planes = [picture.y, picture.u, picture.v].concat();
        match planes.len() == self.shape.frame_len() {
            true => Ok(Some(planes)),
            false => Err(MediaError::damaged(&self.path, "its pictures are not 4:2:0")),
        }
    }
}

/// Replaces the length before each unit by a start code; `None` when the lengths do not add up.
fn annex_b(stored: &[u8], length_size: usize) -> Option<Vec<u8>> {
    let mut stream = Vec::with_capacity(stored.len() + 16);
    let mut rest = stored;
    while !rest.is_empty() {
        let (length, after) = rest.split_at_checked(length_size)?;
        let length = length.iter().fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        let (unit, after) = after.split_at_checked(length)?;
        stream.extend(START_CODE);
        stream.extend(unit);
        rest = after;
    }
    Some(stream)
}
