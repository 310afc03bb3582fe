//! Runs: what a tracker found, written in chunks while it works, and never changed once it has ended.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use honami_model::document::RunId;
use honami_model::provenance::Provenance;
use honami_model::track::{Sample, Span, TrackId, TrackSet};
use rusqlite::{Connection, OptionalExtension, Row, TransactionBehavior, params};

use crate::codec;
use crate::error::StoreError;
use crate::lock::Lock;
use crate::project::{Access, Project};
use crate::schema;

mod compact;

/// Frames of a chunk at most: what a kill can cost, and what one transaction writes.
const CHUNK_FRAMES: usize = 64;

/// What is known of a run before its first frame.
#[derive(Clone, Debug, PartialEq)]
pub struct RunHead {
    /// What makes it, from what.
    pub provenance: Provenance,
    /// The tracks it begins with; more may be born in it.
    pub tracks: TrackSet,
    /// The frames it is asked for.
    pub frames: Range<u32>,
}

/// How a run stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RunState {
    /// Somebody works on it.
    Running,
    /// It did all it was asked for.
    Complete,
    /// It was stopped, or its plugin failed; what it had found is kept.
    Stopped {
        /// Why.
        reason: String,
    },
    /// The program died in the middle; what it had written is kept.
    Interrupted,
}

impl std::fmt::Display for RunState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Running => f.write_str("running"),
            Self::Complete => f.write_str("complete"),
            Self::Stopped { reason } => write!(f, "stopped: {reason}"),
            Self::Interrupted => f.write_str("interrupted"),
        }
    }
}

/// A run, without its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RunInfo {
    /// Its number.
    pub id: RunId,
    /// How it stands.
    pub state: RunState,
    /// What it was asked for.
    pub head: RunHead,
    /// The tracks it has samples of, births included; empty while it runs.
    pub tracks: TrackSet,
    /// The frames it has samples in, first to last; empty while it runs.
    pub found: Range<u32>,
}

/// The pen of a working run: its own connection, to be given to the thread that tracks.
///
/// It keeps the project locked. Dropped without [`finish`](Self::finish) or [`abandon`](Self::abandon), the
/// run counts as interrupted when the project is opened again.
#[derive(Debug)]
pub struct RunWriter {
    run: RunId,
    conn: Connection,
    _lock: Arc<Lock>,
}

impl RunWriter {
    /// The run's number.
    #[must_use]
    pub fn run(&self) -> RunId {
        self.run
    }

    /// Writes consecutive frames, each with its samples in any order; when this returns, they survive a
    /// kill. Best with 64 frames at a time. A frame written twice counts as written last; frames may come
    /// in any direction.
    ///
    /// # Errors
    /// [`StoreError::NotFinite`] before anything is written; what SQLite met.
    pub fn append(&mut self, first_frame: u32, frames: &[Vec<(TrackId, Sample)>]) -> Result<(), StoreError> {
        for (frame, samples) in (first_frame..).zip(frames) {
            let broken = samples.iter().find(|(_, sample)| !(sample.x.is_finite() && sample.y.is_finite()));
            if let Some(&(track, _)) = broken {
                return Err(StoreError::NotFinite { track, frame });
            }
        }
        for (first_frame, frames) in (first_frame..).step_by(CHUNK_FRAMES).zip(frames.chunks(CHUNK_FRAMES)) {
            let tx = self.conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
            let data = encode_chunk(first_frame, frames);
            tx.prepare_cached("INSERT INTO chunk (run, data) VALUES (?1, ?2)")?
                .execute(params![self.run.0, data])?;
            tx.commit()?;
        }
        Ok(())
    }

    /// Ends the run as complete: its chunks become one row a track, in one transaction.
    ///
    /// # Errors
    /// What SQLite met; the run stays as it was and is compacted when the project is opened again.
    pub fn finish(mut self) -> Result<RunId, StoreError> {
        compact::end(&mut self.conn, self.run, &RunState::Complete)?;
        Ok(self.run)
    }

