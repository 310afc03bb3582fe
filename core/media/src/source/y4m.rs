//! YUV4MPEG2: uncompressed video, 8-bit mono, 4:2:0, 4:2:2 and 4:4:4; read in place.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::picture::Range;

use super::{Decode, Probed, Shape, Source, check_size};
use crate::convert::{Chroma, Coded};
use crate::error::MediaError;

/// First bytes of every such file.
pub(crate) const MAGIC: &[u8] = b"YUV4MPEG2";

/// Longest line that is taken for a header.
const LONGEST_LINE: u64 = 1024;

/// Reads the header and finds every frame.
pub(crate) fn probe(path: &Path) -> Result<Probed, MediaError> {
    let fail = |e| MediaError::io("read", path, e);
    let file = File::open(path).map_err(fail)?;
    let length = file.metadata().map_err(fail)?.len();
    let mut reader = BufReader::new(file);
    let head = parse_head(path, &line(path, &mut reader)?)?;
    let stored_len = head.coded.frame_len(head.width, head.height) as u64;
    let mut starts = Vec::new();
    loop {
        let frame_head = line(path, &mut reader)?;
        let at = starts.len();
        match frame_head.split(' ').next() {
            Some("") => break,
            Some("FRAME") => {}
            Some("YUV4MPEG2") => {
                return Err(MediaError::damaged(path, format!("a second stream begins at frame {at}")));
            }
            _ => return Err(MediaError::damaged(path, format!("no frame where frame {at} should begin"))),
        }
        let start = reader.stream_position().map_err(fail)?;
        if start + stored_len > length {
            return Err(MediaError::damaged(path, format!("the file ends within frame {at}")));
        }
        starts.push(start);
        reader.seek_relative(stored_len as i64).map_err(fail)?;
    }
    let shape =
        Shape { width: head.width, height: head.height, colour: head.coded.colour(), range: head.range };
    let times_s = (0..starts.len()).map(|k| k as f64 * head.period.0 as f64 / head.period.1 as f64).collect();
    let source = Y4m { path: path.to_path_buf(), coded: head.coded, shape, starts: starts.into() };
    Ok(Probed { shape, times_s, notes: head.notes, source: Box::new(source) })
}

#[derive(Debug)]
struct Head {
    width: u32,
    height: u32,
    /// Seconds per frame as a fraction.
    period: (u64, u64),
    coded: Coded,
    range: Range,
    notes: Vec<String>,
}

fn parse_head(path: &Path, head: &str) -> Result<Head, MediaError> {
    let mut words = head.split(' ').filter(|word| !word.is_empty());
    if words.next() != Some("YUV4MPEG2") {
        return Err(MediaError::NotAVideo { path: path.to_path_buf(), why: "no Y4M header".to_owned() });
    }
    let (mut width, mut height, mut rate) = (0, 0, None);
    let (mut chroma, mut range, mut notes) = ("420", Range::Limited, Vec::new());
    for word in words {
        let (key, value) = word.split_at_checked(1).unwrap_or((word, ""));
        match key {
            "W" => width = value.parse().unwrap_or(0),
            "H" => height = value.parse().unwrap_or(0),
            "F" => rate = value.split_once(':').and_then(|(n, d)| n.parse().ok().zip(d.parse().ok())),
            "C" => chroma = value,
            "I" if !matches!(value, "p" | "?") => {
                notes.push("interlaced: each frame mixes two instants".to_owned());
            }
            "X" if value == "COLORRANGE=FULL" => range = Range::Full,
            _ => {}
        }
    }
    let chroma = match chroma {
        "420" | "420jpeg" | "420mpeg2" | "420paldv" => Chroma::Half,
        "422" => Chroma::HalfWidth,
        "444" => Chroma::Whole,
        "mono" => Chroma::None,
        other => {
            let what = format!("Y4M with samples C{other}; 8-bit mono, 420, 422 and 444 are read");
            return Err(MediaError::Unsupported { path: path.to_path_buf(), what });
        }
    };
    let (width, height) = check_size(path, width, height)?;
    let period = match rate {
        Some((frames, seconds)) if frames > 0 && seconds > 0 => (seconds, frames),
        _ => {
            notes.push("the header gives no rate: 25 fps unless one is given".to_owned());
            (1, 25)
        }
    };
    Ok(Head { width, height, period, coded: Coded::Planar { chroma, bits: 8 }, range, notes })
}

/// One line without its end; empty at the end of the file.
fn line(path: &Path, reader: &mut BufReader<File>) -> Result<String, MediaError> {
    let mut bytes = Vec::new();
    reader
        .by_ref()
        .take(LONGEST_LINE)
        .read_until(b'\n', &mut bytes)
        .map_err(|e| MediaError::io("read", path, e))?;
    if !bytes.is_empty() && bytes.pop() != Some(b'\n') {
        return Err(MediaError::damaged(path, "a header line has no end"));
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

struct Y4m {
    path: PathBuf,
    coded: Coded,
    shape: Shape,
    /// Where the pixels of each frame begin, bytes.
    starts: Arc<[u64]>,
}

impl Source for Y4m {
    fn recipe(&self) -> String {
        "y4m, planes 1".to_owned()
    }

    fn is_raw(&self) -> bool {
        true
    }

    fn decode(&self, wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        let file = File::open(&self.path).map_err(|e| MediaError::io("read", &self.path, e))?;
        let stored = vec![0; self.coded.frame_len(self.shape.width, self.shape.height)];
        let reading = Reading {
            path: self.path.clone(),
            file,
            coded: self.coded,
            shape: self.shape,
            starts: Arc::clone(&self.starts),
            next: wanted as usize,
            stored,
        };
        Ok((wanted, Box::new(reading)))
    }
}

struct Reading {
    path: PathBuf,
    file: File,
    coded: Coded,
    shape: Shape,
    starts: Arc<[u64]>,
    next: usize,
    stored: Vec<u8>,
}

impl Decode for Reading {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        let Some(&start) = self.starts.get(self.next) else { return Ok(false) };
        let raw = self.coded.is_planes();
        let target = if raw { &mut *frame } else { &mut self.stored };
        let read = self.file.seek(SeekFrom::Start(start)).and_then(|_| self.file.read_exact(target));
        read.map_err(|e| MediaError::io("read", &self.path, e))?;
        if !raw {
            self.coded.to_planes(&self.stored, &self.shape, frame);
        }
        self.next += 1;
        Ok(true)
    }
}
