//! What is painted over the frame, and the parts of the matte that was found of it.

use std::hash::Hash as _;

use honami_workbench::matting::{Mark, Part};

use super::Canvas;
use crate::app::painting::Painting;

/// Marks: of the plant white, of what lies behind it black.
const PLANT: [u8; 3] = [255, 255, 255];
const BACKGROUND: [u8; 3] = [0, 0, 0];

impl Canvas<'_> {
    /// The parts in their colours, marks over them, and the pen; without colours in letters.
    pub(super) fn painting(&mut self, painting: &Painting) {
        let found = painting.found.as_ref().map(|(of, _)| *of);
        (painting.marks.n_changes, found, painting.brush as u8).hash(&mut self.scene);
        match self.letters.is_some() {
            true => self.painting_in_letters(painting),
            false => self.painting_in_colours(painting),
        }
        self.cross(painting.at);
    }

    fn painting_in_colours(&mut self, painting: &Painting) {
        let (columns, rows) = self.lens.size();
        for row in 0..rows {
            for column in 0..columns {
                let (from, to) = self.piece([column, row], [columns, rows]);
                let middle = [0, 1].map(|axis| (from[axis] + to[axis]) / 2.0);
                let pixel = &mut self.pixels[(row * columns + column) as usize];
                match (painting.marks.seen(from, to), painting.part_at(middle)) {
                    (Some(mark), _) => *pixel = if mark == Mark::Foreground { PLANT } else { BACKGROUND },
                    (None, Some(part)) => *pixel = mixed(*pixel, part.colour()),
                    (None, None) => {}
                }
            }
        }
    }

    fn painting_in_letters(&mut self, painting: &Painting) {
        let (columns, rows) = (u32::from(self.lens.area.width), u32::from(self.lens.area.height));
        for row in 0..rows {
            for column in 0..columns {
                let (from, to) = self.piece([column, row], [columns, rows]);
                let middle = [0, 1].map(|axis| (from[axis] + to[axis]) / 2.0);
                let letter = match (painting.marks.seen(from, to), painting.part_at(middle)) {
                    (Some(mark), _) => Some(if mark == Mark::Foreground { 'P' } else { '-' }),
                    (None, part) => part.and_then(letter_of),
                };
                if let (Some(letter), Some(letters)) = (letter, &mut self.letters) {
                    letters.letters.push(((row * columns + column) as usize, letter));
                }
            }
        }
    }

    /// What a place of the screen shows of the picture, from the middle of its first pixel to that of its last.
    fn piece(&self, at: [u32; 2], of: [u32; 2]) -> ([f64; 2], [f64; 2]) {
        let (origin, extent) = ([self.lens.x, self.lens.y], [self.lens.width, self.lens.height]);
        let edge = |axis: usize, n: u32| origin[axis] + extent[axis] * f64::from(n) / f64::from(of[axis]);
        let from = [0, 1].map(|axis| edge(axis, at[axis]));
        let to = [0, 1].map(|axis| edge(axis, at[axis] + 1));
        // Of a pixel that is seen larger than its place, the one in the middle.
        let middle = |axis: usize| (from[axis] + to[axis]) / 2.0;
        let inner = |axis: usize, edge: f64, inwards: f64| {
            let is_wide = to[axis] - from[axis] > 1.0;
            if is_wide { edge + 0.5 * inwards } else { middle(axis) }
        };
        ([0, 1].map(|axis| inner(axis, from[axis], 1.0)), [0, 1].map(|axis| inner(axis, to[axis], -1.0)))
    }
}

/// Half the picture in gray, half the part, as `honami matte --parts` writes it.
fn mixed([r, g, b]: [u8; 3], part: [u8; 3]) -> [u8; 3] {
    let gray = (299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b)) / 1000;
    part.map(|of_part| ((u32::from(of_part) + gray) / 2) as u8)
}

/// The letter of a part where there are no colours; of what lies outside none.
fn letter_of(part: Part) -> Option<char> {
    match part {
        Part::Outside => None,
        Part::Inner => Some('i'),
        Part::Boundary => Some('b'),
        Part::Trunk => Some('t'),
        Part::Kept => Some('k'),
    }
}