    /// Ends the run as stopped, for a reason a person reads; what it has found is kept.
    ///
    /// # Errors
    /// As [`finish`](Self::finish).
    pub fn abandon(mut self, reason: &str) -> Result<RunId, StoreError> {
        compact::end(&mut self.conn, self.run, &RunState::Stopped { reason: reason.to_owned() })?;
        Ok(self.run)
    }
}

impl Project {
    /// Begins a run and returns its pen; edits go on meanwhile.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], or what SQLite met.
    pub fn begin_run(&mut self, head: &RunHead) -> Result<RunWriter, StoreError> {
        let lock = self.lock()?;
        let conn = schema::connect(self.path(), true)?;
        let json = |what: serde_json::Result<String>| what.map_err(StoreError::corrupt);
        conn.execute(
            "INSERT INTO run (state, first_frame, end_frame, seeds, provenance)
             VALUES ('running', ?1, ?2, ?3, ?4)",
            params![
                head.frames.start,
                head.frames.end,
                json(serde_json::to_string(&head.tracks))?,
                json(serde_json::to_string(&head.provenance))?
            ],
        )?;
        let run = RunId(u32::try_from(conn.last_insert_rowid()).map_err(StoreError::corrupt)?);
        Ok(RunWriter { run, conn, _lock: lock })
    }

    /// All runs in the order they began, shown or not.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn runs(&self) -> Result<Vec<RunInfo>, StoreError> {
        let mut statement = self.conn.prepare(&format!("{SELECT_RUN} ORDER BY id"))?;
        let rows = statement.query_map([], |row| Ok(self.run_of_row(row)))?;
        rows.map(|row| row?).collect()
    }

    /// One run.
    ///
    /// # Errors
    /// [`StoreError::NoSuchRun`], or what SQLite met.
    pub fn run(&self, run: RunId) -> Result<RunInfo, StoreError> {
        let mut statement = self.conn.prepare_cached(&format!("{SELECT_RUN} WHERE id = ?1"))?;
        let row = statement.query_row([run.0], |row| Ok(self.run_of_row(row))).optional()?;
        row.unwrap_or(Err(StoreError::NoSuchRun(run)))
    }

    /// The spans of one track in one run, in order; a working or interrupted run gives what is written.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn run_spans(&self, run: RunId, track: TrackId) -> Result<Vec<Span>, StoreError> {
        if self.has_chunks(run)? {
            let mut spans = BTreeMap::new();
            compact::gather(
                &self.conn,
                run,
                |id| id == track,
                |_, span| {
                    spans.insert(span.first_frame, span);
                    Ok(())
                },
            )?;
            return Ok(spans.into_values().collect());
        }
        let sql = "SELECT first_frame, data FROM span WHERE run = ?1 AND track = ?2 ORDER BY first_frame";
        let mut statement = self.conn.prepare_cached(sql)?;
        let mut rows = statement.query([run.0, track.0])?;
        let mut spans = Vec::new();
        while let Some(row) = rows.next()? {
            let data = row.get_ref(1)?.as_blob().map_err(StoreError::corrupt)?;
            spans.push(Span { first_frame: row.get(0)?, samples: codec::read_block(data)? });
        }
        Ok(spans)
    }

    /// All tracks of one run with their spans, in order of tracks and frames.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn run_tracks(&self, run: RunId) -> Result<Vec<(TrackId, Span)>, StoreError> {
        let mut tracks = Vec::new();
        self.each_span(run, |_| true, |track, span| tracks.push((track, span)))?;
        Ok(tracks)
    }

    /// Decodes the spans of the wanted tracks of a run, in order of tracks and frames.
    pub(crate) fn each_span(
        &self,
        run: RunId,
        wanted: impl Fn(TrackId) -> bool,
        mut each: impl FnMut(TrackId, Span),
    ) -> Result<(), StoreError> {
        if self.has_chunks(run)? {
            return compact::gather(&self.conn, run, wanted, |track, span| {
                each(track, span);
                Ok(())
            });
        }
        let sql = "SELECT track, first_frame, data FROM span WHERE run = ?1 ORDER BY track, first_frame";
        let mut statement = self.conn.prepare_cached(sql)?;
        let mut rows = statement.query([run.0])?;
        while let Some(row) = rows.next()? {
            let track = TrackId(row.get(0)?);
            if wanted(track) {
                let data = row.get_ref(2)?.as_blob().map_err(StoreError::corrupt)?;
                each(track, Span { first_frame: row.get(1)?, samples: codec::read_block(data)? });
            }
        }
        Ok(())
    }

    pub(crate) fn check_run(&self, run: RunId, tracks: &TrackSet) -> Result<(), StoreError> {
        let info = self.run(run)?;
        if info.state == RunState::Running {
            return Err(StoreError::RunWorks(run));
        }
        match tracks.iter().find(|&track| !info.tracks.contains(track)) {
            Some(track) => Err(StoreError::NotInRun { run, track }),
            None => Ok(()),
        }
    }

    fn has_chunks(&self, run: RunId) -> Result<bool, StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM chunk WHERE run = ?1)";
        Ok(self.conn.prepare_cached(sql)?.query_row([run.0], |row| row.get(0))?)
    }

    fn run_of_row(&self, row: &Row<'_>) -> Result<RunInfo, StoreError> {
        let id = RunId(row.get(0)?);
        let state = match row.get_ref(1)?.as_str().map_err(StoreError::corrupt)? {
            // A reader sees the run of a dead session as its next writer will mark it.
            "running" if self.access() == Access::Read && self.holder().is_none() => RunState::Interrupted,
            "running" => RunState::Running,
            "complete" => RunState::Complete,
            "stopped" => RunState::Stopped { reason: row.get(2)? },
            "interrupted" => RunState::Interrupted,
            other => return Err(StoreError::corrupt(format!("run {id} is '{other}'"))),
        };
        let json = |column: usize| row.get_ref(column)?.as_str().map_err(StoreError::corrupt);
        let head = RunHead {
            frames: row.get(3)?..row.get(4)?,
            tracks: serde_json::from_str(json(5)?).map_err(StoreError::corrupt)?,
            provenance: serde_json::from_str(json(6)?).map_err(StoreError::corrupt)?,
        };
        let sql = "SELECT track, first_frame, n_frames FROM span WHERE run = ?1";
        let mut statement = self.conn.prepare_cached(sql)?;
        let spans = statement
            .query_map([id.0], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?
            .collect::<Result<Vec<(u32, u32, u32)>, _>>()?;
        let tracks = spans.iter().map(|&(track, ..)| TrackId(track)).collect();
        let start = spans.iter().map(|&(_, first, _)| first).min().unwrap_or(0);
        let end = spans.iter().map(|&(_, first, n)| first + n).max().unwrap_or(0);
        Ok(RunInfo { id, state, head, tracks, found: start..end })
    }
}

