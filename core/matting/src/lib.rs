//! Mattes: how much of every pixel is plant, and which parts of it are worth tracking (Zeng's dissertation 2.2.1, 5.3).
//!
//! A person marks some of a picture's background and foreground ([`Mark`]); [`matte`] finds the opacity of every pixel by
//! closed-form matting; [`Parts`] keeps of it what is neither at a boundary nor trunk, which is the mask that detectors
//! read; [`carry()`] takes marks to a later frame, where they make a matte anew.
//!
//! Pixels as everywhere: x right, y down, `(0, 0)` the centre of the top left one. No input or output, no clock, no chance;
//! the same bits for any number of threads, which are those of the rayon pool that it is called in.

mod carry;
mod cycle;
mod grid;
mod laplacian;
mod marks;
mod parts;
mod shapes;
mod solve;
mod tiles;
mod work;

#[cfg(test)]
mod tests;

use cycle::Cycle;
use tiles::Share;

pub use carry::{Moved, carry};
pub use marks::{Mark, from_scribbles, from_trimap};
pub use parts::{Part, Parts, PartsWish};

/// A borrowed picture in colour, 8 bits a channel.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    width: u32,
    height: u32,
    rgb: &'a [[u8; 3]],
}

/// A window is 3 by 3 pixels, and so is the smallest picture.
const LEAST_SIDE: u32 = 3;
/// The most pixels of a picture: 12 million take 4.3 GB.
const MOST_PIXELS: u64 = 12_000_000;

impl<'a> Picture<'a> {
    /// A picture of `height` rows of `width` pixels, row by row.
    ///
    /// # Errors
    /// Where it has less than 3 pixels along a side, more than 12 million, or not as many as its sizes say.
    pub fn new(width: u32, height: u32, rgb: &'a [[u8; 3]]) -> Result<Self, MattingError> {
        let n_pixels = u64::from(width) * u64::from(height);
        if width.min(height) < LEAST_SIDE {
            Err(MattingError::TooSmall { width, height })
        } else if n_pixels > MOST_PIXELS {
            Err(MattingError::TooLarge { width, height })
        } else if n_pixels != rgb.len() as u64 {
            Err(MattingError::Pixels { wanted: n_pixels as usize, came: rgb.len() })
        } else {
            Ok(Self { width, height, rgb })
        }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Colour of a pixel, 0 to 1.
    fn colour(&self, pixel: usize) -> [f64; 3] {
        self.rgb[pixel].map(|value| f64::from(value) / 255.0)
    }
}

/// How opacities follow colours and marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// ε of equation 2.6: how much a window prefers opacities that do not change with colour. 1e-9 to 1.
    pub epsilon: f64,
    /// λ: how much a mark weighs, beside the cost of a window. 1e-4 to 1e6.
    pub lambda: f64,
}

impl Default for Options {
    /// As in the code of the authors: ε = 1e-7, λ = 100.
    fn default() -> Self {
        Self { epsilon: 1e-7, lambda: 100.0 }
    }
}

impl Options {
    fn check(&self) -> Result<(), MattingError> {
        let ranges = [("epsilon", self.epsilon, [1e-9, 1.0]), ("lambda", self.lambda, [1e-4, 1e6])];
        ranges.into_iter().try_for_each(|(name, came, [least, most])| {
            let is_good = (least..=most).contains(&came);
            if is_good { Ok(()) } else { Err(MattingError::Option { name, came, least, most }) }
        })
    }
}

/// How much of every pixel of a picture is foreground.
#[derive(Clone, Debug, PartialEq)]
pub struct Matte {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Opacity of every pixel, 0 to 1, row by row.
    pub alpha: Vec<f32>,
    /// Steps that the solver took.
    pub n_steps: usize,
}

impl Matte {
    /// Opacities as a gray picture: 0 is background, 255 foreground.
    #[must_use]
    pub fn gray(&self) -> Vec<u8> {
        self.alpha.iter().map(|alpha| (alpha * 255.0).round() as u8).collect()
    }
}

