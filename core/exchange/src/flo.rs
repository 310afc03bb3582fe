//! Dense motion between two pictures, in Middlebury's `.flo` files (Baker et al. 2011).
//!
//! All numbers are little-endian: the f32 202021.25 (the letters `PIEH`), i32 width, i32 height, then row by row an
//! f32 pair (u, v) for every pixel, in pixels right and down. A pair with a part beyond 1e9 in size is unknown.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::atomic::AtomicFile;
use crate::table::TableError;

/// The first four bytes of a file.
const MAGIC: [u8; 4] = 202_021.25_f32.to_le_bytes();
/// A part of a vector that is larger says that the vector is unknown.
const UNKNOWN_OVER: f32 = 1e9;
/// What is written for an unknown vector.
const UNKNOWN: [f32; 2] = [1e10; 2];
/// Neither side of a picture is longer, pixels.
const LONGEST_SIDE: u32 = 32_768;

/// Where every pixel of one picture is in the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One a pixel, row by row: by how many pixels it moves right and down; `None` where nobody knows.
    pub vectors: Vec<Option<[f32; 2]>>,
}

impl Flow {
    /// The vector at a position in pixels, bilinear between the four around it; `None` where one of them is unknown
    /// or outside.
    #[must_use]
    pub fn at(&self, [x, y]: [f32; 2]) -> Option<[f32; 2]> {
        let [(left, right, s), (top, bottom, t)] = [around(x, self.width)?, around(y, self.height)?];
        let vector = |x: usize, y: usize| self.vectors.get(y * self.width as usize + x).copied().flatten();
        let (a, b) = (vector(left, top)?, vector(right, top)?);
        let (c, d) = (vector(left, bottom)?, vector(right, bottom)?);
        let mix = |k: usize| (1.0 - t) * ((1.0 - s) * a[k] + s * b[k]) + t * ((1.0 - s) * c[k] + s * d[k]);
        Some([mix(0), mix(1)])
    }
}

/// The whole numbers on both sides of a coordinate, and how far it is from the lower to the upper one.
fn around(v: f32, size: u32) -> Option<(usize, usize, f32)> {
    let low = v.floor();
    let is_inside = low >= 0.0 && v.ceil() < size as f32;
    is_inside.then(|| (low as usize, v.ceil() as usize, v - low))
}

/// Why a `.flo` file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlowError {
    /// The system would not read it.
    #[error("cannot read the flow: {source}: {}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It begins with something else.
    #[error("this is no .flo file: it does not begin with the f32 202021.25: {}", path.display())]
    NotFlow {
        /// The file.
        path: PathBuf,
    },
    /// Its size is none that a picture has.
    #[error("the flow is said to be {}x{} pixels, wanted 1 to {LONGEST_SIDE} each: {}", size[0], size[1], path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// Width and height that it names.
        size: [i32; 2],
    },
    /// It ends too early, or goes on too long.
    #[error("a flow of {}x{} pixels takes {wanted} bytes, this file has {came}: {}", size[0], size[1], path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Width and height that it names.
        size: [u32; 2],
        /// Bytes that such a file has.
        wanted: u64,
        /// Bytes that it has.
        came: u64,
    },
}

/// Reads a `.flo` file; a vector that is not finite is unknown, too.
///
/// # Errors
/// [`FlowError`], when it cannot be read or is no such file.
pub fn read(path: &Path) -> Result<Flow, FlowError> {
    let bytes = std::fs::read(path).map_err(|source| FlowError::File { path: path.into(), source })?;
    let head = |at: usize| bytes.get(at..at + 4).and_then(|word| <[u8; 4]>::try_from(word).ok());
    let (Some(MAGIC), Some(width), Some(height)) = (head(0), head(4), head(8)) else {
        return Err(FlowError::NotFlow { path: path.into() });
    };
    let named = [i32::from_le_bytes(width), i32::from_le_bytes(height)];
    let side = |v: i32| u32::try_from(v).ok().filter(|v| (1..=LONGEST_SIDE).contains(v));
    let (Some(width), Some(height)) = (side(named[0]), side(named[1])) else {
        return Err(FlowError::Size { path: path.into(), size: named });
    };
    let (came, wanted) = (bytes.len() as u64, 12 + 8 * u64::from(width) * u64::from(height));
    if came != wanted {
        return Err(FlowError::Length { path: path.into(), size: [width, height], wanted, came });
    }
    let (pairs, _) = bytes[12..].as_chunks::<8>();
    Ok(Flow { width, height, vectors: pairs.iter().map(vector).collect() })
}

fn vector(&[a, b, c, d, e, f, g, h]: &[u8; 8]) -> Option<[f32; 2]> {
    let pair = [f32::from_le_bytes([a, b, c, d]), f32::from_le_bytes([e, f, g, h])];
    // A NaN is in no range.
    pair.iter().all(|v| (-UNKNOWN_OVER..=UNKNOWN_OVER).contains(v)).then_some(pair)
}

/// Writes a `.flo` file, whole or not at all.
///
/// # Errors
/// [`TableError::File`] when the folder cannot be written to or is full.
pub fn write(path: &Path, flow: &Flow) -> Result<(), TableError> {
    let mut file = AtomicFile::create(path, |head| head.starts_with(&MAGIC))?;
    let full = |source| TableError::File { path: path.into(), source };
    let head = [MAGIC, flow.width.to_le_bytes(), flow.height.to_le_bytes()];
    file.write_all(head.as_flattened()).map_err(full)?;
    for vector in &flow.vectors {
        let pair = vector.unwrap_or(UNKNOWN).map(f32::to_le_bytes);
        file.write_all(pair.as_flattened()).map_err(full)?;
    }
    file.finish()
}

#[cfg(test)]
mod tests;
