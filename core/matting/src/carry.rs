//! Marks for a later frame, from an earlier one's matte and from features that were followed from one to the other.
//!
//! Every pixel of the later frame looks where the feature nearest to it came from, takes the opacity that was there, and is
//! marked where that was sure and is so all about it. What lies between is unknown, and the later frame's own colours tell
//! it when its matte is made. So a mistake of the motion that is smaller than the band does no harm, and none is carried on
//! to the frames after.

#[cfg(test)]
mod tests;

use crate::grid::Size;
use crate::marks::{self, Mark};
use crate::shapes::near;
use crate::work::made;
use crate::{Matte, MattingError};

/// A feature in both frames: `[x, y]`, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// In the frame of the matte.
    pub from: [f64; 2],
    /// In the later frame.
    pub to: [f64; 2],
}

/// An opacity this near to 0 or 1 is sure.
const SURE: f32 = 0.05;
/// Pixels along a square that moves as one.
const SQUARE: usize = 4;

/// Marks for a later frame. `band_px` is how far a mark stays from any pixel that is not marked alike: as far as features
/// may be wrong about pixels between them.
///
/// # Errors
/// Where there is no feature, or one lies at no finite place; where no background or no foreground is left that is sure.
pub fn carry(matte: &Matte, moved: &[Moved], band_px: u32) -> Result<Vec<Mark>, MattingError> {
    let places = moved.iter().flat_map(|moved| [moved.from, moved.to]);
    if let Some(at) = places.into_iter().find(|at| !at.iter().all(|x| x.is_finite())) {
        return Err(MattingError::Place { at });
    }
    if moved.is_empty() {
        return Err(MattingError::NothingMoved);
    }
    let size = Size { width: matte.width as usize, height: matte.height as usize };
    let squares = Size { width: size.width.div_ceil(SQUARE), height: size.height.div_ceil(SQUARE) };
    let ways = made(squares.n_nodes(), |square| {
        let middle = [square % squares.width, square / squares.width]
            .map(|at| (at * SQUARE) as f64 + (SQUARE - 1) as f64 / 2.0);
        way_back(middle, moved)
    });
    let mut sure = made(size.n_nodes(), |pixel| {
        let at = [pixel % size.width, pixel / size.width];
        let way = ways[at[1] / SQUARE * squares.width + at[0] / SQUARE];
        let from = [0, 1].map(|k| (at[k] as f64 + way[k]).round());
        let is_in =
            (0.0..size.width as f64).contains(&from[0]) && (0.0..size.height as f64).contains(&from[1]);
        if is_in {
            sure(matte.alpha[from[1] as usize * size.width + from[0] as usize])
        } else {
            Mark::Unknown
        }
    });
    let others = [Mark::Background, Mark::Foreground].map(|mark| {
        let other: Vec<bool> = sure.iter().map(|&of| of != mark).collect();
        near(&other, size, band_px as usize)
    });
    for (pixel, mark) in sure.iter_mut().enumerate() {
        if others.iter().all(|near| near[pixel]) {
            *mark = Mark::Unknown;
        }
    }
    marks::check(&sure)?;
    Ok(sure)
}

/// From a place to where it came from, as the nearest feature has it; of those equally near the first.
fn way_back(at: [f64; 2], moved: &[Moved]) -> [f64; 2] {
    let far = |moved: &Moved| (moved.to[0] - at[0]).powi(2) + (moved.to[1] - at[1]).powi(2);
    let nearest = moved.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.map_or([0.0; 2], |moved| [0, 1].map(|k| moved.from[k] - moved.to[k]))
}

fn sure(alpha: f32) -> Mark {
    if alpha <= SURE {
        Mark::Background
    } else if alpha >= 1.0 - SURE {
        Mark::Foreground
    } else {
        Mark::Unknown
    }
}
