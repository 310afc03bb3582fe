//! H.264 in MP4 without any installed program: 8-bit 4:2:0 progressive, what cameras and phones mostly write.
//!
//! The container is read by re_mp4's boxes and our own sample table (which trusts nothing), the stream is decoded by
//! the bundled openh264; both give the same frames and times as ffmpeg (tested bit for bit).

use std::collections::VecDeque;
use std::fs::File;
use std::io::{BufReader, Seek, SeekFrom};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::picture::Range;
use openh264::OpenH264API;
use openh264::decoder::{DecodedYUV, Decoder, DecoderConfig, Flush};
use openh264::formats::YUVSource;
use re_mp4::{Avc1Box, BoxHeader, BoxType, MoovBox, ReadBox, StsdBoxContent, TrakBox};

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
    let notes = if sps.square { Vec::new() } else { vec!["its pixels are not square: positions are in stored pixels".to_owned()] };
    let quarters = quarters_clockwise(trak);
    let source = Video { path: path.to_path_buf(), shape, head: annex_b_head(avc1), table: Arc::new(table), length_size: usize::from(avcc.length_size_minus_one & 3) + 1 };
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
    head: Arc<[u8]>,
    /// Bytes of the length before each unit in a sample.
    length_size: usize,
}

impl Source for Video {
    fn recipe(&self) -> String {
        "openh264 0.9, planes 1".to_owned()
    }

    fn decode(&self, _wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        let file = File::open(&self.path).map_err(|e| MediaError::io("read", &self.path, e))?;
        // Flushing after each sample would give frames in decoding order.
        let config = DecoderConfig::new().flush_after_decode(Flush::NoFlush);
        let decoder = Decoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(|e| failed(&self.path, 0, &e))?;
        let mut running = Running {
            path: self.path.clone(),
            shape: self.shape,
            table: Arc::clone(&self.table),
            length_size: self.length_size,
            file,
            decoder,
            n_fed: 0,
            n_shown: 0,
            ready: VecDeque::new(),
            flushed: false,
        };
        let shape = running.shape;
        let first = running.decoder.decode(&self.head).map_err(|e| failed(&self.path, 0, &e))?;
        let none = first.map(|picture| planes_of(&picture, &shape, &self.path, 0)).transpose()?;
        running.ready.extend(none);
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
    /// Pictures that came out, in display order.
    n_shown: usize,
    ready: VecDeque<Vec<u8>>,
    flushed: bool,
}

impl Decode for Running {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        loop {
            while let Some(picture) = self.ready.pop_front() {
                let kept = self.table.keeps(self.n_shown);
                self.n_shown += 1;
                if kept {
                    frame.copy_from_slice(&picture);
                    return Ok(true);
                }
            }
            match self.table.samples.get(self.n_fed).copied() {
                Some(sample) => self.feed(sample)?,
                None if self.flushed => return Ok(false),
                None => self.flush()?,
            }
        }
    }
}

impl Running {
    fn feed(&mut self, sample: Sample) -> Result<(), MediaError> {
        let mut stored = vec![0; sample.len as usize];
        self.file
            .read_exact_at(&mut stored, sample.offset)
            .map_err(|_| MediaError::damaged(&self.path, format!("the file now ends within sample {}", self.n_fed)))?;
        let stream = annex_b(&stored, self.length_size)
            .ok_or_else(|| MediaError::damaged(&self.path, format!("sample {} is not H.264", self.n_fed)))?;
        let picture = self.decoder.decode(&stream).map_err(|e| failed(&self.path, self.n_fed, &e))?;
        let planes = picture.map(|p| planes_of(&p, &self.shape, &self.path, self.n_shown)).transpose()?;
        self.ready.extend(planes);
        self.n_fed += 1;
        Ok(())
    }

    fn flush(&mut self) -> Result<(), MediaError> {
        self.flushed = true;
        let pictures = self.decoder.flush_remaining().map_err(|e| failed(&self.path, self.n_fed, &e))?;
        for picture in &pictures {
            self.ready.push_back(planes_of(picture, &self.shape, &self.path, self.n_shown)?);
        }
        Ok(())
    }
}

fn failed(path: &Path, sample: usize, error: &openh264::Error) -> MediaError {
    MediaError::damaged(path, format!("sample {sample} does not decode: {error}"))
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

/// The picture without its padding.
fn planes_of(picture: &DecodedYUV<'_>, shape: &Shape, path: &Path, frame: usize) -> Result<Vec<u8>, MediaError> {
    let (width, height) = picture.dimensions();
    let (found, first) = (Size(width as u32, height as u32), Size(shape.width, shape.height));
    if found != first {
        return Err(MediaError::SizeChange { path: path.to_path_buf(), frame: frame as u32, found, first });
    }
    let (y_stride, u_stride, v_stride) = picture.strides();
    let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut planes = Vec::with_capacity(shape.frame_len());
    for (plane, stride, width, height) in [
        (picture.y(), y_stride, width, height),
        (picture.u(), u_stride, half_width, half_height),
        (picture.v(), v_stride, half_width, half_height),
    ] {
        for row in plane.chunks(stride).take(height) {
            planes.extend(&row[..width]);
        }
    }
    Ok(planes)
}
