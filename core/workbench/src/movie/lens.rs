//! Where places of the clip are in a movie, and how large its strokes are.

use honami_media::Rect;

use super::{MovieSize, SIDES};
use crate::error::WorkbenchError;

/// Strokes are for pictures so high; on others they are as much larger or smaller.
const DRAWN_FOR: f64 = 480.0;
/// No stroke is thinner than so many times what it is at that height.
const THINNEST: f64 = 0.75;

/// What products of sides and scales are off by.
const TINY: f64 = 1e-6;

/// From the clip to the movie.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lens {
    /// Width and height of the movie, pixels.
    pub(super) size: [u32; 2],
    /// What of the clip, and beside it, is seen.
    pub(super) area: Rect,
    /// Pixels of the movie on one of the clip.
    pub(super) scale: f64,
    /// Pixels of the movie on one of a picture that is [`DRAWN_FOR`] high.
    pub(super) unit: f64,
}

impl Lens {
    /// # Errors
    /// [`WorkbenchError::MovieSize`] of less than 16 or more than 8192 pixels.
    pub(super) fn of(clip: [u32; 2], wanted: MovieSize) -> Result<Self, WorkbenchError> {
        let clip = clip.map(f64::from);
        let size = match wanted {
            MovieSize::Scale(scale) => clip.map(|side| (side * scale + TINY).floor()),
            MovieSize::Pixels(size) => size.map(f64::from),
        };
        if !size.iter().all(|side| SIDES.contains(side)) {
            return Err(WorkbenchError::MovieSize { width: size[0], height: size[1] });
        }
        let whole = |at: usize| size[at] / clip[at];
        let (scale, area) = match wanted {
            // Sides are whole pixels: less than one of the movie is cut off at the right and below.
            MovieSize::Scale(scale) => {
                (scale, Rect { x: -0.5, y: -0.5, width: size[0] / scale, height: size[1] / scale })
            }
            MovieSize::Pixels(_) => {
                let scale = whole(0).min(whole(1));
                let seen = size.map(|side| side / scale);
                let [x, y] = [0, 1].map(|axis| (clip[axis] - seen[axis]) / 2.0 - 0.5);
                (scale, Rect { x, y, width: seen[0], height: seen[1] })
            }
        };
        let unit = (clip[0].min(clip[1]) * scale / DRAWN_FOR).max(THINNEST);
        Ok(Self { size: size.map(|side| side as u32), area, scale, unit })
    }

    /// Where a place of the clip is.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.area.x) * self.scale - 0.5, (y - self.area.y) * self.scale - 0.5]
    }
}
