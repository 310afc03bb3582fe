//! What can go wrong with a clip, one line each: what was wanted, what came, what to do; the path last.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use honami_model::clip::TimesError;

/// Why a clip cannot be opened, read or written.
///
/// Cheap to clone: every caller that waits for a frame gets the decoder's one error.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MediaError {
    /// There is no such file, folder or matching image.
    #[error("no such file, folder or image pattern: {}", path.display())]
    Missing {
        /// What was asked for.
        path: PathBuf,
    },
    /// The operating system refused to read or write.
    #[error("{doing}: {source}: {}", path.display())]
    Io {
        /// What was being done, as in "read".
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: Arc<io::Error>,
    },
    /// The file is neither a video nor an image.
    #[error("not a video ({why}): {}", path.display())]
    NotAVideo {
        /// The file.
        path: PathBuf,
        /// How that shows.
        why: String,
    },
    /// The folder or pattern has no image in it.
    #[error("no PNG, JPEG, TIFF or BMP image in it: {}", path.display())]
    NoImages {
        /// The folder or pattern.
        path: PathBuf,
    },
    /// The folder holds several sequences of the same length.
    #[error("holds several image sequences ({}); name one of them as a pattern: {}", series.join(", "), path.display())]
    Ambiguous {
        /// The folder.
        path: PathBuf,
        /// One pattern per sequence.
        series: Vec<String>,
    },
    /// A frame has another size than the first.
    #[error("frame {frame} is {found}, the frames before it are {first}; a clip has one size: {}", path.display())]
    SizeChange {
        /// The image, or the video.
        path: PathBuf,
        /// The first frame of another size.
        frame: u32,
        /// Its size.
        found: Size,
        /// Size of frame 0.
        first: Size,
    },
    /// The file ends early or is damaged.
    #[error("damaged or cut short ({why}): {}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where and how.
        why: String,
    },
    /// The file has no frame.
    #[error("has no frame: {}", path.display())]
    NoFrames {
        /// The file.
        path: PathBuf,
    },
    /// Only ffmpeg can do this, and it is not installed or not wanted.
    #[error("{what} needs ffmpeg (apt install ffmpeg): {}", path.display())]
    NeedsFfmpeg {
        /// The file.
        path: PathBuf,
        /// What the built-in code cannot read or write.
        what: String,
    },
    /// A kind of picture that honami does not read.
    #[error("{what}: {}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it is and what would do.
        what: String,
    },
    /// A name with an ending that no movie has.
    #[error("movies are written as .mp4, .y4m or a folder of PNG images, not .{ending}: {}", path.display())]
    Ending {
        /// The name.
        path: PathBuf,
        /// What it ends in, in small letters.
        ending: String,
    },
    /// There is no folder for what is to be written.
    #[error("{} is no folder: make it first (mkdir -p), or choose another name: {}", folder.display(), path.display())]
    NoFolder {
        /// What was to be written.
        path: PathBuf,
        /// The folder it would be in.
        folder: PathBuf,
    },
    /// The decoder gave more or fewer frames than the index promised.
    #[error("decodes to {found} frames where its index promises {promised}; open it again, now every frame is counted first: {}", path.display())]
    FrameCount {
        /// The file.
        path: PathBuf,
        /// Frames decoded; of a longer stream, one more than promised.
        found: u32,
        /// Frames in the index.
        promised: u32,
    },
    /// The frame lies beyond the clip.
    #[error("frame {frame} of a clip of {n_frames} frames (they count from 0)")]
    Beyond {
        /// What was asked for.
        frame: u32,
        /// Frames in the clip.
        n_frames: u32,
    },
    /// The stream's times cannot be frame times.
    #[error("{why}; give the true rate (--fps): {}", path.display())]
    Times {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        why: TimesError,
    },
    /// A rate that is not positive.
    #[error("a frame rate must be a positive number, not {fps}")]
    Rate {
        /// What was given.
        fps: f64,
    },
    /// A helper program failed.
    #[error("{program} failed: {line}: {}", path.display())]
    Program {
        /// Which one.
        program: &'static str,
        /// The first line it complained with.
        line: String,
        /// The file it worked on.
        path: PathBuf,
    },
    /// A frame to be written does not fit the movie.
    #[error("a frame of {found} cannot go into a movie of {wanted}")]
    WrongFrame {
        /// What came, size and colour.
        found: String,
        /// What was wanted.
        wanted: String,
    },
}

/// Width and height in pixels, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub u32, pub u32);

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.0, self.1)
    }
}

impl MediaError {
    /// Wraps what the system said; a missing file becomes [`MediaError::Missing`].
    pub(crate) fn io(doing: &'static str, path: &Path, source: io::Error) -> Self {
        let path = path.to_path_buf();
        if source.kind() == io::ErrorKind::NotFound {
            return Self::Missing { path };
        }
        Self::Io { doing, path, source: Arc::new(source) }
    }

    pub(crate) fn damaged(path: &Path, why: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_path_buf(), why: why.into() }
    }
}
