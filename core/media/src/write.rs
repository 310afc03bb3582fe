//! Movies out: Y4M, folders of PNG, and H.264 through ffmpeg.
//!
//! Each is written under a temporary name beside its own and renamed when it is finished; one that is dropped
//! before leaves nothing behind.

use std::path::{Path, PathBuf};

use honami_model::picture::{Planes, Range};
use honami_model::unfinished::Unfinished as Listed;

use crate::convert::rgb_to_planes;
use crate::error::MediaError;
use crate::source::Shape;

mod mp4;
mod png;
mod y4m;

pub use mp4::Mp4;
pub use png::{PngFolder, still};
pub use y4m::Y4m;

/// Frames per second of movies that anything plays.
pub const RATES: std::ops::RangeInclusive<f64> = 1e-3..=1e5;

/// What every frame of a movie is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Frames per second, positive.
    pub fps: f64,
    /// Whether frames have chroma.
    pub colour: bool,
    /// Meaning of the luma bytes.
    pub range: Range,
}

/// A movie that is being written.
pub trait Movie: Send {
    /// Appends a frame.
    ///
    /// # Errors
    /// [`MediaError::WrongFrame`] when it differs from the format, [`MediaError::Io`] when it cannot be written.
    fn push(&mut self, frame: &Planes<'_>) -> Result<(), MediaError>;

    /// Appends a frame of pixels, red, green, blue, row by row from the top, to a movie in colour.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    fn push_rgb(&mut self, pixels: &[[u8; 3]]) -> Result<(), MediaError> {
        let Format { width, height, range, .. } = *self.format();
        let shape = Shape { width, height, colour: true, range };
        self.format().admit_rgb(pixels)?;
        let mut frame = vec![0; shape.frame_len()];
        rgb_to_planes(pixels.as_flattened(), &shape, &mut frame);
        self.push(&shape.planes(&frame))
    }

    /// What its frames are like.
    fn format(&self) -> &Format;

    /// Completes the movie and gives it its name.
    ///
    /// # Errors
    /// [`MediaError::Io`], or [`MediaError::Program`] with what ffmpeg said.
    fn finish(self: Box<Self>) -> Result<(), MediaError>;
}

/// What is written under a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A folder of PNG images, one a frame,
    Images,
    /// a YUV4MPEG2 file,
    Y4m,
    /// H.264 by ffmpeg,
    Mp4,
    /// or one image, `.png`, which is no movie.
    Still,
}

impl Kind {
    /// As the name tells: by its ending; a folder, where it has none, ends in `/` or is one.
    ///
    /// # Errors
    /// [`MediaError::Ending`].
    pub fn of(path: &Path) -> Result<Self, MediaError> {
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Ok(Self::Images);
        }
        match ending(path).as_deref() {
            None => Ok(Self::Images),
            Some("y4m") => Ok(Self::Y4m),
            Some("mp4") => Ok(Self::Mp4),
            _ if path.is_dir() => Ok(Self::Images),
            Some("png") => Ok(Self::Still),
            Some(other) => Err(MediaError::Ending { path: path.to_path_buf(), ending: other.to_owned() }),
        }
    }

    /// Whether there is a folder for it: to be asked before the work for it. Folders of images are made with those they are in.
    ///
    /// # Errors
    /// [`MediaError::NoFolder`].
    pub fn admit(self, path: &Path) -> Result<(), MediaError> {
        let above = || {
            path.ancestors()
                .skip(1)
                .map(|folder| if folder == Path::new("") { Path::new(".") } else { folder })
        };
        let folder = match self {
            Self::Images => above().find(|folder| folder.exists()),
            _ => above().next(),
        };
        match folder {
            Some(folder) if !folder.is_dir() => {
                Err(MediaError::NoFolder { path: path.to_path_buf(), folder: folder.to_path_buf() })
            }
            _ => Ok(()),
        }
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

/// Starts a movie whose kind the name tells: `.y4m`, `.mp4` (needs ffmpeg), else a folder of PNG images.
///
/// # Errors
/// As the kinds' own `create`; [`MediaError::Ending`], [`MediaError::NoFolder`].
pub fn create(path: &Path, format: &Format) -> Result<Box<dyn Movie>, MediaError> {
    let kind = Kind::of(path)?;
    kind.admit(path)?;
    Ok(match kind {
        Kind::Images => Box::new(PngFolder::create(path, format)?),
        Kind::Y4m => Box::new(Y4m::create(path, format)?),
        Kind::Mp4 => Box::new(Mp4::create(path, format)?),
        Kind::Still => {
            return Err(MediaError::Ending {
                path: path.to_path_buf(),
                ending: ending(path).unwrap_or_default(),
            });
        }
    })
}

impl Format {
    fn check(&self) -> Result<(), MediaError> {
        if self.fps.is_finite() && self.fps > 0.0 {
            return Ok(());
        }
        Err(MediaError::Rate { fps: self.fps })
    }

    /// That there are as many pixels as a frame has.
    fn admit_rgb(&self, pixels: &[[u8; 3]]) -> Result<(), MediaError> {
        let wanted = self.width as usize * self.height as usize;
        if pixels.len() == wanted {
            return Ok(());
        }
        let text = |n: usize| format!("{n} pixels");
        Err(MediaError::WrongFrame { found: text(pixels.len()), wanted: text(wanted) })
    }

    fn admit(&self, frame: &Planes<'_>) -> Result<(), MediaError> {
        let found = (frame.y.width, frame.y.height, frame.uv.is_some(), frame.range);
        let wanted = (self.width, self.height, self.colour, self.range);
        if found == wanted {
            return Ok(());
        }
        let text = |(width, height, colour, range): (u32, u32, bool, Range)| {
            format!("{width}x{height} {} {range:?} range", if colour { "colour" } else { "gray" })
        };
        Err(MediaError::WrongFrame { found: text(found), wanted: text(wanted) })
    }
}

/// A file or folder under its temporary name; removed unless it got its own.
#[derive(Debug)]
struct Unfinished {
    temporary: Listed,
    path: PathBuf,
}

impl Unfinished {
    fn beside(path: &Path) -> Self {
        let mut name = std::ffi::OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{}.part", std::process::id()));
        let temporary = Listed::new(path.with_file_name(name));
        Self { temporary, path: path.to_path_buf() }
    }

    fn finish(&self) -> Result<(), MediaError> {
        self.temporary.settle(|name| std::fs::rename(name, &self.path)).map_err(|e| self.fail("write", e))
    }

    /// A missing folder is an error of writing here, not a missing clip.
    fn fail(&self, doing: &'static str, source: std::io::Error) -> MediaError {
        MediaError::Io { doing, path: self.path.clone(), source: std::sync::Arc::new(source) }
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let name = self.temporary.name();
        std::fs::remove_file(name).or_else(|_| std::fs::remove_dir_all(name)).unwrap_or_default();
    }
}
