//! Where every sample of an MP4 track lies, when it is shown, and which the edit list keeps.
//!
//! ISO/IEC 14496-12, 8.6 and 8.7. Every count and offset comes from the file and is checked against it.

use std::path::Path;

use super::boxes::{find, rows, u32_at};
use crate::error::MediaError;

/// Bytes of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sample {
    pub(super) offset: u64,
    pub(super) len: u32,
    /// Its place in display order.
    pub(super) place: usize,
}

#[derive(Debug)]
pub(super) struct Table {
    /// In decoding order.
    pub(super) samples: Vec<Sample>,
    /// Time units per second.
    pub(super) timescale: u64,
    /// Presentation times in display order.
    times: Vec<i64>,
    /// The times that are shown: from, until.
    shown: (i64, i64),
}

impl Table {
    /// Reads the tables of a track (`trak`) of an index (`moov`).
    pub(super) fn read(path: &Path, moov: &[u8], trak: &[u8], file_len: u64) -> Result<Self, MediaError> {
        let damaged = |why: &str| MediaError::damaged(path, why);
        let timescale = find(trak, &[b"mdia", b"mdhd"]).and_then(timescale);
        let movie_scale = find(moov, &[b"mvhd"]).and_then(self::timescale);
        let scales = timescale.zip(movie_scale).ok_or_else(|| damaged("its index gives no unit of time"))?;
        let stbl = find(trak, &[b"mdia", b"minf", b"stbl"]).unwrap_or_default();
        let samples = places(stbl, lens(stbl).unwrap_or_default());
        let mut samples = samples.ok_or_else(|| damaged("its index places samples in no chunk"))?;
        if let Some(at) = samples.iter().position(|s| s.offset.saturating_add(u64::from(s.len)) > file_len) {
            return Err(damaged(&format!("the file ends before sample {at} of {}", samples.len())));
        }
        let mut times = times(stbl, samples.len()).ok_or_else(|| damaged("its index gives too few times"))?;
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by_key(|&at| times[at]);
        for (place, at) in order.into_iter().enumerate() {
            samples[at].place = place;
        }
        times.sort_unstable();
        let shown = shown(path, trak, scales)?;
        Ok(Self { samples, timescale: scales.0, times, shown })
    }

    /// Whether the edit list shows the `k`-th picture in display order.
    pub(super) fn keeps(&self, k: usize) -> bool {
        self.times.get(k).is_some_and(|t| (self.shown.0..self.shown.1).contains(t))
    }

    /// Times of the pictures that are shown, in display order.
    pub(super) fn kept_times(&self) -> Vec<i64> {
        self.times.iter().copied().filter(|t| (self.shown.0..self.shown.1).contains(t)).collect()
    }
}

/// Units per second of `mdhd` and `mvhd`: after two dates of 32 or, in version 1, 64 bits.
fn timescale(body: &[u8]) -> Option<u64> {
    let at = if body.first() == Some(&1) { 20 } else { 12 };
    u32_at(body, at).map(u64::from).filter(|&units| units > 0)
}

fn lens(stbl: &[u8]) -> Option<Vec<u32>> {
    let stsz = find(stbl, &[b"stsz"])?;
    let (same, n) = (u32_at(stsz, 4)?, u32_at(stsz, 8)? as usize);
    if same > 0 {
        // A picture has a byte at least: no file that we can read has more.
        return Some(vec![same; n.min(1 << 24)]);
    }
    let entries = stsz.get(12..)?.chunks_exact(4).take(n);
    Some(entries.filter_map(|entry| u32_at(entry, 0)).collect())
}

/// Samples lie one after the other in chunks; runs of chunks hold equally many.
fn places(stbl: &[u8], lens: Vec<u32>) -> Option<Vec<Sample>> {
    let chunks: Vec<u64> = match (find(stbl, &[b"stco"]), find(stbl, &[b"co64"])) {
        (Some(stco), _) => rows(stco).map(|[offset]| u64::from(offset)).collect(),
        (None, co64) => rows(co64?).map(|[high, low]| u64::from(high) << 32 | u64::from(low)).collect(),
    };
    let mut samples = Vec::with_capacity(lens.len());
    let mut lens = lens.into_iter();
    // First chunk, samples per chunk, description.
    let mut runs = rows::<3>(find(stbl, &[b"stsc"])?).peekable();
    let mut per_chunk = 0;
    for (number, &start) in (1_u32..).zip(&chunks) {
        while let Some([_, n, _]) = runs.next_if(|[first, ..]| *first <= number) {
            per_chunk = n;
        }
        let mut offset = start;
        for _ in 0..per_chunk {
            let Some(len) = lens.next() else { return Some(samples) };
            samples.push(Sample { offset, len, place: 0 });
            offset = offset.checked_add(u64::from(len))?;
        }
    }
    lens.next().is_none().then_some(samples)
}

/// Presentation times in decoding order: sums of the steps (stts) plus offsets (ctts).
fn times(stbl: &[u8], n: usize) -> Option<Vec<i64>> {
    let each = |[count, value]: [u32; 2]| std::iter::repeat_n(value, count as usize);
    let mut decoded = 0_i64;
    let mut times = Vec::with_capacity(n);
    for step in rows(find(stbl, &[b"stts"])?).flat_map(each).take(n) {
        times.push(decoded);
        decoded += i64::from(step);
    }
    if let Some(ctts) = find(stbl, &[b"ctts"]) {
        for (time, offset) in times.iter_mut().zip(rows(ctts).flat_map(each)) {
            // Version 0 says unsigned, but writers put negative ones there too.
            *time += i64::from(offset.cast_signed());
        }
    }
    (times.len() == n).then_some(times)
}

/// The piece of the track that its edit list shows; all of it without one.
fn shown(path: &Path, trak: &[u8], (timescale, movie_scale): (u64, u64)) -> Result<(i64, i64), MediaError> {
    const NORMAL_SPEED: u32 = 1 << 16;
    const EVERYTHING: (i64, i64) = (i64::MIN, i64::MAX);
    let Some(edits) = find(trak, &[b"edts", b"elst"]) else { return Ok(EVERYTHING) };
    // A media time of -1 is a pause before the clip starts.
    let pieces: Vec<(u64, i64, u32)> = edits_of(edits).filter(|&(_, start, _)| start != -1).collect();
    match pieces.as_slice() {
        [] => Ok(EVERYTHING),
        &[(length, from, NORMAL_SPEED)] => {
            let length = u128::from(length) * u128::from(timescale) / u128::from(movie_scale);
            // No length: to the end.
            let length = i64::try_from(length).ok().filter(|&length| length > 0).unwrap_or(i64::MAX);
            Ok((from, from.saturating_add(length)))
        }
        pieces => {
            let what = format!("an MP4 cut together from {} pieces or played at another speed", pieces.len());
            Err(MediaError::NeedsFfmpeg { path: path.to_path_buf(), what })
        }
    }
}

/// Length in movie units, first media time, speed (16.16 bits).
fn edits_of(elst: &[u8]) -> Box<dyn Iterator<Item = (u64, i64, u32)> + '_> {
    if elst.first() == Some(&1) {
        let long = |[a, b, c, d, speed]: [u32; 5]| {
            let wide = |high: u32, low: u32| u64::from(high) << 32 | u64::from(low);
            (wide(a, b), wide(c, d).cast_signed(), speed)
        };
        return Box::new(rows(elst).map(long));
    }
    Box::new(rows(elst).map(|[length, start, speed]| (length.into(), start.cast_signed().into(), speed)))
}
