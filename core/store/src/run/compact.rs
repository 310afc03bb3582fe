//! Chunks of frames become spans of tracks.

use std::collections::BTreeMap;

use honami_model::document::RunId;
use honami_model::track::{Sample, Span, TrackId};
use rusqlite::{Connection, TransactionBehavior, params};

use super::RunState;
use crate::codec::{self, Record};
use crate::error::StoreError;

/// Samples held in memory at once, about 110 MB: a longer run is read in several passes, as in tests.
const BATCH_SAMPLES: usize = if cfg!(test) { 50 } else { 4_000_000 };

/// Ends a run: spans instead of chunks, and the state it ends in, in one transaction.
pub(super) fn end(conn: &mut Connection, run: RunId, state: &RunState) -> Result<(), StoreError> {
    let tx = conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
    gather(&tx, run, |_| true, |track, span| insert(&tx, run, track, &span))?;
    tx.execute("DELETE FROM chunk WHERE run = ?1", [run.0])?;
    let (word, reason) = state.words();
    tx.execute("UPDATE run SET state = ?1, reason = ?2 WHERE id = ?3", params![word, reason, run.0])?;
    Ok(tx.commit()?)
}

/// Writes consecutive samples of a track of a run.
pub(super) fn insert(conn: &Connection, run: RunId, track: TrackId, span: &Span) -> Result<(), StoreError> {
    let mut data = Vec::new();
    codec::write_block(&mut data, &span.samples);
    let n_frames = codec::len_u32(span.samples.len());
    let sql = "INSERT INTO span (run, track, first_frame, n_frames, data) VALUES (?1, ?2, ?3, ?4, ?5)";
    conn.prepare_cached(sql)?.execute(params![run.0, track.0, span.first_frame, n_frames, data])?;
    Ok(())
}

/// Puts the chunks of a run together: the gap-free spans of the wanted tracks, in order of tracks and frames.
pub(super) fn gather(
    conn: &Connection,
    run: RunId,
    wanted: impl Fn(TrackId) -> bool,
    mut each: impl FnMut(TrackId, Span) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let mut n_samples: BTreeMap<TrackId, usize> = BTreeMap::new();
    each_record(conn, run, |record| {
        if wanted(record.track) {
            *n_samples.entry(record.track).or_default() += record.n_samples();
        }
        Ok(())
    })?;
    let mut left = n_samples.into_iter().peekable();
    while let Some((first, n)) = left.next() {
        let (mut last, mut total) = (first, n);
        while let Some((track, n)) = left.next_if(|(_, n)| total + n <= BATCH_SAMPLES) {
            (last, total) = (track, total + n);
        }
        let mut batch: BTreeMap<TrackId, BTreeMap<u32, Vec<Sample>>> = BTreeMap::new();
        each_record(conn, run, |record| {
            if (first..=last).contains(&record.track) && wanted(record.track) {
                let pieces = batch.entry(record.track).or_default();
                // Direction and repetition are the writer's: later pieces lie over earlier ones.
                lay(pieces, record.span()?);
            }
            Ok(())
        })?;
        for (track, pieces) in batch {
            join(pieces).into_iter().try_for_each(|span| each(track, span))?;
        }
    }
    Ok(())
}

/// Gives every record of a run's chunks in the order they were written, undecoded.
pub(super) fn each_record(
    conn: &Connection,
    run: RunId,
    mut each: impl FnMut(Record<'_>) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let mut statement = conn.prepare_cached("SELECT data FROM chunk WHERE run = ?1 ORDER BY id")?;
    let mut rows = statement.query([run.0])?;
    while let Some(row) = rows.next()? {
        let chunk = row.get_ref(0)?.as_blob().map_err(StoreError::corrupt)?;
        codec::records(chunk)?.into_iter().try_for_each(&mut each)?;
    }
    Ok(())
}

/// Lays a span over pieces that do not overlap, keyed by first frame, so that they still do not.
fn lay(pieces: &mut BTreeMap<u32, Vec<Sample>>, span: Span) {
    let frames = span.frames();
    let under: Vec<u32> = pieces
        .range(..frames.end)
        .rev()
        .take_while(|&(&start, samples)| start + codec::len_u32(samples.len()) > frames.start)
        .map(|(&start, _)| start)
        .collect();
    for start in under {
        let Some(mut head) = pieces.remove(&start) else { continue };
        let end = start + codec::len_u32(head.len());
        if end > frames.end {
            pieces.insert(frames.end, head.split_off((frames.end - start) as usize));
        }
        if start < frames.start {
            head.truncate((frames.start - start) as usize);
            pieces.insert(start, head);
        }
    }
    pieces.insert(span.first_frame, span.samples);
}

/// Joins pieces that touch.
fn join(pieces: BTreeMap<u32, Vec<Sample>>) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for (first_frame, mut samples) in pieces {
        match spans.last_mut() {
            Some(last) if last.frames().end == first_frame => last.samples.append(&mut samples),
            _ => spans.push(Span { first_frame, samples }),
        }
    }
    spans
}
