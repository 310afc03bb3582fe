//! MATLAB files of version 5: the matrices of numbers in them.

use crate::plant::PlantFileError;
use std::io::Read as _;

/// A file of numbers is not larger than this when it is unpacked, bytes.
const UNPACKED_MAX: u64 = 1 << 30;
/// Bytes before the first element.
const HEADER: usize = 128;

/// A matrix, column by column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    pub(super) name: String,
    pub(super) n_columns: usize,
    pub(super) numbers: Vec<f64>,
}

fn lacks(what: impl Into<String>) -> PlantFileError {
    PlantFileError::Lacks(what.into())
}

/// The first matrix of real numbers whose name begins so, in small letters.
pub(super) fn matrix(bytes: &[u8], begins: &str) -> Result<Matrix, PlantFileError> {
    let header = bytes.get(..HEADER).filter(|header| header.starts_with(b"MATLAB 5.0"));
    let header = header.ok_or_else(|| {
        lacks("a MATLAB file begins with `MATLAB 5.0`, this one does not: save it with -v7 or as CSV")
    })?;
    if header.get(126..128) != Some(b"IM") {
        return Err(lacks("a MATLAB file of a machine of the other byte order: save it anew, or as CSV"));
    }
    let mut names = Vec::new();
    let mut rest = bytes.get(HEADER..).unwrap_or_default();
    while let Some((kind, data, after)) = element(rest) {
        rest = after;
        let unpacked;
        let whole = match kind {
            15 => {
                unpacked = unpack(data)?;
                match element(&unpacked) {
                    Some((14, data, _)) => data,
                    _ => continue,
                }
            }
            14 => data,
            _ => continue,
        };
        if let Some(matrix) = real(whole) {
            if matrix.name.to_lowercase().starts_with(begins) {
                return Ok(matrix);
            }
            names.push(matrix.name);
        }
    }
    Err(lacks(format!(
        "a MATLAB file has a matrix of cylinders whose name begins with Cyl; this has {}",
        if names.is_empty() { "no matrix of numbers".to_owned() } else { names.join(", ") }
    )))
}

fn unpack(data: &[u8]) -> Result<Vec<u8>, PlantFileError> {
    let mut unpacked = Vec::new();
    let mut reader = flate2::read::ZlibDecoder::new(data).take(UNPACKED_MAX);
    reader
        .read_to_end(&mut unpacked)
        .map_err(|error| lacks(format!("a MATLAB file that is broken: {error}")))?;
    Ok(unpacked)
}

/// Kind, data, and what comes after: of the long form, or the short one with four bytes at most.
fn element(bytes: &[u8]) -> Option<(u32, &[u8], &[u8])> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let first = word(0)?;
    if first >> 16 > 0 {
        let n = (first >> 16) as usize;
        return Some((first & 0xffff, bytes.get(4..4 + n)?, bytes.get(8..)?));
    }
    let n = word(4)? as usize;
    let data = bytes.get(8..8_usize.checked_add(n)?)?;
    // Elements begin at multiples of eight bytes, but for what follows a packed one.
    let padded = if first == 15 { n } else { n.next_multiple_of(8) };
    Some((first, data, bytes.get(8 + padded..).unwrap_or_default()))
}

/// A matrix of real numbers of two dimensions.
fn real(bytes: &[u8]) -> Option<Matrix> {
    let (_, flags, rest) = element(bytes)?;
    let class = *flags.first()?;
    let is_complex = flags.get(1)? & 0x08 > 0;
    let (_, sizes, rest) = element(rest)?;
    let (_, name, rest) = element(rest)?;
    // Doubles, singles and whole numbers.
    if !(6..=15).contains(&class) || is_complex || sizes.len() != 8 {
        return None;
    }
    let size = |at: usize| Some(u32::from_le_bytes(sizes.get(at..at + 4)?.try_into().ok()?) as usize);
    let (n_rows, n_columns) = (size(0)?, size(4)?);
    let (kind, data, _) = element(rest)?;
    let numbers = numbers(kind, data)?;
    let is_whole = n_rows.checked_mul(n_columns) == Some(numbers.len()) && n_columns > 0;
    let name = String::from_utf8_lossy(name).into_owned();
    is_whole.then_some(Matrix { name, n_columns, numbers })
}

/// Numbers as they are stored, which may be smaller than their class.
fn numbers(kind: u32, data: &[u8]) -> Option<Vec<f64>> {
    macro_rules! read {
        ($kind:ty) => {
            data.as_chunks::<{ size_of::<$kind>() }>()
                .0
                .iter()
                .map(|b| <$kind>::from_le_bytes(*b) as f64)
                .collect()
        };
    }
    Some(match kind {
        1 => read!(i8),
        2 => read!(u8),
        3 => read!(i16),
        4 => read!(u16),
        5 => read!(i32),
        6 => read!(u32),
        7 => read!(f32),
        9 => read!(f64),
        _ => return None,
    })
}
