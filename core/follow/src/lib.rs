//! What tracker plugins share: parameters that mean the same in all of them, the detector, and points from frame to
//! frame.
//!
//! A parameter group is taken in by `params!` with `..detection: Detection,`. A plugin that knows where points of one
//! frame are in the next gives a [`Method`], one that measures dense motion a [`Motion`], and either exports a
//! [`Follower`] of it; one whose points are more than places uses the pieces.

mod detection;
mod follower;
mod losing;
mod motion;
mod search;
mod state;

pub use detection::{Corners, Detection};
pub use follower::{Follower, Method, Step, Trust};
pub use losing::Losing;
pub use motion::Motion;
pub use search::{Search, field_there_and_back, klt_field, pyramid, there_and_back, windows};
pub use state::{from_bytes, to_bytes};

use honami_plugin::{Error, Field, Frame, Result};
use honami_vision::Gray;
use honami_vision::field::Grid;

/// The picture of a frame, as the algorithms take it.
#[must_use]
pub fn picture<'a>(frame: &Frame<'a>) -> Gray<'a> {
    let honami_plugin::Gray { data, width, height, stride } = frame.gray;
    Gray { data, width, height, stride }
}

/// Displacements at the nodes of a grid, row by row, as the host takes them.
#[must_use]
pub fn dense(grid: Grid, vectors: impl IntoIterator<Item = Option<[f32; 2]>>) -> Field {
    let Grid { origin, step_px, nx, ny } = grid;
    Field { origin, step: step_px, nx, ny, vectors: vectors.into_iter().collect() }
}

/// Refuses a frame of another size than those before, `(width, height)`.
///
/// # Errors
/// When its size is another.
pub fn check_size(frame: &Frame<'_>, before: (u32, u32)) -> Result<()> {
    let (width, height) = (frame.gray.width, frame.gray.height);
    if (width, height) == before {
        return Ok(());
    }
    Err(Error::data(format!(
        "frame {} is {width}x{height}, those before were {}x{}: split the clip where its size changes",
        frame.index, before.0, before.1
    )))
}
