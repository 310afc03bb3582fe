//! The boxes of an MP4 file (ISO/IEC 14496-12): read from memory, with every length checked.
//!
//! re_mp4, tried first, walks in circles on damaged sizes; a clip that a camera did not finish must fail at once.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;

use crate::error::MediaError;

/// Largest index that is read, bytes: days of video.
const LARGEST_INDEX: u64 = 1 << 28;

/// The body of the file's index, the `moov` box.
pub(super) fn read_index(path: &Path, file: &File, file_len: u64) -> Result<Vec<u8>, MediaError> {
    let read =
        |buffer: &mut [u8], at| file.read_exact_at(buffer, at).map_err(|e| MediaError::io("read", path, e));
    let mut at = 0;
    while at + 8 <= file_len {
        let mut head = vec![0; 16.min(file_len - at) as usize];
        read(&mut head, at)?;
        let Some((name, head_len, size)) = head_of(&head, file_len - at) else { break };
        if &name == b"moov" {
            if size > file_len - at || size > LARGEST_INDEX {
                return Err(MediaError::damaged(path, "the file ends within its index"));
            }
            let mut body = vec![0; (size - head_len) as usize];
            read(&mut body, at + head_len)?;
            return Ok(body);
        }
        at = at.saturating_add(size);
    }
    Err(MediaError::damaged(path, "it has no index (moov box)"))
}

/// Name, length of the head and length of the whole box; a size of 0 reaches to the end of `available`.
fn head_of(bytes: &[u8], available: u64) -> Option<([u8; 4], u64, u64)> {
    let name = bytes.get(4..8)?.try_into().ok()?;
    let (head_len, size) = match u32_at(bytes, 0)? {
        0 => (8, available),
        1 => (16, u64_at(bytes, 8)?),
        size => (8, u64::from(size)),
    };
    (size >= head_len).then_some((name, head_len, size))
}

/// The boxes in a body, in order, up to the first that does not fit.
pub(super) fn children(body: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = body;
    std::iter::from_fn(move || {
        let (name, head_len, size) = head_of(rest, rest.len() as u64)?;
        let (whole, after) = rest.split_at_checked(usize::try_from(size).ok()?)?;
        rest = after;
        Some((name, &whole[head_len as usize..]))
    })
}

/// The body of the box at the end of a path of names.
pub(super) fn find<'a>(body: &'a [u8], path: &[&[u8; 4]]) -> Option<&'a [u8]> {
    path.iter().try_fold(body, |body, name| children(body).find(|(n, _)| n == *name).map(|(_, found)| found))
}

/// Rows of `N` numbers, 32 bits each, after a version, flags and a count.
pub(super) fn rows<const N: usize>(body: &[u8]) -> impl Iterator<Item = [u32; N]> {
    let n = u32_at(body, 4).unwrap_or(0) as usize;
    let numbers = body.get(8..).unwrap_or_default().chunks_exact(4 * N);
    numbers.take(n).map(|row| std::array::from_fn(|k| u32_at(row, 4 * k).unwrap_or(0)))
}

pub(super) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

pub(super) fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_be_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}
