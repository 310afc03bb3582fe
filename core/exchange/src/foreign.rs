//! Tracks of other programs: one noun for all of them, one file a format, one door in and one out.
//!
//! Positions are in our pixels on both sides of the door ([`origin`](crate::origin) converts them). What a
//! format cannot keep is said by [`losses`], with numbers; what a file holds that is no track is in
//! [`ForeignTracks::dropped`].
//!
//! ```
//! use honami_exchange::foreign::{Format, ReadOptions, parse};
//! let mot = "1,7,9.5,19.5,1,1,0.9,-1,-1,-1\n2,7,10.5,19.5,1,1,0.8,-1,-1,-1\n";
//! let read = parse(mot.as_bytes(), Format::Mot, &ReadOptions::of([640, 480]))?;
//! assert_eq!(read.tracks[0].number, Some(7));
//! let (frame, sample) = read.tracks[0].samples().next().unwrap();
//! assert_eq!((frame, sample.x, sample.y), (0, 8.5, 18.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, Write};
use std::path::Path;
use std::sync::Arc;

use honami_model::track::{Quality, Sample, Source, Span, Status};

use crate::origin::{Origin, Raster};
use crate::watch::{Watch, Watched};

pub use error::{Flaw, ForeignError};
pub use format::Format;
pub use loss::{Loss, losses, manual};
pub(crate) use own::Table;

mod cells;
mod cvat;
mod deeplabcut;
mod dltdv;
mod draft;
mod error;
mod format;
mod loss;
mod mot;
mod own;
mod tapvid;
mod trackmate;
mod xml;

/// Samples that one file may hold; twice the largest project that honami is measured with.
pub const MAX_SAMPLES: usize = 50_000_000;

/// A track of another program's file, or one on its way there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForeignTrack {
    /// Its number there, where it has one.
    pub number: Option<u32>,
    /// Its name there, where it has one; not empty.
    pub name: Option<String>,
    /// Its samples, in order of frames; between two spans nothing is known of it. Source
    /// [`Key`](Source::Key) marks what the file calls a key-frame.
    pub spans: Vec<Arc<Span>>,
}

impl ForeignTrack {
    /// All samples with their frames, in order.
    pub fn samples(&self) -> impl Iterator<Item = (u32, &Sample)> {
        self.spans.iter().flat_map(|span| span.frames().zip(&span.samples))
    }

    /// The sample in a frame.
    #[must_use]
    pub fn at(&self, frame: u32) -> Option<&Sample> {
        let after = self.spans.partition_point(|span| span.first_frame <= frame);
        self.spans[..after].last()?.get(frame)
    }

    /// Number of samples.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.spans.iter().map(|span| span.samples.len()).sum()
    }
}

/// What a file of another program tells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForeignTracks {
    /// The tracks, in the order of the file.
    pub tracks: Vec<ForeignTrack>,
    /// Width and height of the pictures they were found in, where the file says so.
    pub size: Option<[u32; 2]>,
    /// What the file holds that is no track of points, with numbers: `3 boxes`.
    pub dropped: Vec<String>,
}

/// How a file is to be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadOptions {
    /// Width and height of the pictures that its positions belong to.
    pub size: [u32; 2],
    /// Where it counts from, if not where its format usually does.
    pub origin: Option<Origin>,
    /// The camera whose points are wanted, in a file of several.
    pub camera: Option<u32>,
    /// How many of its units of length a pixel is wide, if it does not say so itself.
    pub pixel_size: Option<f64>,
}

impl ReadOptions {
    /// Read as the format usually is, on pictures of this size.
    #[must_use]
    pub fn of(size: [u32; 2]) -> Self {
        Self { size, origin: None, camera: None, pixel_size: None }
    }
}

/// What is written, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outgoing<'a> {
    /// The tracks, each with a number of its own.
    pub tracks: &'a [ForeignTrack],
    /// Width and height of the clip.
    pub size: [u32; 2],
    /// Frames of the clip; none of the samples lies beyond.
    pub n_frames: u32,
    /// Its rate, where it has more than one frame.
    pub fps: Option<f64>,
    /// Whether its frames come at uneven times.
    pub variable_rate: bool,
    /// Where the file is to count from, if not where its format usually does.
    pub origin: Option<Origin>,
    /// CVAT: every frame becomes a key-frame.
    pub every_frame: bool,
    /// MOTChallenge: side of the box around a point, pixels.
    pub box_px: f64,
}

/// The format of a file, by its name and what it begins with.
///
/// # Errors
/// [`ForeignError::Unknown`] when it is none of those honami reads; when the file cannot be read.
pub fn recognise(path: &Path) -> Result<Format, ForeignError> {
    let file = File::open(path).map_err(|source| ForeignError::file(path, source))?;
    let mut head = Vec::new();
    file.take(4096).read_to_end(&mut head).map_err(|source| ForeignError::file(path, source))?;
    Format::of_content(&head).ok_or_else(|| ForeignError::Unknown { path: path.to_owned() })
}

