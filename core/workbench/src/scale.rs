//! Scale bars: how many metres a pixel is, as a person says of something in the picture.

use honami_model::edit::Transaction;
pub use honami_model::scale::{BarError, ScaleBar};
use honami_store::Project;

use crate::error::WorkbenchError;

/// Why something is no scale of a project.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ScaleError {
    /// It measures nothing.
    #[error(transparent)]
    Bar(#[from] BarError),
    /// An end is not in the picture.
    #[error(
        "({x:.1}, {y:.1}) is not in the picture of {width}x{height} pixels: both ends of a scale bar are seen"
    )]
    Outside {
        /// Pixels right.
        x: f64,
        /// Pixels down.
        y: f64,
        /// Columns of the picture.
        width: u32,
        /// Rows of it.
        height: u32,
    },
    /// There is none to take away.
    #[error("the project has no scale bar")]
    None,
    /// There is no such frame.
    #[error("there is no frame {frame}: the clip has frames 0 to {last}")]
    Frame {
        /// Asked for.
        frame: u32,
        /// The last.
        last: u32,
    },
}

/// The transaction that keeps a scale bar, or takes the one away that there is; the project stays as it is.
///
/// # Errors
/// [`ScaleError`].
pub fn prepare(project: &Project, bar: Option<ScaleBar>) -> Result<Transaction, WorkbenchError> {
    let clip = &project.clip().clip;
    let Some(bar) = bar else {
        return match project.document().scale() {
            Some(_) => Ok(Transaction::set_scale(None)),
            None => Err(ScaleError::None.into()),
        };
    };
    bar.check().map_err(ScaleError::Bar)?;
    let (width, height) = (clip.width, clip.height);
    let is_in = |v: f64, size: u32| (-0.5..=f64::from(size) - 0.5).contains(&v);
    if let Some([x, y]) = bar.ends.into_iter().find(|[x, y]| !(is_in(*x, width) && is_in(*y, height))) {
        return Err(ScaleError::Outside { x, y, width, height }.into());
    }
    let (frame, last) = (bar.frame, clip.times.len().saturating_sub(1));
    if frame > last {
        return Err(ScaleError::Frame { frame, last }.into());
    }
    Ok(Transaction::set_scale(Some(bar)))
}
