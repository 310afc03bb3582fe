//! Reading runs: what they are, and their samples, compacted or not.

use std::collections::BTreeMap;

use honami_model::document::RunId;
use honami_model::track::{Span, TrackId, TrackSet};
use rusqlite::{OptionalExtension, Row};

use super::{Build, RunHead, RunInfo, RunState, Seam, compact};
use crate::codec;
use crate::error::StoreError;
use crate::project::{Access, Project};

impl Project {
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

    /// What was kept of what a run was asked for; `None` where nothing was.
    ///
    /// # Errors
    /// [`StoreError::NoSuchRun`], or what SQLite met.
    pub fn request_of(&self, run: RunId) -> Result<Option<String>, StoreError> {
        let mut statement = self.conn.prepare_cached("SELECT request FROM run WHERE id = ?1")?;
        let request = statement.query_row([run.0], |row| row.get(0)).optional()?;
        request.ok_or(StoreError::NoSuchRun(run))
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

    fn seams(&self, run: RunId) -> Result<Vec<Seam>, StoreError> {
        let sql = "SELECT frame, why, plugin_version, plugin_sha256 FROM seam WHERE run = ?1 ORDER BY id";
        let mut statement = self.conn.prepare_cached(sql)?;
        let seam = |row: &Row<'_>| {
            let (version, sha256): (Option<String>, Option<String>) = (row.get(2)?, row.get(3)?);
            let build = version.zip(sha256).map(|(version, sha256)| Build { version, sha256 });
            Ok(Seam { frame: row.get(0)?, why: row.get(1)?, build })
        };
        let rows = statement.query_map([run.0], seam)?;
        Ok(rows.collect::<rusqlite::Result<_>>()?)
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
        let mut spans = statement
            .query_map([id.0], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))?
            .collect::<Result<Vec<(u32, u32, u32)>, _>>()?;
        // Chunks while it is not ended, spans afterwards: never both.
        compact::each_record(&self.conn, id, |record| {
            spans.push((record.track.0, record.first_frame, codec::len_u32(record.n_samples())));
            Ok(())
        })?;
        let tracks = spans.iter().map(|&(track, ..)| TrackId(track)).collect();
        let start = spans.iter().map(|&(_, first, _)| first).min().unwrap_or(0);
        let end = spans.iter().map(|&(_, first, n)| first.saturating_add(n)).max().unwrap_or(0);
        Ok(RunInfo { id, state, head, tracks, found: start..end, seams: self.seams(id)? })
    }
}

const SELECT_RUN: &str = "SELECT id, state, reason, first_frame, end_frame, seeds, provenance FROM run";
