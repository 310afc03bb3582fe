//! Shapes made of pixels: what lies near them, and which hang together.

#[cfg(test)]
mod tests;

use crate::grid::Size;
use crate::work::{made, rows};

/// The pixels at most `radius` away from one of these, from centre to centre; these too.
pub(crate) fn near(shape: &[bool], size: Size, radius: usize) -> Vec<bool> {
    let Size { width, height } = size;
    // Of every pixel: how far the nearest of the shape is along its row.
    let mut along = vec![usize::MAX; shape.len()];
    rows(&mut along, width, |y, row| {
        let shape = &shape[y * width..][..width];
        for order in [(0..width).collect::<Vec<_>>(), (0..width).rev().collect()] {
            let mut since = usize::MAX;
            for x in order {
                since = if shape[x] { 0 } else { since.saturating_add(1) };
                row[x] = row[x].min(since);
            }
        }
    });
    made(shape.len(), |pixel| {
        let (x, y) = (pixel % width, pixel / width);
        (y.saturating_sub(radius)..(y + radius + 1).min(height)).any(|row| {
            let (dx, dy) = (along[row * width + x], row.abs_diff(y));
            dx <= radius && dx * dx + dy * dy <= radius * radius
        })
    })
}

/// Pixels of a shape that hang together: neighbours along rows and columns.
pub(crate) struct Piece {
    pub(crate) pixels: Vec<usize>,
    /// Whether one of them is at the picture's border.
    pub(crate) at_border: bool,
}

/// The pieces of a shape, by their first pixels.
pub(crate) fn pieces(shape: &[bool], size: Size) -> Vec<Piece> {
    let mut left = shape.to_vec();
    let mut pieces = Vec::new();
    for first in 0..left.len() {
        if !std::mem::take(&mut left[first]) {
            continue;
        }
        let mut piece = Piece { pixels: vec![first], at_border: false };
        let mut seen = 0;
        while let Some(&pixel) = piece.pixels.get(seen) {
            seen += 1;
            for offset in [[1, 0], [0, 1], [-1, 0], [0, -1]] {
                match size.beside(pixel, offset) {
                    Some(beside) if std::mem::take(&mut left[beside]) => piece.pixels.push(beside),
                    Some(_) => {}
                    None => piece.at_border = true,
                }
            }
        }
        pieces.push(piece);
    }
    pieces
}