/// Reads a file, watched.
///
/// # Errors
/// [`ForeignError`] says where the file is not what its format wants; any of them when the watch has stopped it.
pub fn read(
    path: &Path,
    format: Format,
    options: &ReadOptions,
    watch: &Watch,
) -> Result<ForeignTracks, ForeignError> {
    let file = File::open(path).map_err(|source| ForeignError::file(path, source))?;
    let file = Watched { file, watch: watch.clone() };
    let tracks = match format {
        Format::Csv => return own::read_csv(path, file),
        Format::Parquet => crate::parquet::parse(file),
        _ => text(BufReader::new(file), format, options),
    };
    tracks.map_err(|flaw| ForeignError::Flaw { path: path.to_owned(), flaw })
}

/// Reads what a file holds.
///
/// # Errors
/// [`Flaw`] says where it is not what its format wants; [`Format::Csv`] is read from files only.
pub fn parse(bytes: &[u8], format: Format, options: &ReadOptions) -> Result<ForeignTracks, Flaw> {
    match format {
        Format::Parquet => crate::parquet::parse(bytes::Bytes::copy_from_slice(bytes)),
        _ => text(Cursor::new(bytes), format, options),
    }
}

fn text<R: std::io::BufRead + Seek>(
    reader: R,
    format: Format,
    options: &ReadOptions,
) -> Result<ForeignTracks, Flaw> {
    let raster = Raster { origin: options.origin.unwrap_or(format.origin()), size: options.size };
    match format {
        Format::Csv | Format::Parquet => Err(Flaw::wrong("file", "text or an archive", format.word())),
        Format::Cvat => cvat::parse(reader, raster),
        Format::DeepLabCut => deeplabcut::parse(reader, raster),
        Format::Dltdv => dltdv::parse(reader, raster, options.camera),
        Format::TrackMate => trackmate::parse(reader, raster, options.pixel_size),
        Format::TapVid => tapvid::parse(reader, raster),
        Format::Mot => mot::parse(reader, raster),
    }
}

/// Writes tracks in another program's format; the own tables are written row by row.
///
/// # Errors
/// When the disk is full; for the own tables, [`std::io::ErrorKind::Unsupported`].
pub fn write(out: impl Write + Seek, format: Format, what: &Outgoing<'_>) -> std::io::Result<()> {
    let raster = Raster { origin: what.origin.unwrap_or(format.origin()), size: what.size };
    match format {
        Format::Csv | Format::Parquet => Err(std::io::ErrorKind::Unsupported.into()),
        Format::Cvat => cvat::write(out, raster, what),
        Format::DeepLabCut => deeplabcut::write(out, raster, what),
        Format::Dltdv => dltdv::write(out, raster, what),
        Format::TrackMate => trackmate::write(out, raster, what),
        Format::TapVid => tapvid::write(out, raster, what),
        Format::Mot => mot::write(out, raster, what),
    }
}

/// A sample that a file gives with a position and at most one number for its trust, 0 to 1.
///
/// Trust 0 marks a position that is predicted, not seen; 1 and none leave it unmeasured. The number is kept as
/// correlation, the measure that has the same range.
fn seen(at: [f32; 2], trust: Option<f32>) -> Sample {
    let [x, y] = at;
    let status = if trust == Some(0.0) { Status::Occluded } else { Status::Tracked };
    let ncc = trust.filter(|&trust| trust > 0.0 && trust < 1.0);
    Sample { x, y, status, source: Source::Imported, quality: Quality { fb_px: None, ncc } }
}

/// The one number for the trust in a sample: what [`seen`] reads back; `None` where there is no position.
fn trust_of(sample: &Sample) -> Option<f32> {
    match sample.status {
        // The least there is, so that what was seen is never taken for predicted.
        Status::Tracked | Status::Newborn => {
            Some(crate::trust(sample.quality).map_or(1.0, |trust| trust.max(1e-6)))
        }
        Status::Occluded => Some(0.0),
        Status::Lost | Status::Outside | Status::Rejected => None,
    }
}

/// How often each kind of thing was met that is no track of points.
#[derive(Debug, Default)]
struct Tally(BTreeMap<&'static str, u64>);

impl Tally {
    fn add(&mut self, what: &'static str) {
        *self.0.entry(what).or_default() += 1;
    }

    fn lines(self) -> Vec<String> {
        self.0.into_iter().map(|(what, n)| format!("{n} {what}")).collect()
    }
}

#[cfg(test)]
mod tests;
