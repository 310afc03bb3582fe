//! What a person says of a picture: here it is background, there foreground.

#[cfg(test)]
mod tests;

use crate::{MattingError, Picture};

/// What is known of a pixel before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Mark {
    /// Nothing: its opacity is to be found.
    #[default]
    Unknown,
    /// It shows what lies behind: opacity 0.
    Background,
    /// It shows what is to be kept: opacity 1.
    Foreground,
}

impl Mark {
    /// All marks; projects keep their numbers in this order.
    pub const ALL: [Self; 3] = [Self::Unknown, Self::Background, Self::Foreground];

    /// The opacity that it stands for, where it is known.
    #[must_use]
    pub fn alpha(self) -> Option<f64> {
        match self {
            Self::Unknown => None,
            Self::Background => Some(0.0),
            Self::Foreground => Some(1.0),
        }
    }
}

/// This dark or darker, of 255, is black; this far from white or nearer is white.
const NEAR: u8 = 25;

/// Marks by scribbles: a copy of the picture on which background was painted black and foreground white (Zeng's
/// dissertation 5.3.1).
///
/// A pixel is marked where the copy differs from the picture and is black or white, by a tenth at most in every channel. Of
/// other colours are the soft borders of brushes, which mark nothing.
///
/// # Errors
/// Where the sizes differ; where more than a quarter of the copy differs without being black or white, so that it is no
/// copy, or was compressed; where not both were painted.
pub fn from_scribbles(picture: &Picture<'_>, scribbles: &Picture<'_>) -> Result<Vec<Mark>, MattingError> {
    same_size(picture, [scribbles.width, scribbles.height])?;
    let mut n_neither = 0;
    let mark = |(before, after): (&[u8; 3], &[u8; 3])| {
        if before == after {
            return Mark::Unknown;
        }
        let mark = black_or_white(after);
        n_neither += usize::from(mark == Mark::Unknown);
        mark
    };
    let marks: Vec<Mark> = picture.rgb.iter().zip(scribbles.rgb).map(mark).collect();
    if n_neither > marks.len() / 4 {
        return Err(MattingError::NoCopy { percent: 100 * n_neither / marks.len() });
    }
    check(&marks)?;
    Ok(marks)
}

/// Marks by a trimap, a gray picture: black (0 to 25) is background, white (230 to 255) foreground, gray between unknown.
///
/// # Errors
/// Where the sizes differ; where nothing is black or nothing white.
pub fn from_trimap(picture: &Picture<'_>, trimap: &[u8], size: [u32; 2]) -> Result<Vec<Mark>, MattingError> {
    same_size(picture, size)?;
    let came = trimap.len();
    if came != picture.rgb.len() {
        return Err(MattingError::Pixels { wanted: picture.rgb.len(), came });
    }
    let marks: Vec<Mark> = trimap.iter().map(|&gray| black_or_white(&[gray; 3])).collect();
    check(&marks)?;
    Ok(marks)
}

fn black_or_white(colour: &[u8; 3]) -> Mark {
    if colour.iter().all(|&value| value <= NEAR) {
        Mark::Background
    } else if colour.iter().all(|&value| value >= u8::MAX - NEAR) {
        Mark::Foreground
    } else {
        Mark::Unknown
    }
}

fn same_size(picture: &Picture<'_>, came: [u32; 2]) -> Result<(), MattingError> {
    let wanted = [picture.width, picture.height];
    if came == wanted { Ok(()) } else { Err(MattingError::Size { wanted, came }) }
}

/// Whether there are marks of either kind.
pub(crate) fn check(marks: &[Mark]) -> Result<(), MattingError> {
    match [Mark::Background, Mark::Foreground].map(|mark| marks.contains(&mark)) {
        [true, true] => Ok(()),
        [false, false] => Err(MattingError::NothingMarked),
        [true, false] => Err(MattingError::NoForeground),
        [false, true] => Err(MattingError::NoBackground),
    }
}
