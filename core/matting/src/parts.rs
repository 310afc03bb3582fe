//! Which pixels of a matte are worth tracking (Zeng's dissertation 5.3.2, figures 5.1 and 5.3).
//!
//! A corner at a boundary belongs to the plant and to what lies behind it, so it follows neither; and the trunk hardly
//! moves. The dissertation takes both away and does not say how. Here:
//!
//! 1. A pixel is plant where its opacity is at least a half. Pieces of plant and of background that are smaller than a speck
//!    count as what is about them.
//! 2. Background that reaches the picture's border is *outside*; what the plant encloses is *inner background*.
//! 3. Plant no farther than the band from either is *boundary*.
//! 4. From the foot, the lowest row of the largest piece, up, for as long as the plant stays slender, it is *trunk*: until
//!    it is twice as wide as at the foot, which is the median of the lowest twentieth. A plant that never gets so wide has
//!    none.
//! 5. What is left is *kept*.

#[cfg(test)]
mod tests;

use std::ops::Range;

use crate::grid::Size;
use crate::shapes::{Piece, near, pieces};
use crate::{Matte, MattingError, Picture};

/// What a pixel is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Background about the plant.
    Outside,
    /// Background that the plant encloses.
    Inner,
    /// Plant beside background.
    Boundary,
    /// Plant that hardly moves, from the foot to the crown.
    Trunk,
    /// Plant to be tracked.
    Kept,
}

impl Part {
    /// All parts; projects keep their numbers in this order.
    pub const ALL: [Self; 5] = [Self::Outside, Self::Inner, Self::Boundary, Self::Trunk, Self::Kept];

    /// What it is called.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Inner => "inner background",
            Self::Boundary => "boundary",
            Self::Trunk => "trunk",
            Self::Kept => "kept",
        }
    }

    /// Its colour in pictures: as in figure 5.1, what is tracked is cyan, the boundary red, inner background yellow.
    #[must_use]
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::Outside => [40, 40, 40],
            Self::Inner => [255, 220, 0],
            Self::Boundary => [230, 40, 40],
            Self::Trunk => [150, 90, 40],
            Self::Kept => [0, 220, 220],
        }
    }
}

/// What is taken away of a matte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartsWish {
    /// Plant no farther than this from background is boundary, pixels from centre to centre.
    pub boundary_px: u32,
    /// A piece of fewer pixels is a speck.
    pub speck: usize,
    /// Whether the trunk is taken away.
    pub trunk: bool,
}

impl Default for PartsWish {
    /// A band of 3 px, specks of less than 16 pixels, without the trunk.
    fn default() -> Self {
        Self { boundary_px: 3, speck: 16, trunk: true }
    }
}

/// The part of every pixel of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One a pixel, row by row.
    pub parts: Vec<Part>,
}

/// Opacity of plant, at least.
const PLANT: f32 = 0.5;
/// The foot is this part of the plant's height, and its trunk ends where it is as many times as wide.
const FOOT: usize = 20;
const WIDER: usize = 2;

impl Parts {
    /// The parts of a matte.
    #[must_use]
    pub fn new(matte: &Matte, wish: &PartsWish) -> Self {
        let size = Size { width: matte.width as usize, height: matte.height as usize };
        let mut plant: Vec<bool> = matte.alpha.iter().map(|&alpha| alpha >= PLANT).collect();
        turn_specks(&mut plant, true, size, wish.speck);
        turn_specks(&mut plant, false, size, wish.speck);
        let behind: Vec<bool> = plant.iter().map(|plant| !plant).collect();
        let beside = near(&behind, size, wish.boundary_px as usize);
        let plant_part = |beside: &bool| if *beside { Part::Boundary } else { Part::Kept };
        let mut parts: Vec<Part> = beside.iter().map(plant_part).collect();
        for piece in pieces(&behind, size) {
            let part = if piece.at_border { Part::Outside } else { Part::Inner };
            piece.pixels.iter().for_each(|&pixel| parts[pixel] = part);
        }
        if wish.trunk {
            trunk(&plant, size).into_iter().flatten().for_each(|pixel| parts[pixel] = Part::Trunk);
        }
        Self { width: matte.width, height: matte.height, parts }
    }

