//! Where every sample of an MP4 track lies, when it is shown, and which the edit list keeps.
//!
//! ISO/IEC 14496-12, 8.6 and 8.7. Every count and offset comes from the file and is checked against it.

use std::path::Path;

use re_mp4::{MoovBox, StblBox, TrakBox};

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
    pub(super) fn read(
        path: &Path,
        moov: &MoovBox,
        trak: &TrakBox,
        file_len: u64,
    ) -> Result<Self, MediaError> {
        let damaged = |why: &str| MediaError::damaged(path, why);
        let stbl = &trak.mdia.minf.stbl;
        let timescale = u64::from(trak.mdia.mdhd.timescale);
        if timescale == 0 || moov.mvhd.timescale == 0 {
            return Err(damaged("its index gives no unit of time"));
        }
        let lens = lens(stbl);
        let mut samples =
            places(stbl, &lens).ok_or_else(|| damaged("its index places samples in no chunk"))?;
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
        let shown = shown(path, trak, u64::from(moov.mvhd.timescale), timescale)?;
        Ok(Self { samples, timescale, times, shown })
    }

    /// Whether the edit list shows the `k`-th picture in display order.
    pub(super) fn keeps(&self, k: usize) -> bool {
        self.times.get(k).is_none_or(|t| (self.shown.0..self.shown.1).contains(t))
    }

    /// Times of the pictures that are shown, in display order.
    pub(super) fn kept_times(&self) -> Vec<i64> {
        self.times.iter().copied().filter(|t| (self.shown.0..self.shown.1).contains(t)).collect()
    }
}

fn lens(stbl: &StblBox) -> Vec<u32> {
    let stsz = &stbl.stsz;
    if stsz.sample_size > 0 {
        // All alike: audio mostly; the count is bounded by the chunks that hold them, see `places`.
        return vec![stsz.sample_size; stsz.sample_count.min(1 << 24) as usize];
    }
    stsz.sample_sizes.clone()
}

/// Samples lie one after the other in chunks; runs of chunks hold equally many.
fn places(stbl: &StblBox, lens: &[u32]) -> Option<Vec<Sample>> {
    let chunks: Vec<u64> = match (&stbl.stco, &stbl.co64) {
        (Some(stco), _) => stco.entries.iter().map(|&offset| u64::from(offset)).collect(),
        (None, Some(co64)) => co64.entries.clone(),
        (None, None) => return None,
    };
    let mut lens = lens.iter().copied();
    let mut samples = Vec::with_capacity(lens.len());
    let mut runs = stbl.stsc.entries.iter().peekable();
    let mut per_chunk = 0;
    for (number, &start) in (1_u32..).zip(&chunks) {
        while let Some(run) = runs.next_if(|run| run.first_chunk <= number) {
            per_chunk = run.samples_per_chunk;
        }
        let mut offset = start;
        for _ in 0..per_chunk {
            let Some(len) = lens.next() else { return Some(samples) };
            samples.push(Sample { offset, len, place: samples.len() });
            offset = offset.checked_add(u64::from(len))?;
        }
    }
    lens.next().is_none().then_some(samples)
}

/// Presentation times in decoding order: sums of the steps (stts) plus offsets (ctts).
fn times(stbl: &StblBox, n: usize) -> Option<Vec<i64>> {
    let steps =
        stbl.stts.entries.iter().flat_map(|e| std::iter::repeat_n(e.sample_delta, e.sample_count as usize));
    let mut decoded = 0_i64;
    let mut times: Vec<i64> = steps
        .take(n)
        .map(|step| {
            let time = decoded;
            decoded += i64::from(step);
            time
        })
        .collect();
    if let Some(ctts) = &stbl.ctts {
        let offsets =
            ctts.entries.iter().flat_map(|e| std::iter::repeat_n(e.sample_offset, e.sample_count as usize));
        for (time, offset) in times.iter_mut().zip(offsets) {
            *time += i64::from(offset);
        }
    }
    (times.len() == n).then_some(times)
}

/// The piece of the track that its edit list shows; all of it without one.
fn shown(path: &Path, trak: &TrakBox, movie_scale: u64, timescale: u64) -> Result<(i64, i64), MediaError> {
    let edits = trak.edts.as_ref().and_then(|edts| edts.elst.as_ref());
    let Some(edits) = edits else { return Ok((i64::MIN, i64::MAX)) };
    // A media time of -1, in 32 or 64 bits, is a pause before the clip starts.
    let is_pause = |time: u64| time == u64::from(u32::MAX) || time == u64::MAX;
    let pieces: Vec<_> = edits.entries.iter().filter(|edit| !is_pause(edit.media_time)).collect();
    match pieces.as_slice() {
        [] => Ok((i64::MIN, i64::MAX)),
        [piece] if piece.media_rate == 1 && piece.media_rate_fraction == 0 => {
            let from = i64::try_from(piece.media_time).unwrap_or(i64::MAX);
            let length = u128::from(piece.segment_duration) * u128::from(timescale) / u128::from(movie_scale);
            let until = match i64::try_from(length) {
                Ok(length) if length > 0 => from.saturating_add(length),
                _ => i64::MAX,
            };
            Ok((from, until))
        }
        pieces => {
            let what = format!("an MP4 cut together from {} pieces or played at another speed", pieces.len());
            Err(MediaError::NeedsFfmpeg { path: path.to_path_buf(), what })
        }
    }
}
