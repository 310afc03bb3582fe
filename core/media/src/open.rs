//! Opening a clip: what kind it is, how many frames it has and when, and where its decoded frames will lie.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::clip::{Clip, FrameTimes};

use crate::cache::{Folder, Wanted};
use crate::error::MediaError;
use crate::media::{Head, Media};
use crate::source::{Probed, Source, contained, ffmpeg, mp4, sequence, y4m};
use crate::{hash, programs};

/// How to open a clip. The default serves everybody but tests and containers that lie.
#[derive(Clone, Debug, Default)]
pub struct OpenOptions {
    /// The true rate, frames per second: frame k is at k / fps seconds whatever the container says.
    pub fps: Option<f64>,
    /// Folder for decoded frames; by default `$XDG_CACHE_HOME/honami/frames`.
    pub cache_dir: Option<PathBuf>,
    /// Bound of that folder, bytes; by default `$HONAMI_CACHE_BYTES`, else 4 GiB. 0: nothing is kept.
    pub cache_bytes: Option<u64>,
    /// Who decodes videos.
    pub decoder: Decoder,
    /// Recent frames kept in memory when decoding on demand; by default as many as 256 MiB hold.
    pub recent_frames: Option<usize>,
}

/// Who decodes videos. Image sequences and Y4M need nobody.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decoder {
    /// ffmpeg where it is installed, else the built-in decoder.
    #[default]
    Auto,
    /// ffmpeg as a child process: any format it knows.
    Ffmpeg,
    /// The built-in decoder: 8-bit 4:2:0 progressive H.264 in MP4.
    Builtin,
}

/// What opening is busy with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Reading the file for its content hash.
    Hashing,
    /// Finding frames and their times.
    Indexing,
}

/// The folder in which decoded frames are kept unless told otherwise; `None` where there is no home folder.
#[must_use]
pub fn cache_folder() -> Option<std::path::PathBuf> {
    crate::cache::Folder::find(None, None).map(|folder| folder.dir)
}

/// Opens a video file, a Y4M file, a folder of images or an image pattern (`frame_%04d.png`, `*.png`).
///
/// Frame times are seconds after the first frame. Decoding starts in the background; see [`Media::frame`].
///
/// # Errors
/// [`MediaError`], one line that says what is wrong with the clip; nothing is left behind then.
pub fn open(path: &Path, options: &OpenOptions) -> Result<Media, MediaError> {
    open_with(path, options, &mut |_| {})
}

/// [`open`], telling which step it takes: long videos take seconds to hash, some must be decoded to be counted.
///
/// # Errors
/// As [`open`].
pub fn open_with(
    path: &Path,
    options: &OpenOptions,
    on_step: &mut dyn FnMut(Step),
) -> Result<Media, MediaError> {
    let kind = kind_of(path)?;
    let images = if kind == Kind::Images { Some(sequence::list(path)?) } else { None };
    open_kind(path, (kind, images), options, on_step)
}

/// Content hash of a clip, as [`Media::sha256`] without opening it.
///
/// # Errors
/// [`MediaError`] when it cannot be read.
pub fn sha256_of_clip(path: &Path) -> Result<String, MediaError> {
    match kind_of(path)? {
        Kind::Images => hash::sha256_of_sequence(&sequence::list(path)?.0),
        _ => hash::sha256_of_file(path),
    }
}

/// How large a clip is, without reading more of it than that takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Width of every frame, pixels.
    pub width: u32,
    /// Height of every frame, pixels.
    pub height: u32,
    /// Frames.
    pub n_frames: usize,
}

/// How large a clip is: neither hashed nor decoded.
///
/// # Errors
/// [`MediaError`] when it is no clip.
pub fn size_of(path: &Path) -> Result<Extent, MediaError> {
    let kind = kind_of(path)?;
    let images = if kind == Kind::Images { Some(sequence::list(path)?) } else { None };
    let Probed { shape, times_s, .. } = probe(path, (kind, images), Decoder::Auto, false)?;
    Ok(Extent { width: shape.width, height: shape.height, n_frames: times_s.len() })
}

/// Opens image files, in this order, as one clip.
///
/// # Errors
/// As [`open`].
pub fn open_images(files: &[PathBuf], options: &OpenOptions) -> Result<Media, MediaError> {
    let path = files.first().map_or(Path::new(""), PathBuf::as_path);
    open_kind(path, (Kind::Images, Some((files.to_vec(), Vec::new()))), options, &mut |_| {})
}

/// Images in order, and notes on what was left out.
type Images = Option<(Vec<PathBuf>, Vec<String>)>;