    /// The mask that detectors read: 255 where features may be, else 0.
    #[must_use]
    pub fn mask(&self) -> Vec<u8> {
        self.parts.iter().map(|&part| if part == Part::Kept { 255 } else { 0 }).collect()
    }

    /// How many pixels a part has.
    #[must_use]
    pub fn n_pixels(&self, part: Part) -> usize {
        self.parts.iter().filter(|&&of| of == part).count()
    }

    /// The picture with every part in its colour: half the colour, half the picture in gray.
    ///
    /// # Errors
    /// Where the picture is of another size.
    pub fn painted(&self, picture: &Picture<'_>) -> Result<Vec<[u8; 3]>, MattingError> {
        let (wanted, came) = ([self.width, self.height], picture.size());
        if wanted != came {
            return Err(MattingError::Size { wanted: came, came: wanted });
        }
        let paint = |(part, colour): (&Part, &[u8; 3])| {
            // Luma of BT.601, in whole numbers.
            let [r, g, b] = colour.map(u32::from);
            let gray = (299 * r + 587 * g + 114 * b) / 1000;
            part.colour().map(|of_part| ((u32::from(of_part) + gray) / 2) as u8)
        };
        Ok(self.parts.iter().zip(picture.rgb).map(paint).collect())
    }
}

/// Gives pieces that are specks to what is about them.
fn turn_specks(plant: &mut [bool], of_plant: bool, size: Size, speck: usize) {
    let shape: Vec<bool> = plant.iter().map(|&plant| plant == of_plant).collect();
    let specks = pieces(&shape, size).into_iter().filter(|piece| piece.pixels.len() < speck);
    specks.flat_map(|piece| piece.pixels).for_each(|pixel| plant[pixel] = !of_plant);
}

/// The pixels of the trunk, a run a row, from the foot up.
fn trunk(plant: &[bool], size: Size) -> Vec<Range<usize>> {
    let largest = |a: Piece, b: Piece| if b.pixels.len() > a.pixels.len() { b } else { a };
    let Some(piece) = pieces(plant, size).into_iter().reduce(largest) else { return Vec::new() };
    let rows = piece.pixels.iter().map(|pixel| pixel / size.width);
    let (top, foot) = rows.fold((usize::MAX, 0), |(top, foot), y| (top.min(y), foot.max(y)));
    let mut own = vec![false; plant.len()];
    piece.pixels.iter().for_each(|&pixel| own[pixel] = true);

    let runs = |y: usize| runs(&own[y * size.width..][..size.width], y * size.width);
    let Some(lowest) = runs(foot).into_iter().max_by_key(Range::len) else { return Vec::new() };
    let mut trunk = vec![lowest];
    for y in (top..foot).rev() {
        let below = trunk[trunk.len() - 1].clone();
        let below = below.start - size.width..below.end - size.width;
        let shared = |run: &Range<usize>| run.end.min(below.end).saturating_sub(run.start.max(below.start));
        let above = runs(y).into_iter().max_by_key(shared).filter(|run| shared(run) > 0);
        let Some(above) = above else { break };
        let n_foot = ((foot - top + 1) / FOOT).max(1);
        if trunk.len() >= n_foot {
            let mut widths: Vec<usize> = trunk[..n_foot].iter().map(Range::len).collect();
            widths.sort_unstable();
            if above.len() > WIDER * widths[n_foot / 2] {
                return trunk;
            }
        }
        trunk.push(above);
    }
    Vec::new()
}

/// Where a row is true, run by run; the row begins at pixel `first`.
fn runs(row: &[bool], first: usize) -> Vec<Range<usize>> {
    let chunks = row.chunk_by(|a, b| a == b);
    let runs = chunks.scan(first, |at, chunk| {
        let start = std::mem::replace(at, *at + chunk.len());
        Some((chunk[0], start..*at))
    });
    runs.filter_map(|(is_in, run)| is_in.then_some(run)).collect()
}