const SELECT_RUN: &str = "SELECT id, state, reason, first_frame, end_frame, seeds, provenance FROM run";

/// Marks what dead sessions left running as interrupted and compacts it; the caller holds the lock.
pub(crate) fn end_interrupted(conn: &mut Connection) -> Result<(), StoreError> {
    let mut statement = conn.prepare("SELECT id FROM run WHERE state = 'running' ORDER BY id")?;
    let runs = statement.query_map([], |row| row.get(0))?.collect::<Result<Vec<u32>, _>>()?;
    drop(statement);
    runs.into_iter().try_for_each(|run| compact::end(conn, RunId(run), &RunState::Interrupted))
}

/// Consecutive frames as records of consecutive samples of a track.
fn encode_chunk(first_frame: u32, frames: &[Vec<(TrackId, Sample)>]) -> Vec<u8> {
    let mut spans: BTreeMap<TrackId, Vec<Span>> = BTreeMap::new();
    for (frame, samples) in (first_frame..).zip(frames) {
        for &(track, sample) in samples {
            let spans = spans.entry(track).or_default();
            match spans.last_mut() {
                Some(last) if last.frames().end == frame => last.samples.push(sample),
                _ => spans.push(Span { first_frame: frame, samples: vec![sample] }),
            }
        }
    }
    let mut out = Vec::new();
    for (track, spans) in spans {
        for span in spans {
            codec::write_record(&mut out, track, span.first_frame, &span.samples);
        }
    }
    out
}

#[cfg(test)]
mod tests;