fn open_kind(
    path: &Path,
    (kind, images): (Kind, Images),
    options: &OpenOptions,
    on_step: &mut dyn FnMut(Step),
) -> Result<Media, MediaError> {
    if let Some(fps) = options.fps.filter(|fps| !(fps.is_finite() && *fps > 0.0)) {
        return Err(MediaError::Rate { fps });
    }
    on_step(Step::Hashing);
    let sha256 = match &images {
        Some((files, _)) => hash::sha256_of_sequence(files)?,
        None => hash::sha256_of_file(path)?,
    };
    let folder = Folder::find(options.cache_dir.as_deref(), options.cache_bytes);
    let miscounted = folder.as_ref().map(|folder| folder.mark_of(&sha256));
    on_step(Step::Indexing);
    let count_frames = miscounted.as_ref().is_some_and(|mark| mark.exists());
    let probed = probe(path, (kind, images), options.decoder, count_frames)?;
    let Probed { shape, times_s, mut notes, source } = probed;
    let times = frame_times(path, times_s, options.fps, &mut notes)?;
    let clip = Clip { width: shape.width, height: shape.height, times };
    let key = format!("{sha256} {} {shape:?} {}", source.recipe(), clip.n_frames());
    let wanted = Wanted { key: hash::sha256_of_bytes(key.as_bytes()), shape, n_frames: clip.n_frames() };
    let mut head = Head {
        clip,
        notes,
        sha256,
        path: path.to_path_buf(),
        shape,
        recent_frames: options.recent_frames,
        miscounted,
    };
    let source: Arc<dyn Source> = Arc::from(source);
    if source.is_raw() {
        return Ok(Media::on_demand(head, source));
    }
    let Some(folder) = folder else {
        head.notes.push("no cache folder (HOME is not set): frames are decoded on demand, slower".to_owned());
        return Ok(Media::on_demand(head, source));
    };
    if let Some(map) = folder.complete(&wanted) {
        return Ok(Media::cached(head, source, map));
    }
    match folder.begin(&wanted) {
        Ok(filling) => Media::filling(head, source, filling),
        Err(why) => {
            head.notes
                .push(format!("the frame cache is not used ({why}): frames are decoded on demand, slower"));
            Ok(Media::on_demand(head, source))
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Images,
    Y4m,
    Mp4,
    Other,
}

/// By the first bytes; images by their names, because a JPEG may also begin a raw stream of them.
fn kind_of(path: &Path) -> Result<Kind, MediaError> {
    if path.is_dir() || sequence::is_pattern(path) {
        return Ok(Kind::Images);
    }
    let fail = |e| MediaError::io("read", path, e);
    let mut start = Vec::new();
    File::open(path).and_then(|file| file.take(16).read_to_end(&mut start)).map_err(fail)?;
    Ok(match start.as_slice() {
        [] => return Err(MediaError::NoFrames { path: path.to_path_buf() }),
        bytes if bytes.starts_with(y4m::MAGIC) => Kind::Y4m,
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => Kind::Mp4,
        _ if sequence::is_image(path) => Kind::Images,
        _ => Kind::Other,
    })
}

fn probe(
    path: &Path,
    (kind, images): (Kind, Images),
    decoder: Decoder,
    count_frames: bool,
) -> Result<Probed, MediaError> {
    contained(path, || match (kind, images) {
        (Kind::Y4m, _) => y4m::probe(path),
        (_, Some((files, notes))) => sequence::probe(path, files, notes),
        (kind, None) => probe_video(path, kind, decoder, count_frames),
    })?
}

fn probe_video(path: &Path, kind: Kind, decoder: Decoder, count_frames: bool) -> Result<Probed, MediaError> {
    let has_ffmpeg = || programs::ffmpeg_version().is_some();
    match (decoder, kind) {
        (Decoder::Auto | Decoder::Ffmpeg, _) if has_ffmpeg() => ffmpeg::probe(path, count_frames),
        (Decoder::Auto | Decoder::Builtin, Kind::Mp4) => mp4::probe(path),
        _ => Err(MediaError::NeedsFfmpeg { path: path.to_path_buf(), what: "this kind of file".to_owned() }),
    }
}

/// The stream's times, or k / fps where the user knows better.
fn frame_times(
    path: &Path,
    times_s: Vec<f64>,
    fps: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<FrameTimes, MediaError> {
    let n = u32::try_from(times_s.len()).unwrap_or(u32::MAX);
    if n == 0 {
        return Err(MediaError::NoFrames { path: path.to_path_buf() });
    }
    let in_clip = |why| MediaError::Times { path: path.to_path_buf(), why };
    if let Some(fps) = fps {
        notes.retain(|note| !note.contains(" fps "));
        return FrameTimes::constant(n, fps).map_err(in_clip);
    }
    let times = FrameTimes::new(times_s).map_err(in_clip)?;
    if times.is_variable() {
        notes.push(format!("{n} frames at an irregular rate: times come from the stream"));
    }
    Ok(times)
}
