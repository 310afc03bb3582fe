//! Samples as bytes, little endian.
//!
//! A block is `version u8, n u32`, then columns: n tags u8, n times x f32, n times y f32, and the qualities
//! that were measured, forward-backward before correlation, f32 each. A tag is the status in bits 0-2, the
//! source in bits 3-5, bit 6: forward-backward was measured, bit 7: correlation was. A chunk is a sequence
//! of records `track u32, first frame u32, length u32, block` with length bytes of block.

use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};

use crate::error::StoreError;

const VERSION: u8 = 1;
const SOURCES: [Source; 5] =
    [Source::Key, Source::Sketch, Source::Tracked, Source::Interpolated, Source::Imported];

/// Appends a block.
pub(crate) fn write_block(out: &mut Vec<u8>, samples: &[Sample]) {
    out.push(VERSION);
    out.extend_from_slice(&len_u32(samples.len()).to_le_bytes());
    out.extend(samples.iter().map(|sample| {
        let Quality { fb_px, ncc } = sample.quality;
        sample.status as u8
            | (sample.source as u8) << 3
            | u8::from(fb_px.is_some()) << 6
            | u8::from(ncc.is_some()) << 7
    }));
    let columns = samples
        .iter()
        .map(|sample| sample.x)
        .chain(samples.iter().map(|sample| sample.y))
        .chain(samples.iter().filter_map(|sample| sample.quality.fb_px))
        .chain(samples.iter().filter_map(|sample| sample.quality.ncc));
    out.extend(columns.flat_map(f32::to_le_bytes));
}

/// Reads a block that fills `bytes` exactly.
///
/// # Errors
/// [`StoreError::Corrupt`] when the bytes are no block of this version.
pub(crate) fn read_block(bytes: &[u8]) -> Result<Vec<Sample>, StoreError> {
    let corrupt = || StoreError::corrupt("a block of samples cannot be read");
    let ([version], rest) = bytes.split_first_chunk().ok_or_else(corrupt)?;
    let (n, rest) = rest.split_first_chunk().ok_or_else(corrupt)?;
    let n = u32::from_le_bytes(*n) as usize;
    let (tags, columns) = rest.split_at_checked(n).ok_or_else(corrupt)?;
    let count = |bit: u8| tags.iter().filter(|&&tag| tag >> bit & 1 == 1).count();
    let (floats, tail) = columns.as_chunks::<4>();
    if *version != VERSION || !tail.is_empty() || floats.len() != 2 * n + count(6) + count(7) {
        return Err(corrupt());
    }
    let column = |from: usize| floats[from..].iter().map(|&bytes| f32::from_le_bytes(bytes));
    let (mut fbs, mut nccs) = (column(2 * n), column(2 * n + count(6)));
    tags.iter()
        .zip(column(0).zip(column(n)))
        .map(|(&tag, (x, y))| {
            Ok(Sample {
                x,
                y,
                status: Status::from_u8(tag & 7).ok_or_else(corrupt)?,
                source: *SOURCES.get((tag >> 3 & 7) as usize).ok_or_else(corrupt)?,
                quality: Quality {
                    fb_px: if tag >> 6 & 1 == 1 { fbs.next() } else { None },
                    ncc: if tag >> 7 == 1 { nccs.next() } else { None },
                },
            })
        })
        .collect()
}

/// Appends a record of a chunk.
pub(crate) fn write_record(out: &mut Vec<u8>, track: TrackId, first_frame: u32, samples: &[Sample]) {
    out.extend_from_slice(&track.0.to_le_bytes());
    out.extend_from_slice(&first_frame.to_le_bytes());
    let length_at = out.len();
    out.extend_from_slice(&[0; 4]);
    write_block(out, samples);
    let length = len_u32(out.len() - length_at - 4);
    out[length_at..length_at + 4].copy_from_slice(&length.to_le_bytes());
}

/// One record of a chunk, its samples still encoded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<'a> {
    pub(crate) track: TrackId,
    pub(crate) first_frame: u32,
    block: &'a [u8],
}

impl Record<'_> {
    /// Number of samples.
    pub(crate) fn n_samples(&self) -> usize {
        self.block.get(1..5).and_then(|n| n.try_into().ok()).map_or(0, u32::from_le_bytes) as usize
    }

    /// Decodes the samples.
    pub(crate) fn span(&self) -> Result<Span, StoreError> {
        Ok(Span { first_frame: self.first_frame, samples: read_block(self.block)? })
    }
}

/// The records of a chunk.
///
/// # Errors
/// [`StoreError::Corrupt`] when a record is cut short.
pub(crate) fn records(mut chunk: &[u8]) -> Result<Vec<Record<'_>>, StoreError> {
    let mut records = Vec::new();
    while !chunk.is_empty() {
        let (record, rest) =
            split_record(chunk).ok_or_else(|| StoreError::corrupt("a chunk of samples is cut short"))?;
        records.push(record);
        chunk = rest;
    }
    Ok(records)
}

fn split_record(chunk: &[u8]) -> Option<(Record<'_>, &[u8])> {
    let (head, rest) = chunk.split_first_chunk::<12>()?;
    let [track, first_frame, length] =
        [0, 4, 8].map(|at| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]));
    let (block, rest) = rest.split_at_checked(length as usize)?;
    Some((Record { track: TrackId(track), first_frame, block }, rest))
}

pub(crate) fn len_u32(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests;
