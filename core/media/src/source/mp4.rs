//! H.264 in MP4 without any installed program: 8-bit 4:2:0 progressive, what cameras and phones mostly write.
//!
//! The container is read by re_mp4's boxes and our own sample table (which trusts nothing), the stream is decoded by
//! rusty_h264, which gives the same bits as ffmpeg (tested on every clip; openh264 does not where B-frames use direct
//! prediction: up to 25 levels off in a clip of reeds).

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Seek, SeekFrom};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::picture::Range;
use re_mp4::{Avc1Box, BoxHeader, BoxType, MoovBox, ReadBox, StsdBoxContent, TrakBox};
use rusty_h264_decoder::{DecodeError, Decoder};

use super::{Decode, Probed, Shape, Source, check_size, seconds, turned};
use crate::error::{MediaError, Size};
use sps::Sps;
use table::{Sample, Table};

mod sps;
mod table;

/// Reads the container's index and the stream's parameters.
pub(crate) fn probe(path: &Path) -> Result<Probed, MediaError> {
    let needs_ffmpeg = |what: String| MediaError::NeedsFfmpeg { path: path.to_path_buf(), what };
    let file = File::open(path).map_err(|e| MediaError::io("read", path, e))?;
    let file_len = file.metadata().map_err(|e| MediaError::io("read", path, e))?.len();
    let moov = read_moov(path, file, file_len)?;
    if moov.mvex.is_some() {
        return Err(needs_ffmpeg("a fragmented MP4".to_owned()));
    }
    let Some(trak) = moov.traks.iter().find(|trak| trak.mdia.minf.vmhd.is_some()) else {
        let why = "no video stream in it".to_owned();
        return Err(MediaError::NotAVideo { path: path.to_path_buf(), why });
    };
    let avc1 = match &trak.mdia.minf.stbl.stsd.contents {
        StsdBoxContent::Avc1(avc1) => avc1,
        StsdBoxContent::Unknown(name) => return Err(needs_ffmpeg(format!("{name} video"))),
        other => return Err(needs_ffmpeg(format!("{} video", other.codec_string().unwrap_or_default()))),
    };
    let avcc = &avc1.avcc.contents;
    let sps = avcc.sequence_parameter_sets.first().and_then(|nal| Sps::parse(&nal.bytes));
    let sps = sps.ok_or_else(|| MediaError::damaged(path, "its H.264 parameters cannot be read"))?;
    if let Some(what) = sps.beyond_builtin() {
        return Err(needs_ffmpeg(what.to_owned()));
    }
    let (width, height) = check_size(path, sps.width, sps.height)?;
    let range = if sps.full_range { Range::Full } else { Range::Limited };
    let shape = Shape { width, height, colour: true, range };
    let table = Table::read(path, &moov, trak, file_len)?;
    let times_s = seconds(table.kept_times(), 1, table.timescale);
    let notes = if sps.square {
        Vec::new()
    } else {
        vec!["its pixels are not square: positions are in stored pixels".to_owned()]
    };
    let quarters = quarters_clockwise(trak);
    let source = Video {
        path: path.to_path_buf(),
        shape,
        head: annex_b_head(avc1),
        table: Arc::new(table),
        length_size: usize::from(avcc.length_size_minus_one & 3) + 1,
    };
    Ok(turned(Probed { shape, times_s, notes, source: Box::new(source) }, quarters))
}

/// Finds and reads the index box.
fn read_moov(path: &Path, file: File, file_len: u64) -> Result<MoovBox, MediaError> {
    let damaged = |what: String| MediaError::damaged(path, what);
    let mut reader = BufReader::new(file);
    let mut at = 0;
    while at + 8 <= file_len {
        reader.seek(SeekFrom::Start(at)).map_err(|e| MediaError::io("read", path, e))?;
        let BoxHeader { name, size } = BoxHeader::read(&mut reader).map_err(|e| damaged(e.to_string()))?;
        // A size of 0 reaches to the end; after a 64-bit size the reader stands 8 bytes further on.
        let start = reader.stream_position().map_err(|e| MediaError::io("read", path, e))? - 8;
        let end = if size == 0 { file_len } else { start.saturating_add(size) };
        if name == BoxType::MoovBox {
            if end > file_len {
                return Err(damaged("the file ends within its index".to_owned()));
            }
            return MoovBox::read_box(&mut reader, size).map_err(|e| damaged(format!("its index: {e}")));
        }
        if end <= at {
            break;
        }
        at = end;
    }
    Err(damaged("it has no index (moov box)".to_owned()))
}

/// Quarter turns that make the picture upright, from the track's matrix; other matrices are not honoured.
fn quarters_clockwise(trak: &TrakBox) -> u32 {
    let m = &trak.tkhd.matrix;
    match (m.a.signum(), m.b.signum(), m.c.signum(), m.d.signum()) {
        (0, 1, -1, 0) => 1,
        (-1, 0, 0, -1) => 2,
        (0, -1, 1, 0) => 3,
        _ => 0,
    }
}

/// Start code of a unit in a byte stream (H.264 annex B).
const START_CODE: [u8; 4] = [0, 0, 0, 1];

/// Sequence and picture parameters as a byte stream.
fn annex_b_head(avc1: &Avc1Box) -> Arc<[u8]> {
    let avcc = &avc1.avcc.contents;
    let units = avcc.sequence_parameter_sets.iter().chain(&avcc.picture_parameter_sets);
    units.flat_map(|unit| START_CODE.into_iter().chain(unit.bytes.iter().copied())).collect()
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