/// The matte of a picture: opacities α that are least in `αᵀ L α + λ Σ (α_i - b_i)²`, the sum over the marked pixels, whose
/// marks are b; then cut to 0 to 1. L is the matting Laplacian, with windows of 3 by 3.
///
/// `marks` has one mark a pixel. `go_on` is told the share that is done, 0 to 1, between steps, and stops the work where it
/// says no. The minimum is found to 1 of 255, at the size of the picture: no pixel is taken to be sure because it seemed so
/// at a smaller size. Some 360 bytes a pixel are taken, and 6 to 28 µs of one core.
///
/// # Errors
/// Where there are not as many marks as pixels, or not both background and foreground among them; an option out of its
/// range; stopped.
pub fn matte(
    picture: &Picture<'_>,
    marks: &[Mark],
    options: &Options,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Matte, MattingError> {
    options.check()?;
    if marks.len() != picture.rgb.len() {
        return Err(MattingError::Pixels { wanted: picture.rgb.len(), came: marks.len() });
    }
    marks::check(marks)?;
    let mut matrix = laplacian::laplacian(picture, options.epsilon);
    for (block, mark) in matrix.blocks[0].iter_mut().zip(marks) {
        block[0][0] += mark.alpha().map_or(0.0, |_| options.lambda);
    }
    let known: Vec<[f64; 1]> = marks.iter().map(|mark| [mark.alpha().unwrap_or(0.0)]).collect();
    let right: Vec<[f64; 1]> = known.iter().map(|[alpha]| [alpha * options.lambda]).collect();
    if !go_on(0.0) {
        return Err(MattingError::Stopped);
    }
    let mut cycle = Cycle::new(matrix, &lost(picture, marks));
    let solution = solve::solve(&mut cycle, &right, known, go_on)?;
    let alpha = solution.x.iter().map(|[alpha]| alpha.clamp(0.0, 1.0) as f32).collect();
    Ok(Matte { width: picture.width, height: picture.height, alpha, n_steps: solution.n_steps })
}

/// What the Laplacian all but loses: the constant and the channels, but for marked pixels, which lose nothing.
fn lost(picture: &Picture<'_>, marks: &[Mark]) -> Vec<Share<1>> {
    let share = |(pixel, mark): (usize, &Mark)| match mark {
        Mark::Unknown => {
            let [r, g, b] = picture.colour(pixel);
            [[1.0, r, g, b]]
        }
        Mark::Background | Mark::Foreground => [[0.0; 4]],
    };
    marks.iter().enumerate().map(share).collect()
}

/// Why there is no matte.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MattingError {
    /// Not one window.
    #[error("the picture is {width}x{height} pixels, and a matte needs 3x3 at least")]
    TooSmall {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// Too much memory.
    #[error("the picture is {width}x{height} pixels, and 12 million are the most: make it smaller")]
    TooLarge {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// Not one value a pixel.
    #[error("one value for each of {wanted} pixels was wanted, and {came} came")]
    Pixels {
        /// Of the picture.
        wanted: usize,
        /// Values.
        came: usize,
    },
    /// Marks for another picture.
    #[error(
        "scribbles or trimap are {}x{} pixels, the picture {}x{}: paint on a copy of the picture", came[0], came[1],
        wanted[0], wanted[1]
    )]
    Size {
        /// Width and height of the picture.
        wanted: [u32; 2],
        /// Those of the marks.
        came: [u32; 2],
    },
    /// No copy of the picture with scribbles.
    #[error(
        "{percent} % of the scribbles' pixels are not those of the picture, and neither black nor white: paint on a copy of \
         the picture, and keep it as PNG"
    )]
    NoCopy {
        /// Of all pixels.
        percent: usize,
    },
    /// No mark at all.
    #[error("nothing is marked: paint white on what is to be kept, and black on what lies behind")]
    NothingMarked,
    /// Black alone.
    #[error("only background is marked: paint white on what is to be kept, too")]
    NoForeground,
    /// White alone.
    #[error("only foreground is marked: paint black on what lies behind, too")]
    NoBackground,
    /// A number out of its range.
    #[error("{name} is {least:e} to {most:e}, not {came}")]
    Option {
        /// Of [`Options`].
        name: &'static str,
        /// As it came.
        came: f64,
        /// At least.
        least: f64,
        /// At most.
        most: f64,
    },
    /// A place that is none.
    #[error("a feature lies at finite numbers of pixels, not at ({}, {})", at[0], at[1])]
    Place {
        /// Pixels, right and down.
        at: [f64; 2],
    },
    /// Nothing tells how the picture moved.
    #[error("no feature is seen in both frames: nothing tells how the picture moved from one to the other")]
    NothingMoved,
    /// It does not end.
    #[error(
        "after {n_steps} steps the matte is still off by an energy of {energy:e}: mark more of the picture"
    )]
    Unsolved {
        /// Taken.
        n_steps: usize,
        /// Of the error.
        energy: f64,
    },
    /// Whoever was told how far it was said no.
    #[error("stopped before the matte was found")]
    Stopped,
}
