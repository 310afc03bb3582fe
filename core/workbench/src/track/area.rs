//! Where features may be found.

use std::path::{Path, PathBuf};

use honami_media::OpenOptions;
use honami_model::clip::Clip;
use honami_model::document::{Document, MatteId};
use honami_store::Project;
use serde::{Deserialize, Serialize};

use crate::drive::Areas;
use crate::error::WorkbenchError;
use crate::error::matte::MatteError;
use crate::matte::kept;

/// Where features may be found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Area {
    /// Everywhere.
    #[default]
    Whole,
    /// Where this image is not black.
    Mask(PathBuf),
    /// In a rectangle: x, y, width, height in pixels.
    Rect([f64; 4]),
    /// In what the mattes leave that the project keeps, or everywhere where it keeps none.
    Usual,
    /// In what these mattes leave, each from its frame on until the next one's.
    Kept(Vec<MatteId>),
}

impl Area {
    /// What is meant by it in a document as it is now.
    pub(super) fn meant(&self, document: &Document) -> Self {
        let mattes: Vec<MatteId> = document.mattes().map(|(_, matte)| matte).collect();
        match self {
            Self::Usual if mattes.is_empty() => Self::Whole,
            Self::Usual => Self::Kept(mattes),
            other => other.clone(),
        }
    }

    /// Frames of the mattes among it.
    ///
    /// # Errors
    /// What the project met.
    pub fn mattes(&self, project: &Project) -> Result<Vec<u32>, WorkbenchError> {
        let Self::Kept(mattes) = self else { return Ok(Vec::new()) };
        mattes.iter().map(|&matte| Ok(project.matte_info(matte)?.frame)).collect()
    }

    /// Its masks.
    ///
    /// # Errors
    /// Where an image is not as the clip is, and what the project met.
    pub(crate) fn read(&self, project: &Project, clip: &Clip) -> Result<Areas, WorkbenchError> {
        match self {
            Self::Whole | Self::Usual => Ok(Areas::default()),
            Self::Mask(path) => Ok(Areas::always(image(path, clip)?)),
            Self::Rect(rect) => Ok(Areas::always(inside(*rect, clip))),
            Self::Kept(mattes) => {
                let mask = |&matte: &MatteId| {
                    let kept = project.matte(matte)?;
                    Ok::<_, WorkbenchError>((kept.frame, kept::parts(&kept)?.mask()))
                };
                Ok(Areas::new(mattes.iter().map(mask).collect::<Result<_, _>>()?))
            }
        }
    }

    /// Why nothing is detected in an area without a pixel.
    pub(super) fn nowhere(&self, clip: &Clip) -> WorkbenchError {
        let of = (clip.width, clip.height);
        match self {
            Self::Mask(path) => WorkbenchError::EmptyMask { path: path.clone() },
            &Self::Rect([x, y, w, h]) => WorkbenchError::EmptyRegion { x, y, w, h, of },
            Self::Whole | Self::Usual => {
                WorkbenchError::EmptyRegion { x: 0.0, y: 0.0, w: of.0.into(), h: of.1.into(), of }
            }
            Self::Kept(_) => MatteError::NothingKept.into(),
        }
    }
}

/// A byte a pixel of an image of the clip's size, zero where it is black.
pub(crate) fn image(path: &Path, clip: &Clip) -> Result<Vec<u8>, WorkbenchError> {
    let wanted = (clip.width, clip.height);
    let options = OpenOptions { cache_bytes: Some(0), ..OpenOptions::default() };
    let image = honami_media::open(path, &options)?;
    let came = (image.clip().width, image.clip().height);
    if came != wanted {
        return Err(WorkbenchError::MaskSize { wanted, came, path: path.to_owned() });
    }
    let n_frames = image.clip().times.len();
    if n_frames > 1 {
        return Err(WorkbenchError::MaskFrames { n_frames, path: path.to_owned() });
    }
    let frame = image.frame(0)?;
    let gray = frame.planes().y;
    Ok((0..gray.height).flat_map(|y| gray.row(y)).copied().collect())
}

fn inside([x, y, width, height]: [f64; 4], clip: &Clip) -> Vec<u8> {
    let is_in = |v: u32, from: f64, size: f64| (from..from + size).contains(&f64::from(v));
    let pixel = |k: u64| {
        let (px, py) = (k % u64::from(clip.width), k / u64::from(clip.width));
        u8::from(is_in(px as u32, x, width) && is_in(py as u32, y, height))
    };
    (0..u64::from(clip.width) * u64::from(clip.height)).map(pixel).collect()
}
