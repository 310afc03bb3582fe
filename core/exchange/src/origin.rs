//! Where a file counts its pixels from, and the one place that converts it.
//!
//! Ours: pixels, x right, y down, (0, 0) the centre of the top-left pixel. A picture of W×H pixels reaches from
//! -0.5 to W-0.5 and H-0.5. Half a pixel is seen by every measure that counts errors below one pixel.

use std::str::FromStr;

/// How positions are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The centre of the top-left pixel is (0, 0): ours, OpenCV's, DeepLabCut's, TrackMate's.
    Centre,
    /// The outer corner of the top-left pixel is (0, 0), its centre (½, ½): CVAT, TAP-Vid.
    Corner,
    /// The centre of the top-left pixel is (1, 1): DLTdv 8, MOTChallenge.
    Top,
    /// The centre of the bottom-left pixel is (1, 1), y up: DLTdv 5 to 7, Argus.
    Bottom,
    /// As [`Corner`](Self::Corner), as shares of the picture's width and height.
    Normalised,
}

/// No such origin.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("wanted an origin: centre, corner, top, bottom or normalised; came {0}")]
pub struct OriginError(String);

impl Origin {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Centre, Self::Corner, Self::Top, Self::Bottom, Self::Normalised];

    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Corner => "corner",
            Self::Top => "top",
            Self::Bottom => "bottom",
            Self::Normalised => "normalised",
        }
    }
}

impl FromStr for Origin {
    type Err = OriginError;

    fn from_str(text: &str) -> Result<Self, OriginError> {
        Self::ALL.into_iter().find(|origin| origin.word() == text).ok_or_else(|| OriginError(text.to_owned()))
    }
}

/// Pictures of one size whose positions are counted from one origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Where it counts from.
    pub origin: Origin,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Raster {
    /// A position of the file in our pixels.
    #[must_use]
    pub fn to_ours(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size.map(f64::from);
        match self.origin {
            Origin::Centre => [x, y],
            Origin::Corner => [x - 0.5, y - 0.5],
            Origin::Top => [x - 1.0, y - 1.0],
            Origin::Bottom => [x - 1.0, height - y],
            Origin::Normalised => [x * width - 0.5, y * height - 0.5],
        }
    }

    /// A position in our pixels as the file counts it.
    #[must_use]
    pub fn from_ours(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size.map(f64::from);
        match self.origin {
            Origin::Centre => [x, y],
            Origin::Corner => [x + 0.5, y + 0.5],
            Origin::Top => [x + 1.0, y + 1.0],
            Origin::Bottom => [x + 1.0, height - y],
            Origin::Normalised => [(x + 0.5) / width, (y + 0.5) / height],
        }
    }
}

/// A position, in our pixels, on pictures of another size that show the same.
#[must_use]
pub fn resized(at: [f64; 2], from: [u32; 2], to: [u32; 2]) -> [f64; 2] {
    if from == to {
        return at;
    }
    let share = Raster { origin: Origin::Normalised, size: from }.from_ours(at);
    Raster { origin: Origin::Normalised, size: to }.to_ours(share)
}

#[cfg(test)]
mod tests;
