//! Inner corners of a chessboard, to a fraction of a pixel and in order.
//!
//! Places where two dark and two bright sectors meet answer to a ring of samples (`response`); each has four edges (`rays`). Two of them
//! are neighbours where an edge leads from one to the other with the dark side on the same hand, and neighbours make a grid
//! (`grid`). What is missing is looked for where the grid says it must be. Corners are then refined on the picture itself
//! (`refine`). Every threshold is a share of a corner's own contrast, of the distance of corners, or an angle.

mod grid;
mod rays;
mod refine;
mod response;
#[cfg(test)]
mod tests;

use honami_model::picture::Gray;

use crate::pyramid::Pyramid;
use grid::Grid;
pub use refine::{Window, refined};

/// A side shorter than this holds no board.
const SMALLEST_PX: u32 = 20;
/// Sizes of the picture at which boards are looked for, halves and halves of halves: squares of 8 px to 1000.
const LEVELS: u32 = 5;

/// A chessboard, by its inner corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Corners in a row.
    pub columns: usize,
    /// Rows of corners.
    pub rows: usize,
}

/// Why there are no corners.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BoardError {
    /// One corner is no grid.
    #[error("a board has at least 2 by 2 inner corners, came {columns} by {rows}")]
    Board {
        /// Corners in a row.
        columns: usize,
        /// Rows of corners.
        rows: usize,
    },
    /// Nothing to look at.
    #[error(
        "a board needs a picture of at least {SMALLEST_PX} by {SMALLEST_PX} pixels, came {width} by {height}"
    )]
    Picture {
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
    },
    /// No board.
    #[error(
        "a board of {columns} by {rows} inner corners was not found; the largest grid has {came} corners, {wide} by {high} at \
         most. All corners must be seen, with a margin of half a square"
    )]
    NotFound {
        /// Corners in a row, wanted.
        columns: usize,
        /// Rows of corners, wanted.
        rows: usize,
        /// Corners of the largest grid.
        came: usize,
        /// Its columns, as it lies in the picture.
        wide: usize,
        /// Its rows.
        high: usize,
    },
    /// Another board.
    #[error("the board has {wide} by {high} inner corners; wanted were {columns} by {rows}")]
    Other {
        /// Corners in a row, wanted.
        columns: usize,
        /// Rows of corners, wanted.
        rows: usize,
        /// Its columns, as it lies in the picture.
        wide: usize,
        /// Its rows.
        high: usize,
    },
}

/// The inner corners of a board, row by row, pixels; `x` along a row and `y` down the board turn as x and y of the picture do.
///
/// The first corner is one whose outermost square is dark, where the colours tell one end from the other (one of columns and
/// rows is even, the other odd); of boards that look the same either way, the one from which rows lead to the right. So
/// the views of two cameras agree.
///
/// # Errors
/// [`BoardError`] where there is no such board, or not all of it.
pub fn find(picture: &Gray<'_>, board: Board, window: Window) -> Result<Vec<[f64; 2]>, BoardError> {
    let Board { columns, rows } = board;
    if columns < 2 || rows < 2 {
        return Err(BoardError::Board { columns, rows });
    }
    if picture.width.min(picture.height) < SMALLEST_PX {
        return Err(BoardError::Picture { width: picture.width, height: picture.height });
    }
    let mut best: Option<Grid> = None;
    let pyramid = Pyramid::new(picture, LEVELS, response::RADIUS_PX + 2);
    for (level, sized) in pyramid.levels().iter().enumerate() {
        let corners = rays::corners(&sized.picture());
        let Some(grid) = grid::largest(&sized.picture(), corners, board) else { continue };
        if let Some(places) = grid.ordered(board) {
            let scale = f64::from(1_u32 << level);
            let places: Vec<[f64; 2]> = places.into_iter().map(|at| at.map(|c| c * scale)).collect();
            return Ok(refined(picture, &places, columns, window));
        }
        if best.as_ref().is_none_or(|best| grid.len() > best.len()) {
            best = Some(grid);
        }
    }
    let (came, [wide, high]) = best.map_or((0, [0, 0]), |grid| (grid.len(), grid.size()));
    let is_whole = came == wide * high && came > 0;
    let has_all = wide.max(high) >= columns.max(rows) && wide.min(high) >= columns.min(rows);
    Err(if is_whole && has_all {
        BoardError::Other { columns, rows, wide, high }
    } else {
        BoardError::NotFound { columns, rows, came, wide, high }
    })
}
