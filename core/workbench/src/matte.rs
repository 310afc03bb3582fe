//! Mattes of pictures: read, found, and written as pictures that other commands read.

use std::path::{Path, PathBuf};

use honami_matting::{
    Mark, Matte, MattingError, Options, Parts, PartsWish, Picture, from_scribbles, from_trimap, matte,
};
use honami_media::{Media, Still};

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

pub mod carried;
pub mod kept;

/// Where marks come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MarkSource {
    /// A copy of the picture on which background was painted black and the plant white.
    Scribbles(PathBuf),
    /// A gray picture: black is background, white the plant, gray between unknown.
    Trimap(PathBuf),
    /// These, one a pixel, painted over the picture where it is shown.
    Painted(Vec<Mark>),
    /// These, one a pixel, carried on from an earlier frame.
    Carried {
        /// That frame.
        from: u32,
        /// One a pixel.
        marks: Vec<Mark>,
    },
}

/// What is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct MatteRequest {
    /// The picture's file, for what is said of it.
    pub path: PathBuf,
    /// What is known before.
    pub marks: MarkSource,
    /// How opacities follow colours and marks.
    pub options: Options,
    /// What is taken away of the plant.
    pub parts: PartsWish,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Matted {
    /// What was known before, one a pixel.
    pub marks: Vec<Mark>,
    /// The opacities.
    pub matte: Matte,
    /// What every pixel is of.
    pub parts: Parts,
}

impl Matted {
    /// Marked pixels: background, foreground.
    #[must_use]
    pub fn n_marked(&self) -> [usize; 2] {
        [Mark::Background, Mark::Foreground].map(|mark| self.marks.iter().filter(|&&m| m == mark).count())
    }
}

/// The colours of one frame of a clip.
///
/// # Errors
/// [`WorkbenchError::Frames`] where there is no such frame, and what reading it met.
pub fn frame(media: &Media, n: u32) -> Result<Still, WorkbenchError> {
    let n_frames = media.clip().times.len();
    if n >= n_frames {
        return Err(WorkbenchError::Frames { start: n, end: n.saturating_add(1), n_frames });
    }
    Ok(Still::of(&media.frame(n)?))
}

/// Finds the matte of a picture and its parts.
///
/// # Errors
/// [`WorkbenchError::Matte`] with what the picture or the marks lack, [`WorkbenchError::Stopped`], and what reading the marks
/// met.
pub fn run(still: &Still, request: &MatteRequest, progress: &dyn Progress) -> Result<Matted, WorkbenchError> {
    let of = |path: &Path| {
        let path = path.to_owned();
        |source| match source {
            MattingError::Stopped => WorkbenchError::Stopped,
            source => WorkbenchError::Matte { path, source },
        }
    };
    let picture = Picture::new(still.width, still.height, &still.rgb).map_err(of(&request.path))?;
    let marks = match &request.marks {
        MarkSource::Scribbles(path) => {
            let scribbles = Still::read(path)?;
            let scribbles =
                Picture::new(scribbles.width, scribbles.height, &scribbles.rgb).map_err(of(path))?;
            from_scribbles(&picture, &scribbles).map_err(of(path))?
        }
        MarkSource::Trimap(path) => {
            let trimap = Still::read(path)?;
            from_trimap(&picture, &trimap.gray(), [trimap.width, trimap.height]).map_err(of(path))?
        }
        MarkSource::Painted(marks) | MarkSource::Carried { marks, .. } => marks.clone(),
    };
    let mut go_on = |share: f64| progress.report((100.0 * share) as u64, 100, "per cent") == Flow::Continue;
    let matte = matte(&picture, &marks, &request.options, &mut go_on).map_err(of(&request.path))?;
    Ok(Matted { marks, parts: Parts::new(&matte, &request.parts), matte })
}

/// Writes a picture of gray values, one a pixel.
///
/// # Errors
/// What writing it met.
pub fn write_gray(path: &Path, gray: &[u8], size: [u32; 2]) -> Result<(), WorkbenchError> {
    let rgb: Vec<[u8; 3]> = gray.iter().map(|&value| [value; 3]).collect();
    Ok(honami_media::write::still(path, &rgb, size[0], size[1])?)
}

/// Writes the parts in their colours over the picture.
///
/// # Errors
/// What writing it met.
pub fn write_parts(path: &Path, parts: &Parts, still: &Still) -> Result<(), WorkbenchError> {
    let of = |source| WorkbenchError::Matte { path: path.to_owned(), source };
    let picture = Picture::new(still.width, still.height, &still.rgb).map_err(of)?;
    let painted = parts.painted(&picture).map_err(of)?;
    Ok(honami_media::write::still(path, &painted, still.width, still.height)?)
}
