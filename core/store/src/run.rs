//! Runs: what a tracker found, written in chunks while it works, and never changed once it has ended.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use honami_model::document::RunId;
use honami_model::provenance::Provenance;
use honami_model::track::{Sample, Span, TrackId, TrackSet};
use rusqlite::{Connection, TransactionBehavior, params};

use crate::codec;
use crate::error::StoreError;
use crate::lock::Lock;
use crate::project::Project;
use crate::{journal, schema};

mod compact;
mod read;
mod whole;

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

impl RunState {
    /// The word in the database, and why the run was stopped.
    fn words(&self) -> (&'static str, Option<&str>) {
        match self {
            Self::Running => ("running", None),
            Self::Complete => ("complete", None),
            Self::Stopped { reason } => ("stopped", Some(reason)),
            Self::Interrupted => ("interrupted", None),
        }
    }
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

/// Where a plugin was started again in the middle of a run, from where it had last seen the features.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seam {
    /// The first frame that it tracked then.
    pub frame: u32,
    /// What became of it before, as is said of it: `died of SIGSEGV`.
    pub why: String,
    /// Another build of the plugin than before, which goes on from there; `None`: the same.
    pub build: Option<Build>,
}

/// Which build of a plugin it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Build {
    /// Version of its library.
    pub version: String,
    /// Content hash of its library, hexadecimal.
    pub sha256: String,
}

/// `1.1.0 (3f2a1c09…)`.
impl std::fmt::Display for Build {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}…)", self.version, self.sha256.get(..8).unwrap_or_default())
    }
}

/// `started again at frame 2: it died of SIGSEGV`, and with which build where that is another one.
impl std::fmt::Display for Seam {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "started again at frame {}: it {}", self.frame, self.why)?;
        self.build.as_ref().map_or(Ok(()), |build| write!(f, ", and goes on as {build}"))
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
    /// The tracks it has samples of, births included; so far, while it runs.
    pub tracks: TrackSet,
    /// The frames it has samples in, first to last; so far, while it runs.
    pub found: Range<u32>,
    /// Where its plugin was started again, in the order in which that happened.
    pub seams: Vec<Seam>,
}

impl RunInfo {
    /// The build of the plugin that tracked a frame.
    #[must_use]
    pub fn build_of(&self, frame: u32) -> Build {
        let Provenance { plugin_version, plugin_sha256, .. } = &self.head.provenance;
        let first = || Build { version: plugin_version.clone(), sha256: plugin_sha256.clone() };
        // What was said last of a frame holds: one that was given up has its frames tracked anew.
        let before = self.seams.iter().rev().filter(|seam| seam.frame <= frame);
        before.filter_map(|seam| seam.build.clone()).next().unwrap_or_else(first)
    }
}

/// The pen of a working run: its own connection, to be given to the thread that tracks.
///
/// It keeps the project locked. Dropped without [`finish`](Self::finish), [`abandon`](Self::abandon) or
/// [`discard`](Self::discard), the run counts as interrupted when the project is opened again.
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

    /// Sets `n` track numbers aside that were never used, for features found on the way.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn reserve_tracks(&mut self, n: u32) -> Result<Range<u32>, StoreError> {
        crate::project::reserve_tracks(&self.conn, n)
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

    /// Keeps that the plugin was started again.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn seam(&mut self, seam: &Seam) -> Result<(), StoreError> {
        let sql =
            "INSERT INTO seam (run, frame, why, plugin_version, plugin_sha256) VALUES (?1, ?2, ?3, ?4, ?5)";
        let (version, sha256) =
            seam.build.as_ref().map(|build| (build.version.as_str(), build.sha256.as_str())).unzip();
        self.conn.execute(sql, params![self.run.0, seam.frame, seam.why, version, sha256])?;
        Ok(())
    }

    /// Keeps what the run was asked for, in words of the caller's: see [`Project::request_of`].
    ///
    /// # Errors
    /// What SQLite met.
    pub fn keep_request(&mut self, request: &str) -> Result<(), StoreError> {
        self.conn.execute("UPDATE run SET request = ?2 WHERE id = ?1", params![self.run.0, request])?;
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

    /// Takes the run back as if it had never begun, with what it has found; another may have its number.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn discard(mut self) -> Result<(), StoreError> {
        let tx = self.conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
        tx.execute("DELETE FROM chunk WHERE run = ?1", [self.run.0])?;
        tx.execute("DELETE FROM seam WHERE run = ?1", [self.run.0])?;
        tx.execute("DELETE FROM run WHERE id = ?1", [self.run.0])?;
        Ok(tx.commit()?)
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
        let run = insert(&conn, head, &RunState::Running)?;
        Ok(RunWriter { run, conn, _lock: lock })
    }
}

/// Writes the head of a new run and returns its number.
fn insert(conn: &Connection, head: &RunHead, state: &RunState) -> Result<RunId, StoreError> {
    let json = |what: serde_json::Result<String>| what.map_err(StoreError::corrupt);
    conn.execute(
        "INSERT INTO run (state, first_frame, end_frame, seeds, provenance) VALUES (?1, ?2, ?3, ?4, ?5)",
        params![
            state.words().0,
            head.frames.start,
            head.frames.end,
            json(serde_json::to_string(&head.tracks))?,
            json(serde_json::to_string(&head.provenance))?
        ],
    )?;
    Ok(RunId(u32::try_from(conn.last_insert_rowid()).map_err(StoreError::corrupt)?))
}

/// Marks what dead sessions left running as interrupted and compacts it; the caller holds the lock. Returns
/// the interrupted runs that were never shown: also those of a session that died before it could show them.
pub(crate) fn interrupted(conn: &mut Connection) -> Result<Vec<RunId>, StoreError> {
    for run in in_state(conn, "running")? {
        compact::end(conn, run, &RunState::Interrupted)?;
    }
    let mut runs = in_state(conn, "interrupted")?;
    if !runs.is_empty() {
        let shown = journal::first_shown(conn)?.runs;
        runs.retain(|run| !shown.contains_key(run));
    }
    Ok(runs)
}

fn in_state(conn: &Connection, state: &str) -> Result<Vec<RunId>, StoreError> {
    let mut statement = conn.prepare("SELECT id FROM run WHERE state = ?1 ORDER BY id")?;
    let runs = statement.query_map([state], |row| row.get(0).map(RunId))?;
    Ok(runs.collect::<Result<_, _>>()?)
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
